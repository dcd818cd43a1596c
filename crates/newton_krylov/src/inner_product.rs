//! Inner products and the few vector operations of the solvers.
//!
//! A sum over a vector is a binary tree whose leaves are chunks of [`CHUNK`] entries. The tree depends only on the length,
//! so the result has the same bits for any number of threads. Where a vector is distributed over ranks, each [`Parts`] of it has a tree of its
//! own, and the bits do not depend on the number of ranks either.

use ranks::Sums;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use tensor::Arch;

/// The number of entries that one thread sums or updates at a time.
pub const CHUNK: usize = 4096;

/// The number of partial sums within a chunk. They are independent, so that they vectorise.
const LANES: usize = 8;

/// The number of columns that are read at the same time: several streams give more memory bandwidth than one.
pub const AT_ONCE: usize = 4;

/// An inner product (x, y) of vectors, possibly with weights that make several fields comparable.
pub trait InnerProduct: Sync {
    /// sums_j := (x_j, y) for parts of one to [`AT_ONCE`] vectors that begin at entry `start` and are as long as y, at most a
    /// chunk.
    fn dots_in_chunk(&self, start: usize, x: &[&[f64]], y: &[f64], sums: &mut [f64]);

    /// How vectors are distributed over ranks; None where this rank has all of them.
    fn parts(&self) -> Option<&Parts> {
        None
    }

    /// (x, y) restricted to the entries of `range`. Both vectors are given in full.
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        let of_part = |part: Range<usize>| {
            tree_sum(part, &|chunk| {
                let mut sum = [0.0];
                self.dots_in_chunk(chunk.start, &[&x[chunk.clone()]], &y[chunk], &mut sum);
                sum[0]
            })
        };
        let Some(parts) = self.parts() else { return of_part(range) };
        let common = |part: &Range<usize>| {
            let start = part.start.max(range.start);
            start..part.end.min(range.end).max(start)
        };
        let sums: Vec<f64> = parts.ranges.iter().map(|part| of_part(common(part))).collect();
        parts.total(&sums, 1)[0]
    }

    /// products_j := (x_j, y) for as many columns x_j as there are products, with the bits of [`Self::dot`]; returns |y|. y is read once
    /// for all of them. `partial` holds the sums of the chunks.
    fn dots(&self, columns: &[Vec<f64>], y: &[f64], partial: &mut Vec<f64>, products: &mut [f64]) -> f64 {
        let (count, chunks) = (products.len(), Chunks { parts: self.parts(), len: y.len() });
        partial.resize((count + 1) * chunks.count(), 0.0);
        partial.par_chunks_mut(count + 1).enumerate().for_each(|(chunk, partial)| {
            let range = chunks.range(chunk);
            let (groups, y) = (columns[..count].chunks(AT_ONCE), &y[range.clone()]);
            for (columns, partial) in groups.zip(partial.chunks_mut(AT_ONCE)) {
                let mut x: [&[f64]; AT_ONCE] = [y; AT_ONCE];
                x.iter_mut().zip(columns).for_each(|(x, column)| *x = &column[range.clone()]);
                self.dots_in_chunk(range.start, &x[..columns.len()], y, &mut partial[..columns.len()]);
            }
            self.dots_in_chunk(range.start, &[y], y, &mut partial[count..]);
        });
        let mut square = 0.0;
        chunks.totals(partial, count + 1, |j, sum| if j < count { products[j] = sum } else { square = sum });
        square.sqrt()
    }

    /// y := y + sum_j c_j x_j for as many columns x_j as there are coefficients; returns |y|. y is read once for both.
    fn add_combination_and_norm(&self, c: &[f64], columns: &[Vec<f64>], y: &mut [f64], partial: &mut Vec<f64>) -> f64 {
        let chunks = Chunks { parts: self.parts(), len: y.len() };
        partial.resize(chunks.count(), 0.0);
        let update = |(chunk, (y, square)): (usize, (&mut [f64], &mut f64))| {
            let start = chunks.range(chunk).start;
            add_combination_from(start, c, columns, y);
            self.dots_in_chunk(start, &[y], y, std::slice::from_mut(square));
        };
        match self.parts() {
            None => y.par_chunks_mut(CHUNK).zip(&mut *partial).enumerate().for_each(update),
            Some(_) => chunks.split(y).into_par_iter().zip(&mut *partial).enumerate().for_each(update),
        }
        let mut square = 0.0;
        chunks.totals(partial, 1, |_, sum| square = sum);
        square.sqrt()
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
        Arch::new().dispatch(|| chunk_dots(None, x, y, sums));
    }
}

