//! Small problems with known answers, for the tests of this crate.
#![allow(clippy::unwrap_used)]

use crate::inner_product::{Euclidean, InnerProduct, Weighted};
use crate::operator::LinearOperator;
use crate::problem::{Field, Inadmissible, NonlinearProblem};

/// Runs `work` on a pool of the given number of threads.
pub(crate) fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// The bits of a vector, to compare them.
pub(crate) fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x_i| x_i.to_bits()).collect()
}

/// A vector of pseudo-random entries in [-1/2, 1/2) by a linear congruence.
pub(crate) fn scattered(length: usize) -> Vec<f64> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..length).map(|_| next()).collect()
}

/// A dense matrix, row by row.
#[derive(Clone)]
pub(crate) struct Dense(pub(crate) Vec<Vec<f64>>);

impl LinearOperator for Dense {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        for (y_i, row) in y.iter_mut().zip(&self.0) {
            *y_i = Euclidean.dot(row, x);
        }
    }
}

impl Dense {
    /// A x = b by Gaussian elimination with row exchanges: the reference for the Krylov methods.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = b.len();
        let mut rows: Vec<Vec<f64>> = self.0.iter().zip(b).map(|(row, &b_i)| [&row[..], &[b_i]].concat()).collect();
        for k in 0..n {
            let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs())).unwrap();
            rows.swap(k, pivot);
            let (done, rest) = rows.split_at_mut(k + 1);
            for row in rest {
                let factor = row[k] / done[k][k];
                (k..=n).for_each(|j| row[j] -= factor * done[k][j]);
            }
        }
        let mut x = vec![0.0; n];
        for k in (0..n).rev() {
            x[k] = (rows[k][n] - (k + 1..n).map(|j| rows[k][j] * x[j]).sum::<f64>()) / rows[k][k];
        }
        x
    }
}

/// A diagonal matrix; as a preconditioner, the entries are those of P^-1.
pub(crate) struct Diagonal(pub(crate) Vec<f64>);

impl LinearOperator for Diagonal {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        (0..x.len()).for_each(|i| y[i] = self.0[i] * x[i]);
    }
}

/// An operator given by a closure (x, y).
pub(crate) struct Action<F: FnMut(&[f64], &mut [f64])>(pub(crate) F);

impl<F: FnMut(&[f64], &mut [f64])> LinearOperator for Action<F> {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) {
        (self.0)(x, y);
    }
}

impl<F: FnMut(&[f64], &mut [f64])> crate::operator::Preconditioner for Action<F> {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        (self.0)(r, z);
    }
}

/// The residual of a small problem and its Jacobian, by value.
pub(crate) type Residual = fn(&[f64]) -> Result<Vec<f64>, Inadmissible>;
pub(crate) type Jacobian = fn(&[f64]) -> Vec<Vec<f64>>;

/// A small problem with a dense Jacobian, M = 1 and no preconditioner.
pub(crate) struct Small {
    residual: Residual,
    jacobian: Jacobian,
    fields: Vec<Field>,
    inner_product: Weighted,
    matrix: Dense,
    inverse_pseudo_time: Vec<f64>,
    /// The result of `largest_step`.
    pub(crate) largest_step: f64,
    /// The result of `round_off`.
    pub(crate) rounding: Option<Vec<f64>>,
}

impl Small {
    /// One field of `n` unknowns.
    pub(crate) fn new(n: usize, residual: Residual, jacobian: Jacobian) -> Self {
        Self::with_fields(&[("all", n)], residual, jacobian)
    }

