//! The mesh as a block: the velocities of its nodes, in equilibrium with its boundary at every time node.

use super::first_admissible_step;
use crate::block::{Block, Couplings, Exchange, Quantity};
use crate::mesh_mover::{MeshMover, MeshQuality, RELATIVE_DETERMINANT};
use crate::motion::MeshMotion;
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use elasticity::{ElasticSlab, ElasticityError, Inversion};
use fem::Clock;
use newton_krylov::problem::Inadmissible;

/// The mesh is settled when its positions have at most this error, relative to the node spacing, and at most the part [`NEGLIGIBLE`] of what
/// the flow may leave. Increments then leave it alone, and products need not differentiate it.
pub(crate) const SETTLED: f64 = 1e-11;

/// See [`SETTLED`]: a linear solve cannot go below the residual of a settled mesh.
const NEGLIGIBLE: f64 = 0.25;

/// An increment must keep this part of the bound of det J / det J_0.
const KEPT: f64 = 0.1;

/// How often an increment of the mesh is halved. After that the line search starts without a proof.
const MESH_HALVINGS: i32 = 8;

/// The mesh of a slab.
///
/// Motions that are prescribed everywhere have no unknowns.
pub struct MeshBlock<const D: usize> {
    /// The motion.
    pub mover: MeshMover<D>,
    /// CG iterations with K since this was last set to zero.
    pub iterations: usize,
    interval: Interval,
    bottom: Vec<f64>,
    /// The displacement at constrained entries: without bodies, and as last read.
    prescribed: Vec<f64>,
    wall_displacement: Vec<f64>,
    velocities: Vec<f64>,
    /// R at these velocities, if it is known.
    residual: Option<Vec<f64>>,
    /// Whether bodies move some of its nodes.
    pub(crate) follows_bodies: bool,
    /// Whether the increment that is being computed leaves the mesh alone.
    pub(crate) settled: bool,
    /// The norm to which the residual of the flow must fall in this slab.
    pub(crate) flow_tolerance: f64,
    inverse_pseudo_time: f64,
}

impl<const D: usize> MeshBlock<D> {
    /// The mesh that `mover` moves in slabs of `time_order` nodes. An elastic mesh is solved to round-off before the flow.
    pub fn new(mut mover: MeshMover<D>, time_order: usize) -> Self {
        if let MeshMotion::Elastic { accuracy, .. } = &mut mover.motion {
            accuracy.position = accuracy.position.min(SETTLED);
        }
        let (field_len, len) = (mover.field_len(), mover.field_len() * time_order);
        MeshBlock {
            mover,
            iterations: 0,
            interval: Interval { start: 0.0, end: 0.0, halvings: 0 },
            bottom: vec![0.0; field_len],
            prescribed: vec![0.0; len],
            wall_displacement: vec![f64::NAN; len],
            velocities: vec![f64::NAN; len],
            residual: None,
            follows_bodies: false,
            settled: false,
            flow_tolerance: f64::INFINITY,
            inverse_pseudo_time: 0.0,
        }
    }

    /// The velocities last set, `[time node][C0 node][component]`.
    pub fn velocities(&self) -> &[f64] {
        &self.velocities
    }

    /// Moves to the slab `interval` on top of the displacement `d`.
    pub(crate) fn begin(&mut self, interval: Interval, clock: Clock, d: &[f64]) -> Result<(), ElasticityError> {
        self.mover.begin_slab(d)?;
        self.interval = interval;
        self.bottom.copy_from_slice(d);
        self.mover.prescribed_in_slab(clock, interval.length(), d, &mut self.prescribed);
        self.inverse_pseudo_time = 0.0;
        self.forget();
        Ok(())
    }

    /// The displacement of constrained nodes that no body moves.
    pub(crate) fn prescribe(&self, exchange: &mut Exchange) {
        exchange.wall_displacement.clone_from(&self.prescribed);
    }

    /// Forgets the mesh: it must be set again.
    pub(crate) fn forget(&mut self) {
        self.velocities.fill(f64::NAN);
        self.residual = None;
    }