/// (x, y) = sum_i w_i x_i y_i
#[derive(Clone, Debug, Default)]
pub struct Weighted {
    /// w_i >= 0, one per entry of the vectors. It is zero for padding of the layout; those entries must be finite
    /// nevertheless.
    pub weights: Vec<f64>,
    /// How vectors are distributed, see [`InnerProduct::parts`].
    pub parts: Option<Parts>,
}

impl Weighted {
    /// With `weights`, on a rank that has all entries.
    pub fn new(weights: Vec<f64>) -> Self {
        Weighted { weights, parts: None }
    }
}

/// The vectors of a rank: a part that all ranks have alike, and one for every block that the rank owns.
#[derive(Clone, Debug)]
pub struct Parts {
    /// First the entries that all ranks have, then those of the own blocks.
    ranges: Vec<Range<usize>>,
    /// The chunks of all parts, and for every part its chunks.
    chunks: Vec<Range<usize>>,
    chunks_of_part: Vec<Range<usize>>,
    sums: Arc<Sums>,
}

impl Parts {
    /// `common` entries that all ranks have, and blocks that end at the entries `ends`, the first of which is the start of the first block.
    pub fn new(common: usize, ends: &[usize], sums: Arc<Sums>) -> Self {
        let blocks = ends.windows(2).map(|ends| common + ends[0]..common + ends[1]);
        let ranges: Vec<Range<usize>> = std::iter::once(0..common).chain(blocks).collect();
        let (mut chunks, mut chunks_of_part) = (Vec::new(), Vec::new());
        for part in &ranges {
            let first = chunks.len();
            chunks.extend(part.clone().step_by(CHUNK).map(|start| start..(start + CHUNK).min(part.end)));
            chunks_of_part.push(first..chunks.len());
        }
        Parts { ranges, chunks, chunks_of_part, sums }
    }

    /// The sums over all parts on all ranks of `count` numbers each; `of_parts[part][number]`.
    fn total(&self, of_parts: &[f64], count: usize) -> Vec<f64> {
        let (common, blocks) = of_parts.split_at(count);
        let mut totals = self.sums.total(blocks, count);
        totals.iter_mut().zip(common).for_each(|(total, common)| *total += common);
        totals
    }
}

/// The chunks of a vector.
struct Chunks<'a> {
    parts: Option<&'a Parts>,
    len: usize,
}

impl Chunks<'_> {
    fn count(&self) -> usize {
        self.parts.map_or(self.len.div_ceil(CHUNK), |parts| parts.chunks.len())
    }

    fn range(&self, chunk: usize) -> Range<usize> {
        self.parts.map_or(chunk * CHUNK..((chunk + 1) * CHUNK).min(self.len), |parts| parts.chunks[chunk].clone())
    }

    /// The vector `y` in chunks.
    fn split<'y>(&self, mut y: &'y mut [f64]) -> Vec<&'y mut [f64]> {
        let mut next = |chunk: usize| {
            let (here, rest) = std::mem::take(&mut y).split_at_mut(self.range(chunk).len());
            y = rest;
            here
        };
        (0..self.count()).map(&mut next).collect()
    }

    /// Passes the sums of `count` numbers over all chunks, `partial[chunk][number]`, to `take`.
    fn totals(&self, partial: &[f64], count: usize, mut take: impl FnMut(usize, f64)) {
        let over = |chunks: Range<usize>, j: usize| tree_sum_of_chunks(chunks, &|chunk| partial[chunk * count + j]);
        let Some(parts) = self.parts else {
            return (0..count).for_each(|j| take(j, over(0..self.count(), j)));
        };
        let of_part = |chunks: &Range<usize>| (0..count).map(|j| over(chunks.clone(), j)).collect::<Vec<f64>>();
        let of_parts: Vec<f64> = parts.chunks_of_part.iter().flat_map(of_part).collect();
        parts.total(&of_parts, count).into_iter().enumerate().for_each(|(j, sum)| take(j, sum));
    }
}