    /// Fields of the given names and lengths.
    pub(crate) fn with_fields(fields: &[(&'static str, usize)], residual: Residual, jacobian: Jacobian) -> Self {
        let mut n = 0;
        let fields = fields.iter().map(|&(name, length)| {
            n += length;
            Field { name, range: n - length..n }
        });
        let fields = fields.collect();
        Self {
            residual,
            jacobian,
            fields,
            inner_product: Weighted::new(vec![1.0; n]),
            matrix: Dense(Vec::new()),
            inverse_pseudo_time: Vec::new(),
            largest_step: 1.0,
            rounding: None,
        }
    }
}

impl NonlinearProblem for Small {
    fn len(&self) -> usize {
        self.inner_product.weights.len()
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        &self.inner_product
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        r.copy_from_slice(&(self.residual)(z)?);
        Ok(())
    }

    fn linearise(&mut self, z: &[f64], inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.matrix = Dense((self.jacobian)(z));
        self.inverse_pseudo_time = inverse_pseudo_time.to_vec();
        Ok(())
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.matrix.apply(direction, out);
    }

    fn add_pseudo_time(&mut self, direction: &[f64], out: &mut [f64]) {
        for (field, inverse) in self.fields.iter().zip(&self.inverse_pseudo_time) {
            field.range.clone().for_each(|i| out[i] += inverse * direction[i]);
        }
    }

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        out.copy_from_slice(r);
    }

    fn largest_step(&mut self, _: &[f64], _: &[f64]) -> f64 {
        self.largest_step
    }

    fn round_off(&mut self, _: &[f64]) -> Option<Vec<f64>> {
        self.rounding.clone()
    }
}

/// The Bratu problem u'' + exp(u) = 0, u(0) = u(1) = 0, by second differences on n inner points:
/// R_i = 2 u_i - u_{i-1} - u_{i+1} - h^2 exp(u_i), preconditioned by the exact inverse of the Laplacian.
pub(crate) struct Bratu {
    fields: [Field; 1],
    u: Vec<f64>,
}

impl Bratu {
    /// n inner points.
    pub(crate) fn new(n: usize) -> Self {
        Self { fields: [Field { name: "u", range: 0..n }], u: vec![0.0; n] }
    }

    /// The lower exact solution, -2 ln( cosh((x - 1/2) theta / 2) / cosh(theta / 4) ), theta = sqrt(2) cosh(theta / 4).
    pub(crate) fn exact(x: f64) -> f64 {
        let theta = (0..100).fold(1.0, |theta: f64, _| 2_f64.sqrt() * (0.25 * theta).cosh());
        -2.0 * ((0.5 * (x - 0.5) * theta).cosh() / (0.25 * theta).cosh()).ln()
    }

    fn h(&self) -> f64 {
        1.0 / (self.u.len() + 1) as f64
    }
}

/// 2 x_i - x_{i-1} - x_{i+1}, with zeros outside.
pub(crate) fn laplacian(x: &[f64], y: &mut [f64]) {
    let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
    (0..x.len()).for_each(|i| y[i] = 2.0 * x[i] - at(i.wrapping_sub(1)) - at(i + 1));
}

/// The inverse of [`laplacian`], by two sums: the Green function is min(x, y) (1 - max(x, y)).
fn inverse_laplacian(r: &[f64], z: &mut [f64]) {
    let size = (r.len() + 1) as f64;
    let x = |i: usize| (i + 1) as f64 / size;
    let mut sum = 0.0;
    for i in 0..r.len() {
        sum += x(i) * r[i];
        z[i] = size * (1.0 - x(i)) * sum;
    }
    sum = 0.0;
    for i in (0..r.len()).rev() {
        z[i] += size * x(i) * sum;
        sum += (1.0 - x(i)) * r[i];
    }
}

impl NonlinearProblem for Bratu {
    fn len(&self) -> usize {
        self.u.len()
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        laplacian(z, r);
        (0..z.len()).for_each(|i| r[i] -= self.h().powi(2) * z[i].exp());
        Ok(())
    }

    fn linearise(&mut self, z: &[f64], _: &[f64]) -> Result<(), Inadmissible> {
        self.u.copy_from_slice(z);
        Ok(())
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        laplacian(direction, out);
        (0..out.len()).for_each(|i| out[i] -= self.h().powi(2) * self.u[i].exp() * direction[i]);
    }

    fn add_pseudo_time(&mut self, _: &[f64], _: &mut [f64]) {
        unreachable!("never damped in the tests");
    }

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        inverse_laplacian(r, out);
    }

    fn largest_step(&mut self, _: &[f64], _: &[f64]) -> f64 {
        1.0
    }
}
