//! The residual that rounding alone causes.
//!
//! ```text
//! R_computed(u) = R(u + e),   |e_i| <= eps |u_i|,     |R_rounding| ~ | dR/du e |                                  (rounding)
//! ```
//!
//! Rounding inside the fluxes acts like a random change of every entry of the state in its last digit. One product along such a change
//! estimates the residual of a converged flow. The difference of two residuals, which is taken too, also contains what the fluxes themselves round: a
//! viscosity that is a ratio of small sums rounds more than its derivatives tell. The estimate is the larger of the
//! two. For bodies the last digits of positions are changed as well, because stiff springs amplify them and light bodies respond to rounded loads. The digits are the same in every run. Thin cells, long slabs and low Mach numbers enlarge
//! the estimate as they enlarge the derivatives.

use super::System;
use newton_krylov::inner_product::axpy;
use newton_krylov::problem::NonlinearProblem;

/// The factor between the estimate and one random change of the last digit: a residual adds up many roundings per entry.
const SAFETY: f64 = 4.0;

impl<const D: usize, const M: usize> System<D, M> {
    /// (rounding) of each field at `z`, which becomes the point of linearisation. It is zero for the mesh where no body moves it: its equations
    /// are well scaled, and the round-off that the Newton driver allows suffices.
    pub(super) fn rounding(&mut self, z: &[f64]) -> Vec<f64> {
        let change = self.last_digits(z);
        let computed = self.difference(z, &change);
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        self.set_point(z);
        let mut effect = vec![0.0; z.len()];
        self.jacobian_product(&change, &mut effect);
        let norms: Vec<f64> = self.field_norms(&effect).into_iter().zip(computed).map(|(a, b)| a.max(b)).collect();
        // The flow is the last field.
        let residual_flow = norms.last().copied();
        tracing::debug!(residual_flow, "round-off of the residual, estimated");
        norms
    }

    /// The norm of each field of R(z + e) - R(z); zero where one of them is not defined.
    fn difference(&mut self, z: &[f64], e: &[f64]) -> Vec<f64> {
        let (mut changed, mut here, mut there) = (z.to_vec(), vec![0.0; z.len()], vec![0.0; z.len()]);
        axpy(1.0, e, &mut changed);
        if self.residual(z, &mut here).is_err() || self.residual(&changed, &mut there).is_err() {
            return vec![0.0; self.fields.len()];
        }
        axpy(-1.0, &here, &mut there);
        self.field_norms(&there)
    }

    /// e of (rounding).
    fn last_digits(&self, z: &[f64]) -> Vec<f64> {
        let mut change = vec![0.0; z.len()];
        for (number, body) in self.bodies.iter().enumerate() {
            let range = self.body_range(number);
            let digits = body.last_digits(&z[range.clone()]);
            (0..)
                .zip(digits)
                .zip(&mut change[range])
                .for_each(|((i, digit), change)| *change = SAFETY * digit * noise(i));
        }
        let range = self.flow_range();
        let (share, cell_len) = (&self.flow.operator.share, self.flow.operator.layout.cell_len());
        for (i, (u, change)) in z[range.clone()].iter().zip(&mut change[range]).enumerate() {
            let in_whole = (share.own[i / cell_len] * cell_len + i % cell_len) as u64;
            *change = SAFETY * f64::EPSILON * u * noise(in_whole);
        }
        change
    }
}

/// A number in [-1, 1) that looks random: splitmix64 of i (Steele, Lea & Flood, OOPSLA 2014).
fn noise(i: u64) -> f64 {
    let mut x = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as i64 as f64 / 2.0_f64.powi(63)
}
