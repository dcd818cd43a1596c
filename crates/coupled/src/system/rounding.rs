//! The residual that rounding alone causes.
//!
//! ```text
//! R_computed(u) = R(u + e),   |e_i| <= eps |u_i|,     |R_rounding| ~ | dR/du e |                                  (rounding)
//! ```
//!
//! Rounding inside the fluxes acts like a random change of every entry of the state in its last digit. One product along such a change
//! estimates the residual of a converged flow. The digits are the same in every run. Thin cells, long slabs and low Mach numbers enlarge
//! the estimate as they enlarge the derivatives.

use super::System;

/// The factor between the estimate and one random change of the last digit: a residual adds up many roundings per entry.
const SAFETY: f64 = 4.0;

impl<const D: usize, const M: usize> System<D, M> {
    /// (rounding) of each field at `z`, which becomes the point of linearisation. It is zero for the mesh: its equations are well scaled,
    /// and the round-off that the Newton driver allows suffices.
    pub(super) fn rounding(&mut self, z: &[f64]) -> Vec<f64> {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        self.set_point(z);
        let range = self.flow_range();
        let (share, cell_len) = (&self.flow.operator.share, self.flow.operator.layout.cell_len());
        let in_whole = |i: usize| (share.own[i / cell_len] * cell_len + i % cell_len) as u64;
        let change: Vec<f64> =
            z[range.clone()].iter().enumerate().map(|(i, u)| SAFETY * f64::EPSILON * u * noise(in_whole(i))).collect();
        let mut effect = vec![0.0; z.len()];
        self.flow.counts.products += 1;
        self.flow.operator.product(&change, &mut effect[range]);
        let norms = self.field_norms(&effect);
        // The flow is the last field; the other parts of `effect` are zero.
        let residual_flow = norms.last().copied();
        tracing::debug!(residual_flow, "round-off of the residual, estimated");
        norms
    }
}

/// A number in [-1, 1) that looks random: splitmix64 of i (Steele, Lea & Flood, OOPSLA 2014).
fn noise(i: u64) -> f64 {
    let mut x = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as i64 as f64 / 2.0_f64.powi(63)
}
