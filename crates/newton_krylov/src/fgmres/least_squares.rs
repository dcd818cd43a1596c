//! The small problem of GMRES, solved as its matrix grows by one column per iteration.
//!
//! ```text
//! (givens)   Q H = ( R )    Q |r_0| e_1 = ( g   )    min over y of | |r_0| e_1 - H y | = |rho|,   y = R^-1 g
//!                  ( 0 )                  ( rho )
//! ```
//!
//! Q is a product of plane rotations, one per column.

use std::ops::Range;

/// min | |r_0| e_1 - H y | with an upper Hessenberg matrix H.
#[derive(Clone, Debug, Default)]
pub(super) struct LeastSquares {
    /// The upper triangle R, column by column, followed by the entries (0..=j, j) of H while column j is being built.
    r: Vec<f64>,
    /// (c, s) of each rotation.
    rotations: Vec<(f64, f64)>,
    /// g, followed by rho.
    g: Vec<f64>,
    /// y, or the coefficients of one Gram-Schmidt pass.
    y: Vec<f64>,
}

/// The storage range of column j of an upper triangle.
fn column(j: usize) -> Range<usize> {
    let start = j * (j + 1) / 2;
    start..start + j + 1
}

impl LeastSquares {
    /// Starts without columns and with |r_0| = `beta`.
    pub(super) fn start(&mut self, beta: f64) {
        self.r.clear();
        self.rotations.clear();
        self.g.clear();
        self.g.push(beta);
    }

    /// Adds the numbers that `products` writes to the new column j of H: number i to entry (i, j), i <= j. Returns the products with
    /// opposite sign, which are to be added to w.
    pub(super) fn subtract_from_column(&mut self, products: impl FnOnce(&mut [f64])) -> &[f64] {
        let new = column(self.rotations.len());
        self.r.resize(new.end, 0.0);
        self.y.resize(new.len(), 0.0);
        products(&mut self.y);
        for (h, h_i) in self.r[new].iter_mut().zip(&mut self.y) {
            *h += *h_i;
            *h_i = -*h_i;
        }
        &self.y
    }

    /// Completes the new column with H_{j+1,j} = `below` and rotates it into R; returns |rho|.
    ///
    /// A column that depends linearly on the earlier ones is dropped: it does not reduce |rho|.
    pub(super) fn rotate(&mut self, below: f64) -> f64 {
        let j = self.rotations.len();
        let h = &mut self.r[column(j)];
        let size = h.iter().fold(below, |size, h_i| size.hypot(*h_i));
        for (i, &(c, s)) in self.rotations.iter().enumerate() {
            (h[i], h[i + 1]) = (c * h[i] + s * h[i + 1], c * h[i + 1] - s * h[i]);
        }
        let diagonal = h[j].hypot(below);
        if diagonal > f64::EPSILON * size {
            let (c, s) = (h[j] / diagonal, below / diagonal);
            h[j] = diagonal;
            self.rotations.push((c, s));
            self.g.push(-s * self.g[j]);
            self.g[j] *= c;
        } else {
            self.r.truncate(column(j).start);
        }
        self.g[self.rotations.len()].abs()
    }

    /// y = R^-1 g, by back substitution.
    pub(super) fn solve(&mut self) -> &[f64] {
        let n = self.rotations.len();
        self.y.clear();
        self.y.extend_from_slice(&self.g[..n]);
        for j in (0..n).rev() {
            let r_j = &self.r[column(j)];
            self.y[j] /= r_j[j];
            for i in 0..j {
                self.y[i] -= r_j[i] * self.y[j];
            }
        }
        &self.y
    }
}
