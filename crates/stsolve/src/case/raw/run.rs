//! `[time]`, `[solver]` and `[output]`

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The time to cover, slab by slab: give `step` or `slabs`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// N_t, the nodes in time of a slab, 1 to 16: order of accuracy 2 N_t - 1 at the end of a slab.
    pub order: usize,
    /// The start.
    #[serde(default)]
    pub start: f64,
    /// The end.
    pub end: f64,
    /// The length of a slab. The last one may be shorter.
    pub step: Option<f64>,
    /// Instead of the step: the number of slabs, all of the same length.
    pub slabs: Option<usize>,
}

/// How the equations of a slab are solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// A slab is done when the residual has fallen by this factor below that of its first guess ...
    pub newton_tolerance: f64,
    /// ... or below this size, in units of the reference state.
    pub newton_absolute_tolerance: f64,
    /// Newton steps per slab at most.
    pub newton_steps: usize,
    /// The loosest tolerance of a linear solve; it is tightened as Newton converges.
    pub krylov_tolerance: f64,
    /// Krylov iterations per Newton step at most.
    pub krylov_iterations: usize,
    /// Krylov iterations between restarts; each keeps two vectors.
    pub krylov_restart: usize,
    /// How the Jacobian acts on a vector.
    pub jacobian: Jacobian,
    /// The first guess of a slab.
    pub predictor: Predictor,
    /// Pseudo-time that damps the first Newton steps of a slab.
    pub pseudo_time: PseudoTime,
    /// How often the length of a slab may be halved before the run gives up.
    pub slab_halvings: usize,
}

impl Default for Solver {
    fn default() -> Self {
        Solver {
            newton_tolerance: 1e-8,
            newton_absolute_tolerance: 1e-12,
            newton_steps: 20,
            krylov_tolerance: 0.1,
            krylov_iterations: 300,
            krylov_restart: 60,
            jacobian: Jacobian::Exact,
            predictor: Predictor::Extrapolate,
            pseudo_time: PseudoTime::default(),
            slab_halvings: 6,
        }
    }
}

/// How the Jacobian acts on a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Jacobian {
    /// By dual numbers.
    Exact,
    /// By differences of residuals; for comparison.
    FiniteDifference,
}

/// The first guess of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Predictor {
    /// The polynomial of the slab before, continued.
    Extrapolate,
    /// The state at the end of the slab before.
    Constant,
    /// The polynomial continued, with the mesh solved first for the new boundary.
    Elastic,
}

/// Pseudo-transient continuation of mesh and flow by one rule: the pseudo-time step grows as the residual falls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PseudoTime {
    /// One over the first pseudo-time step, in units of the slab; 0 starts with plain Newton.
    pub initial_inverse: f64,
    /// The same after a step that had to be rejected; 0 never damps.
    pub restart_inverse: f64,
    /// The power of the ratio of residuals by which the step grows.
    pub power: f64,
}

impl Default for PseudoTime {
    fn default() -> Self {
        PseudoTime { initial_inverse: 0.0, restart_inverse: 1.0, power: 1.0 }
    }
}

/// What is written, and where.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The directory, relative to the case file. Default: `runs/<case name>` where the program is started.
    pub directory: Option<PathBuf>,
    /// A checkpoint, from which a run can be resumed, is written after every so many slabs, and at the end.
    pub checkpoint_every: usize,
    /// The fields are written after every so many slabs, and at the start and the end.
    pub every: usize,
    /// The fields for drawing. The exact coefficients are always written.
    pub fields: Vec<Field>,
}

impl Default for Output {
    fn default() -> Self {
        let fields = vec![Field::Density, Field::Velocity, Field::Pressure, Field::Mach];
        Output { directory: None, checkpoint_every: 10, every: 1, fields }
    }
}

/// A field for drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// The density.
    Density,
    /// The velocity of the gas.
    Velocity,
    /// The pressure.
    Pressure,
    /// The temperature.
    Temperature,
    /// The Mach number.
    Mach,
    /// The curl of the velocity.
    Vorticity,
    /// The velocity of the mesh.
    MeshVelocity,
    /// det J of the motion of the mesh.
    Jacobian,
}
