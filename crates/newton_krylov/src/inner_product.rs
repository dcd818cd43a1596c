//! Inner products and the few vector operations of the solvers.
//!
//! A sum over a vector is a binary tree whose leaves are chunks of [`CHUNK`] entries. The tree depends on the length alone,
//! so the result has the same bits for any number of threads; and nothing is allocated.

use rayon::prelude::*;
use std::ops::Range;
use tensor::Arch;

/// The number of entries that one thread sums up or updates at a time.
pub const CHUNK: usize = 4096;

/// The number of partial sums within a chunk: independent, so that they vectorise.
const LANES: usize = 8;

/// The number of columns that are read at the same time.
const AT_ONCE: usize = 4;

/// An inner product (x, y) of vectors, possibly with weights that make several fields comparable.
pub trait InnerProduct: Sync {
    /// sums_j := (x_j, y) for parts of vectors that begin with entry `start`, as long as y: a chunk at most.
    fn dots_in_chunk(&self, start: usize, x: &[&[f64]], y: &[f64], sums: &mut [f64]);

    /// (x, y) restricted to the entries of `range`, a chunk at most. Both vectors are given in full.
    fn dot_in_chunk(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        let mut sum = [0.0];
        self.dots_in_chunk(range.start, &[&x[range.clone()]], &y[range], &mut sum);
        sum[0]
    }

    /// (x, y) restricted to the entries of `range`. Both vectors are given in full.
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        tree_sum(range, &|chunk| self.dot_in_chunk(chunk, x, y))
    }

    /// products_j := (x_j, y) for as many columns x_j as there are products, with the bits of [`Self::dot`]; returns |y|. y is read once
    /// for all of them. `partial` is memory for the sums of the chunks.
    fn dots(&self, columns: &[Vec<f64>], y: &[f64], partial: &mut Vec<f64>, products: &mut [f64]) -> f64 {
        let (count, chunks) = (products.len(), y.len().div_ceil(CHUNK));
        partial.resize((count + 1) * chunks, 0.0);
        partial.par_chunks_mut(count + 1).enumerate().for_each(|(chunk, partial)| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(y.len());
            let (groups, y) = (columns[..count].chunks(AT_ONCE), &y[range.clone()]);
            for (columns, partial) in groups.zip(partial.chunks_mut(AT_ONCE)) {
                let mut x: [&[f64]; AT_ONCE] = [y; AT_ONCE];
                x.iter_mut().zip(columns).for_each(|(x, column)| *x = &column[range.clone()]);
                self.dots_in_chunk(range.start, &x[..columns.len()], y, &mut partial[..columns.len()]);
            }
            self.dots_in_chunk(range.start, &[y], y, &mut partial[count..]);
        });
        let sum = |j: usize| tree_sum_of_chunks(0..chunks, &|chunk| partial[chunk * (count + 1) + j]);
        products.iter_mut().enumerate().for_each(|(j, product)| *product = sum(j));
        sum(count).sqrt()
    }

    /// y := y + sum_j c_j x_j for as many columns x_j as there are coefficients; returns |y|. y is read once for both.
    fn add_combination_and_norm(&self, c: &[f64], columns: &[Vec<f64>], y: &mut [f64], partial: &mut Vec<f64>) -> f64 {
        partial.resize(y.len().div_ceil(CHUNK), 0.0);
        y.par_chunks_mut(CHUNK).zip(&mut *partial).enumerate().for_each(|(chunk, (y, square))| {
            let start = chunk * CHUNK;
            add_combination_from(start, c, columns, y);
            self.dots_in_chunk(start, &[y], y, std::slice::from_mut(square));
        });
        tree_sum_of_chunks(0..partial.len(), &|chunk| partial[chunk]).sqrt()
    }

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
    fn dots_in_chunk(&self, _: usize, x: &[&[f64]], y: &[f64], sums: &mut [f64]) {
        Arch::new().dispatch(|| chunk_dots(|_| 1.0, x, y, sums));
    }
}

/// (x, y) = sum_i w_i x_i y_i
#[derive(Clone, Debug)]
pub struct Weighted {
    /// w_i >= 0, one per entry of the vectors; zero for entries that only pad the layout (which must be finite all the same).
    pub weights: Vec<f64>,
}

