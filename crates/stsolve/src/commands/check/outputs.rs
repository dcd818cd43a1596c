//! The observations of a case: averages over time, distributions along walls.

use super::super::table::Table;
use case::{Averages, Case};

/// The table of both, if there is one of them.
pub(super) fn table<const D: usize>(case: &Case<D>) -> Option<Table> {
    let mut table = Table::new("output");
    if let Some(averages) = &case.averages {
        add_averages(&mut table, averages, case.time.end);
    }
    if !case.output.surfaces.is_empty() {
        let every = case.output.surfaces_every.map_or("at the end".to_owned(), |every| format!("every {every} slabs"));
        table.row("distributions along", case.output.surfaces.clone(), every);
    }
    (!table.is_empty()).then_some(table)
}

fn add_averages(table: &mut Table, averages: &Averages, end: f64) {
    let to = averages.to.map_or(end, |to| to.min(end));
    table.row("averages from", averages.from, "").row("averages to", to, "");
    if let Some(phases) = averages.phases {
        let periods = format!("of {:.3} periods", (to - averages.from) / phases.period);
        table.row("phases", phases.count, periods);
    }
}
