//! The pictures of a run on its page: the choices, the pictures, the legend, and the data for the script.

use super::axis;
use super::document::fill;
use super::html::{escaped, texts_on_scale, with_digits};
use super::pictures::{ColourMap, Cut, Encoded, PictureQuantity, Pictures, Range, Window, css};
use serde_json::{Value, json};
use tensor::AXES;

const TEMPLATE: &str = include_str!("pictures.html");

/// The choices above the pictures, the pictures, the legend, and their description.
pub fn html(pictures: &Pictures) -> String {
    let quantities = pictures.quantities.iter().map(|(quantity, _)| quantity.label(pictures.dimension));
    let windows = pictures.windows.iter().chain(pictures.cuts.iter().map(|cut| &cut.window));
    let windows: Vec<&str> = windows.map(|window| &window.label[..]).collect();
    fill(TEMPLATE, |key| match key {
        "quantities" => radios("quantity", quantities.clone()),
        "windows" => radios("window", windows.iter().copied()),
        "one_window" => if windows.len() == 1 { "hidden" } else { "" }.to_owned(),
        "last" => (pictures.frames.len() - 1).to_string(),
        _ => String::new(),
    })
}

/// One button for each label, the first of them pressed.
fn radios<'a>(group: &str, labels: impl Iterator<Item = &'a str>) -> String {
    let radio = |(index, label): (usize, &str)| {
        let checked = if index == 0 { " checked" } else { "" };
        format!(
            "<label><input type=\"radio\" name=\"{group}\" value=\"{index}\"{checked}><span>{}</span></label>",
            escaped(label)
        )
    };
    labels.enumerate().map(radio).collect()
}

/// The data of the pictures for the script.
pub fn data(pictures: &Pictures) -> Value {
    let over_time = |(w, shown): (usize, &Window)| {
        let views: Vec<&Encoded> = pictures.frames.iter().map(|frame| &frame.views[w]).collect();
        window(shown, pictures.quantities.len(), &views)
    };
    let windows = pictures.windows.iter().enumerate().map(over_time);
    let cuts = pictures.cuts.iter().map(|shown| cut(shown, pictures.quantities.len()));
    json!({
        "times": pictures.frames.iter().map(|frame| frame.time).collect::<Vec<_>>(),
        "steps": pictures.frames.iter().map(|frame| frame.step).collect::<Vec<_>>(),
        "quantities": pictures.quantities.iter().map(|shown| quantity(shown, pictures.dimension)).collect::<Vec<_>>(),
        "windows": windows.chain(cuts).collect::<Vec<_>>(),
    })
}

/// A quantity and its legend.
fn quantity((quantity, range): &(PictureQuantity, Range), dimension: usize) -> Value {
    let ticks = axis::linear_ticks(range.lower, range.upper);
    let texts = texts_on_scale(&ticks, 3);
    let tick = |(value, text): (&f64, &String)| json!([(value - range.lower) / (range.upper - range.lower), text]);
    json!({
        "label": quantity.label(dimension), "lower": range.lower, "upper": range.upper,
        "colours": ColourMap::css(quantity.colours()), "ticks": ticks.iter().zip(&texts).map(tick).collect::<Vec<_>>(),
        "ground": quantity.ground().map(css),
    })
}

/// A window and its pictures, one of each quantity at every time or, in a cut, at every position.
fn window(window: &Window, quantities: usize, views: &[&Encoded]) -> Value {
    json!({
        "label": window.label, "width": window.width, "height": window.height,
        "lower": window.extent.lower, "upper": window.extent.upper, "axes": window.plane.axes().map(|axis| AXES[axis]),
        "mesh": views.iter().map(|view| &view.mesh).collect::<Vec<_>>(),
        "outline": views.iter().map(|view| &view.outline).collect::<Vec<_>>(),
        "note": window.note, "in_space": window.camera.is_some(),
        "shifts": window.follows.is_some().then(|| views.iter().map(|view| view.shift).collect::<Vec<_>>()),
        "pictures": (0..quantities).map(|q| of_quantity(views, q)).collect::<Vec<_>>(),
    })
}

/// A window at the last time with a plane that a slider moves.
fn cut(cut: &Cut, quantities: usize) -> Value {
    let mut value = window(&cut.window, quantities, &cut.views.iter().collect::<Vec<_>>());
    value["cut"] = json!({ "axis": AXES[cut.window.plane.axis], "positions": cut.positions });
    value
}

/// All pictures of a quantity: the data URI, and the smallest and largest value.
fn of_quantity(views: &[&Encoded], q: usize) -> Value {
    let picture = |view: &&Encoded| {
        let extremes = view.pictures[q].extremes.map(|extremes| extremes.map(|value| with_digits(f64::from(value), 3)));
        json!([view.pictures[q].uri, extremes])
    };
    views.iter().map(picture).collect()
}
