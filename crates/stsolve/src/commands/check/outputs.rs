//! The observations of a case: averages over time, distributions along walls, points, lines, planes, formulas of fields.

use super::super::table::Table;
use case::{Averages, Case, Observed};
use tensor::AXES;

/// The table of all, if there are any.
pub(super) fn table<const D: usize>(case: &Case<D>) -> Option<Table> {
    let mut table = Table::new("output");
    if let Some(averages) = &case.averages {
        add_averages(&mut table, averages, case.time.end);
    }
    if !case.output.surfaces.is_empty() {
        let every = case.output.surfaces_every.map_or("at the end".to_owned(), |every| format!("every {every} slabs"));
        table.row("distributions along", case.output.surfaces.clone(), every);
    }
    add_observed(&mut table, &case.observed);
    (!table.is_empty()).then_some(table)
}

fn add_observed<const D: usize>(table: &mut Table, observed: &Observed<D>) {
    let Observed { formulas, probes, lines, slices } = observed;
    let mut add = |key: &str, names: Vec<String>, file: &str| {
        if !names.is_empty() {
            table.row(key, names, file);
        }
    };
    add("fields by formulas", formulas.iter().map(|formula| formula.name.clone()).collect(), "");
    add("points", probes.iter().map(|probe| probe.name.clone()).collect(), "in history.csv");
    add("lines", lines.iter().map(|line| line.name.clone()).collect(), "in line_NAME.csv");
    add("slices", slices.iter().map(|slice| slice.name.clone()).collect(), "in slice_NAME.pvd");
}

fn add_averages(table: &mut Table, averages: &Averages, end: f64) {
    let to = averages.to.map_or(end, |to| to.min(end)).max(averages.from);
    table.row("averages from", averages.from, "").row("averages to", to, "");
    if !averages.along.is_empty() {
        let axes: Vec<&str> = averages.along.iter().map(|&axis| AXES[axis]).collect();
        table.row("averages along", axes.join(", "), "in averages_along.csv");
    }
    if let Some(phases) = averages.phases {
        let periods = format!("of {:.3} periods", (to - averages.from) / phases.period);
        table.row("phases", phases.count, periods);
    }
}