impl InnerProduct for Weighted {
    fn parts(&self) -> Option<&Parts> {
        self.parts.as_ref()
    }

    fn dots_in_chunk(&self, start: usize, x: &[&[f64]], y: &[f64], sums: &mut [f64]) {
        let weights = &self.weights[start..start + y.len()];
        Arch::new().dispatch(|| chunk_dots(Some(weights), x, y, sums));
    }
}

/// sum_i x_i, by the tree of the inner products: the door of every other sum over the whole mesh.
pub fn sum(x: &[f64]) -> f64 {
    tree_sum(0..x.len(), &|chunk| x[chunk].iter().sum())
}

/// The same for `x` with as many entries for every cell, which belong to blocks that end at the cells `ends`; over the blocks of all ranks.
pub fn sum_over_blocks(x: &[f64], ends: &[usize], sums: &Sums) -> f64 {
    let per_cell = x.len() / ends.last().copied().unwrap_or(0).max(1);
    let of_blocks: Vec<f64> = ends.windows(2).map(|ends| sum(&x[ends[0] * per_cell..ends[1] * per_cell])).collect();
    sums.total(&of_blocks, 1)[0]
}

/// The position where a vector of more than one chunk is split in two: the chunk in its middle.
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

/// sums_j := sum_i w_i x_ij y_i over a chunk; without weights all w_i are one.
#[inline(always)]
fn chunk_dots(weights: Option<&[f64]>, x: &[&[f64]], y: &[f64], sums: &mut [f64]) {
    match *x {
        [a] => sums.copy_from_slice(&group_dots(weights, [a], y)),
        [a, b] => sums.copy_from_slice(&group_dots(weights, [a, b], y)),
        [a, b, c] => sums.copy_from_slice(&group_dots(weights, [a, b, c], y)),
        [a, b, c, d] => sums.copy_from_slice(&group_dots(weights, [a, b, c, d], y)),
        _ => unreachable!("groups have one to {AT_ONCE} columns"),
    }
}

/// [`chunk_dots`] for C columns. The remainder of a chunk after whole packs is padded with zeros.
#[inline(always)]
fn group_dots<const C: usize>(weights: Option<&[f64]>, x: [&[f64]; C], y: &[f64]) -> [f64; C] {
    let whole = y.len() / LANES;
    let mut sums = [[0.0; LANES]; C];
    for pack in 0..whole {
        let at = |vector: &[f64]| -> [f64; LANES] {
            let mut numbers = [0.0; LANES];
            numbers.copy_from_slice(&vector[pack * LANES..(pack + 1) * LANES]);
            numbers
        };
        add_products(weights.map(at), x, at, at(y), &mut sums);
    }
    let last = |vector: &[f64]| -> [f64; LANES] {
        let (mut numbers, rest) = ([0.0; LANES], &vector[whole * LANES..]);
        numbers[..rest.len()].copy_from_slice(rest);
        numbers
    };
    if whole * LANES < y.len() {
        add_products(weights.map(last), x, last, last(y), &mut sums);
    }
    let mut totals = [0.0; C];
    for c in 0..C {
        totals[c] = sums[c].iter().sum();
    }
    totals
}

