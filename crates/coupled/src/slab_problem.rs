//! One slab as one nonlinear problem.
//!
//! ```text
//! z = (V, U),   R(z) = ( R_e(V), R_f(U; V) ),   dR/dz = [ K(V)  0 ; B  A ]                                        (coupled)
//! ```
//!
//! Motions that are prescribed everywhere leave V out of z.

mod residual_breakdown;
mod rounding;

pub use residual_breakdown::ResidualBreakdown;

use crate::lagged_preconditioner::{LaggedPreconditioner, Linearisation, Update};
use crate::mesh_mover::MeshMover;
use crate::motion::MeshMotion;
use crate::state::Interval;
use elasticity::{ElasticMesh, ElasticSlab};
use fem::{SlabOperator, Violation};
use newton_krylov::inner_product::{InnerProduct, Weighted};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use std::ops::Range;

/// The mesh is settled when its positions are this good, relative to the node spacing: increments then leave it alone, and
/// products need not differentiate it.
const SETTLED: f64 = 1e-11;

/// The part of the bound of det J / det J_0 that an increment must leave.
const KEPT: f64 = 0.1;

/// How often an increment of the mesh is halved before the line search goes on without the proof of a good start.
const MESH_HALVINGS: i32 = 8;

/// What a solve has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Evaluations of the flow's residual.
    pub residuals: usize,
    /// Jacobian products along the state alone.
    pub products: usize,
    /// Jacobian products along state and mesh.
    pub mesh_products: usize,
    /// CG iterations with K.
    pub elasticity_iterations: usize,
    /// Times the flow's Jacobian was frozen anew.
    pub rebuilds: usize,
    /// Times its modes were factored anew without that.
    pub refactors: usize,
}

/// The coupled problem of the current slab.
pub struct SlabProblem<const D: usize, const M: usize> {
    /// The flow and the moving mesh.
    pub flow: SlabOperator<D, M>,
    /// The motion of the mesh.
    pub mover: MeshMover<D>,
    /// What has been done since the counts were last taken.
    pub counts: Counts,
    /// The preconditioner of the flow.
    pub lagged_preconditioner: LaggedPreconditioner,
    bottom: Vec<f64>,
    prescribed: Vec<f64>,
    velocities: Vec<f64>,
    /// Of the mesh, at these velocities; none before it is asked for.
    mesh_residual: Option<Vec<f64>>,
    fields: Vec<Field>,
    weights: Weighted,
    inverse_pseudo_time: Vec<f64>,
    /// Whether the increment that is being computed leaves the mesh alone.
    settled: bool,
    mesh_work: Vec<f64>,
    flow_work: Vec<f64>,
}

impl<const D: usize, const M: usize> SlabProblem<D, M> {
    /// The problem of `flow` on the mesh that `mover` moves. Where the mesh is found ahead of the flow, it is found until it is settled.
    pub fn new(flow: SlabOperator<D, M>, mut mover: MeshMover<D>) -> Self {
        if let MeshMotion::Elastic { accuracy, .. } = &mut mover.motion {
            accuracy.position = accuracy.position.min(SETTLED);
        }
        let mesh_weights = crate::weights::mesh(&mover, flow.tables.orders.time);
        let (mesh_len, velocity_len) = (mesh_weights.len(), flow.mesh.field_len() * flow.tables.orders.time);
        let flow_len = flow.layout.len();
        let mut fields = Vec::new();
        if mesh_len > 0 {
            fields.push(Field { name: "mesh", range: 0..mesh_len });
        }
        fields.push(Field { name: "flow", range: mesh_len..mesh_len + flow_len });
        let mut weights = mesh_weights;
        weights.extend(crate::weights::flow(&flow));
        SlabProblem {
            bottom: vec![0.0; flow.mesh.field_len()],
            prescribed: vec![0.0; velocity_len],
            velocities: vec![f64::NAN; velocity_len],
            mesh_residual: None,
            inverse_pseudo_time: vec![0.0; fields.len()],
            fields,
            settled: false,
            weights: Weighted { weights },
            counts: Counts::default(),
            lagged_preconditioner: LaggedPreconditioner::default(),
            mesh_work: vec![0.0; mesh_len],
            flow_work: vec![0.0; flow_len],
            flow,
            mover,
        }
    }

