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
//! all times of the slab. They are no larger than the error that the tolerance allows.
//!
//! ```text
//! u := u + sum_j c_j e_j   with   S(u) = 0,     e_0 = u,     e_j = density in component j > 0                          (correction)
//! ```
//!
//! The modes scale the density at constant velocity and temperature, shift the velocity, and shift the energy per mass. The unknowns are
//! the M numbers c_j. S follows from the integrals at the top and from the flux through the boundary: no cell is evaluated.

use crate::system::System;
use basis::Matrix;
use fem::{FluxesAt, Layout, SlabOperator, left_during_slab};
use navier_stokes::Conserved;
use newton_krylov::inner_product;
use std::array::from_fn;
use std::ops::Range;

/// S is corrected where it exceeds this part of what the slab holds.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Corrections at most.
const CORRECTIONS: usize = 6;

/// After a correction that leaves more than this part of S, the Jacobian is probed.
const SLOW: f64 = 0.1;

/// The relative size of a probe, for differences of boundary fluxes.
const PROBE: f64 = 1e-6;

/// The integrals of a flow at the top of a slab, and its fluxes through the boundary.
pub struct Balance<const M: usize> {
    /// The integral of every component at the top.
    pub totals: Vec<f64>,
    /// The fluxes through the boundary at the quadrature points in time and at the top, positive outwards.
    pub fluxes: Vec<FluxesAt<M>>,
}

impl<const M: usize> Balance<M> {
    /// The balance of `z`, which becomes the point of linearisation.
    fn of<const D: usize>(system: &mut System<D, M>, z: &[f64], velocity_at_top: &[f64]) -> Self {
        system.set_point(z);
        let totals = system.flow.totals(&at_top(system.flow.operator.layout, &z[system.flow_range()]));
        Balance { totals, fluxes: system.flow.operator.boundary_fluxes(Some(velocity_at_top)) }
    }

    /// The integrals at the top plus what has left during the slab.
    fn sum(&self) -> [f64; M] {
        let left = left_during_slab(&self.fluxes);
        from_fn(|m| self.totals[m] + left[m])
    }

    /// The sizes that S is compared with: mass, energy, and for momentum their geometric mean, about mass times the speed of sound.
    fn sizes<const D: usize>(&self) -> [f64; M] {
        let totals = Conserved::<f64, D>::unpack::<M>(&from_fn(|m| self.totals[m].abs()));
        Conserved { momentum: [(totals.density * totals.energy).sqrt(); D], ..totals }.pack()
    }

    /// The part of dS_m / dc_j that comes from the integrals at the top.
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
    let sizes = balance.sizes::<D>();
    let mut solution = Unbalanced { system, z, balance, error, sizes, velocity_at_top };
    solution.correct();
    solution.balance
}

impl<const D: usize, const M: usize> Unbalanced<'_, D, M> {
    /// Newton's method for (correction). It begins with the Jacobian of the storage. If that leaves too much, boundary fluxes are probed
    /// too.
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

    /// One step with the given inverse of dS / dc. Returns the part of S that is left. A step that leaves all of S, or more, is undone.
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

    /// dS_m / dc_j: exact for the storage, by differences for the boundary fluxes.
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
        let (range, layout) = (self.system.flow_range(), self.system.flow.operator.layout);
        let (out, u) = (&mut out[range.clone()], &self.z[range]);
        for (cell, a) in layout.cells_and_times() {
            let (of_out, of_u) = if j == 0 {
                (layout.cell_at(cell, a), layout.cell_at(cell, a))
            } else {
                (layout.component_at(cell, a, j), layout.component_at(cell, a, 0))
            };
            out[of_out].iter_mut().zip(&u[of_u]).for_each(|(out, mode)| *out += c * mode);
        }
    }
}

/// The state at the top of the slab in which the flow is `u`, laid out at one time.
pub fn at_top(layout: Layout, u: &[f64]) -> Vec<f64> {
    let mut top = vec![0.0; layout.at_one_time().len()];
    copy_top(layout, u, &mut top);
    top
}

/// The same into the memory of an earlier one.
pub fn copy_top(layout: Layout, u: &[f64], top: &mut [f64]) {
    for (cell, top) in top.chunks_exact_mut(layout.time_len()).enumerate() {
        top.copy_from_slice(&u[layout.cell_at(cell, layout.time_order - 1)]);
    }
}

/// S: the sums of the flow's residual over the rows of each component.
fn sums<const D: usize, const M: usize>(flow: &SlabOperator<D, M>, residual: &[f64]) -> [f64; M] {
    let of_row = |row: Range<usize>| residual[row].iter().sum::<f64>();
    let of_rows = |m: usize| flow.layout.component(m).map(of_row).collect::<Vec<f64>>();
    from_fn(|m| inner_product::sum_over_blocks(&of_rows(m), &flow.share.ends, &flow.share.sums))
}
