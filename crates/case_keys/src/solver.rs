//! `[solver]`

use newton_krylov::{newton, pseudo_time};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The solver of a slab.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// A slab has converged when the residual has fallen by this factor below that of a state that stays as it is at the bottom of the slab.
    /// The first guess is better, so the residual need not fall as far from there. Bodies and structures have converged when the error of their
    /// positions is this part of their way in the slab, or of the spacing of nodes if that is less. At most 0.1. Mass, momentum and energy
    /// balance to round-off for any tolerance, but the energy of gas and bodies together only to the tolerance.
    pub newton_tolerance: f64,
    /// A slab has also converged when the residual is below this size, in units of the reference state, or at round-off. At most
    /// 0.1.
    pub newton_absolute_tolerance: f64,
    /// The largest number of Newton steps per slab.
    pub newton_steps: usize,
    /// The largest tolerance of a linear solve; it is tightened as Newton's method converges.
    pub krylov_tolerance: f64,
    /// The largest number of Krylov iterations per Newton step.
    pub krylov_iterations: usize,
    /// Krylov iterations between restarts; each stores two vectors.
    pub krylov_restart: usize,
    /// The method for products with the Jacobian.
    pub jacobian: Jacobian,
    /// The preconditioner of the flow. Default: `"low_order"` in three dimensions from `flow.order` = 3, otherwise `"blocks"`. With bodies or
    /// structures that the flow moves, and in a span of one thin cell, `"blocks"` as long as they take less than 2 GB.
    pub preconditioner: Option<Preconditioner>,
    /// The first guess of a slab.
    pub predictor: Predictor,
    /// Pseudo-time damping of the first Newton steps of a slab.
    pub pseudo_time: PseudoTime,
    /// The largest number of times that a slab is halved before the run gives up. With `time.adaptive` the limit is `time.adaptive.smallest`.
    pub slab_halvings: usize,
    /// What the run does when halvings of a slab do not help.
    pub fallback: Fallback,
    /// The thickness of a boundary layer that the initial state gets at no-slip walls; 0 for none. Default: none, unless the first slab
    /// cannot be solved without one.
    pub start_layer: Option<f64>,
    /// Start from the steady flow, found from the initial state by pseudo-time on the mesh at rest. Default: the run starts from
    /// the initial state itself.
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
            preconditioner: None,
            predictor: Predictor::Elastic,
            pseudo_time: PseudoTime::default(),
            slab_halvings: 6,
            fallback: Fallback::SplitForm,
            start_layer: None,
            steady: None,
        }
    }
}

/// The method for products with the Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Jacobian {
    /// By dual numbers.
    Exact,
    /// By differences of residuals; for comparison.
    FiniteDifference,
}

/// The preconditioner of the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preconditioner {
    /// Block ILU(0) with one block per cell: for any slabs, flows and meshes.
    Blocks,
    /// Each cell alone, one direction after the other. It costs little time and memory at any order, and suits slabs so short that sound
    /// crosses at most about the distance of two nodes. Steady flows always use blocks.
    Lines,
    /// The flow on the control volumes of its nodes, by point-block ILU(0). Its memory per unknown does not depend on the order: for flows in
    /// three dimensions.
    LowOrder,
}

/// The first guess of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Predictor {
    /// The flow extrapolated by the polynomial of the previous slab, on the mesh in equilibrium with its boundary.
    Elastic,
    /// Flow and mesh extrapolated by the polynomials of the previous slab.
    Extrapolate,
    /// Flow and mesh as at the end of the previous slab.
    Constant,
}

/// What a run does when a slab of the flow could not be solved after all halvings; of a flow that the mesh does not resolve, without halvings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// It goes back to the start of the slab, and goes on from there to the end in a split form:
    /// `flow.quadrature = "collocated_lobatto"` with `flow.volume_flux = "entropy"`. A warning says so. If that fails in the same slab,
    /// the run stops.
    SplitForm,
    /// It stops.
    None,
}

/// Pseudo-transient continuation of mesh and flow by one rule: the pseudo-time step grows as the residual falls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PseudoTime {
    /// The inverse of the first pseudo-time step, in units of the slab; 0 starts with plain Newton.
    pub initial_inverse: f64,
    /// The same after a rejected step; 0 never damps.
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

/// The search for the steady flow: implicit steps in pseudo-time, which grow as the residual falls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Steady {
    /// The flow is steady when the residual has fallen by this factor below the residual of the initial state. At most
    /// 0.1.
    pub tolerance: f64,
    /// The first step in pseudo-time, in time units: the length of `flow.reference`, or without it that of the mesh, over the reference speed.
    pub first_step: f64,
    /// The power of the ratio of residuals by which the step grows.
    pub power: f64,
    /// The largest ratio of a step to the previous one.
    pub growth: f64,
    /// The largest number of steps.
    pub steps: usize,
    /// The factor by which a linear solve reduces its residual.
    pub krylov_tolerance: f64,
    /// The largest number of Krylov iterations per step; each stores two vectors.
    pub krylov_iterations: usize,
    /// Whether to try lower orders, the lowest with a dissipative flux, if the order of the case does not converge at once, and to
    /// march in time for some slabs if that fails.
    pub sequence: bool,
    /// For so many time units (as for `first_step`) the steady flow is marched in time, slightly disturbed, to see whether
    /// it is stable. 0: never. Default: 8 if the residual at the next higher order shows that the flow is not resolved, otherwise 0.
    pub stability_time: Option<f64>,
    /// What bodies and structures do meanwhile.
    pub bodies: SteadyBodies,
}

/// What bodies and structures do while a steady flow is sought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SteadyBodies {
    /// They keep their positions at the start, and are released with the first slab.
    #[default]
    Held,
    /// They move until they are in equilibrium with the flow. The run starts there, at rest.
    Equilibrium,
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
            bodies: SteadyBodies::Held,
        }
    }
}
