//! An elastic body that the flow moves: a structure on a mesh of its own, whose boundary nodes lie on those of the flow's mesh.
//!
//! ```text
//! R_s,a = (dynamics) - L_a                                        at free entries                                 (elastic body)
//! R_s,a = D_a dt ( W_a - V_a )                                    at entries that a support moves by V_a of (support)
//! L_a,i = sum_q phi_a(s_q) L_q,i                                  the loads of the flow at its points in time
//! ```
//!
//! with (dynamics) of `elasticity::structure_slab`. The unknowns W are the velocities of all C0 nodes of the solid at the time nodes. D_a =
//! dt omega_a (K_ii + |lambda/dt|^2 M_ii), with the largest |lambda|, is the impulse per displacement. Wall and solid move by the same
//! polynomial in time, so the work of the loads on both is equal to rounding.

mod interface;
mod slab;

pub use interface::{Follower, Interface};

use crate::block::{Block, Body, BodyState, Couplings, Exchange, Ledger, Quantity};
use crate::blocks::{SlabTimes, first_admissible_step, jump, last_digits};
use crate::observation::Observation;
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use crate::structure_march::Supports;
use basis::{Matrix, TemporalModes};
use elasticity::{FluidLayer, Loads, ModalSolver, SlabMotion, Structure};
use fem::Clock;
use newton_krylov::problem::Inadmissible;
use slab::Slab;

/// The relative tolerance of a temporal mode in the preconditioner.
const MODE_TOLERANCE: f64 = 1e-2;

/// How often an increment is halved until the law has a stress.
const HALVINGS: i32 = 8;

/// The data of an elastic body.
pub struct ElasticBodyData<const D: usize> {
    /// Its mesh, material and supports.
    pub structure: Structure<D>,
    /// The loads on it, except those of the flow.
    pub loads: Loads<D>,
    /// How its supports move.
    pub supports: Supports<D>,
    /// The displacement at the start, `[C0 node][component]`.
    pub displacement: Vec<f64>,
    /// The velocity at the start.
    pub velocity: Vec<f64>,
    /// The fluid that moves with it, for the preconditioner alone.
    pub fluid: FluidLayer<D>,
    /// The points whose displacements are its coordinates in reports.
    pub points: Vec<Observation>,
}

/// An elastic body as a block.
pub struct ElasticBody<const D: usize> {
    data: ElasticBodyData<D>,
    interface: Interface,
    number: usize,
    motion: SlabMotion,
    /// phi_a at the quadrature points of the flow in time, `[point][a]`.
    at_points: Matrix,
    step: f64,
    /// The largest |lambda|.
    largest_eigenvalue: f64,
    /// D_a of a slab of the length `step`, `[time node][C0 node][component]`.
    scales: Vec<f64>,
    slab: Slab,
    /// W at the point of linearisation and evaluation.
    w: Vec<f64>,
    /// The loads of the flow at that point, `[time node][C0 node][component]`.
    flow_loads: Vec<f64>,
    inverse_pseudo_time: f64,
    /// The preconditioner with the 1/dtau that it is made for.
    modal: Option<(f64, ModalSolver<D>)>,
}

impl<const D: usize> ElasticBody<D> {
    /// Body number `number` of a run with the slabs of `times`.
    pub fn new(data: ElasticBodyData<D>, interface: Interface, number: usize, times: SlabTimes) -> Self {
        let at_points = times.test_functions();
        let SlabTimes { time, step, .. } = times;
        let length = data.structure.length() * time.order();
        let eigenvalues = TemporalModes::new(&time).eigenvalues;
        let mut body = ElasticBody {
            at_points,
            interface,
            number,
            step,
            largest_eigenvalue: eigenvalues.iter().fold(0.0, |largest, lambda| lambda.norm().max(largest)),
            scales: Vec::new(),
            slab: Slab::default(),
            w: vec![0.0; length],
            flow_loads: vec![0.0; length],
            inverse_pseudo_time: 0.0,
            modal: None,
            motion: SlabMotion::new(time),
            data,
        };
        body.scales = body.impulse_scales();
        body
    }

    /// The structure.
    pub fn structure(&self) -> &Structure<D> {
        &self.data.structure
    }

