//! The bounds of eight cells at once: of whole cells, or of their halves along all axes.
//!
//! The values of f = det J on the grid become coefficients of a mixed form, Bernstein up to degree q and Chebyshev beyond:
//!
//! ```text
//! f = sum_i c_i prod_a phi_{i_a}(x_a),     phi_i = B_i for i <= q,   phi_i = T_i for i > q                     (mixed)
//! ```
//!
//! The B_i are not negative and sum to 1, and |T_i| <= 1. All terms that contain a T_i are bounded one axis after the other,
//!
//! ```text
//! |sum_i c_i phi_i| <= max_{i <= q} |c_i| + sum_{i > q} |c_i|                                                   (tail)
//! ```
//!
//! The other terms are a sum of Bernstein polynomials. With the tails and round-off in the margins m, and e_i for det J_0,
//!
//! ```text
//! det J >= sum_i (c_i - m_f) B_i >= r det J_0,     r = min_i (c_i - m_f) / (e_i +- m_g)                       (lower)
//! ```
//!
//! with the sign of c_i - m_f: det J_0 is at most sum_i (e_i + m_g) B_i, and at least sum_i (e_i - m_g) B_i > 0.
//!
//! This is quick and coarse: round-off is bounded by the norms of the matrices, which grow fast with q. Undecided cells are
//! left to [`super::search`].

mod kernel;

pub(super) use kernel::{BoundPack, Swept};

use super::bernstein::{Direction, Mixed};
use crate::lattice::digit;
use basis::{Lagrange, Matrix, scratch_length};
use tensor::{Pack, zeroed};

/// Error of the sums of (mixed), in units of the largest value and of the norms of the matrices.
const SUM_ERROR: f64 = 128.0 * f64::EPSILON;

/// Data shared by all cells of one order.
#[derive(Clone, Debug)]
pub(super) struct Sweep<const D: usize> {
    /// Time nodes to the points of the last direction.
    time_values: Matrix,
    /// Gauss-Lobatto nodes to the points of a direction of space.
    values: Matrix,
    derivatives: Matrix,
    /// Values to (mixed): on the whole cell, then in halves, D axes of space, then time.
    whole: Part,
    halves: Vec<Part>,
    /// q + 1 for each axis.
    kept: Vec<usize>,
    /// The indices of the coefficients of Bernstein polynomials alone, at one index of time.
    bernstein_places: Vec<usize>,
    /// Error of an entry of J for positions of size 1.
    entry_error: f64,
    /// The Lebesgue constant of the grid.
    lebesgue: f64,
}

/// A part of the box in space and time.
#[derive(Clone, Debug)]
struct Part {
    /// (mixed), one matrix per axis.
    matrices: Vec<Matrix>,
    /// Error of a coefficient for values of size 1.
    sum_error: f64,
}

impl Part {
    fn new(axes: Vec<Mixed>) -> Self {
        let norm: f64 = axes.iter().map(|mixed| mixed.norm).product();
        Part { matrices: axes.into_iter().map(|mixed| mixed.matrix).collect(), sum_error: SUM_ERROR * norm }
    }
}

/// Bounds of all terms, and of those with a T_i, line by line.
struct TermBounds {
    all: Vec<Pack>,
    tail: Vec<Pack>,
}

/// Work space and input of [`Sweep`].
pub(super) struct Scratch {
    /// Positions, relative to some point of the cell: `[time node][component][node]`.
    pub(super) nodes: Vec<Pack>,
    /// det J_0, `[point]`, and a bound of its error.
    pub(super) reference: Vec<Pack>,
    pub(super) reference_error: Pack,
    /// `[time point][component][node]`
    in_time: Vec<Pack>,
    /// Columns of J, `[column][time point][component][point]`.
    columns: Vec<Pack>,
    /// det J, `[time point][point]`.
    values: Vec<Pack>,
    /// c_i, and e_i.
    coefficients: Vec<Pack>,
    reference_coefficients: Vec<Pack>,
    term_bounds: TermBounds,
    between: Vec<Pack>,
}

impl<const D: usize> Sweep<D> {
    /// For cells of `order` whose determinants have the degrees of `directions`.
    pub(super) fn new(order: usize, time_values: &Matrix, directions: &[Direction]) -> Self {
        let lagrange = Lagrange::gauss_lobatto(order);
        let n = directions[0].points.len();
        let kept: Vec<usize> = directions.iter().map(Direction::kept).collect();
        let low = |k: &usize| (0..D).all(|a| digit(*k, n, a) < kept[0]);
        let half = |k: usize| Part::new((0..=D).map(|axis| directions[axis].mixed(Some(k >> axis & 1))).collect());
        Sweep {
            time_values: time_values.clone(),
            values: lagrange.value_matrix(&directions[0].points),
            derivatives: lagrange.derivative_matrix(&directions[0].points),
            whole: Part::new(directions.iter().map(|direction| direction.mixed(None)).collect()),
            halves: (0..1 << (D + 1)).map(half).collect(),
            bernstein_places: (0..n.pow(D as u32)).filter(low).collect(),
            kept,
            entry_error: super::entry_error::<D>(order),
            lebesgue: directions.iter().map(Direction::lebesgue_constant).product(),
        }
    }

    /// Points of space.
    pub(super) fn points(&self) -> usize {
        self.values.rows().pow(D as u32)
    }

    pub(super) fn scratch(&self) -> Scratch {
        let (n, m) = (self.points(), self.time_values.rows());
        let nodes = self.values.cols().pow(D as u32) * D;
        let mixed: Vec<&Matrix> = self.whole.matrices.iter().collect();
        let between = scratch_length(&[&self.values; D], m * D).max(scratch_length(&mixed, 1));
        Scratch {
            nodes: zeroed(nodes * self.time_values.cols()),
            reference: zeroed(n),
            reference_error: Pack::ZERO,
            in_time: zeroed(nodes * m),
            columns: zeroed(D * m * D * n),
            values: zeroed(m * n),
            coefficients: zeroed(m * n),
            reference_coefficients: zeroed(n),
            term_bounds: TermBounds { all: zeroed(m * n), tail: zeroed(m * n) },
            between: zeroed(between),
        }
    }
}
