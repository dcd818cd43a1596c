//! The effect of bodies on the flow through a mesh that follows them everywhere. It is linear in their few unknowns, so a few products serve
//! all Krylov directions.

use super::System;
use crate::block::Body;
use newton_krylov::fgmres::Precision;
use newton_krylov::inner_product::InnerProduct;

/// Up to this many unknowns of bodies, products along the mesh that follows them are kept.
const MOST_DIRECTIONS: usize = 12;

/// The effect of the mesh on the flow is that of an earlier Newton step while it is at most this part of the flow's residual: what it lacks is
/// then far less.
const SMALL_EFFECT: f64 = 0.03;

/// Whether the flow keeps the effect of bodies with so many `unknowns` in a slab: the whole mesh follows them, and they are few.
fn keeps_effect(mesh_follows: bool, unknowns: usize) -> bool {
    mesh_follows && unknowns <= MOST_DIRECTIONS
}

/// How Krylov vectors are stored in a system of bodies with so many `unknowns` in a slab. In single precision, like the numbers inside the
/// preconditioner of the flow, where there are none or their effect is kept. Then the mesh's part of the vectors is zero up to
/// round-off, or absent. Otherwise the effect of the mesh that the preconditioner has taken would not be that of the rounded vector.
pub fn krylov_precision(mesh_follows: bool, unknowns: usize) -> Precision {
    if unknowns == 0 || keeps_effect(mesh_follows, unknowns) { Precision::Single } else { Precision::Double }
}

impl<const D: usize, const M: usize> System<D, M> {
    /// Whether the flow keeps the effect of bodies.
    pub(super) fn keeps_effect(&self) -> bool {
        keeps_effect(self.mesh.follows_everywhere(), self.mesh_range().start)
    }

    /// The way of its body per unit of each of their unknowns.
    pub(super) fn travels_of_bodies(&self) -> Vec<f64> {
        let way = |body: &dyn Body, len: usize, k: usize| {
            let mut unit = vec![0.0; len];
            unit[k] = 1.0;
            body.travel(&unit)
        };
        let blocks = self.bodies.iter().zip(&self.ranges);
        blocks.flat_map(|(body, range)| (0..range.len()).map(|k| way(&**body, range.len(), k))).collect()
    }

    /// Moves the walls along the unknowns `x` of bodies. Where the effect on the flow is kept, takes that; unknowns are compared in units of ways.
    pub(super) fn move_along(&mut self, x: &[f64]) {
        if !self.tangent.effect_is_kept {
            return self.move_walls(x);
        }
        let travels: Vec<f64> = x.iter().zip(&self.travel_per_unit).map(|(x, travel)| x * travel).collect();
        while let Some(q) = self.flow.take_effect(&travels) {
            let direction: Vec<f64> = q.iter().zip(&self.travel_per_unit).map(|(q, travel)| q / travel).collect();
            self.move_walls(&direction);
            self.mesh.follow_along(&mut self.tangent);
            self.flow.learn_effect(q, &self.tangent);
        }
        self.tangent.mesh_moves = x.iter().any(|&x| x != 0.0);
    }

    /// The derivative of the displacement of walls along the unknowns `x` of bodies.
    fn move_walls(&mut self, x: &[f64]) {
        if !self.bodies.is_empty() {
            self.tangent.wall_displacement.fill(0.0);
        }
        for (body, range) in self.bodies.iter_mut().zip(&self.ranges) {
            body.move_walls(&x[range.clone()], &mut self.tangent.wall_displacement);
        }
    }

    /// Whether the effect of the mesh is that of an earlier point of linearisation, and too large for that. The first residual after a
    /// linearisation decides.
    pub(super) fn must_take_effect_anew(&mut self, r: &[f64]) -> bool {
        let range = self.flow_range();
        let Some(effect) = self.flow.unjudged_effect() else { return false };
        let mut full = vec![0.0; r.len()];
        full[range.clone()].copy_from_slice(effect);
        let norm = |x: &[f64]| self.weights.norm_on(range.clone(), x);
        let is_small = norm(&full) <= SMALL_EFFECT * norm(r);
        self.flow.judge_effect(is_small)
    }
}
