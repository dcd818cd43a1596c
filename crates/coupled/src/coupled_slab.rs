//! A slab of mesh and flow: the Newton solve, and the checks of its result.

mod guess;

use crate::balance::{self, Balance};
use crate::block::BodyState;
use crate::blocks::{Counts, inadmissible, totals_at};
use crate::march::{March, SlabSolver};
use crate::mesh_mover::MeshQuality;
use crate::resolution::is_unresolved;
use crate::schedule::{Schedule, StepControl};
use crate::slab_error::SlabError;
use crate::start_layer::{EasedStart, StartLayer};
use crate::state::{Interval, Past, State};
use crate::system::System;
use fem::{FluxesAt, SlabEnd, Violation};
use newton_krylov::finite_difference::{FiniteDifference, Scheme};
use newton_krylov::inner_product;
use newton_krylov::newton::{self, FruitlessSteps, Stall, Workspace};
use std::array::from_fn;
use std::sync::Arc;

/// The first guess of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// The flow extended, on the mesh in equilibrium with its boundary: Newton starts on the final mesh.
    Elastic,
    /// The polynomial of the slab before, extended: Newton moves mesh and flow together.
    Extrapolated,
    /// The state and the position at the bottom.
    Constant,
}

/// How Jacobian products are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jacobian {
    /// By dual numbers.
    Exact,
    /// By one-sided differences of the residual.
    FiniteDifference,
}

/// Settings of a march.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The slabs.
    pub schedule: Schedule,
    /// The Newton driver. Its relative tolerance refers to the residual of the constant guess.
    pub newton: newton::Settings,
    /// The first guess of the mesh.
    pub predictor: Predictor,
    /// Jacobian products.
    pub jacobian: Jacobian,
    /// How often a slab may be halved before the run gives up.
    pub max_halvings: u32,
}

/// The finest absolute tolerance, in units of the reference state: rounding of the residual is about as large. If rounding is larger, the
/// solve ends at the estimate of it, see [`newton_krylov::problem::NonlinearProblem::round_off`].
pub const ROUND_OFF: f64 = 1e-13;

/// Below this norm of the residual, in units of the reference state, a Newton step that falls short of its linear solve may have met
/// rounding.
const QUIET: f64 = 1e-6;

/// A slab whose Newton steps lead nowhere fails early, and is halved.
const FRUITLESS_STEPS: FruitlessSteps = FruitlessSteps { steps: 4, left: 0.8 };

/// The same for the first attempt at the first slab, if the start can be made easier: one short step ends it. A step of an eighth leaves 0.875.
const FRUITLESS_FIRST_STEP: FruitlessSteps = FruitlessSteps { steps: 1, left: 0.85 };

/// The largest number of Krylov iterations per Newton step of that attempt.
const FIRST_ITERATIONS: usize = 40;

/// When an attempt at a slab of an unresolved flow gives up: these steps have not brought one digit. A slab that can be solved takes fewer.
const UNRESOLVED_STALL: Stall = Stall { steps: 5, factor: 0.1 };

/// The report of a slab.
#[derive(Clone, Debug)]
pub struct SlabReport<const M: usize> {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// How often an attempt was rejected before.
    pub rejected: usize,
    /// The easier initial state, if the first slab needed one.
    pub eased: Option<EasedStart>,
    /// The report of the Newton driver.
    pub newton: newton::Report,
    /// The norm of the residual that the report begins with, and that at the end. A steady flow begins with the initial state.
    pub residual_norms: [f64; 2],
    /// Its cost, with all rejected attempts.
    pub counts: Counts,
    /// The quality of the mesh.
    pub quality: MeshQuality,
    /// The jump of the flow at the bottom, in L2 over the domain, every component in units of its scale, with that of bodies: an estimate of
    /// the error in time.
    pub jump: f64,
    /// The fluxes through the boundaries, positive outwards, at the quadrature points in time and at the top of the slab.
    pub fluxes: Vec<FluxesAt<M>>,
    /// The integral of every component at the top of the slab.
    pub totals: Vec<f64>,
}

impl<const M: usize> SlabReport<M> {
    /// The norm of the residual at the end over that at the begin.
    pub fn relative_residual(&self) -> f64 {
        self.residual_norms[1] / self.residual_norms[0].max(f64::MIN_POSITIVE)
    }
}

/// A slab that is solved.
pub struct Solved<const M: usize> {
    newton: newton::Report,
    quality: MeshQuality,
    /// See [`SlabReport::jump`].
    jump: f64,
    /// The integrals at the top and the fluxes through the boundary.
    balance: Balance<M>,
    /// Mesh and flow.
    z: Vec<f64>,
}

