//! The history and the sums that a run takes over: for its own columns, walls and controls.

use super::{Origin, RestartError};
use crate::body_record::BodyRecord;
use crate::controls;
use crate::fallback;
use crate::history::columns;
use crate::record::{COLUMNS, HISTORY};
use crate::statistics::BODIES;
use case::{Case, Flow, structure_points_of, walls_of};
use output::Arrays;

impl Origin {
    /// The sums and the history of the run, if `case` has the same walls. Columns that the run did not have are NaN in its rows.
    pub(super) fn sums<const D: usize>(&self, case: &Case<D>, flow: &Flow<D>) -> Result<Arrays, RestartError> {
        self.check_walls(flow)?;
        let here = columns(case);
        let there = self.columns(&here)?;
        // This run has its own quadrature and volume flux.
        let kept = |name: &str| name == HISTORY || (name.starts_with("statistics.") && name != fallback::SINCE);
        let arrays = self.stored.state.arrays.iter().filter(|(name, _)| kept(name));
        let mut arrays: Arrays = arrays.map(|(name, values)| (name.clone(), values.clone())).collect();
        if let Some(rows) = arrays.get_mut(HISTORY) {
            *rows = with_columns(rows, &there, &here).into();
        }
        self.carry_points(case, &mut arrays)?;
        controls::carry(case, &there, &mut arrays);
        Ok(arrays)
    }

    /// The record of the structure, the last body, keeps what points of the same name and place have done.
    fn carry_points<const D: usize>(&self, case: &Case<D>, arrays: &mut Arrays) -> Result<(), RestartError> {
        let [there, here] = self.both(case, structure_points_of)?;
        let records = arrays.get(BODIES).and_then(|numbers| BodyRecord::read_all(numbers));
        let (Some(mut records), true) = (records, there != here) else { return Ok(()) };
        if let Some(record) = records.get_mut(case.bodies.len()) {
            let places: Vec<_> = here.iter().map(|point| there.iter().position(|other| other == point)).collect();
            record.keep::<D>(&places);
        }
        arrays.insert(BODIES.into(), records.iter().flat_map(BodyRecord::numbers).collect::<Vec<f64>>().into());
        Ok(())
    }

    /// The sums of walls are in the order of walls.
    fn check_walls<const D: usize>(&self, flow: &Flow<D>) -> Result<(), RestartError> {
        let metadata = &self.result.metadata;
        let there = walls_of(&metadata.case_text, &metadata.mesh.boundary_names).join(", ");
        let here = flow.walls.iter().map(|wall| &wall.name[..]).collect::<Vec<_>>().join(", ");
        if there == here { Ok(()) } else { Err(self.differs("the walls", there, here)) }
    }

    /// The columns of the history of the run. Earlier versions did not name them: they must be as many as `here`.
    fn columns(&self, here: &[String]) -> Result<Vec<String>, RestartError> {
        let numbers = self.stored.state.arrays.get(HISTORY).map_or(0, |rows| rows.len());
        match self.stored.state.texts.get(COLUMNS) {
            Some(names) => Ok(output::names(names)),
            None if numbers.is_multiple_of(here.len()) => Ok(here.to_vec()),
            None => Err(self.differs("columns of the history", "others", here.len().to_string())),
        }
    }
}

/// `rows` with the columns `there`, one after the other, as rows with the columns `here`.
fn with_columns(rows: &[f64], there: &[String], here: &[String]) -> Vec<f64> {
    let places: Vec<_> = here.iter().map(|name| there.iter().position(|other| other == name)).collect();
    let row = |row: &[f64]| places.iter().map(|place| place.map_or(f64::NAN, |place| row[place])).collect::<Vec<_>>();
    rows.chunks_exact(there.len().max(1)).flat_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 2 columns were cut into rows of 4, and stood below names of other columns.
    #[test]
    fn rows_keep_their_columns() {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let rows = with_columns(&[1.0, 2.0, 3.0, 4.0], &names(&["t", "a"]), &names(&["t", "b", "a", "c"]));
        assert_eq!([rows[0], rows[2], rows[4], rows[6]], [1.0, 2.0, 3.0, 4.0]);
        assert!([1, 3, 5, 7].iter().all(|place| rows[*place].is_nan()) && rows.len() == 8);
    }
}
