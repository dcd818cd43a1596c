//! `[solver]`

use newton_krylov::{newton, pseudo_time};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the equations of a slab are solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// A slab is done when the residual has fallen by this factor below that of its first guess. At most 0.1. Mass, momentum and energy
    /// are balanced to round-off whatever the tolerance.
    pub newton_tolerance: f64,
    /// A slab is also done when the residual is below this size, in units of the reference state, or where only round-off is left of
    /// it. At most 0.1.
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
    /// What keeps the number of Krylov iterations low.
    pub preconditioner: Preconditioner,
    /// The first guess of a slab.
    pub predictor: Predictor,
    /// Pseudo-time that damps the first Newton steps of a slab.
    pub pseudo_time: PseudoTime,
    /// How often the length of a slab may be halved before the run gives up.
    pub slab_halvings: usize,
    /// Start from the steady flow, found from the initial state by pseudo-time on the mesh at rest. Without this section the run
    /// starts from the initial state itself.
    pub steady: Option<Steady>,
}

impl Default for Solver {
    fn default() -> Self {
        let newton = newton::Settings::default();
        Solver {
            newton_tolerance: newton.relative_tolerance,
            newton_absolute_tolerance: newton.absolute_tolerance,
            newton_steps: newton.max_steps,
            krylov_tolerance: newton.forcing.maximum,
            krylov_iterations: newton.krylov.max_iterations,
            krylov_restart: newton.krylov.restart,
            jacobian: Jacobian::Exact,
            preconditioner: Preconditioner::Blocks,
            predictor: Predictor::Elastic,
            pseudo_time: PseudoTime::default(),
            slab_halvings: 6,
            steady: None,
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

/// What keeps the number of Krylov iterations low.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preconditioner {
    /// Block ILU(0), cells with all their unknowns as blocks: for slabs, flows and meshes of any kind.
    Blocks,
    /// Every cell alone, one direction after the other: costs next to nothing at any order, in memory either, and serves slabs so short that
    /// sound crosses no more than about a cell. Not for steady flows, which keep to blocks.
    Lines,
}

/// The first guess of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Predictor {
    /// The flow extended by the polynomial of the slab before, on the mesh in equilibrium with its boundary.
    Elastic,
    /// Flow and mesh extended by the polynomials of the slab before.
    Extrapolate,
    /// Flow and mesh as at the end of the slab before.
    Constant,
}

/// Pseudo-transient continuation of mesh and flow by one rule: the pseudo-time step grows as the residual falls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
        let pseudo_time::Settings { initial_inverse, restart_inverse, power, .. } = pseudo_time::Settings::default();
        PseudoTime { initial_inverse, restart_inverse, power }
    }
}

/// How the steady flow is found: by implicit steps in pseudo-time, which grow as the residual falls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Steady {
    /// The flow is steady when the residual has fallen by this factor below that of the initial state. At most 0.1.
    pub tolerance: f64,
    /// The first step in pseudo-time.
    pub first_step: f64,
    /// The power of the ratio of residuals by which the step grows.
    pub power: f64,
    /// A step is at most this factor longer than the one before.
    pub growth: f64,
    /// Steps at most.
    pub steps: usize,
    /// How far a linear solve reduces its residual.
    pub krylov_tolerance: f64,
    /// Krylov iterations per step at most; each keeps two vectors.
    pub krylov_iterations: usize,
    /// Whether to go by lower orders, the lowest with a dissipative flux, where the order asked for does not converge at once; and to
    /// march in time for some slabs where that fails.
    pub sequence: bool,
    /// For so many time units (reference length / reference speed) the steady flow is marched in time, slightly disturbed, to see whether it
    /// is stable. 0: never. Default: 8 where the residual at the next higher order tells that the flow is not resolved, otherwise 0.
    pub stability_time: Option<f64>,
}

impl Default for Steady {
    fn default() -> Self {
        Steady {
            tolerance: 1e-9,
            first_step: 0.1,
            power: 1.0,
            growth: 4.0,
            steps: 100,
            krylov_tolerance: 0.1,
            krylov_iterations: 200,
            sequence: true,
            stability_time: None,
        }
    }
}
