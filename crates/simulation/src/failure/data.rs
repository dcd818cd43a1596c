//! What was measured where a run has failed: plain numbers, relative where there is something to relate them to.

use super::super::openings::Record;
use serde::Serialize;

/// All that the diagnosis reads, and nothing that it does not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureData {
    /// What gave up.
    pub gave_up: GaveUp,
    /// The last attempt.
    pub attempt: Attempt,
    /// The solve of the last attempt, where there was one.
    pub newton: Option<Newton>,
    /// The mesh.
    pub mesh: Mesh,
    /// The gas, if there is one.
    pub gas: Option<Gas>,
    /// The structure, if it is one.
    pub structure: Option<Structure>,
}

/// What gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GaveUp {
    /// A cell is inverted, or not proved to be valid.
    InvertedCell,
    /// The equilibrium of the mesh was not found.
    Equilibrium,
    /// A load on the structure is no number.
    Load,
    /// The equations of the structure.
    Structure,
    /// There is no residual: the state is none of a gas.
    Inadmissible,
    /// Newton's method.
    Newton,
    /// The linear solver.
    LinearSolver,
    /// Anything else, such as a file.
    Other,
}

/// The last attempt to solve a slab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Attempt {
    /// Whether it was for the steady flow at the start.
    pub steady: bool,
    /// Slabs done before.
    pub slabs_done: usize,
    /// Time at the bottom of the slab.
    pub start: f64,
    /// Its length.
    pub length: f64,
    /// How often it was halved to get there.
    pub halvings: u32,
}

/// A solve that failed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Newton {
    /// |R| at the first guess and after every step.
    pub residuals: Vec<f64>,
    /// What rounding leaves of the residual, where it was estimated.
    pub round_off: Option<f64>,
    /// Steps allowed.
    pub steps_allowed: usize,
    /// Whether they were used up.
    pub steps_used_up: bool,
    /// The part of the linear solves that ran into their limit of iterations.
    pub unfinished_linear_solves: f64,
    /// That limit.
    pub krylov_allowed: usize,
    /// What a march in time from the best state has shown, where a steady flow was not found.
    pub settling: Option<Settling>,
}

/// A flow that was marched in time to see whether it becomes steady.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settling {
    /// Its rate of change in the first quarter.
    pub early: f64,
    /// The same in the last quarter.
    pub late: f64,
    /// The time marched.
    pub duration: f64,
    /// Whether it becomes steady.
    pub calms_down: bool,
}

/// The mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mesh {
    /// How it moves.
    pub motion: Motion,
    /// The smallest det J / det J_0 seen, in the last attempt if cells were inverted there, otherwise before.
    pub smallest_det_j: f64,
    /// How far a node with a prescribed displacement goes in the slab, in thicknesses of its cell.
    pub travel: f64,
    /// Where the prescribed displacement is no number in the slab, if anywhere.
    pub undefined: Option<Undefined>,
    /// The largest prescribed displacement in the slab, over the size of the mesh.
    pub reach: f64,
    /// The largest aspect ratio at rest.
    pub aspect_ratio: f64,
    /// The smallest ratio of the smallest to the largest det J in a cell at rest.
    pub evenness: f64,
    /// Poisson's ratio of an elastic mesh, otherwise 0.
    pub poisson_ratio: f64,
    /// The tolerance of the equilibrium of a neo-Hookean mesh; none with another law.
    pub tolerance: Option<f64>,
    /// Whether it moves without a flow, as with `stsolve motion`.
    pub alone: bool,
}

/// A prescribed displacement that is no number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Undefined {
    /// The time.
    pub time: f64,
    /// The position at rest.
    pub position: Vec<f64>,
}

/// How a mesh moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Not at all.
    #[default]
    Still,
    /// By formulas everywhere.
    Prescribed,
    /// Like an elastic body that is equally stiff everywhere.
    Elastic,
    /// Like an elastic body whose small cells, or those at walls, are stiffer.
    Graded,
}

/// The structure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Structure {
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Distances of nodes that a shear wave passes in the slab.
    pub waves_per_slab: f64,
    /// Where a load is no number, if one is.
    pub bad_load: Option<BadLoad>,
}

/// A load that is no number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BadLoad {
    /// The time.
    pub time: f64,
    /// A node that it acts on.
    pub position: Vec<f64>,
}

/// The gas.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gas {
    /// As the case says it starts.
    pub at_start: Moment,
    /// The last good state.
    pub last: Moment,
    /// Distances of nodes that the fastest wave passes in the slab.
    pub waves_per_slab: f64,
    /// The largest Reynolds number of a distance of nodes; none without viscosity.
    pub cell_reynolds: Option<f64>,
    /// Quadrature points per direction, and how many conserve on any moving mesh.
    pub quadrature: [usize; 2],
    /// The speed with which a boundary is set in motion at the start, over the speed of sound.
    pub kick: f64,
    /// What was seen at inflows and outflows that their conditions are not made for.
    pub openings: Vec<OpeningEvidence>,
}

/// What was seen at an inflow or outflow.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpeningEvidence {
    /// The boundary.
    pub boundary: String,
    /// What, on how much of it, since when.
    pub record: Record,
    /// The same in words.
    pub told: String,
}

/// The gas at one time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// The smallest density or pressure, over its mean.
    pub lowest: Extreme,
    /// The largest change within a cell: of the logarithm of density or pressure, or of the velocity over the speed of sound.
    pub steepest: Extreme,
    /// Where a boundary condition and the gas beside it differ most, if there is a boundary.
    pub mismatch: Option<Mismatch>,
}

/// The extreme of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extreme {
    /// The quantity.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// The cell.
    pub cell: usize,
}

/// A boundary condition and the gas beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mismatch {
    /// The boundary.
    pub boundary: String,
    /// The quantity that differs most.
    pub quantity: &'static str,
    /// The gas has this ...
    pub inside: f64,
    /// ... and the condition asks for that.
    pub target_state: f64,
    /// The difference of velocities over the speed of sound, or of the logarithms of pressure or temperature.
    pub size: f64,
}
