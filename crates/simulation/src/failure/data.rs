//! Measurements of a failed run: plain numbers, relative if there is a reference.

use super::super::openings::Record;
use case::{NoValue, NotPositive};
use serde::Serialize;

/// Exactly the data that the diagnosis reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailureData {
    /// The part that failed.
    pub gave_up: GaveUp,
    /// The last attempt.
    pub attempt: Attempt,
    /// The solve of the last attempt, if there was one.
    pub newton: Option<Newton>,
    /// The mesh.
    pub mesh: Mesh,
    /// The gas, if there is one.
    pub gas: Option<Gas>,
    /// The structure, if it is one.
    pub structure: Option<StructureData>,
    /// The bodies that the flow moves, if there are any.
    pub bodies: Option<Bodies>,
}

/// Bodies that the flow moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bodies {
    /// The path of the mesh in the slab at its last velocity, in thicknesses of its cells.
    pub travel: f64,
    /// The mass of a cylinder or sphere of fluid as large as the body, over the mass of the body; the largest of all bodies.
    pub added_mass: f64,
    /// What nothing holds in a search for an equilibrium, and the remedy.
    pub unheld: Option<[String; 2]>,
    /// det(I + grad d) where the structure was inverted in the last attempt, if it was.
    pub inverted: Option<f64>,
}

/// The part that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GaveUp {
    /// A cell is inverted, or not proved to be valid.
    InvertedCell,
    /// The equilibrium of the mesh was not found.
    Equilibrium,
    /// A load on the structure is NaN.
    Load,
    /// The equations of the structure.
    Structure,
    /// There is no residual, because the state is inadmissible.
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
    /// Whether it was for the equilibrium of a steady flow and its bodies, by slabs that the program chooses.
    pub released: bool,
    /// Slabs done before it.
    pub slabs_done: usize,
    /// Time at the bottom of the slab.
    pub start: f64,
    /// Its length.
    pub length: f64,
    /// The number of halvings that led to it.
    pub halvings: u32,
    /// Whether more of them were not allowed.
    pub halvings_used_up: bool,
}

impl Attempt {
    /// Whether `time.step` gives the length of its slab.
    pub fn has_given_length(&self) -> bool {
        !self.steady && !self.released
    }
}

/// A solve that failed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Newton {
    /// |R| at the first guess and after every step.
    pub residuals: Vec<f64>,
    /// The round-off of the residual, if it was estimated.
    pub round_off: Option<f64>,
    /// The largest number of steps.
    pub steps_allowed: usize,
    /// Whether they were used up.
    pub steps_used_up: bool,
    /// The fraction of the linear solves that reached their limit of iterations.
    pub unfinished_linear_solves: f64,
    /// That limit.
    pub krylov_allowed: usize,
    /// Whether the flow has the preconditioner by blocks.
    pub has_blocks: bool,
    /// The result of a march in time from the best state, if a steady flow was not found.
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
    /// Whether its rate of change does not fall.
    pub is_unsteady: bool,
}

/// The mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mesh {
    /// The kind of its motion.
    pub motion: Motion,
    /// The smallest sampled det J / det J_0, in the last attempt if cells were inverted there, otherwise before.
    pub smallest_det_j: f64,
    /// The path of a node with a prescribed displacement in the slab, in thicknesses of its cell.
    pub travel: f64,
    /// The place where the prescribed displacement is NaN in the slab, if any.
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

/// A prescribed displacement that is NaN.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Undefined {
    /// The time.
    pub time: f64,
    /// The position at rest.
    pub position: Vec<f64>,
}

/// The motion of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// At rest.
    #[default]
    Still,
    /// By formulas everywhere.
    Prescribed,
    /// As an elastic body with constant stiffness.
    Elastic,
    /// As an elastic body whose small cells, or those at walls, are stiffer.
    Graded,
}

/// The structure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructureData {
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Node spacings that a shear wave travels in the slab; None without inertia.
    pub waves_per_slab: Option<f64>,
    /// Whether its law is not linear.
    pub is_nonlinear: bool,
    /// The smallest det(I + grad d) at the bottom of the slab.
    pub smallest_volume_ratio: f64,
    /// The place where a load is NaN, if any.
    pub bad_load: Option<BadLoad>,
}

/// A load that is NaN.
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
    /// At the start, by the case.
    pub at_start: Moment,
    /// The last good state.
    pub last: Moment,
    /// Node spacings that the fastest wave travels in the slab.
    pub waves_per_slab: f64,
    /// The largest Reynolds number of a node spacing; none without viscosity.
    pub cell_reynolds: Option<f64>,
    /// Quadrature points per direction, and the number that conserves on any moving mesh.
    pub quadrature: [usize; 2],
    /// The largest Mach number in the last good state.
    pub mach: f64,
    /// Whether artificial viscosity captures shocks.
    pub captures_shocks: bool,
    /// N_s, nodes of the flow per direction and cell.
    pub order: usize,
    /// Whether the inviscid volume terms are in split form.
    pub is_split: bool,
    /// The speed with which a boundary is set in motion at the start, over the speed of sound.
    pub kick: f64,
    /// How the flow starts.
    pub start: FlowStart,
    /// Flow at inflows and outflows for which their conditions are not suited.
    pub openings: Vec<OpeningMisuse>,
    /// A value of a boundary condition within the slab that must be positive and is not.
    pub not_positive: Option<NotPositive>,
    /// A formula of a source or a boundary that has no value within the slab.
    pub without_value: Option<NoValue>,
}

/// How a flow starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FlowStart {
    /// From the steady flow, which the case asks for.
    SteadyFlow,
    /// From a uniform stream, which the walls stop at once.
    UniformStream,
    /// From the state of another run.
    OtherRun,
    /// From any other state.
    OtherState,
}

/// An observation at an inflow or outflow.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpeningMisuse {
    /// The boundary.
    pub boundary: String,
    /// The kind, the share and the start.
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
    /// The place where a boundary condition and the gas beside it differ most, if there is a boundary.
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
    /// The quantity that differs most, of those that the condition prescribes.
    pub quantity: &'static str,
    /// Its value in the gas ...
    pub inside: f64,
    /// ... and its value by the condition.
    pub target_state: f64,
    /// The difference of velocities over the speed of sound, or of the logarithms of pressure or temperature.
    pub size: f64,
}