    /// Replaces the guess `v` by the mesh in equilibrium with its boundary at every time node, and sets it.
    ///
    /// # Errors
    /// As [`MeshMover::velocities`].
    pub(crate) fn solve(&mut self, exchange: &mut Exchange, v: &mut [f64]) -> Result<(), ElasticityError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let work = self.mover.velocities(self.interval, &self.bottom, &exchange.wall_displacement, v)?;
        self.iterations += work.iterations;
        self.read_walls(exchange);
        self.set(v, exchange);
        Ok(())
    }

    /// The quality of the mesh last set.
    pub(crate) fn quality(&self) -> MeshQuality {
        self.mover.quality(&self.bottom, &self.velocities, self.interval)
    }

    /// Solves for the mesh alone if that solve is exact. All further directions then leave the mesh alone.
    pub(crate) fn solve_ahead(&mut self, norm: f64, right_side: &[f64], increment: &mut [f64]) {
        self.settled = right_side.is_empty() || norm <= SETTLED.min(NEGLIGIBLE * self.flow_tolerance);
        if !self.settled && self.inverse_pseudo_time == 0.0 {
            self.settled = self.solve_increment(right_side, increment);
        }
        self.settled &= !self.follows_bodies;
    }

    fn dt(&self) -> f64 {
        self.interval.length()
    }

    fn elastic(&self) -> Option<(ElasticSlab<'_, D>, f64)> {
        let MeshMotion::Elastic { mesh, accuracy, .. } = &self.mover.motion else { return None };
        Some((ElasticSlab { mesh, motion: &self.mover.slab_motion, dt: self.dt() }, accuracy.solve))
    }

    /// Sets the velocities.
    pub(crate) fn set(&mut self, v: &[f64], exchange: &mut Exchange) {
        if self.velocities != v {
            self.velocities.copy_from_slice(v);
            self.residual = None;
        }
        exchange.mesh_velocity.clone_from(&self.velocities);
    }

    fn read_walls(&mut self, exchange: &Exchange) {
        if self.wall_displacement != exchange.wall_displacement {
            self.wall_displacement.clone_from(&exchange.wall_displacement);
            self.residual = None;
        }
    }

    /// Solves K w = r_e. Returns true if w is exact: the law is linear and CG converged.
    fn solve_increment(&mut self, r_e: &[f64], w: &mut [f64]) -> bool {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let Some((slab, tolerance)) = self.elastic() else { return true };
        let result = slab.solve(r_e, w, tolerance);
        let exact = result.is_ok() && slab.mesh.law().is_linear();
        self.iterations += result.map_or(0, |reports| reports.iter().map(|r| r.iterations).sum());
        exact
    }

    /// Whether bodies move every node, so that the mesh has no equations.
    pub(crate) fn follows_everywhere(&self) -> bool {
        matches!(self.mover.motion, MeshMotion::Followed)
    }

    /// The velocities that move the mesh from the displacement `bottom` to the displacements `d` at the time nodes.
    fn velocities_that_follow(&self, bottom: &[f64], d: &[f64]) -> Vec<f64> {
        let mut v = d.to_vec();
        self.mover.slab_motion.velocities(self.dt(), bottom, &mut v);
        v
    }

    /// Sets the mesh to where bodies move it.
    fn follow(&mut self, exchange: &mut Exchange) -> Result<(), Inadmissible> {
        let v = self.velocities_that_follow(&self.bottom, &self.wall_displacement);
        if self.velocities == v {
            return Ok(());
        }
        self.set(&v, exchange);
        let checked = self.check();
        if checked.is_err() {
            self.forget();
        }
        checked
    }

    /// The derivative of [`Self::follow`].
    pub(crate) fn follow_along(&self, tangent: &mut Exchange) {
        let still = vec![0.0; self.bottom.len()];
        tangent.mesh_velocity = self.velocities_that_follow(&still, &tangent.wall_displacement);
        tangent.mesh_moves = tangent.mesh_velocity.iter().any(|&v| v != 0.0);
    }

    fn check(&self) -> Result<(), Inadmissible> {
        self.quality().admissible()
    }
}