impl InnerProduct for Weighted {
    fn dots_in_chunk(&self, start: usize, x: &[&[f64]], y: &[f64], sums: &mut [f64]) {
        let weights = &self.weights[start..start + y.len()];
        Arch::new().dispatch(|| chunk_dots(|i| weights[i], x, y, sums));
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

/// The sum over whole chunks, numbered from the start of the vectors, by the tree of [`tree_sum`].
fn tree_sum_of_chunks(chunks: Range<usize>, sum: &impl Fn(usize) -> f64) -> f64 {
    match chunks.len() {
        0 => 0.0,
        1 => sum(chunks.start),
        count => {
            let middle = chunks.start + count / 2;
            tree_sum_of_chunks(chunks.start..middle, sum) + tree_sum_of_chunks(middle..chunks.end, sum)
        }
    }
}

/// sums_j := sum_i w_i x_ij y_i over a chunk, [`AT_ONCE`] columns at a time: memory delivers several streams faster than one.
#[inline(always)]
fn chunk_dots(weight: impl Fn(usize) -> f64 + Copy, x: &[&[f64]], y: &[f64], sums: &mut [f64]) {
    for (x, sums) in x.chunks(AT_ONCE).zip(sums.chunks_mut(AT_ONCE)) {
        match *x {
            [a, b, c, d] => sums.copy_from_slice(&group_dots(weight, [a, b, c, d], y)),
            _ => x.iter().zip(sums).for_each(|(x, sum)| [*sum] = group_dots(weight, [x], y)),
        }
    }
}

/// [`chunk_dots`] of C columns.
#[inline(always)]
fn group_dots<const C: usize>(weight: impl Fn(usize) -> f64, x: [&[f64]; C], y: &[f64]) -> [f64; C] {
    let (mut partial, mut sums) = ([[0.0; LANES]; C], [0.0; C]);
    let whole = y.len() / LANES * LANES;
    for start in (0..whole).step_by(LANES) {
        let mut scaled = [0.0; LANES];
        for l in 0..LANES {
            scaled[l] = weight(start + l) * y[start + l];
        }
        for c in 0..C {
            let x = &x[c][start..start + LANES];
            for l in 0..LANES {
                partial[c][l] += scaled[l] * x[l];
            }
        }
    }
    for c in 0..C {
        let rest: f64 = (whole..y.len()).map(|i| weight(i) * y[i] * x[c][i]).sum();
        sums[c] = partial[c].iter().sum::<f64>() + rest;
    }
    sums
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
        return Arch::new().dispatch(|| {
            for (c, columns) in c.chunks(AT_ONCE).zip(columns.chunks(AT_ONCE)) {
                match (c, columns) {
                    (&[a, b, c, d], [v, w, x, z, ..]) => add_four([a, b, c, d], [v, w, x, z].map(|x| &x[start..]), y),
                    _ => c.iter().zip(columns).for_each(|(c, x)| add_one(*c, &x[start..], y)),
                }
            }
        });
    }
    let middle = middle(y.len());
    let (low, high) = y.split_at_mut(middle);
    rayon::join(
        || add_combination_from(start, c, columns, low),
        || add_combination_from(start + middle, c, columns, high),
    );
}

/// y := y + c x
#[inline(always)]
fn add_one(c: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += c * x);
}

