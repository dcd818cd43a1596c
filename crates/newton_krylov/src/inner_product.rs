//! Inner products, the reductions of a vector to a number, and the few vector operations of the solvers.
//!
//! A sum over a vector is a binary tree whose leaves are chunks of [`CHUNK`] entries. The tree depends only on the length, so the result
//! has the same bits for any number of threads. Where a vector is distributed over ranks, each [`Parts`] of it has a tree of its own, and
//! the bits do not depend on the number of ranks either.

mod columns;
mod reductions;

pub use columns::{AT_ONCE, Stored, add_combination_and_norm, dots};
pub(crate) use columns::{add_combination, store};
pub use reductions::{largest, largest_size, reduce, smallest, sum, sum_over_blocks};

use columns::dots_in_chunk;
use ranks::Sums;
use std::ops::Range;
use std::sync::Arc;

/// The number of entries that one thread sums or updates at a time.
pub const CHUNK: usize = 4096;

/// An inner product (x, y) of vectors, possibly with weights that make several fields comparable.
pub trait InnerProduct: Sync {
    /// w_i >= 0, one per entry of the vectors; None if all are one.
    fn weights(&self) -> Option<&[f64]> {
        None
    }

    /// How vectors are distributed over ranks; None where this rank has all of them.
    fn parts(&self) -> Option<&Parts> {
        None
    }

    /// (x, y) restricted to the entries of `range`. Both vectors are given in full.
    fn dot_on(&self, range: Range<usize>, x: &[f64], y: &[f64]) -> f64 {
        let of_part = |part: Range<usize>| {
            tree_sum(part, &|chunk| {
                let mut sum = [0.0];
                dots_in_chunk(self.weights(), chunk.start, &[&x[chunk.clone()]], &y[chunk], &mut sum);
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

impl InnerProduct for Euclidean {}

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

    fn weights(&self) -> Option<&[f64]> {
        Some(&self.weights)
    }
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

/// y := x
pub fn copy(x: &[f64], y: &mut [f64]) {
    update(x, y, &|x_i, _| x_i);
}

#[cfg(test)]
mod tests;