    /// Number of mesh unknowns in z.
    pub fn mesh_len(&self) -> usize {
        self.mesh_work.len()
    }
    /// The flow's part of z.
    pub fn flow_range(&self) -> Range<usize> {
        self.mesh_len()..self.len()
    }
    /// The velocities of the mesh last set, `[time node][C0 node][component]`.
    pub fn velocities(&self) -> &[f64] {
        &self.velocities
    }

    /// Moves to the slab from `start` of length `dt`, on top of the state `u` and the displacement `d`.
    ///
    /// # Errors
    /// As [`MeshMover::begin_slab`].
    pub fn begin(&mut self, start: f64, dt: f64, u: &[f64], d: &[f64]) -> Result<(), elasticity::ElasticityError> {
        self.mover.begin_slab(d)?;
        self.flow.begin_slab(start, dt, u, d);
        self.bottom.copy_from_slice(d);
        self.mover.prescribed_in_slab(start, dt, &mut self.prescribed);
        self.velocities.fill(f64::NAN);
        self.inverse_pseudo_time.fill(0.0);
        self.lagged_preconditioner.begin_slab();
        Ok(())
    }

    /// The mesh in equilibrium with its boundary at every time node, found from the guess `v`; sets the mesh of the flow.
    ///
    /// # Errors
    /// As [`MeshMover::velocities`].
    pub fn move_mesh(&mut self, v: &mut [f64]) -> Result<(), elasticity::ElasticityError> {
        let timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let work = self.mover.velocities(self.interval(), &self.bottom, &self.prescribed, v)?;
        drop(timed);
        self.counts.elasticity_iterations += work.iterations;
        self.set_velocities(v);
        Ok(())
    }

    /// Sets mesh and flow to `z`: what products and boundary fluxes are taken of.
    pub fn set_point(&mut self, z: &[f64]) {
        let (v, u) = z.split_at(self.mesh_len());
        if !v.is_empty() {
            self.set_velocities(v);
        }
        self.flow.linearise(u);
    }

    /// The integrals of the components of `u`, a state at one time, on the mesh at the top of the slab (at first: at rest).
    pub fn totals(&self, u: &[f64]) -> Vec<f64> {
        let flow = &self.flow;
        let one = flow.layout.at_one_time();
        let mut mass_product = vec![0.0; one.len()];
        let row = if flow.interval().1 > 0.0 { flow.top_row() } else { flow.tables.bottom_row() };
        flow.mass_product(u, &row, &mut mass_product);
        let component = |m: usize| -> f64 {
            (0..one.cells)
                .map(|c| mass_product[one.cell(c)][m * one.nodes..(m + 1) * one.nodes].iter().sum::<f64>())
                .sum()
        };
        (0..M).map(component).collect()
    }

    /// The norm of a residual's field `k`.
    pub fn field_norms(&self, r: &[f64]) -> Vec<f64> {
        let norm = |range: &Range<usize>| {
            let squares = r[range.clone()].iter().zip(&self.weights.weights[range.clone()]).map(|(r, w)| w * r * r);
            squares.sum::<f64>().sqrt()
        };
        self.fields.iter().map(|field| norm(&field.range)).collect()
    }

    fn elastic(&self) -> Option<(ElasticSlab<'_, D>, f64)> {
        let MeshMotion::Elastic { mesh, accuracy, .. } = &self.mover.motion else { return None };
        Some((ElasticSlab { mesh, motion: &self.mover.slab_motion, dt: self.flow.interval().1 }, accuracy.solve))
    }

    fn interval(&self) -> Interval {
        let (start, dt) = self.flow.interval();
        Interval { start, end: start + dt, halvings: 0 }
    }