/// The solver of slabs of bodies, mesh and flow.
pub struct CoupledSlab<const D: usize, const M: usize> {
    /// The problem of the current slab.
    pub system: System<D, M>,
    /// The Newton driver.
    pub newton: newton::Settings,
    predictor: Predictor,
    jacobian: Jacobian,
    /// The boundary layer for an easier initial state.
    pub start_layer: StartLayer,
    /// The longest slab at which the solver gives way, if the caller can go on in a more robust way. An attempt at such a slab of an unresolved
    /// flow gives up early, and is not followed by shorter ones. Longer slabs are halved first: they may fail because they are long.
    pub gives_way: Option<f64>,
    /// Whether the solver gives way, and the mesh does not resolve the flow at the bottom of the slab.
    unresolved: bool,
    workspace: Workspace,
}

/// A run of mesh and flow.
pub type FlowMarch<const D: usize, const M: usize> = March<CoupledSlab<D, M>>;

impl<const D: usize, const M: usize> FlowMarch<D, M> {
    /// A run of `system` from the flow `u` at one time. Newton's absolute tolerance is raised to [`ROUND_OFF`] if it is less.
    pub fn new(system: System<D, M>, u: Vec<f64>, settings: Settings) -> Self {
        let Settings { schedule, mut newton, predictor, jacobian, max_halvings } = settings;
        newton.absolute_tolerance = newton.absolute_tolerance.max(ROUND_OFF);
        newton.rounding_suspected_below = QUIET;
        newton.fruitless_steps = Some(FRUITLESS_STEPS);
        let d = system.mover().displacement_at_start(schedule.start);
        let bodies = system.bodies.iter().map(|body| body.initial()).collect();
        let state = State { step: schedule.step, bodies, ..State::new(schedule.start, u, d) };
        let (start_layer, workspace) = (StartLayer::default(), Workspace::default());
        let solver = CoupledSlab {
            system,
            newton,
            predictor,
            jacobian,
            start_layer,
            gives_way: None,
            unresolved: false,
            workspace,
        };
        March::from(solver, state, schedule, max_halvings)
    }

    /// Adapts the length of the slabs from now on.
    pub fn adapt(&mut self, control: StepControl) {
        self.schedule.control = Some(control);
    }

    /// The bodies at the time reached.
    pub fn bodies(&self) -> Vec<BodyState> {
        let bodies = self.solver.system.bodies.iter().zip(&self.state.bodies);
        bodies.map(|(body, stored)| body.read(stored)).collect()
    }

    /// Whether the bodies of `state` are as many as those of this run, and have as many coordinates.
    pub fn has_bodies_of(&self, state: &State) -> bool {
        let lengths = |bodies: &[Vec<f64>]| bodies.iter().map(Vec::len).collect::<Vec<_>>();
        let system = &self.solver.system;
        let unknowns: Vec<usize> = (0..system.bodies.len()).map(|body| system.body_range(body).len()).collect();
        lengths(&state.bodies) == lengths(&self.state.bodies)
            && state.past.as_ref().is_none_or(|past| lengths(&past.bodies) == unknowns)
    }

    /// The integrals of the components at the top of the slab.
    pub fn totals(&self) -> Vec<f64> {
        self.solver.system.flow.totals(&self.state.u)
    }
}

impl<const D: usize, const M: usize> SlabSolver for CoupledSlab<D, M> {
    type Solved = Solved<M>;
    type Report = SlabReport<M>;

    fn solve(&mut self, state: &State, interval: Interval) -> Result<Solved<M>, SlabError> {
        let may_give_way = self.gives_way.is_some_and(|longest| interval.length() <= longest);
        self.unresolved = may_give_way && is_unresolved(&self.system.flow.operator, &state.u);
        let (mut z, references) = self.guess(state, interval)?;
        let settings = self.settings(state);
        let report = self.newton(&mut z, &references, &settings).map_err(|source| self.cause(&z, source))?;
        let velocity_at_top = self.velocity_at_top(interval.end, &z);
        let balance = balance::correct(&mut self.system, &mut z, self.workspace.residual(), &velocity_at_top);
        let quality = self.check_mesh()?;
        self.check_top(&z, interval)?;
        self.check_bodies(&z)?;
        let jump = self.jump_at_bottom(state, &z);
        Ok(Solved { newton: report, quality, jump, balance, z })
    }