    /// The displacement and the velocity of all C0 nodes in a `stored` state.
    pub fn fields<'a>(&self, stored: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let length = self.data.structure.length();
        (&stored[..length], &stored[length..2 * length])
    }

    /// D_a of a slab of the length `step`.
    fn impulse_scales(&self) -> Vec<f64> {
        let scales = self.data.structure.force_scales((self.largest_eigenvalue / self.step).powi(2));
        let weights = self.motion.time().weights();
        weights.iter().flat_map(|w| scales.iter().map(move |scale| self.step * w * scale)).collect()
    }

    /// Calls `act` with every fixed entry of the slab.
    fn at_fixed(&self, mut act: impl FnMut(usize)) {
        let fixed = self.data.structure.fixed();
        (0..self.w.len()).filter(|i| fixed[i % fixed.len()]).for_each(&mut act);
    }

    /// Sets the rows of fixed entries by (elastic body), for the difference `w` to the prescribed velocity.
    fn constrain(&self, w: impl Fn(usize) -> f64, r: &mut [f64]) {
        self.at_fixed(|i| r[i] = self.scales[i] * self.step * w(i));
    }

    /// r := r - L at free entries, for the nodal `loads` of the flow, `[time node][C0 node][component]`.
    fn subtract_nodal_loads(&self, loads: &[f64], r: &mut [f64]) {
        let fixed = self.data.structure.fixed();
        let entries = r.iter_mut().zip(loads).enumerate();
        entries.filter(|(i, _)| !fixed[i % fixed.len()]).for_each(|(_, (r, load))| *r -= load);
    }

    /// Factors the systems of the slab, unless they are known.
    fn factor(&mut self) -> Option<&ModalSolver<D>> {
        let dt = elasticity::nominal_length(self.slab.dt, self.step);
        let rate = self.inverse_pseudo_time;
        if self.modal.as_ref().is_none_or(|(of, modal)| *of != rate || modal.dt() != dt) {
            let _timed = tracing::trace_span!(target: "cost", "preconditioner_setup").entered();
            let (fluid, position) = (Some(&self.data.fluid), &self.slab.displacement[..]);
            let of = elasticity::SlabSystems { dt, inverse_pseudo_time: rate, fluid, position };
            let modal = ModalSolver::new(&self.data.structure, self.motion.time(), of);
            self.modal = modal.ok().map(|modal| (rate, modal));
        }
        self.modal.as_ref().map(|(_, modal)| modal)
    }
}

impl<const D: usize> Block for ElasticBody<D> {
    fn field(&self) -> &'static str {
        "body"
    }

    fn couplings(&self) -> Couplings {
        Couplings { reads: &[Quantity::WallLoads], writes: &[Quantity::WallDisplacement] }
    }

    /// R / D_a is an error of position. The weights divide it by the node spacing.
    fn weights(&self) -> Vec<f64> {
        let (spacing, length) = (self.data.structure.node_spacing(), self.data.structure.length());
        let weight =
            |(i, scale): (usize, &f64)| 1.0 / ((scale * spacing[i % length / D]).powi(2) * self.scales.len() as f64);
        self.scales.iter().enumerate().map(weight).collect()
    }

    fn begin_slab(&mut self, interval: Interval, clock: Clock, state: &State) -> Result<(), SlabError> {
        let (displacement, velocity) = self.fields(&state.bodies[self.number]);
        self.slab = Slab {
            clock,
            dt: interval.length(),
            displacement: displacement.to_vec(),
            velocity: velocity.to_vec(),
            ..Slab::default()
        };
        self.slab.forces = self.in_slab().forces().map_err(SlabError::Structure)?;
        self.slab.supports = self.prescribed();
        if !self.data.structure.law().is_linear() {
            // K is taken at the bottom of the slab.
            self.modal = None;
        }
        self.inverse_pseudo_time = 0.0;
        Ok(())
    }

    fn residual(&mut self, z: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible> {
        self.w.copy_from_slice(z);
        self.write_walls(&self.slab.displacement, z, &mut exchange.wall_displacement);
        self.in_slab().residual(&self.slab.forces, z, r)?;
        self.constrain(|i| z[i] - self.slab.supports[i], r);
        Ok(())
    }

    fn receive(&mut self, exchange: &Exchange, r: &mut [f64]) {
        self.flow_loads = self.nodal_loads(&exchange.wall_loads);
        self.subtract_nodal_loads(&self.flow_loads, r);
    }

    fn linearise(&mut self, z: &[f64], exchange: &mut Exchange, inverse_pseudo_time: f64) {
        self.w.copy_from_slice(z);
        self.write_walls(&self.slab.displacement, z, &mut exchange.wall_displacement);
        self.inverse_pseudo_time = inverse_pseudo_time;
    }

    fn product(&mut self, x: &[f64], _tangent: &mut Exchange, out: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        self.in_slab().product(&self.w, x, out);
        self.constrain(|i| x[i], out);
    }

    fn receive_product(&mut self, tangent: &Exchange, out: &mut [f64]) {
        self.subtract_nodal_loads(&self.nodal_loads(&tangent.wall_loads), out);
    }

    fn precondition(&mut self, r: &[f64], _tangent: &mut Exchange, x: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner").entered();
        x.copy_from_slice(r);
        self.factor();
        if let Some((_, modal)) = &self.modal {
            // FGMRES is flexible: an increment that has not converged is good enough.
            let _ = modal.solve(&self.data.structure, self.slab.dt, MODE_TOLERANCE, x);
        }
        self.at_fixed(|i| x[i] = r[i] / (self.scales[i] * self.step));
    }

    /// (1/dtau) dt omega_a (M + added mass).
    fn add_pseudo_time(&mut self, x: &[f64], out: &mut [f64]) {
        let (structure, length) = (&self.data.structure, self.data.structure.length());
        let rate = self.largest_eigenvalue / self.slab.dt;
        let mut inertia = vec![0.0; length];
        for ((x, out), weight) in
            x.chunks_exact(length).zip(out.chunks_exact_mut(length)).zip(self.motion.time().weights())
        {
            structure.apply_mass_beside(&self.data.fluid, rate, x, &mut inertia);
            let factor = self.inverse_pseudo_time * weight * self.slab.dt;
            let entries = out.iter_mut().zip(&inertia).zip(structure.fixed());
            entries.filter(|(_, fixed)| !**fixed).for_each(|((out, inertia), _)| *out += factor * inertia);
        }
    }

    /// The first of a = 1, 1/2, 1/4, ... for which the law has a stress at all time nodes.
    fn largest_step(&mut self, z: &[f64], dz: &[f64]) -> f64 {
        if self.data.structure.law().is_linear() {
            return 1.0;
        }
        let mut r = vec![0.0; z.len()];
        let is_admissible = |trial: &[f64]| self.in_slab().residual(&self.slab.forces, trial, &mut r).is_ok();
        first_admissible_step(z, dz, HALVINGS, is_admissible)
    }
}

