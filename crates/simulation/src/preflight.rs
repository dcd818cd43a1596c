//! What is known of a run before it starts, for callers of any dimension.

use super::build::{self, PrescribedNode};
use super::error::Failure;
use super::failure::Mismatch;
use super::openings::{self, Record};
use super::probe::{self, MeshOverRun, ProbeError, Timing};
use super::record::result_bytes;
use super::restart;
use case::{Case, Flow};

/// Questions to a case that need the solver.
///
/// The answers are compiled here, once for two and once for three dimensions. A generic function would compile the solver in every crate
/// that calls it.
pub trait Preflight<const D: usize> {
    /// Requires that the result from which the case starts exists and fits, if it names one. Returns warnings.
    ///
    /// # Errors
    /// The file, and why it does not fit.
    fn require_restart(&self, flow: &Flow<D>) -> Result<Vec<String>, Failure>;

    /// The inflows and outflows whose conditions do not suit the initial state.
    fn openings_at_start(&self, flow: &Flow<D>) -> Vec<Record>;

    /// The inflows and outflows at which the flow starts with a jump.
    fn jumps_at_openings(&self, flow: &Flow<D>) -> Vec<Mismatch>;

    /// Times the parts of the first slab.
    ///
    /// # Errors
    /// A mesh or a state from which the first slab cannot start.
    fn time_flow(&self, flow: &Flow<D>) -> Result<Timing, ProbeError>;

    /// Moves the mesh over the whole run, until a cell is not valid; `None` if it rests.
    ///
    /// # Errors
    /// A mesh that cannot be moved.
    fn move_over_run(&self) -> anyhow::Result<Option<MeshOverRun>>;

    /// The C0 nodes with a prescribed motion: those of boundaries that move, or all.
    fn prescribed_nodes(&self) -> Vec<PrescribedNode<D>>;

    /// The solver that the mesh will have, if its interior is elastic.
    fn elasticity_plan(&self) -> Option<elasticity::Plan>;

    /// The bytes that the result file of the whole run will have.
    fn result_bytes(&self) -> usize;
}

macro_rules! with_components {
    ($d:literal, $m:literal) => {
        impl Preflight<$d> for Case<$d> {
            fn require_restart(&self, flow: &Flow<$d>) -> Result<Vec<String>, Failure> {
                restart::check::<$d, $m>(self, flow)
            }
            fn openings_at_start(&self, flow: &Flow<$d>) -> Vec<Record> {
                openings::at_start::<$d, $m>(self, flow)
            }
            fn jumps_at_openings(&self, flow: &Flow<$d>) -> Vec<Mismatch> {
                openings::jumps_at_start::<$d, $m>(self, flow)
            }
            fn time_flow(&self, flow: &Flow<$d>) -> Result<Timing, ProbeError> {
                probe::time_flow::<$d, $m>(self, flow)
            }
            fn move_over_run(&self) -> anyhow::Result<Option<MeshOverRun>> {
                probe::move_over_run(self)
            }
            fn prescribed_nodes(&self) -> Vec<PrescribedNode<$d>> {
                [build::prescribed_nodes(self), build::nodes_of_driven_bodies(self)].concat()
            }
            fn elasticity_plan(&self) -> Option<elasticity::Plan> {
                build::elasticity_plan(self)
            }
            fn result_bytes(&self) -> usize {
                result_bytes::<$d, $m>(self)
            }
        }
    };
}

with_components!(2, 4);
with_components!(3, 5);
