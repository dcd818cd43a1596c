//! Inner products and the few vector operations of the solvers.
//!
//! A sum over a vector is a binary tree whose leaves are chunks of [`CHUNK`] entries. The tree depends on the length alone,
//! so the result has the same bits for any number of threads; and nothing is allocated.

use std::ops::Range;

/// The number of entries that one thread sums up or updates at a time.
pub const CHUNK: usize = 4096;

/// The number of partial sums within a chunk: independent, so that they vectorise.
const LANES: usize = 8;

/// An inner product (x, y) of vectors, possibly with weights that make several fields comparable.
pub trait InnerProduct: Sync {
    /// (x, y) restricted to the entries of `range`. Both vectors are given in full.
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64;

    /// (x, y)
    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        self.dot_on(0..x.len(), x, y)
    }

    /// sqrt((x, x)) restricted to the entries of `range`.
    fn norm_on(&self, range: Range<usize>, x: &[f64]) -> f64 {
        self.dot_on(range, x, x).sqrt()
    }

    /// sqrt((x, x))
    fn norm(&self, x: &[f64]) -> f64 {
        self.norm_on(0..x.len(), x)
    }
}

/// (x, y) = sum_i x_i y_i
#[derive(Clone, Copy, Debug, Default)]
pub struct Euclidean;

impl InnerProduct for Euclidean {
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        tree_sum(range, &|r: Range<usize>| chunk_dot(&x[r.clone()], &y[r]))
    }
}

/// (x, y) = sum_i w_i x_i y_i
#[derive(Clone, Debug)]
pub struct Weighted {
    /// w_i >= 0, one per entry of the vectors; zero for entries that only pad the layout.
    pub weights: Vec<f64>,
}

impl InnerProduct for Weighted {
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        tree_sum(range, &|r: Range<usize>| chunk_weighted_dot(&self.weights[r.clone()], &x[r.clone()], &y[r]))
    }
}

/// Where a vector of more than one chunk is split in two: at the chunk in its middle.
fn middle(length: usize) -> usize {
    length.div_ceil(CHUNK) / 2 * CHUNK
}

/// The sum of `leaf` over the chunks of `range`. The tree is fixed by the length of the range.
fn tree_sum(range: Range<usize>, leaf: &(impl Fn(Range<usize>) -> f64 + Sync)) -> f64 {
    if range.len() <= CHUNK {
        return leaf(range);
    }
    let middle = range.start + middle(range.len());
    let (low, high) = rayon::join(|| tree_sum(range.start..middle, leaf), || tree_sum(middle..range.end, leaf));
    low + high
}

/// sum_i x_i y_i within a chunk.
fn chunk_dot(x: &[f64], y: &[f64]) -> f64 {
    let (x_packs, x_rest) = x.as_chunks::<LANES>();
    let (y_packs, y_rest) = y.as_chunks::<LANES>();
    let mut partial = [0.0; LANES];
    for (a, b) in x_packs.iter().zip(y_packs) {
        for l in 0..LANES {
            partial[l] += a[l] * b[l];
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(a, b)| a * b).sum();
    partial.iter().sum::<f64>() + rest
}

/// sum_i w_i x_i y_i within a chunk.
fn chunk_weighted_dot(w: &[f64], x: &[f64], y: &[f64]) -> f64 {
    let (w_packs, w_rest) = w.as_chunks::<LANES>();
    let (x_packs, x_rest) = x.as_chunks::<LANES>();
    let (y_packs, y_rest) = y.as_chunks::<LANES>();
    let mut partial = [0.0; LANES];
    for ((c, a), b) in w_packs.iter().zip(x_packs).zip(y_packs) {
        for l in 0..LANES {
            partial[l] += c[l] * a[l] * b[l];
        }
    }
    let rest: f64 = w_rest.iter().zip(x_rest).zip(y_rest).map(|((c, a), b)| c * a * b).sum();
    partial.iter().sum::<f64>() + rest
}

/// y := update(x, y) entry by entry, chunks in parallel.
fn update(x: &[f64], y: &mut [f64], rule: &(impl Fn(f64, f64) -> f64 + Sync)) {
    if y.len() <= CHUNK {
        for (y_i, x_i) in y.iter_mut().zip(x) {
            *y_i = rule(*x_i, *y_i);
        }
        return;
    }
    let middle = middle(y.len());
    let (x_low, x_high) = x.split_at(middle);
    let (y_low, y_high) = y.split_at_mut(middle);
    rayon::join(|| update(x_low, y_low, rule), || update(x_high, y_high, rule));
}

/// y := y + sum_j c_j x_j, for as many columns x_j as there are coefficients.
pub(crate) fn add_combination(c: &[f64], columns: &[Vec<f64>], y: &mut [f64]) {
    add_combination_from(0, c, columns, y);
}

/// [`add_combination`] for the part of the vectors that begins at `start` and that `y` holds.
fn add_combination_from(start: usize, c: &[f64], columns: &[Vec<f64>], y: &mut [f64]) {
    if y.len() <= CHUNK {
        for (c_j, x_j) in c.iter().zip(columns) {
            for (y_i, x_ij) in y.iter_mut().zip(&x_j[start..]) {
                *y_i += c_j * x_ij;
            }
        }
        return;
    }
    let middle = middle(y.len());
    let (low, high) = y.split_at_mut(middle);
    rayon::join(
        || add_combination_from(start, c, columns, low),
        || add_combination_from(start + middle, c, columns, high),
    );
}

/// y := a y
pub fn scale(a: f64, y: &mut [f64]) {
    if y.len() <= CHUNK {
        for y_i in y {
            *y_i *= a;
        }
        return;
    }
    let (low, high) = y.split_at_mut(middle(y.len()));
    rayon::join(|| scale(a, low), || scale(a, high));
}

/// y := y + a x
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    update(x, y, &|x_i, y_i| y_i + a * x_i);
}

/// y := x + a y
pub fn xpay(x: &[f64], a: f64, y: &mut [f64]) {
    update(x, y, &|x_i, y_i| x_i + a * y_i);
}

/// y := a x
pub fn scaled_copy(a: f64, x: &[f64], y: &mut [f64]) {
    update(x, y, &|x_i, _| a * x_i);
}

/// y := x
pub fn copy(x: &[f64], y: &mut [f64]) {
    update(x, y, &|x_i, _| x_i);
}