    fn finish(&mut self, state: &mut State, interval: Interval, solved: Solved<M>) -> SlabReport<M> {
        let Solved { newton, quality, jump, balance, mut z } = solved;
        let system = &mut self.system;
        let dt = interval.length();
        let (v, bottom) = (system.mesh.velocities().to_vec(), state.d.clone());
        system.mover().slab_motion.displacement(dt, &bottom, &v, 1.0, &mut state.d);
        state.determinants = system.flow.operator.determinants_at_top().to_vec();
        let bodies: Vec<Vec<f64>> = (0..system.bodies.len()).map(|body| z[system.body_range(body)].to_vec()).collect();
        // The flow is the last part of z. It stays where it is: the vector is large.
        z.drain(..system.flow_range().start);
        balance::copy_top(system.flow.operator.layout, &z, &mut state.u);
        for ((body, z), stored) in system.bodies.iter_mut().zip(&bodies).zip(&mut state.bodies) {
            body.end_slab(z, stored);
        }
        let preconditioner = &mut system.flow.preconditioner;
        let (iterations, rebuilt) = (preconditioner.iterations_since_frozen(), preconditioner.frozen_in_slab());
        preconditioner.stale = state.reuse_policy.record(iterations, rebuilt);
        state.past = Some(Past { interval, dt, bottom, u: Arc::new(z), v: Arc::new(v), bodies });
        let Balance { totals, fluxes } = balance;
        let counts = system.take_counts();
        let (slab, rejected, eased) = (state.slab + 1, state.rejected, state.eased.take());
        let residual_norms = [newton.initial_norm, newton.final_norm()];
        SlabReport { slab, interval, rejected, eased, newton, residual_norms, counts, quality, jump, fluxes, totals }
    }

    fn jump(&self, solved: &Solved<M>) -> (f64, usize) {
        (solved.jump, self.system.flow.operator.layout.time_order)
    }

    fn reject(&mut self) {
        self.system.flow.preconditioner.stale = true;
    }

    fn gives_way(&self, source: &SlabError) -> bool {
        self.unresolved && source.is_of_flow()
    }

    fn ease_start(&mut self, state: &mut State) -> Option<String> {
        if state.slab > 0 {
            return None;
        }
        let (flow, mover) = (&self.system.flow.operator, self.system.mover());
        let tried = state.eased.as_ref().map_or(0, |eased| eased.attempts);
        let thickness = self.start_layer.thicken(flow, mover, tried, &mut state.u)?;
        let totals = totals_at(flow, &state.u, SlabEnd::Bottom);
        state.eased = Some(EasedStart { attempts: tried + 1, thickness, totals });
        Some(format!("the initial state gets a boundary layer {thickness:.3e} thick at the walls"))
    }
}

impl<const D: usize, const M: usize> CoupledSlab<D, M> {
    /// Solves the slab by Newton's method from the guess `z`.
    fn newton(
        &mut self,
        z: &mut [f64],
        references: &[f64],
        settings: &newton::Settings,
    ) -> Result<newton::Report, newton::Error> {
        let CoupledSlab { system, jacobian, workspace, .. } = self;
        let newton::Settings { absolute_tolerance, relative_tolerance, .. } = *settings;
        // The flow is the last field.
        let reference = references.last().copied().unwrap_or(0.0);
        system.mesh.flow_tolerance = absolute_tolerance.max(relative_tolerance * reference);
        match jacobian {
            Jacobian::Exact => newton::solve(system, z, Some(references), settings, workspace),
            Jacobian::FiniteDifference => {
                let mut problem = FiniteDifference::new(system, Scheme::OneSided);
                newton::solve(&mut problem, z, Some(references), settings, workspace)
            }
        }
    }

    /// The settings of Newton's method on top of `state`. An attempt gives up early if the start can still be made easier, or the solver will give
    /// way.
    fn settings(&self, state: &State) -> newton::Settings {
        let mut settings = self.newton;
        settings.krylov.precision = self.system.krylov_precision();
        if state.slab == 0 && state.eased.is_none() && !self.start_layer.walls.is_empty() {
            settings.fruitless_steps = Some(FRUITLESS_FIRST_STEP);
            settings.krylov.max_iterations = settings.krylov.max_iterations.min(FIRST_ITERATIONS);
            settings.pseudo_time.max_rejections = 0;
        }
        if self.unresolved {
            settings.stall = Some(UNRESOLVED_STALL);
            settings.pseudo_time.max_rejections = 0;
        }
        settings
    }

    /// The cause of the failure `source` at `z`. If the mesh alone cannot follow its boundary, that is the cause.
    fn cause(&mut self, z: &[f64], source: newton::Error) -> SlabError {
        let mut v = z[self.system.mesh_range()].to_vec();
        if !v.is_empty() {
            let moved = self.system.move_mesh(&mut v).map_err(SlabError::from);
            if let Err(cause) = moved.and_then(|()| self.check_mesh()) {
                return cause;
            }
        }
        let residual_breakdown = self.system.residual_breakdown(z).map(Box::new);
        SlabError::Newton { residual_breakdown, source: source.into() }
    }

