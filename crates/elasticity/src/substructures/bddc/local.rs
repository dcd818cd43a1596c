//! One block: its constrained inverse, and the extension of values of constraints.
//!
//! ```text
//! A = S_b + C^T C,    G = (C A^{-1} C^T)^{-1},    Phi = A^{-1} C^T G,    S_c = Phi^T S_b Phi = G - I            (local)
//! K_b t = (I - Phi C) A^{-1} t
//! ```
//!
//! All of this in variables that make the diagonal of S_b and the lengths of the rows of C one.

use crate::ElasticityError;
use crate::substructures::bddc::cholesky;
use crate::substructures::bddc::constraints::Constraints;
use crate::substructures::interface::Interface;
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Llt, Solve};

/// A shift of A, relative to its diagonal, for blocks with parts that no constraint holds.
const SHIFT: f64 = 1e-12;

/// A block.
pub(super) struct Local {
    /// The scale of each variable.
    scale: Vec<f64>,
    /// The length of each row of C in the scaled variables.
    lengths: Vec<f64>,
    /// A
    factor: Llt<f64>,
    /// C^T
    rows: Mat<f64>,
    /// Phi
    extension: Mat<f64>,
}

impl Local {
    /// From S_b of a block; also S_c.
    pub(super) fn new<const D: usize>(
        s: Mat<f64>,
        interface: &Interface<D>,
        block: usize,
        constraints: &Constraints,
    ) -> Result<(Self, Mat<f64>), ElasticityError> {
        let mut rows = Mat::zeros(s.nrows(), constraints.of_block[block].len());
        let mut column = 0;
        for (piece, of_piece) in interface.pieces_of(block) {
            for functional in &constraints.of_piece[&piece] {
                let weights = of_piece.iter().zip(functional);
                weights.for_each(|(&row, weight)| rows[(row, column)] = *weight);
                column += 1;
            }
        }
        Local::constrained(s, rows)
    }

    /// The same from the functionals of the constraints, which are the columns of `rows`. S_b is overwritten.
    fn constrained(s: Mat<f64>, rows: Mat<f64>) -> Result<(Self, Mat<f64>), ElasticityError> {
        let scale: Vec<f64> = (0..s.nrows()).map(|i| 1.0 / s[(i, i)].sqrt()).collect();
        let rows = Mat::from_fn(rows.nrows(), rows.ncols(), |i, k| rows[(i, k)] * scale[i]);
        let lengths: Vec<f64> = (0..rows.ncols()).map(|k| rows.col(k).norm_l2()).collect();
        let rows = Mat::from_fn(rows.nrows(), rows.ncols(), |i, k| rows[(i, k)] / lengths[k]);
        let mut a = s;
        for j in 0..a.nrows() {
            (0..a.nrows()).for_each(|i| a[(i, j)] *= scale[i] * scale[j]);
            a[(j, j)] += SHIFT;
        }
        a += &rows * rows.transpose();
        let factor = cholesky(&a, "a block with constraints")?;
        let solved = factor.solve(&rows);
        let g = cholesky(&(rows.transpose() * &solved), "the constraints of a block")?.inverse();
        let extension = &solved * &g;
        let energy = Mat::from_fn(g.nrows(), g.nrows(), |i, j| {
            (g[(i, j)] - f64::from(u8::from(i == j))) / (lengths[i] * lengths[j])
        });
        Ok((Local { scale, lengths, factor, rows, extension }, energy))
    }

    /// Phi^T t, the load of the coarse problem.
    pub(super) fn load(&self, t: &[f64]) -> Vec<f64> {
        let load = self.extension.transpose() * self.scaled(t);
        load.col_as_slice(0).iter().zip(&self.lengths).map(|(load, length)| load / length).collect()
    }

    /// K_b t + Phi c.
    pub(super) fn solve(&self, t: &[f64], c: &[f64]) -> Vec<f64> {
        let mut x = self.factor.solve(self.scaled(t));
        let mut missing = -(self.rows.transpose() * &x);
        c.iter().zip(&self.lengths).enumerate().for_each(|(k, (c, length))| missing[(k, 0)] += c / length);
        x += &self.extension * missing;
        x.col_as_slice(0).iter().zip(&self.scale).map(|(x, scale)| x * scale).collect()
    }

    fn scaled(&self, t: &[f64]) -> Mat<f64> {
        Mat::from_fn(t.len(), 1, |i, _| t[i] * self.scale[i])
    }

    pub(super) fn bytes(&self) -> usize {
        let (n, c) = (self.rows.nrows(), self.rows.ncols());
        (n * n + 2 * n * c + n + c) * size_of::<f64>()
    }
}
