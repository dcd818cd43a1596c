//! Whether the mesh resolves a flow, by its highest modes.
//!
//! ```text
//! s = max_K ( mean_K sum_m ((u_m - P u_m) / s_m)^2 )^{1/2}                                                     (highest modes)
//! ```
//!
//! P removes the Legendre polynomials of the highest degree in any coordinate of the reference cell. s_m is the mean of u_m in the cell, or
//! its scale by [`fem::ConservationLaw::scales`] if that is larger. At a low Mach number the scales of density and energy are those of sound.
//! The polynomials of a smooth flow converge, so that s is small. A slab of an unresolved flow that cannot be solved often has no admissible
//! solution: then shorter slabs do not help.

use basis::{Matrix, gauss_lobatto};
use fem::SlabOperator;
use fem::parallel::{self, Grain};
use newton_krylov::inner_product;
use std::array::from_fn;

/// Flows with a larger s are not resolved. The vortex of the paper has 0.002 at order 4. Of the sudden starts of `scripts/starts.py` the passage at
/// Re = 4e4 has 0.147 where a slab fails; a cylinder at Re = 1e5 with the default wall flux has 0.177. Flows whose slabs are solved have up to 0.39.
const RESOLVED: f64 = 0.1;

/// The lowest order at which s tells anything: at order 2 every slope is a highest mode.
const LOWEST_ORDER: usize = 3;

/// Whether the mesh does not resolve the flow `u` at one time.
pub(crate) fn is_unresolved<const D: usize, const M: usize>(flow: &SlabOperator<D, M>, u: &[f64]) -> bool {
    if flow.tables.orders.flow < LOWEST_ORDER {
        return false;
    }
    let highest_modes = highest_modes(flow, u);
    tracing::debug!(highest_modes, "resolution at the bottom of the slab");
    highest_modes > RESOLVED
}

/// (highest modes) of the flow `u` at one time, on all ranks.
fn highest_modes<const D: usize, const M: usize>(flow: &SlabOperator<D, M>, u: &[f64]) -> f64 {
    let (one, scales) = (flow.layout.at_one_time(), flow.problem.kernels.scales());
    let projection = without_highest_mode(flow.tables.orders.flow);
    let weights = mean_weights::<D>(flow.tables.orders.flow);
    let of_cell = |cell: usize| {
        let of_component = |m: usize| {
            let u = &u[one.component_at(cell, 0, m)];
            mean_square(&projection, &weights, u) / scales[m].max(mean(&weights, u).abs()).powi(2)
        };
        inner_product::sum(&from_fn::<_, M, _>(of_component))
    };
    inner_product::largest_size(&parallel::map(one.cells, Grain::Any, &of_cell), &flow.share.sums).sqrt()
}

/// The mean of u over the reference cell.
fn mean(weights: &[f64], u: &[f64]) -> f64 {
    inner_product::sum(&weights.iter().zip(u).map(|(w, u)| w * u).collect::<Vec<_>>())
}

/// The mean of (u - P u)^2 over the reference cell.
fn mean_square(projection: &Matrix, weights: &[f64], u: &[f64]) -> f64 {
    let mut projected = u.to_vec();
    let order = projection.rows();
    let (mut line, mut result) = (vec![0.0; order], vec![0.0; order]);
    let mut stride = 1;
    while stride < u.len() {
        for start in (0..u.len()).filter(|i| i / stride % order == 0) {
            line.iter_mut().enumerate().for_each(|(k, value)| *value = projected[start + k * stride]);
            projection.apply(&line, &mut result);
            result.iter().enumerate().for_each(|(k, value)| projected[start + k * stride] = *value);
        }
        stride *= order;
    }
    let squares = u.iter().zip(&projected).map(|(u, low)| (u - low).powi(2));
    mean(weights, &squares.collect::<Vec<_>>())
}

/// P along one axis, for values at the Gauss-Lobatto nodes: the nodes are extrema of the highest Legendre polynomial L, which has alternating
/// signs there, and w_i = 2 / (N (N - 1) L(x_i)^2), see [`gauss_lobatto`]. So the entries of L (L, .) / (L, L) are +-(w_j / w_i)^{1/2} / N.
fn without_highest_mode(order: usize) -> Matrix {
    let weights = gauss_lobatto(order).weights;
    let highest = |i: usize, j: usize| {
        let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * (weights[j] / weights[i]).sqrt() / order as f64
    };
    Matrix::from_fn(order, order, |i, j| if i == j { 1.0 - highest(i, i) } else { -highest(i, j) })
}

/// The weights of the nodes for the mean over the reference cell.
fn mean_weights<const D: usize>(order: usize) -> Vec<f64> {
    let weights = gauss_lobatto(order).weights;
    let along = |i: usize, axis: usize| 0.5 * weights[i / order.pow(axis as u32) % order];
    (0..order.pow(D as u32)).map(|i| (0..D).map(|axis| along(i, axis)).product()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square of the highest Legendre polynomial has the mean 1 / (N - 1) by the rule of the nodes.
    #[test]
    fn the_highest_modes_are_what_is_left() {
        for order in 3..8 {
            let (projection, weights) = (without_highest_mode(order), mean_weights::<2>(order));
            let nodes = gauss_lobatto(order).points;
            let values = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
                (0..order * order).map(|i| f(nodes[i % order], nodes[i / order])).collect()
            };
            let degree = order as i32 - 1;
            let lower = values(&|x, y| 2.0 + x.powi(degree - 1) * y.powi(degree - 1) - 3.0 * y);
            assert!(mean_square(&projection, &weights, &lower) < 1e-28);
            // The highest mode of x^(N-1) is L 2^(N-1) (N-1)!^2 / (2N-2)!.
            let factor: f64 = (1..order).map(|k| 2.0 * k as f64 / (order - 1 + k) as f64).product();
            let expected = factor * factor / (order - 1) as f64;
            for highest in [values(&|x, _| x.powi(degree)), values(&|x, y| x + y.powi(degree))] {
                let found = mean_square(&projection, &weights, &highest);
                assert!((found / expected - 1.0).abs() < 1e-12, "{order}: {found} and {expected}");
            }
        }
    }
}