impl<const D: usize> Body for ElasticBody<D> {
    fn initial(&self) -> Vec<f64> {
        [&self.data.displacement[..], &self.data.velocity, &Ledger::default().numbers()].concat()
    }

    fn read(&self, stored: &[f64]) -> BodyState {
        let (displacement, velocity) = self.fields(stored);
        let at_points = |field| self.data.points.iter().flat_map(|point| point.value::<D>(field)).collect();
        BodyState {
            position: at_points(displacement),
            rate: at_points(velocity),
            kinetic_energy: self.data.structure.kinetic_energy(velocity),
            potential_energy: self.data.structure.strain_energy(displacement),
            ledger: Ledger::read(&stored[displacement.len() + velocity.len()..]),
            reactions: self.data.supports.reactions.forces(&self.slab.reaction),
        }
    }

    fn travel(&self, z: &[f64]) -> f64 {
        let (spacing, length) = (self.data.structure.node_spacing(), self.data.structure.length());
        let way = |(i, rate): (usize, &f64)| (self.step * rate / spacing[i % length / D]).powi(2);
        (z.iter().enumerate().map(way).sum::<f64>() / z.len() as f64).sqrt()
    }

    fn jump(&self, z: &[f64]) -> f64 {
        2.0 * self.data.structure.kinetic_energy(&jump(self.motion.time(), z, &self.slab.velocity))
    }

    fn move_walls(&mut self, x: &[f64], displacement: &mut [f64]) {
        self.write_walls(&vec![0.0; self.data.structure.length()], x, displacement);
    }

    fn last_digits(&self, z: &[f64]) -> Vec<f64> {
        last_digits(z, &self.slab.displacement, self.slab.dt)
    }

    fn guess(&mut self, past: Option<(&[f64], f64)>, exchange: &mut Exchange, z: &mut [f64]) {
        self.extrapolate(past, z);
        self.at_fixed(|i| z[i] = self.slab.supports[i]);
        self.w.copy_from_slice(z);
        self.write_walls(&self.slab.displacement, z, &mut exchange.wall_displacement);
    }

    fn end_slab(&mut self, z: &[f64], stored: &mut Vec<f64>) {
        let length = self.data.structure.length();
        let ledger = self.closed(z, Ledger::read(&stored[2 * length..]));
        let mut top = vec![0.0; length];
        self.motion.displacement(self.slab.dt, &self.slab.displacement, z, 1.0, &mut top);
        *stored = [&top[..], &z[z.len() - length..], &ledger.numbers()].concat();
    }
}
