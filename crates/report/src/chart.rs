//! Curves over time, as SVG in which a script may mark times.

use super::axis::Axis;
use super::groups::Scale;
use super::html::{escaped, short};
use output::HistoryTable;
use std::fmt::Write;

/// The drawing and the plot in it, in units of the drawing.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 230.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 508.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 196.0;

/// Curves with more points are thinned out.
pub const MOST_POINTS: usize = 2000;

/// Curves with fewer points show them.
const FEW_POINTS: usize = 40;

/// The displayed rows: at equal distances, and the last one.
pub fn drawn_rows(history: &HistoryTable) -> Vec<usize> {
    let count = history.len();
    let stride = count.div_ceil(MOST_POINTS).max(1);
    (0..count).filter(|row| row % stride == 0 || row + 1 == count).collect()
}

/// A curve over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its label.
    pub label: String,
    /// The run, and its column of the history.
    pub source: (usize, String),
    /// The times.
    pub t: Vec<f64>,
    /// The values.
    pub values: Vec<f64>,
}

impl Curve {
    /// The displayed rows of a column of the history of a run; `None` if there is no such column.
    pub fn of(history: &HistoryTable, run: usize, column: &str, label: &str) -> Option<Self> {
        let rows = drawn_rows(history);
        let pick = |name: &str| history.column(name).map(|column| rows.iter().map(|&row| column[row]).collect());
        Some(Curve { label: label.to_owned(), source: (run, column.to_owned()), t: pick("t")?, values: pick(column)? })
    }
}

/// The figure of some curves; `None` if there is no number to draw.
pub fn figure(title: &str, scale: Scale, curves: &[Curve]) -> Option<String> {
    let values = || curves.iter().flat_map(|curve| curve.values.iter().copied());
    let times = || curves.iter().flat_map(|curve| curve.t.iter().copied());
    let y = match scale {
        Scale::Linear => Axis::linear(values(), BOTTOM, TOP)?,
        Scale::Logarithmic => Axis::logarithmic(values().map(f64::abs), BOTTOM, TOP)?,
    };
    let x = Axis::linear_tight(times(), LEFT, RIGHT)?;
    let mut paths = String::new();
    for (number, curve) in curves.iter().enumerate() {
        let magnitude = |value: f64| if scale == Scale::Logarithmic { value.abs() } else { value };
        let points: Vec<_> =
            curve.t.iter().zip(&curve.values).map(|(t, value)| (x.place(*t), y.place(magnitude(*value)))).collect();
        paths += &path(&points, number);
    }
    let title = escaped(title);
    let [first, last] = [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)];
    Some(format!(
        "<figure class=\"chart\"><figcaption>{title}<span class=\"save\"><button type=\"button\" data-save=\"png\" \
         aria-label=\"Save {title} as PNG\">PNG</button><button type=\"button\" data-save=\"csv\" \
         aria-label=\"Save {title} as CSV\">CSV</button></span></figcaption>\n\
         <svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-label=\"{title} from t = {} to t = {}\" data-t0=\"{}\" data-t1=\"{}\" data-x0=\"{LEFT}\" data-x1=\"{RIGHT}\">\n\
         {}{}{paths}<line class=\"cursor\" y1=\"{TOP}\" y2=\"{BOTTOM}\" x1=\"-9\" x2=\"-9\"/></svg>\n{}</figure>\n",
        short(first),
        short(last),
        x.lower,
        x.upper,
        horizontal(&x),
        vertical(&y),
        legend(curves),
    ))
}

/// A curve, interrupted where there is no number.
fn path(points: &[(f64, f64)], number: usize) -> String {
    let (mut line, mut dots, mut down) = (String::new(), String::new(), false);
    for &(x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            down = false;
            continue;
        }
        let _ = write!(line, "{}{x:.1} {y:.1}", if down { "L" } else { "M" });
        down = true;
        if points.len() < FEW_POINTS {
            let _ = write!(dots, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.4\"/>");
        }
    }
    format!("<g class=\"curve c{}\"><path d=\"{line}\"/>{dots}</g>\n", number % 9)
}

