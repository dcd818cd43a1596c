//! The balances of a slab: mass, momentum and energy that it creates, and the correction that removes them.
//!
//! The test functions of the residual sum to one in space and in time. The sum of the residual over all of them is the error of the
//! balance of component m,
//!
//! ```text
//! S_m = sum_i R_mi = int u_m |_top - int u_m |_bottom + int dt (flux of m through the boundary) - int dt int source_m      (balance)
//! ```
//!
//! Newton's method stops at its tolerance and leaves an S of that size. The correction adds a few smooth modes to the flow, the same at
//! all times of the slab. Their size is that of the error which the tolerance allows anyway.
//!
//! ```text
//! u := u + sum_j c_j e_j   with   S(u) = 0,     e_0 = u,     e_j = density in component j > 0                          (correction)
//! ```
//!
//! The modes scale the density at constant velocity and temperature, shift the velocity, and shift the energy per mass. M numbers are
//! unknown. S follows from what the slab holds at its top and from the flux through the boundary: no cell is evaluated.

use crate::system::System;
use basis::Matrix;
use fem::{FluxesAt, Layout, SlabOperator, left_during_slab};
use newton_krylov::inner_product;
use std::array::from_fn;

/// S is corrected where it exceeds this part of what the slab holds.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Corrections at most.
const CORRECTIONS: usize = 6;

/// A correction that leaves more than this part of S asks for a better Jacobian.
const SLOW: f64 = 0.1;

/// The relative size of a probe, for differences of boundary fluxes.
const PROBE: f64 = 1e-6;

/// What a slab holds at its top, and what passes its boundary.
pub struct Balance<const M: usize> {
    /// The integral of every component at the top.
    pub totals: Vec<f64>,
    /// What leaves at the quadrature points in time and at the top.
    pub fluxes: Vec<FluxesAt<M>>,
}

impl<const M: usize> Balance<M> {
    /// The balance of `z`, which becomes the point of linearisation.
    fn of<const D: usize>(system: &mut System<D, M>, z: &[f64], velocity_at_top: &[f64]) -> Self {
        system.set_point(z);
        let totals = system.flow.totals(&at_top(system.flow.operator.layout, &z[system.flow_range()]));
        Balance { totals, fluxes: system.flow.operator.boundary_fluxes(Some(velocity_at_top)) }
    }

    /// What is at the top and what has left.
    fn sum(&self) -> [f64; M] {
        let left = left_during_slab(&self.fluxes);
        from_fn(|m| self.totals[m] + left[m])
    }

    /// What S is compared with: mass, energy, and for momentum their geometric mean, about mass times the speed of sound.
    fn sizes(&self) -> [f64; M] {
        let (mass, energy) = (self.totals[0].abs(), self.totals[M - 1].abs());
        from_fn(|m| match m {
            0 => mass,
            _ if m == M - 1 => energy,
            _ => (mass * energy).sqrt(),
        })
    }

    /// dS_m / dc_j as far as the top is concerned.
    fn storage(&self) -> Matrix {
        let mass = self.totals[0];
        Matrix::from_fn(M, M, |m, j| {
            if j == 0 {
                self.totals[m]
            } else if m == j {
                mass
            } else {
                0.0
            }
        })
    }
}

/// A solution whose balance is not exact.
struct Unbalanced<'a, const D: usize, const M: usize> {
    system: &'a mut System<D, M>,
    z: &'a mut [f64],
    balance: Balance<M>,
    /// S
    error: [f64; M],
    sizes: [f64; M],
    velocity_at_top: &'a [f64],
}

/// Applies (correction) to the flow of `z`, a solution whose residual is given. Returns the balance of the result; `z` is then the point
/// of linearisation. Walls have `velocity_at_top`, see [`fem::SlabOperator::boundary_fluxes`].
pub fn correct<const D: usize, const M: usize>(
    system: &mut System<D, M>,
    z: &mut [f64],
    residual: &[f64],
    velocity_at_top: &[f64],
) -> Balance<M> {
    let error = sums(&system.flow.operator, &residual[system.flow_range()]);
    let balance = Balance::of(system, z, velocity_at_top);
    let sizes = balance.sizes();
    let mut solution = Unbalanced { system, z, balance, error, sizes, velocity_at_top };
    solution.correct();
    solution.balance
}

