//! The page: the data of a run, inserted into the template.

use super::html::{escaped, legend_texts, script_json, short, with_digits};
use super::pictures::{ColourMap, Encoded, Pictures, Quantity, Range, css};
use super::run_files::{FailedRun, RunFiles, Status};
use super::{axis, chart, figures, groups};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use output::HistoryTable;
use serde_json::{Map, Value, json};

const TEMPLATE: &str = include_str!("page.html");
pub const STYLE: &str = include_str!("page.css");
pub const SCRIPT: &str = include_str!("page.js");

/// The page of a run; `pictures`, or the reason why there are none.
pub fn page(run: &RunFiles, pictures: &Result<Pictures, String>) -> String {
    let (title, name) = (run.title(), run.case_name());
    fill(TEMPLATE, |key| match key {
        "style" => STYLE.to_owned(),
        "script" => SCRIPT.to_owned(),
        "name" => escaped(name),
        "title" => escaped(if title.is_empty() { name } else { &title }),
        "status" => status(run),
        "failure" => run.failure.as_ref().map_or_else(String::new, failure),
        "pictures" => pictures.as_ref().map_or_else(|reason| missing("No pictures", reason), picture_panel),
        "charts" => charts(run),
        "figures" => figures::tables(run),
        "figures_note" => figures_note(run).to_owned(),
        "case" => run.case_text().map_or_else(String::new, escaped),
        "creator" => run.result.as_ref().map_or_else(|_| String::new(), |reader| escaped(&reader.metadata.creator)),
        "data" => script_json(&data(run, pictures.as_ref().ok())),
        _ => String::new(),
    })
}

/// Replaces `{{key}}` by its value. Inserted values are not scanned again.
pub fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, text) = part.split_once("}}").unwrap_or((part, ""));
        out += &value(key);
        out += text;
    }
    out
}

/// The progress of the run.
fn status(run: &RunFiles) -> String {
    let (class, word, text) = match &run.status {
        Status::Done => ("good", "completed", String::new()),
        Status::Running => ("busy", "running", "make the report again to see more".to_owned()),
        Status::Stopped(reason) => ("bad", "stopped", escaped(reason)),
        Status::Interrupted => {
            ("bad", "interrupted", "the run has left no summary; continue it with --resume".to_owned())
        }
    };
    let reached = run.history.column("t").and_then(|t| t.last().copied());
    let reached = reached.map_or("no slab is done yet".to_owned(), |t| format!("t = {}", short(t)));
    let slabs = match run.slabs() {
        1 => "1 slab".to_owned(),
        slabs => format!("{slabs} slabs"),
    };
    format!(
        "<p class=\"status\"><span class=\"badge {class}\">{word}</span> {reached}, {slabs} <span class=\"reason\">{text}\
         </span></p>"
    )
}

/// Why a run failed: likely causes, remedies, the worst cell.
fn failure(failed: &FailedRun) -> String {
    let text = |value: &Value| escaped(value.as_str().unwrap_or_default());
    let cause = |cause: &Value| {
        format!("<li>{}.<br><strong>Remedy:</strong> {}.</li>\n", text(&cause["what"]), text(&cause["remedy"]))
    };
    let causes: String = failed.numbers["causes"].as_array().into_iter().flatten().map(cause).collect();
    let causes = if causes.is_empty() { "<li>None is known for this kind of failure.</li>".to_owned() } else { causes };
    let cell = &failed.numbers["worst_cell"];
    let centre: Vec<String> =
        cell["centre"].as_array().into_iter().flatten().filter_map(Value::as_f64).map(short).collect();
    let picture = failed.cell.as_ref().map_or_else(String::new, |svg| {
        let (uri, caption) = (BASE64_STANDARD.encode(svg), format!(
            "The worst cell, {}, at ({}): {}", cell["cell"], centre.join(", "), text(&cell["because"])
        ));
        format!(
            "<figure class=\"worst\"><img src=\"data:image/svg+xml;base64,{uri}\" alt=\"{caption}\"><figcaption>{caption}.</figcaption>\
             </figure>"
        )
    });
    let error = text(&failed.numbers["error"]);
    format!(
        "<section id=\"failure\"><h2>Why it failed</h2>\n<p>{error}</p>\n<div class=\"why\"><ol>{causes}</ol>{picture}</div></section>\n"
    )
}

fn missing(what: &str, reason: &str) -> String {
    format!("<p class=\"missing\">{what}: {}.</p>", escaped(reason))
}

fn charts(run: &RunFiles) -> String {
    let groups = groups::groups(&run.history.columns, run.boundaries());
    let figures: String = groups.iter().filter_map(|group| chart::figure(group, &run.history)).collect();
    if figures.is_empty() { missing("No curves", "no slab is done yet") } else { figures }
}

