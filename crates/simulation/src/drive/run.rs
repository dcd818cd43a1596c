//! What is driven from slab to slab: a flow, a structure or a mesh.

use crate::averages::AverageSums;
use crate::context::{RunContext, Stop};
use crate::crew::Together;
use crate::cuts::Due;
use crate::error::Failure;
use crate::failure::Finding;
use crate::record::Stored;
use crate::session::Session;
use crate::statistics::RunStatistics;
use coupled::Counts;
use output::{ArraySpec, Checkpoint, OutputError, Summary};
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A march from slab to slab, and its output.
pub(crate) trait Run {
    /// The state of the march.
    fn state(&self) -> &coupled::State;
    /// Whether the end has been reached.
    fn is_done(&self) -> bool;
    /// Attempts to advance one slab; `false` if the attempt is rejected and the next one is easier.
    fn advance(&mut self) -> anyhow::Result<bool>;
    /// Whether there is a more robust way to go on.
    fn can_fall_back(&self) -> bool {
        false
    }
    /// Whether the run goes on in it after this `error`.
    fn falls_back_after(&self, _error: &anyhow::Error) -> bool {
        false
    }
    /// Whether the start that it needs first is still missing in the run with these `statistics`.
    fn awaits_start(&self, _statistics: &RunStatistics) -> bool {
        false
    }
    /// Begins the balances anew, after the run was restored with other integrals of the same flow, or other energies of bodies.
    fn begin_balances(&mut self, _statistics: &mut RunStatistics) {}
    /// Mesh velocities at the start, at every time node, laid out like those of a slab.
    fn velocities_at_start(&self) -> Vec<f64>;
    /// The flow of the last slab in some `cells`, `[cell][time node][component][node]`; at the start the initial state at every time node. Empty
    /// without a flow.
    fn flow_of_slab(&self, _cells: Range<usize>) -> Cow<'_, [f64]> {
        Cow::default()
    }
    /// The sums of averages in some `cells`.
    fn averages(&self, _cells: Range<usize>) -> AverageSums {
        AverageSums::default()
    }
    /// The ranks that write files together, if they do.
    fn together(&self) -> Option<Together<'_>> {
        None
    }
    /// The flow of the last slab in all cells, if there is a flow.
    fn whole_flow_of_slab(&self) -> Option<Arc<Vec<f64>>> {
        None
    }
    /// Prepares and records the start of the run; returns its row of history.csv, if it has one.
    fn open(&mut self, _context: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        Ok(None)
    }
    /// Records the slab that [`Run::advance`] has solved and reports it; returns its row of history.csv.
    fn enter(&mut self, context: &mut RunContext) -> Vec<f64>;
    /// What the rejected attempts at the next slab have cost.
    fn counts(&self) -> Counts {
        Counts::default()
    }
    /// The state from which the next slab can start.
    fn store(&self) -> Stored<'_>;
    /// Restores the march from a checkpoint.
    ///
    /// # Errors
    /// Something is missing there, or cannot be read.
    fn restore(&mut self, stored: &Checkpoint) -> Result<(), Failure>;
    /// summary.json
    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary;
    /// Examines the `error` of a failed slab.
    fn examine(&self, error: &anyhow::Error, statistics: &RunStatistics) -> Finding;
    /// Writes the lines and slices that are `due` into `directory`.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn cut(&self, _directory: &Path, _due: Due) -> Result<(), OutputError> {
        Ok(())
    }
    /// Distributions along walls at the end of the last slab, with their descriptions.
    fn surfaces(&self) -> Vec<(ArraySpec, Vec<f64>)> {
        Vec::new()
    }
    /// Writes files about the state at the end into `directory`.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn leave(&self, _directory: &Path) -> anyhow::Result<()> {
        Ok(())
    }
    /// The final verdict on a run that has reached its end.
    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure>;
}
