//! Proved validity of moving cells: lower bounds of det J over a cell and a slab.
//!
//! With positions of degree N - 1 per direction in space and N_t in time, det J(xi, s) is a polynomial:
//!
//! ```text
//! degree in xi_a = D (N-1) - 1  (column a of J has one degree less),    degree in s = D N_t              (degrees)
//! ```
//!
//! It is interpolated on a grid that determines it. The Bernstein coefficients of the interpolant bound it from both
//! sides everywhere, not only at points. If the bound is not sharp enough to decide, the box in space and time is
//! bisected. Given positions are taken as exact; the rounding of all later operations is part of the bound.
//!
//! With a reference cell the ratio det J / det J_0 is treated in the same way: if f has the coefficients b_i, and g the
//! coefficients c_i > 0, then f >= min_i (b_i / c_i) g.

mod bernstein;
mod motion;
mod search;
mod sweep;
#[cfg(test)]
mod tests;

use crate::geometry::inverted;
use crate::lattice::Lattice;
use crate::parallel::{self, Grain};
use crate::{CellMap, Mesh, MeshError};
use basis::{Lagrange, Matrix};
use bernstein::{Direction, Polynomial};
pub use motion::MotionCheck;
use rayon::prelude::*;
use search::Search;
use tensor::{det, norm};

/// A proved bound is sharp enough if it reaches this fraction of the smallest sampled value.
const SHARPNESS: f64 = 0.5;

/// A point of a cell and a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabPoint<const D: usize> {
    /// The reference point, in [-1, 1]^D.
    pub xi: [f64; D],
    /// The time in the slab, in [0, 1].
    pub s: f64,
}

/// Bounds of det J, or of det J / det J_0, of one cell in one slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<const D: usize> {
    /// The proved lower bound.
    pub lower: f64,
    /// The smallest sampled value.
    pub sampled_min: f64,
    /// The largest sampled value.
    pub sampled_max: f64,
    /// The place of the smallest sampled value.
    pub at: SlabPoint<D>,
}

impl<const D: usize> Bound<D> {
    /// No information.
    const UNKNOWN: Bound<D> = Bound {
        lower: f64::NEG_INFINITY,
        sampled_min: f64::INFINITY,
        sampled_max: f64::NEG_INFINITY,
        at: SlabPoint { xi: [0.0; D], s: 0.0 },
    };

    /// The scaled Jacobian, min / max over the cell and the slab, as sampled: 1 for a parallelepiped at rest, negative
    /// if inverted.
    pub fn scaled_jacobian(&self) -> f64 {
        self.sampled_min / self.sampled_max
    }
}

/// The answer to "is det J > 0 everywhere in the cell and the slab?".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Validity<const D: usize> {
    /// Yes: [`Bound::lower`] > 0.
    Valid(Bound<D>),
    /// No: [`Bound::sampled_min`] <= 0 at [`Bound::at`].
    Invalid(Bound<D>),
    /// The smallest value is so close to zero that the permitted bisections did not decide its sign.
    Undecided(Bound<D>),
}

impl<const D: usize> Validity<D> {
    /// The bound, for any answer.
    pub fn bound(&self) -> &Bound<D> {
        match self {
            Validity::Valid(bound) | Validity::Invalid(bound) | Validity::Undecided(bound) => bound,
        }
    }
    /// Whether the cell is proved to be valid.
    pub fn is_valid(&self) -> bool {
        matches!(self, Validity::Valid(_))
    }
}

/// Proves bounds for cells of one order that move through given times.
#[derive(Clone, Debug)]
pub struct ValidityCheck<const D: usize> {
    order: usize,
    n_times: usize,
    map: CellMap<D>,
    /// Interpolation in time from the time nodes to the points of the last direction.
    time_values: Matrix,
    /// D directions of space, then time.
    directions: Vec<Direction>,
}

impl<const D: usize> ValidityCheck<D> {
    /// For positions at the Gauss-Lobatto nodes of order `order` and at the distinct times `times` in [0, 1]. The
    /// positions are the interpolating polynomial in time; a single time means cells at rest.
    ///
    /// # Panics
    /// If `order` is less than 2 or there is no time.
    pub fn new(order: usize, times: &[f64]) -> Self {
        // (degrees)
        let space = Direction::new(D * (order - 1) - 1);
        let time = Direction::new(D * (times.len() - 1));
        let s: Vec<f64> = time.points.iter().map(|x| 0.5 + 0.5 * x).collect();
        ValidityCheck {
            order,
            n_times: times.len(),
            map: CellMap::on_grid(order, &space.points),
            time_values: Lagrange::new(times.to_vec()).value_matrix(&s),
            directions: std::iter::repeat_n(space, D).chain([time]).collect(),
        }
    }

    /// The length of the positions of one cell, `[time][node][D]`.
    pub fn positions_length(&self) -> usize {
        self.n_times * self.order.pow(D as u32) * D
    }

    /// The bound of det J without any bisection.
    pub fn bound(&self, positions: &[f64]) -> Bound<D> {
        self.search(positions, None).bound()
    }