    fn elastic_mesh(&self) -> Option<&ElasticMesh<D>> {
        let MeshMotion::Elastic { mesh, .. } = &self.mover.motion else { return None };
        Some(mesh)
    }

    /// w = K^{-1} r_e with the K of the bottom; whether that is exact: the law is linear, and CG converged.
    fn solve_mesh(&mut self, r_e: &[f64], w: &mut [f64]) -> bool {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let Some((slab, tolerance)) = self.elastic() else { return true };
        let result = slab.solve(r_e, w, tolerance);
        let exact = result.is_ok() && slab.mesh.law().is_linear();
        self.counts.elasticity_iterations += result.map_or(0, |reports| reports.iter().map(|r| r.iterations).sum());
        exact
    }

    /// rest -= B w.
    fn subtract_effect_of_mesh(&mut self, w: &[f64], rest: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        let (still, mut effect) = (vec![0.0; rest.len()], vec![0.0; rest.len()]);
        self.counts.mesh_products += 1;
        self.flow.product_with_mesh(&still, w, &mut effect);
        rest.iter_mut().zip(&effect).for_each(|(rest, effect)| *rest -= effect);
    }

    fn set_velocities(&mut self, v: &[f64]) {
        if self.velocities != v {
            self.velocities.copy_from_slice(v);
            self.mesh_residual = None;
            self.flow.set_mesh(v);
        }
    }

    /// The residual of the mesh, which becomes that of the flow. Newton's method asks for it again and again where the mesh is settled.
    fn set_mesh(&mut self, v: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        let Some((slab, _)) = self.elastic() else { return Ok(()) };
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let same = self.velocities == v;
        match &self.mesh_residual {
            Some(known) if same => r.copy_from_slice(known),
            _ => {
                slab.residual(&self.bottom, &self.prescribed, v, r)?;
                if !same {
                    self.mover.check_validity(&self.bottom, v, self.interval())?;
                }
                self.set_velocities(v);
                self.mesh_residual = Some(r.to_vec());
            }
        }
        Ok(())
    }

    /// Makes the preconditioner again from what it was made of.
    pub fn rebuild(&mut self, frozen: Linearisation) {
        self.lagged_preconditioner.rebuild(&mut self.flow, frozen);
        self.velocities.fill(f64::NAN);
    }

    /// Freezes, refactors or keeps the preconditioner of the flow.
    fn update_preconditioner(&mut self) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner_setup").entered();
        let rate = self.inverse_pseudo_time.last().copied().unwrap_or(0.0);
        match self.lagged_preconditioner.update(&self.flow, &self.bottom, &self.velocities, rate) {
            Update::Kept => {}
            Update::Refactored => self.counts.refactors += 1,
            Update::Rebuilt => self.counts.rebuilds += 1,
        }
    }
}

impl<const D: usize, const M: usize> NonlinearProblem for SlabProblem<D, M> {
    fn len(&self) -> usize {
        self.mesh_work.len() + self.flow_work.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &self.weights
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        let n = self.mesh_len();
        let ((v, u), (r_e, r_f)) = (z.split_at(n), r.split_at_mut(n));
        self.set_mesh(v, r_e)?;
        self.counts.residuals += 1;
        let _timed = tracing::trace_span!(target: "cost", "residual").entered();
        self.flow.residual(u, r_f).map_err(inadmissible)
    }

    fn linearise(&mut self, z: &[f64], inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.set_point(z);
        self.inverse_pseudo_time.copy_from_slice(inverse_pseudo_time);
        self.update_preconditioner();
        Ok(())
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        let n = self.mesh_len();
        let ((w, x), (out_e, out_f)) = (direction.split_at(n), out.split_at_mut(n));
        out_e.fill(0.0);
        if w.iter().all(|&w| w == 0.0) {
            self.counts.products += 1;
            self.flow.product(x, out_f);
        } else {
            self.counts.mesh_products += 1;
            if let Some((slab, _)) = self.elastic() {
                slab.jacobian_product(&self.bottom, &self.velocities, w, out_e);
            }
            self.flow.product_with_mesh(x, w, out_f);
        }
    }

