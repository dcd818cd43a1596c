//! Measurements of trial computations: seconds, and the mesh over the run.

use super::super::table::Table;
use crate::cli::Probe;
use case::{Case, Motion};
use elasticity::Law;
use simulation::{MeshOverRun, Timing, typical_iterations};

/// Newton steps of a typical slab.
const TYPICAL_STEPS: usize = 3;

/// The amount of work for which a probe takes some seconds: displacements times slabs, unknowns of a three-dimensional mesh, unknowns of
/// the flow in a slab of two and of three dimensions.
const CHEAP_MOTION: usize = 10_000_000;
const CHEAP_MESH_IN_SPACE: usize = 60_000;
const CHEAP_FLOW: [usize; 2] = [1_000_000, 200_000];

/// The number of operations of a formula that take about as long as the rest of a displacement.
const CHEAP_FORMULA: usize = 1000;

/// Whether the mesh is moved over the run for the check.
pub(super) fn moves_mesh<const D: usize>(case: &Case<D>, probe: Probe) -> bool {
    let Some(motion) = &case.motion else { return false };
    let newton = if matches!(motion, Motion::Elastic { law: Law::NeoHookean, .. }) { 10 } else { 1 };
    let displacements = case.mesh.coordinates().len();
    // A long formula costs more than the use of its value.
    let formulas = 1 + motion.operations() / CHEAP_FORMULA;
    let work = (displacements * case.time.order * newton * formulas).saturating_mul(case.time.slabs);
    chosen(probe, work <= CHEAP_MOTION && (D == 2 || displacements <= CHEAP_MESH_IN_SPACE))
}

/// What stands for the table of a mesh that is too costly to be moved for the check.
pub(super) fn mesh_not_moved<const D: usize>(case: &Case<D>, probe: Probe) -> Option<Table> {
    let mut table = Table::new("mesh over the run");
    table.row("not computed", "that takes more than some seconds: `--probe always`", "");
    (case.motion.is_some() && probe == Probe::Auto).then_some(table)
}

/// What stands for the table of a mesh that nothing but the flow moves.
pub(super) fn mesh_moved_by_flow() -> Table {
    let mut table = Table::new("mesh over the run");
    table.row("not computed", "only the flow moves it: `stsolve run`", "");
    table
}

/// Whether a flow with this number of unknowns is timed.
pub(super) fn times_flow<const D: usize>(unknowns: usize, probe: Probe) -> bool {
    chosen(probe, unknowns <= CHEAP_FLOW[D - 2])
}

fn chosen(probe: Probe, cheap: bool) -> bool {
    match probe {
        Probe::Auto => cheap,
        Probe::Always => true,
        Probe::Never => false,
    }
}

/// Seconds of the parts of a run, and of the whole.
pub(super) fn timing_table<const D: usize>(case: &Case<D>, timing: &Timing) -> Table {
    let (steps, iterations) = (TYPICAL_STEPS, typical_iterations(case));
    let slab = steps as f64 * (2.0 * timing.residual + iterations as f64 * timing.iteration);
    let run = timing.setup + timing.preconditioner + case.time.slabs as f64 * slab;
    let mut table = Table::new("seconds, measured");
    table
        .row("set-up", timing.setup, "")
        .row("residual", timing.residual, "")
        .row("Krylov iteration", timing.iteration, "product and preconditioner")
        .row("making the preconditioner", timing.preconditioner, "now and then")
        .row("a slab", slab, format!("if it takes {steps} Newton steps of {iterations} iterations"))
        .row("the run", run, "if all slabs do, and the preconditioner is made once")
        .row("threads", rayon::current_num_threads(), "");
    if case.solver.steady.is_some() {
        table.row("steady flow", "not counted", "");
    }
    if let Some(bytes) = timing.memory {
        table.row("memory so far", bytes as f64 / 1e6, "MB, without Krylov vectors");
    }
    table
}

/// The proved bounds of the mesh over the run. What the flow moves rests in them.
pub(super) fn mesh_table(mesh: &MeshOverRun, moved_by_flow: bool) -> Table {
    let quality = &mesh.quality;
    let mut table = Table::new("mesh over the run");
    let proved = if moved_by_flow { "or more, proved while all that the flow moves rests" } else { "or more, proved" };
    table
        .row("det J / det J_0", quality.lower_bound, proved)
        .row("smallest met", quality.sampled_min, "")
        .row("in cell", quality.cell, "")
        .row("at time", quality.time, "")
        .row("scaled Jacobian", quality.scaled_jacobian, "smallest: 1 is undistorted");
    table
}
