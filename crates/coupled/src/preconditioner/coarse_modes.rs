//! The coarse systems of the temporal modes, and their direct solution.

use basis::is_real;
use faer::{c32, c64};
use fem::Stored;
use fem::parallel::{self, Grain};
use sparse::{Factorisation, Scalar};
use std::ops::Mul;

/// A real number of the coarse level.
pub trait Entry: Stored + Scalar + Mul<Output = Self> {
    /// A complex number of two of them.
    type Pair: Scalar;
    /// re + i im.
    fn pair(re: Self, im: Self) -> Self::Pair;
    /// Both parts.
    fn parts(pair: Self::Pair) -> [Self; 2];
}

impl Entry for f32 {
    type Pair = c32;
    fn pair(re: f32, im: f32) -> c32 {
        c32::new(re, im)
    }
    fn parts(pair: c32) -> [f32; 2] {
        [pair.re, pair.im]
    }
}

impl Entry for f64 {
    type Pair = c64;
    fn pair(re: f64, im: f64) -> c64 {
        c64::new(re, im)
    }
    fn parts(pair: c64) -> [f64; 2] {
        [pair.re, pair.im]
    }
}

/// The factors of P^T B P of a mode, and room to solve with them.
pub enum CoarseMode<T: Entry> {
    /// A real mode: one column.
    Real(Factorisation<T>, Vec<T>),
    /// A complex pair: two columns.
    Complex(Factorisation<T::Pair>, [Vec<T::Pair>; 2]),
}

impl<T: Entry> CoarseMode<T> {
    /// Columns that belong to it.
    fn columns(&self) -> usize {
        match self {
            CoarseMode::Real(..) => 1,
            CoarseMode::Complex(..) => 2,
        }
    }

    /// Bytes of the factors.
    pub fn bytes(&self) -> usize {
        match self {
            CoarseMode::Real(factors, _) => factors.bytes(),
            CoarseMode::Complex(factors, _) => factors.bytes(),
        }
    }

    /// x := (P^T B P)^{-1} x; a complex x as all its real parts and then all imaginary ones.
    fn solve(&mut self, x: &mut [T]) {
        match self {
            CoarseMode::Real(factors, work) => factors.solve(x, 1, work),
            CoarseMode::Complex(factors, [pairs, work]) => {
                let (re, im) = x.split_at_mut(x.len() / 2);
                pairs.clear();
                pairs.extend(re.iter().zip(&*im).map(|(re, im)| T::pair(*re, *im)));
                factors.solve(pairs, 1, work);
                let parts = re.iter_mut().zip(im);
                pairs.iter().zip(parts).for_each(|(pair, (re, im))| [*re, *im] = T::parts(*pair));
            }
        }
    }
}

/// Solves all modes at the same time; `x[column][unknown]`.
pub fn solve_modes<T: Entry>(modes: &mut [CoarseMode<T>], unknowns: usize, mut x: &mut [T]) {
    let mut columns = Vec::with_capacity(modes.len());
    for mode in &*modes {
        let (own, rest) = x.split_at_mut(mode.columns() * unknowns);
        columns.push(own);
        x = rest;
    }
    parallel::for_each_pair((modes, 1), (&mut columns, 1), Grain::Any, &|_, mode, x| mode[0].solve(&mut *x[0]));
}

/// For every column the columns x of which (lambda x) there is made, and their factors.
pub fn products_with(shifts: &[c64]) -> Vec<Vec<(usize, f64)>> {
    let mut products = Vec::new();
    for lambda in shifts {
        let first = products.len();
        if is_real(*lambda) {
            products.push(vec![(first, lambda.re)]);
        } else {
            products.push(vec![(first, lambda.re), (first + 1, -lambda.im)]);
            products.push(vec![(first + 1, lambda.re), (first, lambda.im)]);
        }
    }
    products
}