fn figures_note(run: &RunFiles) -> &'static str {
    match run.summary {
        Some(_) => "From summary.json. Point at a number to see all its digits.",
        None => "There is no summary of this run; these are sums and extremes of history.csv.",
    }
}

/// The choices above the pictures, the pictures, the legend, and their description.
fn picture_panel(pictures: &Pictures) -> String {
    let quantities = pictures.quantities.iter().enumerate();
    let quantity =
        |(i, (quantity, _)): (usize, &(Quantity, Range))| radio("quantity", i, quantity.label(pictures.dimension));
    let windows = pictures.windows.iter().enumerate().map(|(i, window)| radio("window", i, &window.label));
    fill(include_str!("pictures.html"), |key| match key {
        "quantities" => quantities.clone().map(quantity).collect(),
        "windows" => windows.clone().collect(),
        "one_window" => if pictures.windows.len() == 1 { "hidden" } else { "" }.to_owned(),
        "last" => (pictures.frames.len() - 1).to_string(),
        _ => String::new(),
    })
}

fn radio(group: &str, index: usize, label: &str) -> String {
    let checked = if index == 0 { " checked" } else { "" };
    format!(
        "<label><input type=\"radio\" name=\"{group}\" value=\"{index}\"{checked}><span>{}</span></label>",
        escaped(label)
    )
}

/// The data for the script of the page.
fn data(run: &RunFiles, pictures: Option<&Pictures>) -> Value {
    json!({ "name": run.directory, "history": [history(&run.history)], "pictures": pictures.map(picture_data) })
}

/// The displayed rows, column by column.
pub fn history(history: &HistoryTable) -> Value {
    let rows = chart::drawn_rows(history);
    let column = |name: &String| {
        let values = history.column(name).unwrap_or_default();
        (name.clone(), rows.iter().map(|&row| number(values[row])).collect::<Value>())
    };
    Value::Object(history.columns.iter().map(column).collect::<Map<_, _>>())
}

/// A number; integers without a fraction, as in the file.
fn number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 { json!(value as i64) } else { json!(value) }
}

fn picture_data(pictures: &Pictures) -> Value {
    let quantity = |(quantity, range): &(Quantity, Range)| {
        let ticks = axis::linear_ticks(range.lower, range.upper);
        let texts = legend_texts(&ticks);
        let tick = |(value, text): (&f64, &String)| json!([(value - range.lower) / (range.upper - range.lower), text]);
        json!({
            "label": quantity.label(pictures.dimension), "lower": range.lower, "upper": range.upper,
            "colours": ColourMap::css(quantity.colours()), "ticks": ticks.iter().zip(&texts).map(tick).collect::<Vec<_>>(),
            "ground": quantity.ground().map(css),
        })
    };
    let window = |(w, window): (usize, &super::pictures::Window)| {
        let views: Vec<&Encoded> = pictures.frames.iter().map(|frame| &frame.views[w]).collect();
        json!({
            "label": window.label, "width": window.width, "height": window.height,
            "lower": window.extent.lower, "upper": window.extent.upper,
            "mesh": views.iter().map(|view| &view.mesh).collect::<Vec<_>>(),
            "outline": views.iter().map(|view| &view.outline).collect::<Vec<_>>(),
            "note": window.note, "in_space": window.camera.is_some(),
            "shifts": window.follows.is_some().then(|| views.iter().map(|view| view.shift).collect::<Vec<_>>()),
            "pictures": (0..pictures.quantities.len()).map(|q| of_quantity(&views, q)).collect::<Vec<_>>(),
        })
    };
    json!({
        "times": pictures.frames.iter().map(|frame| frame.time).collect::<Vec<_>>(),
        "steps": pictures.frames.iter().map(|frame| frame.step).collect::<Vec<_>>(),
        "quantities": pictures.quantities.iter().map(quantity).collect::<Vec<_>>(),
        "windows": pictures.windows.iter().enumerate().map(window).collect::<Vec<_>>(),
    })
}

/// The pictures of a quantity at all times: the data URI, and the smallest and largest value.
fn of_quantity(views: &[&Encoded], q: usize) -> Value {
    let picture = |view: &&Encoded| {
        let extremes = view.pictures[q].extremes.map(|extremes| extremes.map(|value| with_digits(f64::from(value), 3)));
        json!([view.pictures[q].uri, extremes])
    };
    views.iter().map(picture).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let value = |key: &str| if key == "a" { "{{b}}".to_owned() } else { "x".to_owned() };
        assert_eq!(fill("1 {{a}} 2 {{b}}", value), "1 {{b}} 2 x");
    }
}
