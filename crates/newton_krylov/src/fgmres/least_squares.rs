//! The small problem of GMRES, solved as its matrix grows by one column per iteration.
//!
//! ```text
//! (givens)   Q H = ( R )    Q |r_0| e_1 = ( g   )    min over y of | |r_0| e_1 - H y | = |rho|,   y = R^-1 g
//!                  ( 0 )                  ( rho )
//! ```
//!
//! Q is a product of plane rotations, one per column.

/// min | |r_0| e_1 - H y | with an upper Hessenberg matrix H.
#[derive(Clone, Debug, Default)]
pub(super) struct LeastSquares {
    /// The entries of R, column by column: entry (i, j) at j stride + i. The column under construction holds that of H.
    r: Vec<f64>,
    stride: usize,
    /// The number of columns of R.
    columns: usize,
    /// (c, s) of each rotation.
    rotations: Vec<(f64, f64)>,
    /// g, followed by rho.
    g: Vec<f64>,
    /// y, or the coefficients of one Gram-Schmidt pass.
    y: Vec<f64>,
}

impl LeastSquares {
    /// Makes room for `restart` columns.
    pub(super) fn resize(&mut self, restart: usize) {
        self.stride = restart + 1;
        self.r.resize(self.stride * restart, 0.0);
        self.rotations.resize(restart, (1.0, 0.0));
        self.g.resize(restart + 1, 0.0);
        self.y.resize(restart, 0.0);
        self.columns = 0;
    }

    /// Starts with no column and |r_0| = `beta`.
    pub(super) fn start(&mut self, beta: f64) {
        self.columns = 0;
        self.r.fill(0.0);
        self.g[0] = beta;
    }

    /// Adds `product(i)`, i <= j, to entry (i, j) of H, j being the new column; returns what is to be added to w: the products
    /// with their signs changed.
    pub(super) fn subtract_from_column(&mut self, product: impl Fn(usize) -> f64) -> &[f64] {
        let j = self.columns;
        let column = &mut self.r[j * self.stride..][..=j];
        for (i, (h, minus)) in column.iter_mut().zip(&mut self.y).enumerate() {
            let h_i = product(i);
            *h += h_i;
            *minus = -h_i;
        }
        &self.y[..=j]
    }

    /// Completes the new column with H_{j+1,j} = `below` and rotates it into R; returns |rho|.
    ///
    /// A column that depends on the earlier ones is dropped: it does not reduce |rho|.
    pub(super) fn rotate(&mut self, below: f64) -> f64 {
        let j = self.columns;
        let column = &mut self.r[j * self.stride..][..=j];
        let size = column.iter().fold(below, |size, h| size.hypot(*h));
        for (i, &(c, s)) in self.rotations[..j].iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let diagonal = column[j].hypot(below);
        if diagonal > f64::EPSILON * size {
            let (c, s) = (column[j] / diagonal, below / diagonal);
            column[j] = diagonal;
            self.rotations[j] = (c, s);
            (self.g[j], self.g[j + 1]) = (c * self.g[j], -s * self.g[j]);
            self.columns += 1;
        }
        self.g[self.columns].abs()
    }

    /// y = R^-1 g, by back substitution.
    pub(super) fn solve(&mut self) -> &[f64] {
        let n = self.columns;
        self.y[..n].copy_from_slice(&self.g[..n]);
        for j in (0..n).rev() {
            let column = &self.r[j * self.stride..][..=j];
            self.y[j] /= column[j];
            for i in 0..j {
                self.y[i] -= column[i] * self.y[j];
            }
        }
        &self.y[..n]
    }
}
