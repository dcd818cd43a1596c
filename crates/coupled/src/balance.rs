//! Balances of a slab: what it makes of mass, momentum and energy out of nothing, and how that is put right.
//!
//! The test functions of the residual sum to one in space and in time. Its sum over all of them is the error of the balance,
//!
//! ```text
//! (balance)    S_m = sum_i R_mi = int u_m |_top - int u_m |_bottom + int ( flux_m through the boundary ) dt - int int source_m
//! ```
//!
//! and Newton's method leaves it as large as its tolerance allows. What it leaves is removed here: the flow changes along a few smooth
//! modes, the same at all times of the slab, by no more than the error that the tolerance allows it anyway.
//!
//! ```text
//! (shift)      u := u + sum_j c_j e_j ,     e_0 = u ,     e_j = the constant 1 in component j ,     S(u) = 0
//! ```
//!
//! The first mode changes density alone: velocities and temperatures stay, at walls too. M numbers are sought, and S is known from what
//! the slab holds at its top and what passes the boundary: no cell is evaluated.

use crate::slab_problem::SlabProblem;
use basis::Matrix;
use fem::{FluxesAt, Layout, left_during_slab};
use std::array::from_fn;

/// S is put right where it exceeds this part of what the slab holds.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// The part of its unit by which a mode is changed to see what it changes.
const PROBE: f64 = 1e-6;

/// Shifts at most.
const SHIFTS: usize = 3;

/// What the slab holds at its top, and what has passed its boundary.
pub struct Balance<const M: usize> {
    /// The integral of every component at the top.
    pub totals: Vec<f64>,
    /// What leaves at the quadrature points in time and at the top.
    pub fluxes: Vec<FluxesAt<M>>,
}

impl<const M: usize> Balance<M> {
    /// Of `z`, which becomes the point of linearisation.
    pub fn of<const D: usize>(problem: &mut SlabProblem<D, M>, z: &[f64]) -> Self {
        problem.set_point(z);
        let totals = problem.totals(&at_top(problem.flow.layout, &z[problem.flow_range()]));
        Balance { totals, fluxes: problem.flow.boundary_fluxes() }
    }

    /// What is at the top and what has left.
    fn sum(&self) -> [f64; M] {
        let left = left_during_slab(&self.fluxes);
        from_fn(|m| self.totals[m] + left[m])
    }
}

/// Changes the flow of `z`, a solution with the given residual, by (shift), and returns the balance of the result. The flow stays as it
/// is where the shift does not make S smaller.
pub fn put_right<const D: usize, const M: usize>(
    problem: &mut SlabProblem<D, M>,
    z: &mut [f64],
    residual: &[f64],
) -> Balance<M> {
    let mut balance = Balance::of(problem, z);
    let mut error = sums::<D, M>(problem, residual);
    let size = sizes(&balance.totals);
    let worst = |error: &[f64; M]| (0..M).map(|m| error[m].abs() / size[m]).fold(0.0, f64::max);
    if worst(&error) <= ROUND_OFF {
        return balance;
    }
    let Some(inverse) = response(problem, z, &balance).inverse() else {
        problem.set_point(z);
        return balance;
    };
    for _ in 0..SHIFTS {
        let mut shift = [0.0; M];
        inverse.apply(&error, &mut shift);
        let mut shifted = z.to_vec();
        let range = problem.flow_range();
        (0..M).for_each(|j| add_mode(problem, j, -shift[j], &z[range.clone()], &mut shifted[range.clone()]));
        let after = Balance::of(problem, &shifted);
        let (new, old) = (after.sum(), balance.sum());
        let left = from_fn(|m| error[m] + (new[m] - old[m]));
        if !(worst(&left) < worst(&error)) {
            problem.set_point(z);
            break;
        }
        z.copy_from_slice(&shifted);
        (balance, error) = (after, left);
        if worst(&error) <= ROUND_OFF {
            break;
        }
    }
    balance
}

/// The state at the top of the slab in which the flow is `u`, laid out at one time.
pub fn at_top(layout: Layout, u: &[f64]) -> Vec<f64> {
    (0..layout.cells).flat_map(|cell| u[layout.cell_at(cell, layout.time_order - 1)].iter().copied()).collect()
}

/// S, the sums of the flow's residual by component.
fn sums<const D: usize, const M: usize>(problem: &SlabProblem<D, M>, residual: &[f64]) -> [f64; M] {
    let (layout, mut sums) = (problem.flow.layout, [0.0; M]);
    for (row, r) in residual[problem.flow_range()].chunks_exact(layout.nodes).enumerate() {
        sums[row % M] += r.iter().sum::<f64>();
    }
    sums
}

/// The size of what is balanced: mass and energy, and for momentum their geometric mean, a mass at about the speed of sound.
fn sizes(totals: &[f64]) -> Vec<f64> {
    let (mass, energy) = (totals[0].abs(), totals[totals.len() - 1].abs());
    let mut sizes = vec![(mass * energy).sqrt(); totals.len()];
    (sizes[0], sizes[totals.len() - 1]) = (mass, energy);
    sizes
}

/// dS_m / dc_j, by differences.
fn response<const D: usize, const M: usize>(problem: &mut SlabProblem<D, M>, z: &[f64], here: &Balance<M>) -> Matrix {
    let (range, scales, here) = (problem.flow_range(), problem.flow.problem.kernels.scales(), here.sum());
    let columns: [[f64; M]; M] = from_fn(|j| {
        let step = if j == 0 { PROBE } else { PROBE * scales[j] };
        let mut probe = z.to_vec();
        add_mode(problem, j, step, &z[range.clone()], &mut probe[range.clone()]);
        let there = Balance::of(problem, &probe).sum();
        from_fn(|m| (there[m] - here[m]) / step)
    });
    Matrix::from_fn(M, M, |m, j| columns[j][m])
}

/// out += c e_j at the flow `u`.
fn add_mode<const D: usize, const M: usize>(problem: &SlabProblem<D, M>, j: usize, c: f64, u: &[f64], out: &mut [f64]) {
    let nodes = problem.flow.layout.nodes;
    for (row, (out, u)) in out.chunks_exact_mut(nodes).zip(u.chunks_exact(nodes)).enumerate() {
        match j {
            0 => out.iter_mut().zip(u).for_each(|(out, u)| *out += c * u),
            _ if row % M == j => out.iter_mut().for_each(|out| *out += c),
            _ => {}
        }
    }
}