    /// The quality of the mesh last set, if it is proved to be valid.
    fn check_mesh(&mut self) -> Result<MeshQuality, SlabError> {
        let quality = self.system.mesh.quality();
        if quality.is_valid() { Ok(quality) } else { Err(SlabError::Invalid { quality }) }
    }

    /// Whether the flow is admissible at the nodes of the slab's top: the next slab begins there.
    fn check_top(&self, z: &[f64], interval: Interval) -> Result<(), SlabError> {
        let operator = &self.system.flow.operator;
        let (layout, u) = (operator.layout, &z[self.system.flow_range()]);
        let at = |cell: usize, i: usize| from_fn(|m| u[layout.index(cell, layout.time_order - 1, m, i)]);
        let nodes = (0..layout.cells).flat_map(|cell| (0..layout.nodes).map(move |i| (cell, i)));
        let found = nodes.map(|(cell, i)| (cell, operator.problem.kernels.inadmissible(&at(cell, i))));
        let own = found.filter_map(|(cell, what)| Some((operator.share.own[cell], what?)));
        let own = own.min_by_key(|(cell, _)| *cell).map(|(cell, (quantity, value))| Violation {
            quantity: quantity.to_string(),
            value,
            cell,
            time: interval.end,
        });
        operator.share.first_violation(own).map_or(Ok(()), |violation| Err(SlabError::Top(inadmissible(violation))))
    }

    /// Whether the motions of all bodies can be accepted.
    fn check_bodies(&self, z: &[f64]) -> Result<(), SlabError> {
        let mut bodies = self.system.bodies.iter().enumerate();
        bodies.try_for_each(|(number, body)| body.check_slab(&z[self.system.body_range(number)]))
    }

    /// The velocity of the mesh at the top of the slab with the unknowns `z`, the time `t`; at prescribed nodes the prescribed one, at those that
    /// a body moves that of the body.
    fn velocity_at_top(&self, t: f64, z: &[f64]) -> Vec<f64> {
        let (mover, v) = (self.system.mover(), self.system.mesh.velocities());
        // The last time node is the top.
        let mut velocity = v[v.len() - mover.field_len()..].to_vec();
        if self.system.follows_time() {
            mover.prescribe_velocity(t, &mut velocity);
        }
        let nodes = self.system.bodies.iter().flat_map(|body| body.nodes_with_velocity_at_top());
        nodes.for_each(|node| velocity[node * D..(node + 1) * D].fill(0.0));
        for (number, body) in self.system.bodies.iter().enumerate() {
            body.add_velocity_at_top(&z[self.system.body_range(number)], &mut velocity);
        }
        velocity
    }

    /// |u(t_n+) - u_n| / L^(D/2) in L2 over the domain, every component in units of its scale, with the jumps of the velocities of bodies. The unit
    /// of length has no influence.
    fn jump_at_bottom(&mut self, state: &State, z: &[f64]) -> f64 {
        self.jump_of_flow(state, z).hypot(self.jump_of_bodies(z)) / self.system.volume_scale.sqrt()
    }

    /// (sum of v . M v / rho U^2)^1/2 of the jumps v of the velocities of bodies: over a solid of density rho_s the L2 norm of (rho_s /
    /// rho)^1/2 v / U.
    fn jump_of_bodies(&self, z: &[f64]) -> f64 {
        let bodies = self.system.bodies.iter().enumerate();
        let energy: f64 = bodies.map(|(number, body)| body.jump(&z[self.system.body_range(number)])).sum();
        (energy / self.system.kinetic_scale).max(0.0).sqrt()
    }

    fn jump_of_flow(&mut self, state: &State, z: &[f64]) -> f64 {
        let flow = &self.system.flow.operator;
        let (layout, one, u) = (flow.layout, flow.layout.at_one_time(), &z[self.system.flow_range()]);
        let [jump, mass_product] = self.workspace.room().map(|room| &mut room[..one.len()]);
        jump.iter_mut().zip(&state.u).for_each(|(jump, below)| *jump = -below);
        for (a, phi) in flow.tables.time.values(0.0).into_iter().enumerate() {
            for cell in 0..layout.cells {
                let above = &u[layout.cell_at(cell, a)];
                jump[one.cell(cell)].iter_mut().zip(above).for_each(|(jump, u)| *jump += phi * u);
            }
        }
        let scales = flow.problem.kernels.scales();
        flow.mass_product(jump, SlabEnd::Bottom, mass_product);
        for (i, (jump, moment)) in jump.iter_mut().zip(mass_product).enumerate() {
            *jump = *jump * *moment / scales[one.component_of(i)].powi(2);
        }
        inner_product::sum_over_blocks(jump, &flow.share.ends, &flow.share.sums).max(0.0).sqrt()
    }
}