/// y := y + sum_j c_j x_j, added one by one.
#[inline(always)]
fn add_four(c: [f64; AT_ONCE], x: [&[f64]; AT_ONCE], y: &mut [f64]) {
    let [v, w, x, z] = x.map(|x| &x[..y.len()]);
    for i in 0..y.len() {
        y[i] = y[i] + c[0] * v[i] + c[1] * w[i] + c[2] * x[i] + c[3] * z[i];
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problems::{bits, scattered, with_threads};

    /// Longer than one chunk, and neither a multiple of a chunk nor of a pack.
    const LENGTH: usize = 100_003;

    #[test]
    fn sums_of_small_integers_are_exact() {
        let x: Vec<f64> = (0..LENGTH).map(|i| (i % 7) as f64).collect();
        let w: Vec<f64> = (0..LENGTH).map(|i| (i % 3) as f64).collect();
        let squares: u64 = (0..LENGTH as u64).map(|i| (i % 7).pow(2)).sum();
        let weighted: u64 = (0..LENGTH as u64).map(|i| (i % 3) * (i % 7).pow(2)).sum();
        let within: u64 = (5_000..70_001_u64).map(|i| (i % 7).pow(2)).sum();
        assert_eq!(Euclidean.dot(&x, &x), squares as f64);
        assert_eq!(Euclidean.dot_on(5_000..70_001, &x, &x), within as f64);
        assert_eq!(Weighted { weights: w }.dot(&x, &x), weighted as f64);
    }

    #[test]
    fn padding_of_weight_zero_does_not_count() {
        let inner_product = Weighted { weights: vec![1.0, 0.0, 2.0] };
        assert_eq!(inner_product.dot(&[1.0, 5.0, 3.0], &[2.0, 7.0, 1.0]), 8.0);
        assert_eq!(inner_product.norm(&[0.0, 5.0, 0.0]), 0.0);
    }

    #[test]
    fn a_sum_is_as_accurate_as_its_tree_is_deep() {
        let tenths = vec![0.1; 1 << 22];
        let ones = vec![1.0; 1 << 22];
        let exact = 0.1 * (1 << 22) as f64;
        assert!((Euclidean.dot(&tenths, &ones) - exact).abs() <= 1e-13 * exact);
    }

    #[test]
    fn many_products_at_once_are_those_one_by_one_bit_by_bit() {
        for length in [1, CHUNK, CHUNK + 1, 3 * CHUNK, LENGTH] {
            let x = scattered(length);
            let columns: Vec<Vec<f64>> =
                (1..6).map(|j| x.iter().map(|x_i| (f64::from(j) * x_i).sin()).collect()).collect();
            let weighted = Weighted { weights: x.iter().map(|x_i| x_i.abs()).collect() };
            let mut products = vec![f64::NAN; 5];
            let norm = weighted.dots(&columns, &x, &mut Vec::new(), &mut products);
            let single: Vec<f64> = columns.iter().map(|column| weighted.dot(column, &x)).collect();
            assert_eq!(bits(&products), bits(&single), "{length}");
            assert_eq!(norm.to_bits(), weighted.norm(&x).to_bits(), "{length}");
            let (mut together, mut apart) = (x.clone(), x.clone());
            let norm = weighted.add_combination_and_norm(&products, &columns, &mut together, &mut Vec::new());
            add_combination(&products, &columns, &mut apart);
            assert_eq!(bits(&together), bits(&apart), "{length}");
            assert_eq!(norm.to_bits(), weighted.norm(&apart).to_bits(), "{length}");
        }
    }

    #[test]
    fn every_operation_has_the_same_bits_on_one_two_and_three_threads() {
        let x = scattered(LENGTH);
        let run = || {
            let columns = vec![x.clone(), x.iter().map(|x_i| x_i.sin()).collect()];
            let mut y = x.iter().map(|x_i| x_i.cos()).collect::<Vec<_>>();
            axpy(0.3, &x, &mut y);
            xpay(&x, -0.7, &mut y);
            scale(1.1, &mut y);
            add_combination(&[0.2, 1.0 / 3.0], &columns, &mut y);
            let weights = x.iter().map(|x_i| x_i.abs()).collect();
            (bits(&y), Euclidean.dot(&x, &y).to_bits(), Weighted { weights }.norm(&y).to_bits())
        };
        let one = with_threads(1, run);
        assert_eq!(one, with_threads(2, run));
        assert_eq!(one, with_threads(3, run));
    }

    #[test]
    fn updates_are_those_of_their_names() {
        let x: Vec<f64> = (0..LENGTH).map(|i| i as f64).collect();
        let y = vec![2.0; LENGTH];
        let after = |rule: &dyn Fn(&mut [f64])| {
            let mut y = y.clone();
            rule(&mut y);
            (y[1], y[LENGTH - 1])
        };
        let last = (LENGTH - 1) as f64;
        assert_eq!(after(&|y| axpy(3.0, &x, y)), (5.0, 2.0 + 3.0 * last));
        assert_eq!(after(&|y| xpay(&x, 3.0, y)), (7.0, last + 6.0));
        assert_eq!(after(&|y| scaled_copy(3.0, &x, y)), (3.0, 3.0 * last));
        assert_eq!(after(&|y| copy(&x, y)), (1.0, last));
        assert_eq!(after(&|y| scale(3.0, y)), (6.0, 6.0));
        assert_eq!(after(&|y| add_combination(&[1.0, 2.0], &[x.clone(), x.clone()], y)), (5.0, 2.0 + 3.0 * last));
    }
}
