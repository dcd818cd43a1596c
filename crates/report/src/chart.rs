//! Curves over time, as SVG in which a script may mark times.

use super::axis::Axis;
use super::groups::Scale;
use super::html::{escaped, short};
use output::HistoryTable;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Range;

/// The drawing and the plot in it, in units of the drawing.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 230.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 508.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 196.0;

/// Histories with more rows are thinned out.
pub const MOST_ROWS: usize = 2000;

/// Curves with fewer points show them.
const FEW_POINTS: usize = 40;

/// Of so many rows of a history one is on the page.
fn stride(history: &HistoryTable) -> usize {
    history.len().div_ceil(MOST_ROWS).max(1)
}

/// The rows on the page: at equal distances, the last one, and the nearest ones to the `times` of pictures.
pub fn rows_on_page(history: &HistoryTable, times: &[f64]) -> BTreeSet<usize> {
    let (count, t) = (history.len(), history.column("t").unwrap_or_default());
    let nearest = |time: &f64| (0..count).min_by(|a, b| (t[*a] - time).abs().total_cmp(&(t[*b] - time).abs()));
    (0..count).step_by(stride(history)).chain(count.checked_sub(1)).chain(times.iter().filter_map(nearest)).collect()
}

/// A curve over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its label.
    pub label: String,
    /// The run, and its column of the history.
    pub source: (usize, String),
    /// Of so many rows of that history one is on the page.
    pub stride: usize,
    /// The times.
    pub t: Vec<f64>,
    /// The values.
    pub values: Vec<f64>,
}

impl Curve {
    /// A column of the history of a run, to be drawn on this `scale`; `None` if there is no such column.
    pub fn of(history: &HistoryTable, run: usize, column: &str, label: &str, scale: Scale) -> Option<Self> {
        let (t, values, stride) = (history.column("t")?, history.column(column)?, stride(history));
        let rows = drawn_rows(&values, stride, scale);
        let [t, values] = [t, values].map(|column| rows.iter().map(|&row| column[row]).collect());
        Some(Curve { label: label.to_owned(), source: (run, column.to_owned()), stride, t, values })
    }
}

/// The rows of a curve through `values`: the first, the last, and the least and the largest value of every `2 stride` rows. Every n-th row alone
/// would show a periodic signal with a wrong period, and leave out peaks.
fn drawn_rows(values: &[f64], stride: usize, scale: Scale) -> Vec<usize> {
    let count = values.len();
    if stride == 1 {
        return (0..count).collect();
    }
    let bucket = |first: usize| extremes(values, first..count.min(first + 2 * stride), scale);
    let ends = [0, count - 1];
    let rows: BTreeSet<usize> = (0..count).step_by(2 * stride).flat_map(bucket).chain(ends).collect();
    rows.into_iter().collect()
}

/// The `rows` of the least and the largest value that the `scale` can show; the first row if it shows none, which breaks the curve.
fn extremes(values: &[f64], rows: Range<usize>, scale: Scale) -> [usize; 2] {
    let height = |row: usize| if scale == Scale::Logarithmic { values[row].abs() } else { values[row] };
    let is_shown = |row: &usize| height(*row).is_finite() && (scale == Scale::Linear || height(*row) > 0.0);
    let shown = || rows.clone().filter(is_shown);
    let least = shown().min_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap_or(rows.start);
    let largest = shown().max_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap_or(rows.start);
    [least, largest]
}

