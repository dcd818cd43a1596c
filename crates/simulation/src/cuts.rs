//! The files of lines and slices.

use super::cells::StateSource;
use super::probes::FlowAtPoints;
use super::{lines, slices};
use case::Case;
use output::{LineFile, OutputError, SliceSeries};
use std::path::Path;

/// The checkpoint that a run is resumed from.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    /// Its time.
    pub time: f64,
    /// The slabs before it.
    pub slabs: usize,
    /// Whether it is the end of the resumed run, too.
    pub is_end: bool,
    /// Whether it is the start of the run: its files begin there, however many slabs an earlier run had done.
    pub is_start: bool,
}

impl Reached {
    /// The last time that a file with an entry after `every` slabs keeps. The entry of a former end is left out if a run without
    /// interruption has none there.
    pub fn last_kept(self, every: usize) -> f64 {
        if self.keeps_last(every) { self.time } else { self.time.next_down() }
    }

    /// Whether an entry at its time is one of those after `every` slabs, or that of the end.
    pub fn keeps_last(self, every: usize) -> bool {
        self.is_end || self.is_start || self.slabs.is_multiple_of(every)
    }
}

/// Which lines and slices are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Those that are due after a number of slabs.
    BySlabs,
    /// Those that are not: where a run stops early, the others have been written.
    Rest,
    /// All, at the start and the end.
    All,
}

impl Due {
    /// Whether what is written after `every` slabs belongs to them after so many `slabs`.
    fn includes(self, every: usize, slabs: usize) -> bool {
        match self {
            Due::BySlabs => slabs.is_multiple_of(every),
            Due::Rest => !slabs.is_multiple_of(every),
            Due::All => true,
        }
    }
}

/// Starts the files in `directory`, or keeps what they have up to the checkpoint `reached` of a run that is resumed.
///
/// # Errors
/// A file that cannot be written.
pub fn begin<const D: usize>(case: &Case<D>, directory: &Path, reached: Option<Reached>) -> Result<(), OutputError> {
    let observed = &case.observed;
    let last_kept = |every| reached.map(|reached| reached.last_kept(every));
    for line in &observed.lines {
        let columns = lines::columns(line, &observed.formulas);
        LineFile::of(directory, &line.name).begin(&columns, &lines::places(line), last_kept(line.every))?;
    }
    observed.slices.iter().try_for_each(|slice| SliceSeries::of(directory, &slice.name).begin(last_kept(slice.every)))
}

/// Writes the lines and slices that are `due` after so many `slabs`.
///
/// # Errors
/// A file that cannot be written.
pub fn write<const D: usize, const M: usize>(
    case: &Case<D>,
    (flow, source): (&FlowAtPoints<D>, &StateSource),
    directory: &Path,
    (slabs, due): (usize, Due),
) -> Result<(), OutputError> {
    let is_due = |every: usize| due.includes(every, slabs);
    for line in case.observed.lines.iter().filter(|line| is_due(line.every)) {
        LineFile::of(directory, &line.name).append(&lines::rows::<D, M>(flow, line, source))?;
    }
    for slice in case.observed.slices.iter().filter(|slice| is_due(slice.every)) {
        let cut = slices::cut::<D, M>(flow, slice, source);
        SliceSeries::of(directory, &slice.name).append(slabs, flow.time, &cut, slice.csv)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that stops early writes each entry once.
    #[test]
    fn the_rest_is_what_was_not_due() {
        for slabs in 0..12 {
            let of = |due: Due| due.includes(3, slabs);
            assert!(of(Due::All) && of(Due::BySlabs) != of(Due::Rest), "{slabs}");
        }
    }

    /// A line of a run that was extended once kept its rows at the former end, which one long run does not have.
    #[test]
    fn the_rows_of_a_former_end_are_kept_only_where_one_run_has_them() {
        let reached = |slabs, is_end| Reached { time: 0.5, slabs, is_end, is_start: false };
        assert_eq!(reached(6, false).last_kept(3), 0.5);
        assert!(reached(5, false).last_kept(3) < 0.5);
        assert_eq!(reached(5, true).last_kept(3), 0.5, "nothing is left to do");
        assert_eq!(reached(0, false).last_kept(3), 0.5, "the start");
        let start = Reached { is_start: true, ..reached(7, false) };
        assert_eq!(start.last_kept(3), 0.5, "the start of a run that continues another one");
    }
}