/// sums_c += w y x_c for one pack, which `at` takes from a vector.
#[inline(always)]
fn add_products<const C: usize>(
    weights: Option<[f64; LANES]>,
    x: [&[f64]; C],
    at: impl Fn(&[f64]) -> [f64; LANES],
    mut y: [f64; LANES],
    sums: &mut [[f64; LANES]; C],
) {
    if let Some(weights) = weights {
        for l in 0..LANES {
            y[l] *= weights[l];
        }
    }
    for c in 0..C {
        let x = at(x[c]);
        for l in 0..LANES {
            sums[c][l] += y[l] * x[l];
        }
    }
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

/// [`add_combination`] for the part of the vectors that begins at `start` and is held in `y`.
fn add_combination_from(start: usize, c: &[f64], columns: &[Vec<f64>], y: &mut [f64]) {
    if y.len() <= CHUNK {
        return Arch::new().dispatch(|| {
            for (c, x) in c.chunks(AT_ONCE).zip(columns.chunks(AT_ONCE)) {
                let x = |j: usize| &x[j][start..];
                match *c {
                    [a] => add_group([a], [x(0)], y),
                    [a, b] => add_group([a, b], [x(0), x(1)], y),
                    [a, b, c] => add_group([a, b, c], [x(0), x(1), x(2)], y),
                    [a, b, c, d] => add_group([a, b, c, d], [x(0), x(1), x(2), x(3)], y),
                    _ => unreachable!("groups have one to {AT_ONCE} columns"),
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

/// y := y + sum_j c_j x_j, added one by one.
#[inline(always)]
fn add_group<const C: usize>(c: [f64; C], x: [&[f64]; C], y: &mut [f64]) {
    let mut columns = x;
    for j in 0..C {
        columns[j] = &x[j][..y.len()];
    }
    for (i, y) in y.iter_mut().enumerate() {
        for j in 0..C {
            *y += c[j] * columns[j][i];
        }
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

    /// Longer than one chunk, and a multiple neither of a chunk nor of a pack.
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
        assert_eq!(Weighted::new(w.clone()).dot(&x, &x), weighted as f64);
        let (columns, mut products) = (vec![x.clone(), w.clone(), x.clone()], vec![0.0; 3]);
        let norm = Weighted::new(w).dots(&columns, &x, &mut Vec::new(), &mut products);
        let cubes: u64 = (0..LENGTH as u64).map(|i| (i % 3).pow(2) * (i % 7)).sum();
        assert_eq!((products, norm), (vec![weighted as f64, cubes as f64, weighted as f64], (weighted as f64).sqrt()));
    }

    #[test]
    fn padding_of_weight_zero_does_not_count() {
        let inner_product = Weighted::new(vec![1.0, 0.0, 2.0]);
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
        let of = |length: usize, count: u8| {
            let x = scattered(length);
            let column = |j| x.iter().map(|x_i| (f64::from(j) * x_i).sin()).collect();
            let columns: Vec<Vec<f64>> = (1..=count).map(column).collect();
            (x, columns)
        };
        for (length, count) in [(1, 5), (7, 3), (CHUNK, 0), (CHUNK + 1, 4), (3 * CHUNK, 8), (LENGTH, 6)] {
            let (x, columns) = of(length, count);
            let mut products = vec![f64::NAN; columns.len()];
            Euclidean.dots(&columns, &x, &mut Vec::new(), &mut products);
            let single: Vec<f64> = columns.iter().map(|column| Euclidean.dot(column, &x)).collect();
            assert_eq!(bits(&products), bits(&single), "{length}");
            let weighted = Weighted::new(x.iter().map(|x_i| x_i.abs()).collect());
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
            let weighted = Weighted::new(x.iter().map(|x_i| x_i.abs()).collect());
            let mut numbers = vec![0.0; 2];
            let norm = weighted.dots(&columns, &y, &mut Vec::new(), &mut numbers);
            numbers.push(norm);
            numbers.push(weighted.add_combination_and_norm(&[0.1, 0.7], &columns, &mut y, &mut Vec::new()));
            numbers.extend([Euclidean.dot(&x, &y), weighted.norm(&y)]);
            (bits(&y), bits(&numbers))
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