/// Ticks and labels of the axis of time.
fn horizontal(axis: &Axis) -> String {
    let tick = |(value, text): (f64, String)| {
        let x = axis.place(value);
        format!(
            "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{BOTTOM}\"/><text class=\"x\" x=\"{x:.1}\" \
             y=\"{:.1}\">{text}</text>\n",
            BOTTOM + 15.0
        )
    };
    let label = format!("<text class=\"x\" x=\"{:.1}\" y=\"{:.1}\">t</text>\n", 0.5 * (LEFT + RIGHT), HEIGHT - 3.0);
    axis.labels().map(tick).collect::<String>() + &label
}

/// Ticks and labels of the axis of values.
fn vertical(axis: &Axis) -> String {
    let tick = |(value, text): (f64, String)| {
        let y = axis.place(value);
        format!(
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{RIGHT}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"y\" x=\"{:.1}\" \
             y=\"{:.1}\">{text}</text>\n",
            LEFT - 6.0,
            y + 3.8
        )
    };
    axis.labels().map(tick).collect()
}

fn legend(curves: &[Curve]) -> String {
    let item = |(number, curve): (usize, &Curve)| {
        let (run, column) = &curve.source;
        format!(
            "<li><svg class=\"key\" viewBox=\"0 0 22 8\" aria-hidden=\"true\"><g class=\"curve c{}\"><path d=\"M0 4H22\"/></g>\
             </svg>{} <output data-run=\"{run}\" data-column=\"{}\" data-label=\"{}\"></output></li>",
            number % 9,
            escaped(&curve.label),
            escaped(column),
            escaped(&curve.label),
        )
    };
    format!("<ul class=\"legend\">{}</ul>", curves.iter().enumerate().map(item).collect::<String>())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The chart of the column `a` of a history.
    fn chart(scale: Scale, history: &HistoryTable) -> Option<String> {
        figure("a < b", scale, &[Curve::of(history, 0, "a", "first").unwrap()])
    }

    fn history(rows: usize, value: impl Fn(usize) -> f64) -> HistoryTable {
        let rows = (0..rows).flat_map(|row| [row as f64, value(row)]).collect();
        HistoryTable { columns: vec!["t".into(), "a".into()], rows }
    }

    #[test]
    fn a_curve_goes_through_its_points() {
        let figure = chart(Scale::Linear, &history(3, |row| [1.0, 3.0, 2.0][row])).unwrap();
        // From the left to the right end, the largest value on top.
        assert!(figure.contains("a &lt; b") && figure.contains("<path d=\"M70.0 "), "{figure}");
        let points: Vec<&str> =
            figure.split("<path d=\"M").nth(1).unwrap().split('"').next().unwrap().split('L').collect();
        let y: Vec<f64> = points.iter().map(|p| p.split(' ').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(points.len(), 3);
        assert!(y[0] > y[2] && y[2] > y[1] && y.iter().all(|y| (TOP..=BOTTOM).contains(y)), "{y:?}");
        assert!((y[0] - 2.0 * y[2] + y[1]).abs() < 0.2, "linear: {y:?}");
    }

    #[test]
    fn what_is_no_number_breaks_a_curve() {
        let figure = chart(Scale::Logarithmic, &history(5, |row| if row == 2 { 0.0 } else { -1e-9 })).unwrap();
        let path = figure.split("<path d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!((path.matches('M').count(), path.matches('L').count()), (2, 2), "{path}");
    }

    #[test]
    fn without_a_number_there_is_no_figure() {
        assert!(chart(Scale::Linear, &history(0, |_| 0.0)).is_none());
        assert!(chart(Scale::Logarithmic, &history(4, |_| 0.0)).is_none());
    }

    #[test]
    fn long_histories_are_thinned_and_keep_their_end() {
        assert_eq!(drawn_rows(&history(5, |_| 0.0)), [0, 1, 2, 3, 4]);
        let rows = drawn_rows(&history(10_001, |_| 0.0));
        assert!(rows.len() <= MOST_POINTS + 1 && rows[0] == 0 && rows.last() == Some(&10_000));
    }
}