    /// Bisects until the sign of det J is decided, and until the bound is at least half of the smallest sampled value.
    pub fn decide(&self, positions: &[f64]) -> Validity<D> {
        self.search(positions, None).decide(&self.directions, f64::INFINITY)
    }

    /// [`Self::decide`] for cells 0..n_cells on all threads; `positions(cell, x)` fills the array x, `[time][node][D]`.
    pub fn decide_cells(&self, n_cells: usize, positions: impl Fn(usize, &mut [f64]) + Sync) -> Vec<Validity<D>> {
        let buffer = || vec![0.0; self.positions_length()];
        let answer = |x: &mut Vec<f64>, cell| {
            positions(cell, x);
            self.decide(x)
        };
        (0..n_cells).into_par_iter().map_init(buffer, answer).collect()
    }

    /// The search for the smallest det J; with a `reference`, the positions `[node][D]` of the cell with det J_0 > 0, for that of
    /// det J / det J_0.
    fn search(&self, positions: &[f64], reference: Option<&[f64]>) -> Search<D> {
        let (values, numerator) = self.determinant(positions, &self.time_values);
        // A cell at rest has the same position at every time.
        let at_rest = Matrix::from_fn(self.time_values.rows(), 1, |_, _| 1.0);
        let denominator = reference.map(|nodes| self.determinant(nodes, &at_rest));
        Search::new(&self.directions, (values, numerator), denominator)
    }

    /// det J on the grid and as a polynomial, for positions at times that `time_values` interpolates.
    fn determinant(&self, positions: &[f64], time_values: &Matrix) -> (Lattice, Polynomial) {
        let (centred, size) = centred::<D>(positions);
        let shape: Vec<usize> = std::iter::once(D).chain([self.order; D]).chain([time_values.cols()]).collect();
        let jacobians = self.map.lattice_jacobians(Lattice::new(shape, centred).apply(D + 1, time_values));
        let entry_error = entry_error::<D>(self.order) * size;
        let error = jacobians.iter().map(|m| determinant_error(m, entry_error)).fold(0.0, f64::max);
        let grid = self.directions.iter().map(|direction| direction.points.len()).collect();
        let values = Lattice::new(grid, jacobians.iter().map(det).collect());
        let polynomial = Polynomial::interpolate(&self.directions, values.clone(), error);
        (values, polynomial)
    }
}

impl<const D: usize> Mesh<D> {
    /// The cell with the smallest scaled Jacobian, and that value, see [`Bound::scaled_jacobian`]: 1 for a parallelepiped, 0 for a
    /// degenerate cell.
    pub fn smallest_scaled_jacobian(&self) -> (usize, f64) {
        let check = ValidityCheck::<D>::new(self.order, &[0.0]);
        let value = |cell| (cell, check.bound(self.cell_coordinates(cell)).scaled_jacobian());
        let values = parallel::map(self.n_cells(), Grain::Any, &value);
        values.into_iter().fold((0, f64::INFINITY), |least, next| if next.1 < least.1 { next } else { least })
    }
}

/// Positions relative to the first one, since a common offset would cost digits, and their largest distance along an
/// axis.
fn centred<const D: usize>(positions: &[f64]) -> (Vec<f64>, f64) {
    let relative: Vec<f64> = positions.iter().enumerate().map(|(i, x)| x - positions[i % D]).collect();
    let size = relative.iter().map(|x| x.abs()).fold(0.0, f64::max);
    (relative, size)
}

/// A bound of the error of an entry of J for positions of size 1. |p'| <= (N-1)^2 max |p| (Markov), and each of the D sums has N
/// terms. Callers double it to cover the rounding of centred positions.
fn entry_error<const D: usize>(order: usize) -> f64 {
    f64::EPSILON * (D * order * (order - 1).pow(2)) as f64
}

/// A bound of the error of det m if its columns m_a have errors of `entry_error`: sum_a |dm_a| prod_{b != a} |m_b|,
/// plus the rounding of some operations on prod_a |m_a|.
fn determinant_error<const D: usize>(m: &[[f64; D]; D], entry_error: f64) -> f64 {
    let lengths: [f64; D] = std::array::from_fn(|a| norm(&m.map(|row| row[a])));
    let others = |a: usize| (0..D).filter(|&b| b != a).map(|b| lengths[b]).product::<f64>();
    (0..D).map(|a| (2.0 * entry_error + 8.0 * f64::EPSILON * lengths[a]) * others(a)).sum()
}

/// Whether det J > 0 is proved in every cell; the error names the first where it is not.
pub(crate) fn check_cells<const D: usize>(mesh: &Mesh<D>) -> Result<(), MeshError> {
    let check = ValidityCheck::<D>::new(mesh.order, &[0.0]);
    let answers = check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
    for (cell, answer) in answers.into_iter().enumerate() {
        match answer {
            Validity::Valid(_) => {}
            Validity::Invalid(bound) => return Err(inverted(mesh, cell, &bound.at.xi, bound.sampled_min)),
            Validity::Undecided(bound) => {
                return Err(MeshError::Degenerate { cell, lower: bound.lower, sampled: bound.sampled_min });
            }
        }
    }
    Ok(())
}
