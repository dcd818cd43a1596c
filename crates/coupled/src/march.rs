//! The march from slab to slab.

use crate::balance::{self, Balance};
use crate::mesh_mover::MeshQuality;
use crate::schedule::{Schedule, StepControl};
use crate::slab_problem::{Counts, ResidualBreakdown, SlabProblem, inadmissible};
use crate::state::{Interval, Past, State};
use fem::{FluxesAt, Violation};
use newton_krylov::finite_difference::{FiniteDifference, Scheme};
use newton_krylov::newton::{self, Workspace};
use newton_krylov::problem::{Inadmissible, NonlinearProblem};
use std::array::from_fn;

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

/// The finest absolute tolerance, in units of the reference state: no residual of a flow is known better. A residual whose rounding is
/// larger ends at its own estimate of that, see [`NonlinearProblem::round_off`].
pub const ROUND_OFF: f64 = 1e-13;

/// Below this norm of the residual, in units of the reference state, Newton looks out for rounding.
const QUIET: f64 = 1e-6;

/// What a slab has done.
#[derive(Clone, Debug)]
pub struct SlabReport<const M: usize> {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// How often an attempt was rejected before.
    pub rejected: usize,
    /// The Newton driver.
    pub newton: newton::Report,
    /// What it has cost, rejected attempts included.
    pub counts: Counts,
    /// The quality of the mesh.
    pub quality: MeshQuality,
    /// The jump of the flow at the bottom, in L2 over the domain, every component in units of its scale: an estimate of the error
    /// in time.
    pub jump: f64,
    /// What leaves through the boundaries at the quadrature points in time and at the top of the slab.
    pub fluxes: Vec<FluxesAt<M>>,
    /// The integral of every component at the top of the slab.
    pub totals: Vec<f64>,
}

/// A slab that is solved.
struct Solved<const M: usize> {
    newton: newton::Report,
    quality: MeshQuality,
    /// See [`SlabReport::jump`].
    jump: f64,
    /// What the slab holds and lets pass.
    balance: Balance<M>,
    /// Mesh and flow.
    z: Vec<f64>,
}