    /// T = (1/dtau_f) dt W (x) M for the flow, with one lumped mass, and (1/dtau_e) diag K on displacement increments for the mesh.
    fn add_pseudo_time(&mut self, direction: &[f64], out: &mut [f64]) {
        let n = self.mesh_len();
        let (_, dt) = self.flow.interval();
        let ((w, x), (out_e, out_f)) = (direction.split_at(n), out.split_at_mut(n));
        if let Some(mesh) = self.elastic_mesh() {
            let (diagonal, collocation) = (mesh.diagonal(), self.mover.slab_motion.time().collocation());
            let len = diagonal.len();
            for (i, out) in out_e.iter_mut().enumerate() {
                let row = collocation.row(i / len);
                let increment: f64 = row.iter().enumerate().map(|(b, a)| dt * a * w[b * len + i % len]).sum();
                *out += self.inverse_pseudo_time[0] * diagonal[i % len] * increment;
            }
        }
        let rate = self.inverse_pseudo_time.last().copied().unwrap_or(0.0);
        self.flow.add_mass(rate * dt, x, out_f);
    }

    /// Solves for the mesh alone where that is exact: the Krylov directions that follow then leave the mesh alone.
    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        increment.fill(0.0);
        let n = self.mesh_len();
        let norms = self.field_norms(right_side);
        self.settled = n == 0 || norms[0] <= SETTLED;
        if !self.settled && self.inverse_pseudo_time[0] == 0.0 {
            self.settled = self.solve_mesh(&right_side[..n], &mut increment[..n]);
        }
    }

    /// Block lower triangular: the mesh by K, its effect on the flow by an exact product, the flow by its factored modes.
    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        let ((r_e, r_f), (w, x)) = (r.split_at(self.mesh_len()), out.split_at_mut(self.mesh_len()));
        w.fill(0.0);
        let mut rest = std::mem::take(&mut self.flow_work);
        rest.copy_from_slice(r_f);
        if !self.settled {
            // An unconverged increment still is a good one: the iteration outside is flexible.
            let _ = self.solve_mesh(r_e, w);
            self.subtract_effect_of_mesh(w, &mut rest);
        }
        let timed = tracing::trace_span!(target: "cost", "preconditioner").entered();
        self.lagged_preconditioner.apply(&rest, x);
        drop(timed);
        self.flow_work = rest;
    }

    fn round_off(&mut self, z: &[f64]) -> Option<Vec<f64>> {
        Some(self.rounding(z))
    }

    /// The first of a = 1, 1/2, 1/4, ... for which the mesh of V + a dV is proved to keep a part `KEPT` of the bound of det J / det J_0
    /// that it has at V.
    fn largest_step(&mut self, z: &[f64], increment: &[f64]) -> f64 {
        let (v, w) = (&z[..self.mesh_len()], &increment[..self.mesh_len()]);
        if w.iter().all(|&w| w == 0.0) {
            return 1.0;
        }
        let bound = |v: &[f64]| self.mover.quality(&self.bottom, v, self.interval()).lower_bound;
        let enough = (KEPT * bound(v)).max(0.0);
        let mut trial = vec![0.0; v.len()];
        let mut keeps = |a: f64| {
            trial.iter_mut().zip(v.iter().zip(w)).for_each(|(trial, (v, w))| *trial = v + a * w);
            bound(&trial) > enough
        };
        let mut steps = (0..MESH_HALVINGS).map(|k| 0.5_f64.powi(k));
        // Where none will do the shortest is left to the residual, which says what is wrong.
        steps.find(|a| keeps(*a)).unwrap_or(0.5_f64.powi(MESH_HALVINGS))
    }
}

pub(crate) fn inadmissible(violation: Violation) -> Inadmissible {
    let Violation { quantity, value, cell, time } = violation;
    Inadmissible { quantity: quantity.to_string(), value, location: format!("in cell {cell} at t = {time}") }
}