impl<const D: usize> Block for MeshBlock<D> {
    fn field(&self) -> &'static str {
        "mesh"
    }

    fn couplings(&self) -> Couplings {
        Couplings { reads: &[Quantity::WallDisplacement], writes: &[Quantity::MeshVelocity] }
    }

    fn weights(&self) -> Vec<f64> {
        crate::weights::mesh(&self.mover, self.mover.slab_motion.time().order())
    }

    fn begin_slab(&mut self, interval: Interval, clock: Clock, state: &State) -> Result<(), SlabError> {
        Ok(self.begin(interval, clock, &state.d)?)
    }

    /// A settled mesh keeps its velocities during Newton's method: then the residual is known.
    fn residual(&mut self, v: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible> {
        self.read_walls(exchange);
        if self.follows_everywhere() {
            return self.follow(exchange);
        }
        let Some((slab, _)) = self.elastic() else { return Ok(()) };
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let same = self.velocities == v;
        match &self.residual {
            Some(known) if same => r.copy_from_slice(known),
            _ => {
                slab.residual(&self.bottom, &self.wall_displacement, v, r).map_err(inverted_mesh)?;
                self.set(v, exchange);
                if !same && let Err(invalid) = self.check() {
                    self.forget();
                    return Err(invalid);
                }
                self.residual = Some(r.to_vec());
            }
        }
        Ok(())
    }

    fn linearise(&mut self, v: &[f64], exchange: &mut Exchange, inverse_pseudo_time: f64) {
        if !v.is_empty() {
            self.set(v, exchange);
        } else if self.follows_everywhere() {
            self.read_walls(exchange);
            let v = self.velocities_that_follow(&self.bottom, &self.wall_displacement);
            self.set(&v, exchange);
        }
        self.inverse_pseudo_time = inverse_pseudo_time;
    }

    fn product(&mut self, w: &[f64], tangent: &mut Exchange, out: &mut [f64]) {
        out.fill(0.0);
        if tangent.effect_is_kept {
            return;
        }
        if self.follows_everywhere() {
            return self.follow_along(tangent);
        }
        tangent.mesh_moves = w.iter().any(|&w| w != 0.0);
        let Some((slab, _)) = self.elastic() else { return };
        if tangent.mesh_moves {
            tangent.mesh_velocity.copy_from_slice(w);
            slab.jacobian_product(&self.bottom, &self.velocities, w, out);
        }
        if self.follows_bodies {
            slab.add_prescribed(-1.0, &tangent.wall_displacement, out);
        }
    }

    fn precondition(&mut self, r: &[f64], tangent: &mut Exchange, w: &mut [f64]) {
        w.fill(0.0);
        if tangent.effect_is_kept {
            return;
        }
        tangent.mesh_moves = false;
        if self.follows_everywhere() {
            return self.follow_along(tangent);
        }
        if self.settled || w.is_empty() {
            return;
        }
        // FGMRES is flexible: an increment that has not converged is good enough.
        let mut rest = r.to_vec();
        if self.follows_bodies
            && let Some((slab, _)) = self.elastic()
        {
            slab.add_prescribed(1.0, &tangent.wall_displacement, &mut rest);
        }
        let _ = self.solve_increment(&rest, w);
        tangent.mesh_moves = true;
        tangent.mesh_velocity.copy_from_slice(w);
    }

    /// (1/dtau) diag K on displacement increments.
    fn add_pseudo_time(&mut self, w: &[f64], out: &mut [f64]) {
        let MeshMotion::Elastic { mesh, .. } = &self.mover.motion else { return };
        let (diagonal, collocation) = (mesh.diagonal(), self.mover.slab_motion.time().collocation());
        let (len, dt) = (diagonal.len(), self.dt());
        for (i, out) in out.iter_mut().enumerate() {
            let row = collocation.row(i / len);
            let increment: f64 = row.iter().enumerate().map(|(b, a)| dt * a * w[b * len + i % len]).sum();
            *out += self.inverse_pseudo_time * diagonal[i % len] * increment;
        }
    }

    /// The first of a = 1, 1/2, 1/4, ... for which the bound of det J / det J_0 at V + a dV is more than `KEPT` times that at V.
    fn largest_step(&mut self, v: &[f64], w: &[f64]) -> f64 {
        if w.iter().all(|&w| w == 0.0) {
            return 1.0;
        }
        let bound = |v: &[f64]| self.mover.quality(&self.bottom, v, self.interval).lower_bound;
        let enough = (KEPT * bound(v)).max(0.0);
        first_admissible_step(v, w, MESH_HALVINGS, |trial| bound(trial) > enough)
    }
}

/// An inverted mesh has its own quantity: that of an [`Inversion`] belongs to structures.
fn inverted_mesh(Inversion { cell, volume_ratio: value }: Inversion) -> Inadmissible {
    let location = format!("in cell {cell} at a point of the energy of the mesh");
    Inadmissible { quantity: RELATIVE_DETERMINANT.into(), value, location }
}
