//! Curves over time, as SVG in which a script may mark times.

use super::axis::Axis;
use super::document::missing;
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

/// A chart: curves that share their axes.
pub struct Chart {
    /// Its title.
    pub title: String,
    /// The scale of the vertical axis.
    pub scale: Scale,
    /// Whether it tells of the solver and the mesh.
    pub of_solver: bool,
    /// The curves.
    pub curves: Vec<Curve>,
}

impl Chart {
    /// Whether there are numbers, and all of them are zero.
    fn is_zero(&self) -> bool {
        let values = || self.curves.iter().flat_map(|curve| &curve.values);
        values().next().is_some() && values().all(|value| *value == 0.0)
    }

    /// The figure with its legend, and space for values that a script inserts. `None` if there is no number to draw.
    fn figure(&self) -> Option<String> {
        figure(&self.title, self.scale, &self.curves)
    }
}

/// Charts of the run in their order, then those of solver and mesh, which are folded unless they are alone. Charts of zeros are named only.
pub fn arranged(charts: &[Chart]) -> String {
    let figures = |of_solver: bool| -> String {
        let shown = charts.iter().filter(|chart| chart.of_solver == of_solver && !chart.is_zero());
        let figures: String = shown.filter_map(Chart::figure).collect();
        if figures.is_empty() { figures } else { format!("<div class=\"charts\">\n{figures}</div>\n") }
    };
    let (of_run, of_solver) = (figures(false), figures(true));
    let open = if of_run.is_empty() { " open" } else { "" };
    let folded = format!("<details{open}><summary>Solver and mesh</summary>\n{of_solver}</details>\n");
    let zero: Vec<&str> = charts.iter().filter(|chart| chart.is_zero()).map(|chart| &chart.title[..]).collect();
    let zero_note = format!("<p class=\"note\">Zero at all times: {}.</p>\n", escaped(&zero.join("; ")));
    match of_run.is_empty() && of_solver.is_empty() {
        true => missing("No curves", "no slab is done yet"),
        false => [
            of_run,
            if of_solver.is_empty() { of_solver } else { folded },
            if zero.is_empty() { String::new() } else { zero_note },
        ]
        .concat(),
    }
}

/// The figure of some curves; `None` if there is no number to draw.
fn figure(title: &str, scale: Scale, curves: &[Curve]) -> Option<String> {
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
    let tick = |&value: &f64| {
        let x = axis.place(value);
        format!(
            "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{BOTTOM}\"/><text class=\"x\" x=\"{x:.1}\" \
             y=\"{:.1}\">{}</text>\n",
            BOTTOM + 15.0,
            short(value)
        )
    };
    let label = format!("<text class=\"x\" x=\"{:.1}\" y=\"{:.1}\">t</text>\n", 0.5 * (LEFT + RIGHT), HEIGHT - 3.0);
    axis.ticks.iter().map(tick).collect::<String>() + &label
}

/// Ticks and labels of the axis of values.
fn vertical(axis: &Axis) -> String {
    let tick = |&value: &f64| {
        let y = axis.place(value);
        format!(
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{RIGHT}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"y\" x=\"{:.1}\" \
             y=\"{:.1}\">{}</text>\n",
            LEFT - 6.0,
            y + 3.8,
            axis.name(value)
        )
    };
    axis.ticks.iter().map(tick).collect()
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

    /// A chart of two slabs with this value in the second one.
    fn of(title: &str, of_solver: bool, value: f64) -> Chart {
        let history = history(2, |row| row as f64 * value);
        let curves = vec![Curve::of(&history, 0, "a", "first").unwrap()];
        Chart { title: title.to_owned(), scale: Scale::Linear, of_solver, curves }
    }

    #[test]
    fn charts_of_the_solver_are_folded_unless_they_are_alone() {
        let both = arranged(&[of("lift", false, 1.0), of("residual", true, 1.0)]);
        let (open, folded) = both.split_once("<details>").unwrap();
        assert!(open.contains(">lift<") && folded.contains(">residual<") && !folded.contains(">lift<"), "{both}");
        assert!(arranged(&[of("residual", true, 1.0)]).starts_with("<details open>"));
        assert!(!arranged(&[of("lift", false, 1.0)]).contains("details"));
        assert!(arranged(&[]).contains("No curves"));
    }

    #[test]
    fn charts_of_zeros_are_named() {
        let page = arranged(&[of("lift", false, 1.0), of("heat & work", false, 0.0), of("repairs", true, 0.0)]);
        assert_eq!(page.matches("<figure").count(), 1);
        assert!(page.contains("Zero at all times: heat &amp; work; repairs.") && !page.contains("details"), "{page}");
    }

    #[test]
    fn long_histories_are_thinned_and_keep_their_end() {
        assert_eq!(drawn_rows(&history(5, |_| 0.0)), [0, 1, 2, 3, 4]);
        let rows = drawn_rows(&history(10_001, |_| 0.0));
        assert!(rows.len() <= MOST_POINTS + 1 && rows[0] == 0 && rows.last() == Some(&10_000));
    }
}