/// Why a slab could not be solved.
#[derive(Debug, thiserror::Error)]
pub enum SlabError {
    /// The mesh equations were not solved.
    #[error("the mesh could not be moved")]
    Mesh(#[from] elasticity::ElasticityError),
    /// A cell is not proved to stay valid.
    #[error("cell {} is inverted or nearly so at t = {}: det J / det J_0 = {:e}", quality.cell, quality.time, quality.sampled_min)]
    Invalid {
        /// What was found.
        quality: MeshQuality,
    },
    /// Neither the extrapolated nor the constant guess is a state.
    #[error("no admissible guess")]
    Guess(#[from] Inadmissible),
    /// The slab is solved by what is no state at its top: the equations see what lies between, and the top only from below.
    #[error("the equations have a solution that is not admissible at the top of the slab")]
    Top(#[source] Inadmissible),
    /// Newton failed.
    #[error("the equations of flow and mesh are not solved{}", largest_in(residual_breakdown.as_deref()))]
    Newton {
        /// What is left of the residual, if there was one.
        residual_breakdown: Option<Box<ResidualBreakdown>>,
        /// Why.
        source: Box<newton::Error>,
    },
}

/// Where the residual is largest, for a message.
fn largest_in(residual_breakdown: Option<&ResidualBreakdown>) -> String {
    residual_breakdown
        .and_then(ResidualBreakdown::worst_cell)
        .map_or(String::new(), |cell| format!("; their residual is largest in cell {cell}"))
}

/// The run stops: the smallest slab allowed could not be solved either.
#[derive(Debug, thiserror::Error)]
#[error("slab {slab}, t = {} to {}, could not be solved, halved {halvings} times", interval.start, interval.end)]
pub struct MarchError {
    /// The number of the slab.
    pub slab: usize,
    /// The interval of the last attempt.
    pub interval: Interval,
    /// How often the slab was halved.
    pub halvings: u32,
    /// What went wrong at last.
    #[source]
    pub source: SlabError,
}

impl MarchError {
    /// `interval`, the next one of `state`, has failed because of `source`.
    pub(crate) fn new(state: &State, interval: Interval, source: SlabError) -> Self {
        MarchError { slab: state.slab + 1, interval, halvings: interval.halvings, source }
    }
}

/// A run in progress.
pub struct March<const D: usize, const M: usize> {
    /// The problem of the current slab.
    pub problem: SlabProblem<D, M>,
    /// Where the run stands.
    pub state: State,
    settings: Settings,
    workspace: Workspace,
}

impl<const D: usize, const M: usize> March<D, M> {
    /// A run of `problem` from the flow `u` at one time. Newton's absolute tolerance is raised to [`ROUND_OFF`] if it is less.
    pub fn new(problem: SlabProblem<D, M>, u: Vec<f64>, mut settings: Settings) -> Self {
        settings.newton.absolute_tolerance = settings.newton.absolute_tolerance.max(ROUND_OFF);
        settings.newton.quiet = QUIET;
        let Schedule { start, step, .. } = settings.schedule;
        let d = problem.mover.displacement_at_start(start);
        let state = State { step, ..State::new(start, u, d) };
        March { problem, state, settings, workspace: Workspace::default() }
    }

    /// The settings, which may be changed between slabs.
    pub fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// Adapts the length of the slabs from now on.
    pub fn adapt(&mut self, control: StepControl) {
        self.settings.schedule.control = Some(control);
    }

    /// Whether the end is reached.
    pub fn is_done(&self) -> bool {
        self.settings.schedule.is_done(&self.state)
    }

    /// Advances one slab, a shorter one if need be.
    ///
    /// # Errors
    /// [`MarchError`]; the state is then that of the last slab that succeeded.
    pub fn advance(&mut self) -> Result<SlabReport<M>, MarchError> {
        let mut rejected = 0;
        loop {
            let interval = self.settings.schedule.pending(&mut self.state);
            match self.attempt(interval) {
                Ok(Solved { jump, .. }) if self.repeats(interval, jump) => {
                    tracing::info!(start = interval.start, end = interval.end, jump, "slab too long, shortened");
                }
                Ok(solved) => return Ok(self.accept(interval, rejected, solved)),
                Err(source) => self.shorten(interval, source)?,
            }
            rejected += 1;
        }
    }

    fn repeats(&mut self, interval: Interval, jump: f64) -> bool {
        let time_order = self.problem.flow.layout.time_order;
        self.settings.schedule.repeats(&mut self.state, interval, jump, time_order)
    }

    /// Goes on with a shorter slab, if one is allowed, where `interval` has failed.
    fn shorten(&mut self, interval: Interval, source: SlabError) -> Result<(), MarchError> {
        let cause = chain(&source);
        if !self.settings.schedule.shorten(&mut self.state, interval, self.settings.max_halvings) {
            return Err(MarchError::new(&self.state, interval, source));
        }
        tracing::warn!(start = interval.start, end = interval.end, cause, "slab rejected, halving it");
        self.problem.lagged_preconditioner.stale = true;
        Ok(())
    }

    /// Solves one slab from the current state.
    fn attempt(&mut self, interval: Interval) -> Result<Solved<M>, SlabError> {
        let dt = interval.end - interval.start;
        self.problem.begin(interval.start, dt, &self.state.u, &self.state.d)?;
        self.problem.lagged_preconditioner.patience = self.state.reuse_policy.patience();
        let mut v = self.guess_velocities(interval);
        if self.settings.predictor == Predictor::Elastic || self.problem.mesh_len() == 0 {
            self.problem.move_mesh(&mut v)?;
            // Before any flow is solved on it.
            self.check_mesh(&v, interval)?;
        }
        let mut z = v[..self.problem.mesh_len()].to_vec();
        z.extend(self.constant_guess());
        let (references, norm) = self.references(&z)?;
        if self.settings.predictor != Predictor::Constant {
            self.improve_guess(&mut z, norm, dt);
        }
        let settings = &self.settings.newton;
        let solved = match self.settings.jacobian {
            Jacobian::Exact => {
                newton::solve(&mut self.problem, &mut z, Some(&references), settings, &mut self.workspace)
            }
            Jacobian::FiniteDifference => {
                let mut problem = FiniteDifference::new(&mut self.problem, Scheme::OneSided);
                newton::solve(&mut problem, &mut z, Some(&references), settings, &mut self.workspace)
            }
        };
        let report = solved.map_err(|source| self.cause(&z, interval, source))?;
        let velocity_at_top = self.velocity_at_top(interval.end, self.problem.velocities());
        let balance = balance::correct(&mut self.problem, &mut z, self.workspace.residual(), &velocity_at_top);
        let quality = self.check_mesh(self.problem.velocities(), interval)?;
        self.check_top(&z, interval)?;
        let jump = self.jump(&z);
        Ok(Solved { newton: report, quality, jump, balance, z })
    }

    /// Why Newton has failed at `z`: often the mesh cannot follow its boundary, with or without a flow.
    fn cause(&mut self, z: &[f64], interval: Interval, source: newton::Error) -> SlabError {
        let mut v = z[..self.problem.mesh_len()].to_vec();
        if !v.is_empty() {
            let moved = self.problem.move_mesh(&mut v).map_err(SlabError::from);
            if let Err(cause) = moved.and_then(|()| self.check_mesh(&v, interval)) {
                return cause;
            }
        }
        SlabError::Newton {
            residual_breakdown: self.problem.residual_breakdown(z).map(Box::new),
            source: source.into(),
        }
    }

    /// The quality of the mesh, if it is proved to be valid.
    fn check_mesh(&self, v: &[f64], interval: Interval) -> Result<MeshQuality, SlabError> {
        let quality = self.problem.mover.quality(&self.state.d, v, interval);
        if quality.is_valid() { Ok(quality) } else { Err(SlabError::Invalid { quality }) }
    }

    /// Whether the flow is admissible at the nodes of the slab's top, where the next one begins.
    fn check_top(&self, z: &[f64], interval: Interval) -> Result<(), SlabError> {
        let (layout, kernels) = (self.problem.flow.layout, &self.problem.flow.problem.kernels);
        let u = &z[self.problem.flow_range()];
        let at = |cell: usize, i: usize| from_fn(|m| u[layout.index(cell, layout.time_order - 1, m, i)]);
        let nodes = (0..layout.cells).flat_map(|cell| (0..layout.nodes).map(move |i| (cell, i)));
        let found = nodes.map(|(cell, i)| (cell, kernels.inadmissible(&at(cell, i))));
        let Some((cell, (quantity, value))) = found.filter_map(|(cell, what)| Some((cell, what?))).next() else {
            return Ok(());
        };
        Err(SlabError::Top(inadmissible(Violation { quantity, value, cell, time: interval.end })))
    }

    /// The state at the bottom, at every time node.
    pub fn constant_guess(&self) -> Vec<f64> {
        let layout = self.problem.flow.layout;
        let one = layout.at_one_time();
        let mut guess = vec![0.0; layout.len()];
        for cell in 0..layout.cells {
            for a in 0..layout.time_order {
                guess[layout.cell_at(cell, a)].copy_from_slice(&self.state.u[one.cell(cell)]);
            }
        }
        guess
    }

    /// Norms of the residual at the guess: of each field, what relative tolerances refer to (for the mesh it is the spacing of nodes), and
    /// of all.
    fn references(&mut self, z: &[f64]) -> Result<(Vec<f64>, f64), Inadmissible> {
        let mut r = vec![0.0; z.len()];
        self.problem.residual(z, &mut r)?;
        let mut norms = self.problem.field_norms(&r);
        if self.problem.mesh_len() > 0 {
            norms[0] = 1.0;
        }
        Ok((norms, self.problem.inner_product().norm(&r)))
    }

    /// Replaces the flow's guess, whose residual has the norm `norm`, by the polynomial of the slab before, if that has the smaller one.
    fn improve_guess(&mut self, z: &mut [f64], norm: f64, dt: f64) {
        let Some(past) = &self.state.past else { return };
        let (layout, range) = (self.problem.flow.layout, self.problem.flow_range());
        let mut candidate = z.to_vec();
        let time = self.problem.mover.slab_motion.time();
        for (a, s) in time.nodes().iter().enumerate() {
            let phi = time.extrapolation(dt / past.dt, *s);
            for cell in 0..layout.cells {
                let out = &mut candidate[range.clone()][layout.cell_at(cell, a)];
                out.fill(0.0);
                for (b, phi) in phi.iter().enumerate() {
                    out.iter_mut().zip(&past.u[layout.cell_at(cell, b)]).for_each(|(u, old)| *u += phi * old);
                }
            }
        }
        let mut r = vec![0.0; z.len()];
        let admissible = self.problem.residual(&candidate, &mut r).is_ok();
        if admissible && self.problem.inner_product().norm(&r) < norm {
            z.copy_from_slice(&candidate);
        }
    }

    /// The first guess of the mesh velocities: rest, unless the motion of the slab before may be continued.
    fn guess_velocities(&self, interval: Interval) -> Vec<f64> {
        let mover = &self.problem.mover;
        let (time, len) = (mover.slab_motion.time(), mover.field_len());
        let extrapolated = self.state.extrapolated_velocities(time, len, interval.end - interval.start);
        let is_good = match self.settings.predictor {
            Predictor::Constant => false,
            Predictor::Elastic => true,
            Predictor::Extrapolated => mover.quality(&self.state.d, &extrapolated, interval).is_valid(),
        };
        if is_good { extrapolated } else { vec![0.0; len * time.order()] }
    }

    /// Moves the state to the top of the slab.
    fn accept(&mut self, interval: Interval, rejected: usize, solved: Solved<M>) -> SlabReport<M> {
        let Solved { newton, quality, jump, balance, z } = solved;
        let dt = interval.end - interval.start;
        let layout = self.problem.flow.layout;
        let u = z[self.problem.flow_range()].to_vec();
        let v = self.problem.velocities().to_vec();
        let bottom = self.state.d.clone();
        self.problem.mover.slab_motion.displacement(dt, &bottom, &v, 1.0, &mut self.state.d);
        self.state.u = balance::at_top(layout, &u);
        let Balance { totals, fluxes } = balance;
        let lagged_preconditioner = &mut self.problem.lagged_preconditioner;
        let (iterations, frozen) =
            (lagged_preconditioner.iterations_since_frozen(), lagged_preconditioner.frozen_in_slab());
        lagged_preconditioner.stale = self.state.reuse_policy.record(iterations, frozen);
        self.state.past = Some(Past { interval, dt, bottom, u, v });
        self.state.finish(interval);
        self.settings.schedule.adapt(&mut self.state, interval, jump, layout.time_order);
        let counts = std::mem::take(&mut self.problem.counts);
        SlabReport { slab: self.state.slab, interval, rejected, newton, counts, quality, jump, fluxes, totals }
    }

    /// The velocity of the mesh at the top of the slab, the time `t`, of which `v` are the velocities: as prescribed where it is.
    fn velocity_at_top(&self, t: f64, v: &[f64]) -> Vec<f64> {
        let mover = &self.problem.mover;
        // The last time node is the top.
        let mut velocity = v[v.len() - mover.field_len()..].to_vec();
        mover.prescribe_velocity(t, &mut velocity);
        velocity
    }

    /// |u(t_n+) - u_n| in L2 over the domain, every component in units of its scale.
    fn jump(&self, z: &[f64]) -> f64 {
        let flow = &self.problem.flow;
        let (layout, one, u) = (flow.layout, flow.layout.at_one_time(), &z[self.problem.flow_range()]);
        let mut jump: Vec<f64> = self.state.u.iter().map(|below| -below).collect();
        for (a, phi) in flow.tables.time.values(0.0).into_iter().enumerate() {
            for cell in 0..layout.cells {
                let above = &u[layout.cell_at(cell, a)];
                jump[one.cell(cell)].iter_mut().zip(above).for_each(|(jump, u)| *jump += phi * u);
            }
        }
        let (mut mass_product, scales) = (vec![0.0; jump.len()], flow.problem.kernels.scales());
        flow.mass_product(&jump, &flow.tables.bottom_row(), &mut mass_product);
        let square = |(i, (jump, moment)): (usize, (&f64, &f64))| jump * moment / scales[i / one.nodes % M].powi(2);
        jump.iter().zip(&mass_product).enumerate().map(square).sum::<f64>().max(0.0).sqrt()
    }

    /// The integrals of the components at the top of the slab.
    pub fn totals(&self) -> Vec<f64> {
        self.problem.totals(&self.state.u)
    }
}

/// An error and its causes in one line.
pub fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |e| e.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
