//! The files of lines and slices.

use super::probes::FlowAtPoints;
use super::{lines, slices};
use case::Case;
use output::{LineFile, OutputError, SliceSeries};
use std::path::Path;

/// Starts the files in `directory`, or keeps what they have up to the time `reached` of a run that is resumed.
///
/// # Errors
/// A file that cannot be written.
pub fn begin<const D: usize>(case: &Case<D>, directory: &Path, reached: Option<f64>) -> Result<(), OutputError> {
    let observed = &case.observed;
    for line in &observed.lines {
        LineFile::of(directory, &line.name).begin(&lines::columns(line, &observed.formulas), reached)?;
    }
    observed.slices.iter().try_for_each(|slice| SliceSeries::of(directory, &slice.name).begin(reached))
}

/// Writes the lines and slices that are due after so many `slabs`; all of them `at_end`.
///
/// # Errors
/// A file that cannot be written.
pub fn write<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &FlowAtPoints<D>,
    directory: &Path,
    (slabs, at_end): (usize, bool),
) -> Result<(), OutputError> {
    let is_due = |every: usize| at_end || slabs.is_multiple_of(every);
    for line in case.observed.lines.iter().filter(|line| is_due(line.every)) {
        LineFile::of(directory, &line.name).append(&lines::rows::<D, M>(flow, line))?;
    }
    for slice in case.observed.slices.iter().filter(|slice| is_due(slice.every)) {
        let cut = slices::cut::<D, M>(flow, slice);
        SliceSeries::of(directory, &slice.name).append(slabs, flow.time, &cut)?;
    }
    Ok(())
}
