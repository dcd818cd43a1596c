//! All charts of a page: those of the run, then those of solver and mesh, folded.

use super::chart::{Curve, figure};
use super::document::missing;
use super::groups::Scale;
use super::html::escaped;

/// Coefficients of this size are round-off, such as the lift of a symmetric body. Quantities with units have no such size.
const ROUND_OFF: f64 = 1e-13;

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
        let largest = if self.title.ends_with("coefficients") { ROUND_OFF } else { 0.0 };
        values().next().is_some() && values().all(|value| value.abs() <= largest)
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A chart of two slabs with this value in the second one.
    fn of(title: &str, of_solver: bool, value: f64) -> Chart {
        let (label, source) = ("first".to_owned(), (0, "a".to_owned()));
        let curves = vec![Curve { label, source, stride: 1, t: vec![0.0, 1.0], values: vec![0.0, value] }];
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
        let coefficients = of("foil & tail: coefficients", false, 3e-19);
        let page = arranged(&[of("lift", false, 1.0), coefficients, of("repairs", true, 0.0)]);
        assert_eq!(page.matches("<figure").count(), 1);
        let told = "Zero at all times: foil &amp; tail: coefficients; repairs.";
        assert!(page.contains(told) && !page.contains("details"), "{page}");
        // The mass of a cube of a micrometre was called zero.
        assert!(!arranged(&[of("Mass", false, 1.2e-18)]).contains("Zero"));
    }
}
