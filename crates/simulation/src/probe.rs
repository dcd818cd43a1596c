//! Cost of a run and validity of its mesh, measured beforehand on the mesh of the case.

use super::build;
use case::memory;
use case::{Case, Flow};
use coupled::{FlowMarch, Interval, MeshMarch, MeshQuality, SlabError};
use elasticity::ElasticityError;
use navier_stokes::{Compiled, NavierStokes};
use newton_krylov::problem::{Inadmissible, NonlinearProblem};
use std::time::Instant;

/// The number of evaluations; the shortest time is taken.
const REPEATS: usize = 3;

/// Seconds of the parts of a run on this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// To set up the run.
    pub setup: f64,
    /// A residual.
    pub residual: f64,
    /// A Krylov iteration: a product with the Jacobian and the preconditioner.
    pub iteration: f64,
    /// To make the preconditioner.
    pub preconditioner: f64,
    /// The memory of the process afterwards, in bytes, if the system reports it.
    pub memory: Option<u64>,
}

/// Why there is no probe.
#[derive(Debug, thiserror::Error)]
pub enum ProbeError {
    /// The mesh cannot be moved.
    #[error("the mesh could not be moved: {0}")]
    Mesh(#[from] ElasticityError),
    /// The initial state is inadmissible on the mesh of the first slab.
    #[error("the first slab starts from an {0}")]
    State(#[from] Inadmissible),
    /// The first slab cannot begin.
    #[error(transparent)]
    Slab(SlabError),
}

impl From<SlabError> for ProbeError {
    fn from(error: SlabError) -> Self {
        match error {
            SlabError::Mesh(error) => ProbeError::Mesh(error),
            SlabError::Guess(state) => ProbeError::State(state),
            other => ProbeError::Slab(other),
        }
    }
}

/// Times the parts of the first slab of `case`.
///
/// # Errors
/// A mesh or a state from which the first slab cannot start.
pub fn time_flow<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Result<Timing, ProbeError>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let begun = Instant::now();
    let mut march: FlowMarch<D, M> = build::march(case, flow)?;
    let setup = begun.elapsed().as_secs_f64();
    let z = start_of_slab(&mut march, case)?;
    let problem = &mut march.solver.system;
    let (mut r, mut increment) = (vec![0.0; z.len()], vec![0.0; z.len()]);
    let residual = fastest(|| problem.residual(&z, &mut r))?;
    let still = vec![0.0; problem.fields().len()];
    let begun = Instant::now();
    problem.linearise(&z, &still)?;
    let preconditioner = begun.elapsed().as_secs_f64();
    // The mesh is in equilibrium already, so directions vanish there, as in most iterations of a run.
    r[..problem.mesh_len()].fill(0.0);
    problem.guess_increment(&r, &mut increment);
    let iteration = fastest(|| {
        problem.precondition(&r, &mut increment);
        problem.jacobian_product(&increment, &mut r);
        Ok(())
    })?;
    Ok(Timing { setup, residual, iteration, preconditioner, memory: memory::peak() })
}

/// The start of Newton's method in the first slab: the mesh moved, the flow as at the start.
fn start_of_slab<const D: usize, const M: usize>(
    march: &mut FlowMarch<D, M>,
    case: &Case<D>,
) -> Result<Vec<f64>, SlabError> {
    let (solver, state) = (&mut march.solver, &march.state);
    let (start, end) = (case.time.start, case.time.start + case.time.step);
    Ok(solver.guess(state, Interval { start, end, halvings: 0 })?.0)
}

/// The shortest time of some calls, in seconds.
fn fastest(mut call: impl FnMut() -> Result<(), Inadmissible>) -> Result<f64, Inadmissible> {
    let mut shortest = f64::INFINITY;
    for _ in 0..REPEATS {
        let begun = Instant::now();
        call()?;
        shortest = shortest.min(begun.elapsed().as_secs_f64());
    }
    Ok(shortest)
}

/// The mesh over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOverRun {
    /// Its worst quality.
    pub quality: MeshQuality,
    /// The first time at which a cell is not proved to be valid.
    pub first_invalid: Option<f64>,
}

/// Moves the mesh of `case` over the whole run, until a cell is not valid; None if it rests.
///
/// # Errors
/// A mesh that cannot be moved.
pub fn move_over_run<const D: usize>(case: &Case<D>) -> anyhow::Result<Option<MeshOverRun>> {
    let mut march =
        MeshMarch::new(build::mover_without_flow(case)?, case.time.schedule(), case.solver.slab_halvings as u32);
    let mut over_run: Option<MeshOverRun> = None;
    while case.motion.is_some() && !march.is_done() && over_run.is_none_or(|m| m.first_invalid.is_none()) {
        let report = march.advance()?;
        let quality = over_run.map_or(report.quality, |m| m.quality.worst(report.quality));
        over_run = Some(MeshOverRun { quality, first_invalid: report.first_invalid });
    }
    Ok(over_run)
}
