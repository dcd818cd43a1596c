//! The steps of generalised conjugate residuals with (node blocks) (Eisenstat, Elman, Schultz 1983), mode by mode:
//!
//! ```text
//! z_k = (node ilu)^-1 r,  w_k = (lambda + dt A) z_k,  both made orthogonal to the w_i before;   x += a z_k,  r -= a w_k,  a = (w_k, r) / (w_k, w_k)
//! ```
//!
//! A fixed number of steps keeps the preconditioner independent of tolerances. Three steps gain a third of the outer iterations, more gain
//! nothing: there the low-order operator is the limit.

use super::sweeps::Operator;
use super::vectors::{Field, Space};
use faer::c64;
use fem::{Layout, Share};

/// Steps of an application.
const STEPS: usize = 3;

/// Vectors of the iteration: right side, solution, and two for each step.
pub const VECTORS: usize = 2 + 2 * STEPS;

/// The vectors of the iteration.
pub(super) struct Iteration {
    /// The right side at first.
    pub(super) residual: Field,
    pub(super) solution: Field,
    directions: [Field; STEPS],
    images: [Field; STEPS],
}

impl Iteration {
    pub(super) fn new(layout: Layout, share: &Share) -> Self {
        let vectors = || std::array::from_fn(|_| Field::zeros(layout, share));
        let (residual, solution) = (Field::zeros(layout, share), Field::zeros(layout, share));
        Iteration { residual, solution, directions: vectors(), images: vectors() }
    }

    /// Solves for the right side in `residual`.
    pub(super) fn run<const D: usize, const M: usize, const W: usize>(&self, operator: &Operator<D, M, W>) {
        let space = Space { components: M, columns: &operator.factor.columns, share: &operator.matrix.share };
        self.solution.change(|_, x| x.fill(0.0));
        let mut squares: Vec<Vec<c64>> = Vec::with_capacity(STEPS);
        for k in 0..STEPS {
            let (z, w) = (&self.directions[k], &self.images[k]);
            operator.sweep(&self.residual, z);
            z.receive_ghosts(&operator.matrix.share);
            operator.multiply(z, w);
            for (i, square) in squares.iter().enumerate() {
                let projection = ratios(&space.dots(&self.images[i], w), square);
                let back: Vec<c64> = projection.into_iter().map(|ratio| -ratio).collect();
                space.add(&back, &self.directions[i], z);
                space.add(&back, &self.images[i], w);
            }
            squares.push(space.dots(w, w));
            let step = ratios(&space.dots(w, &self.residual), &squares[k]);
            space.add(&step, z, &self.solution);
            space.add(&step.into_iter().map(|ratio| -ratio).collect::<Vec<_>>(), w, &self.residual);
        }
    }
}

/// Quotients; 0 where nothing is left to divide by.
fn ratios(above: &[c64], below: &[c64]) -> Vec<c64> {
    let ratio = |(a, b): (&c64, &c64)| if b.re > 0.0 { a / b.re } else { c64::ZERO };
    above.iter().zip(below).map(ratio).collect()
}