impl<const D: usize, const M: usize> Unbalanced<'_, D, M> {
    /// Newton's method for (correction). Where little passes the boundary its Jacobian is that of the storage; else fluxes are probed.
    fn correct(&mut self) {
        let (mut inverse, mut probed) = (self.balance.storage().inverse(), false);
        for _ in 0..CORRECTIONS {
            if self.worst(&self.error) <= ROUND_OFF {
                return;
            }
            let Some(jacobian) = &inverse else { return };
            let left = self.step(jacobian);
            if left <= SLOW {
                continue;
            }
            if probed {
                return;
            }
            (inverse, probed) = (self.jacobian().inverse(), true);
        }
    }

    /// The largest part of S, relative to its size.
    fn worst(&self, error: &[f64; M]) -> f64 {
        (0..M)
            .map(|m| error[m].abs() / self.sizes[m])
            .fold(0.0, |worst, part| if part > worst || part.is_nan() { part } else { worst })
    }

    /// One step with the given inverse of dS / dc. Returns the part of S that is left; the step is taken if that is less than one.
    fn step(&mut self, inverse: &Matrix) -> f64 {
        let (mut c, mut corrected) = ([0.0; M], self.z.to_vec());
        inverse.apply(&self.error, &mut c);
        (0..M).for_each(|j| self.add_mode(j, -c[j], &mut corrected));
        let after = Balance::of(self.system, &corrected, self.velocity_at_top);
        let (new, old) = (after.sum(), self.balance.sum());
        let error = from_fn(|m| self.error[m] + (new[m] - old[m]));
        let left = self.worst(&error) / self.worst(&self.error);
        if left < 1.0 {
            self.z.copy_from_slice(&corrected);
            (self.balance, self.error) = (after, error);
        } else {
            self.system.set_point(self.z);
        }
        left
    }

    /// dS_m / dc_j: that of the storage exactly, that of the boundary fluxes by differences.
    fn jacobian(&mut self) -> Matrix {
        let (storage, here) = (self.balance.storage(), left_during_slab(&self.balance.fluxes));
        let columns: [[f64; M]; M] = from_fn(|j| {
            let step = if j == 0 { PROBE } else { PROBE * self.sizes[j] / self.sizes[0] };
            let mut probe = self.z.to_vec();
            self.add_mode(j, step, &mut probe);
            self.system.set_point(&probe);
            let there = left_during_slab(&self.system.flow.operator.boundary_fluxes(None));
            from_fn(|m| storage[(m, j)] + (there[m] - here[m]) / step)
        });
        self.system.set_point(self.z);
        Matrix::from_fn(M, M, |m, j| columns[j][m])
    }

    /// out += c e_j, with e_j taken at z.
    fn add_mode(&self, j: usize, c: f64, out: &mut [f64]) {
        let (range, nodes) = (self.system.flow_range(), self.system.flow.operator.layout.nodes);
        let states = out[range.clone()].chunks_exact_mut(M * nodes).zip(self.z[range].chunks_exact(M * nodes));
        for (out, u) in states {
            let (out, mode) = if j == 0 { (out, u) } else { (&mut out[j * nodes..(j + 1) * nodes], &u[..nodes]) };
            out.iter_mut().zip(mode).for_each(|(out, mode)| *out += c * mode);
        }
    }
}

/// The state at the top of the slab in which the flow is `u`, laid out at one time.
pub fn at_top(layout: Layout, u: &[f64]) -> Vec<f64> {
    let mut top = Vec::with_capacity(layout.at_one_time().len());
    (0..layout.cells).for_each(|cell| top.extend_from_slice(&u[layout.cell_at(cell, layout.time_order - 1)]));
    top
}

/// S: the sums of the flow's residual by component, in the order of its entries.
fn sums<const D: usize, const M: usize>(flow: &SlabOperator<D, M>, residual: &[f64]) -> [f64; M] {
    let rows = |m: usize| residual.chunks_exact(flow.layout.nodes).skip(m).step_by(M);
    let of_rows = |m: usize| rows(m).map(|r| r.iter().sum()).collect::<Vec<f64>>();
    std::array::from_fn(|m| inner_product::sum_over_blocks(&of_rows(m), &flow.share.ends, &flow.share.sums))
}
