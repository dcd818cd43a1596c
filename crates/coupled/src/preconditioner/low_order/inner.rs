//! The steps of generalised conjugate residuals with (node blocks) (Eisenstat, Elman, Schultz 1983), mode by mode:
//!
//! ```text
//! z_k = (node ilu)^-1 r,   w_k = (lambda + dt A) z_k
//! r := r - sum_i d_i w_i,  y := y + d   with   (w_i, w_j) d_j = (w_i, r)                                            (minimal residual)
//! x = sum_k y_k z_k
//! ```
//!
//! The residual is orthogonal to all w_i before w_k, so the right side of (minimal residual) has one entry. A fixed number of steps keeps the
//! preconditioner independent of tolerances.

use super::sweeps::Operator;
use super::vectors::{Field, Space};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side, c64};
use fem::{Layout, Share};

/// Steps of an application.
const STEPS: usize = 3;

/// Vectors of the iteration: the right side, and two for each step.
pub const VECTORS: usize = 1 + 2 * STEPS;

/// What must be left of an image beside those before it, squared, in units of its square: more than the round-off of single precision.
const INDEPENDENT: f64 = 1e-10;

/// The vectors of the iteration.
pub(super) struct Iteration {
    /// The right side at first, the solution at the end.
    pub(super) vector: Field,
    directions: [Field; STEPS],
    images: [Field; STEPS],
}

impl Iteration {
    pub(super) fn new(layout: Layout, share: &Share) -> Self {
        let vectors = || std::array::from_fn(|_| Field::zeros(layout, share));
        Iteration { vector: Field::zeros(layout, share), directions: vectors(), images: vectors() }
    }

    /// Replaces the right side in `vector` by the solution.
    pub(super) fn run<const D: usize, const M: usize, const W: usize>(&self, operator: &Operator<D, M, W>) {
        let space = Space { columns: &operator.factor.columns, share: &operator.matrix.share };
        let modes = space.columns.len();
        let mut grams = vec![Mat::<c64>::zeros(STEPS, STEPS); modes];
        let mut y = vec![vec![c64::ZERO; modes]; STEPS];
        for k in 0..STEPS {
            let (z, w) = (&self.directions[k], &self.images[k]);
            operator.sweep(&self.vector, z);
            z.receive_ghosts(&operator.matrix.share);
            operator.multiply(z, w);
            let mut others: Vec<&Field> = self.images[..=k].iter().collect();
            others.push(&self.vector);
            let dots = space.dots(&others, w);
            let mut d = vec![vec![c64::ZERO; modes]; k + 1];
            for (mode, gram) in grams.iter_mut().enumerate() {
                for (i, dots) in dots[..=k].iter().enumerate() {
                    (gram[(i, k)], gram[(k, i)]) = (dots[mode], dots[mode].conj());
                }
                for (i, increment) in increments(gram, k, dots[k + 1][mode].conj()).into_iter().enumerate() {
                    d[i][mode] = increment;
                    y[i][mode] += increment;
                }
            }
            if k + 1 < STEPS {
                let back: Vec<Vec<c64>> = d.iter().map(|d| d.iter().map(|d| -d).collect()).collect();
                space.add(&back, &self.images[..=k].iter().collect::<Vec<_>>(), &self.vector);
            }
        }
        self.vector.change(|_, x| x.fill(0.0));
        space.add(&y, &self.directions.iter().collect::<Vec<_>>(), &self.vector);
    }
}

/// d of (minimal residual) for w_0 to w_k, where (w_k, r) = `product`. It is 0 where w_k is not independent.
fn increments(gram: &Mat<c64>, k: usize, product: c64) -> Vec<c64> {
    let none = vec![c64::ZERO; k + 1];
    let Ok(factors) = gram.submatrix(0, 0, k + 1, k + 1).llt(Side::Lower) else { return none };
    if factors.L()[(k, k)].re.powi(2) <= INDEPENDENT * gram[(k, k)].re {
        return none;
    }
    let right_side = Mat::from_fn(k + 1, 1, |i, _| if i == k { product } else { c64::ZERO });
    let d = factors.solve(&right_side);
    (0..=k).map(|i| d[(i, 0)]).collect()
}