/// How the `curves` of a figure are thinned out, for its caption; empty if they have all rows.
fn thinning(curves: &[Curve]) -> String {
    let stride = curves.iter().map(|curve| curve.stride).max().unwrap_or(1);
    if stride == 1 {
        return String::new();
    }
    let up_to = if curves.iter().all(|curve| curve.stride == stride) { "" } else { "up to " };
    format!(
        "<span class=\"thinned\" data-rows=\"one row of {stride}\">least and largest value of {up_to}{} rows each; numbers and \
         CSV: one row of {up_to}{stride}</span>",
        2 * stride
    )
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
         aria-label=\"Save {title} as CSV\">CSV</button></span>{}</figcaption>\n\
         <svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-label=\"{title} from t = {} to t = {}\" data-t0=\"{}\" data-t1=\"{}\" data-x0=\"{LEFT}\" data-x1=\"{RIGHT}\">\n\
         {}{}{paths}<line class=\"cursor\" y1=\"{TOP}\" y2=\"{BOTTOM}\" x1=\"-9\" x2=\"-9\"/></svg>\n{}</figure>\n",
        thinning(curves),
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
        figure("a < b", scale, &[Curve::of(history, 0, "a", "first", scale).unwrap()])
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
    fn long_histories_are_thinned_and_keep_their_end_and_the_rows_of_pictures() {
        assert_eq!(rows_on_page(&history(5, |_| 0.0), &[]), (0..5).collect());
        assert!(rows_on_page(&history(0, |_| 0.0), &[1.0]).is_empty());
        let rows = rows_on_page(&history(10_001, |_| 0.0), &[1234.4]);
        assert!(rows.len() <= MOST_ROWS + 3 && rows.contains(&0) && rows.last() == Some(&10_000), "{}", rows.len());
        // The number below a picture was that of another slab.
        assert!(rows.contains(&1234));
    }

    /// Every 25-th row of a signal with a period of 24.5 rows was drawn as a signal with a period of 1225 rows.
    #[test]
    fn a_thinned_curve_keeps_the_extremes_of_a_periodic_signal() {
        let sine = |row: usize| (std::f64::consts::TAU * row as f64 / 24.5).sin();
        let curve = Curve::of(&history(50_000, sine), 0, "a", "first", Scale::Linear).unwrap();
        assert!(curve.t.len() <= MOST_ROWS + 2 && curve.t.is_sorted(), "{}", curve.t.len());
        assert_eq!((curve.t[0], *curve.t.last().unwrap()), (0.0, 49_999.0));
        for first in (0..50_000).step_by(50) {
            let drawn =
                || curve.t.iter().zip(&curve.values).filter(|(t, _)| (first..first + 50).contains(&(**t as usize)));
            assert!(drawn().any(|(_, value)| *value > 0.99) && drawn().any(|(_, value)| *value < -0.99), "{first}");
        }
    }

    #[test]
    fn a_peak_between_rows_is_drawn_and_zeros_do_not_break_a_logarithmic_curve() {
        let peak = |row: usize| if row == 4321 { 7.0 } else { 1.0 };
        let curve = Curve::of(&history(20_000, peak), 0, "a", "first", Scale::Linear).unwrap();
        assert!(curve.values.contains(&7.0));
        let often_zero = |row: usize| if row.is_multiple_of(3) { 0.0 } else { -1e-9 };
        let curve = Curve::of(&history(20_000, often_zero), 0, "a", "first", Scale::Logarithmic).unwrap();
        assert!(curve.values.iter().skip(1).all(|value| *value != 0.0));
        // Where there is no number at all, the curve is interrupted.
        let gap = |row: usize| if (8000..9000).contains(&row) { f64::NAN } else { row as f64 };
        let curve = Curve::of(&history(20_000, gap), 0, "a", "first", Scale::Linear).unwrap();
        assert!(curve.values.iter().any(|value| value.is_nan()));
    }

    #[test]
    fn the_caption_tells_that_a_curve_is_thinned() {
        assert!(!chart(Scale::Linear, &history(100, |row| row as f64)).unwrap().contains("thinned"));
        let figure = chart(Scale::Linear, &history(50_000, |row| row as f64)).unwrap();
        assert!(
            figure.contains("least and largest value of 50 rows each; numbers and CSV: one row of 25<"),
            "{figure}"
        );
    }
}
