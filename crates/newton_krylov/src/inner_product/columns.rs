//! Columns: many vectors that an inner product or an update reads at once, stored in single or double precision.

use super::{CHUNK, Chunks, InnerProduct, middle};
use rayon::prelude::*;
use tensor::Arch;

/// The number of partial sums within a chunk. They are independent, so that they vectorise.
const LANES: usize = 8;

/// The number of columns that are read at the same time: several streams give more memory bandwidth than one.
pub const AT_ONCE: usize = 4;

/// The numbers of a stored column. Sums over them are in double precision.
pub trait Stored: Copy + Default + Send + Sync + Into<f64> {
    /// The distance from one to the next number.
    const EPSILON: f64;

    /// The nearest number.
    fn nearest(x: f64) -> Self;
}

impl Stored for f64 {
    const EPSILON: f64 = f64::EPSILON;

    fn nearest(x: f64) -> Self {
        x
    }
}

impl Stored for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;

    fn nearest(x: f64) -> Self {
        x as f32
    }
}

/// column := y, and y := the column, which differs if it is stored in less than double precision.
pub(crate) fn store<S: Stored>(y: &mut [f64], column: &mut [S]) {
    y.par_chunks_mut(CHUNK).zip(column.par_chunks_mut(CHUNK)).for_each(|(y, column)| {
        for (y, stored) in y.iter_mut().zip(column) {
            *stored = S::nearest(*y);
            *y = (*stored).into();
        }
    });
}

/// products_j := (x_j, y) for as many columns x_j as there are products, with the bits of [`InnerProduct::dot`]; returns |y|. y is read
/// once for all of them. `partial` holds the sums of the chunks.
pub fn dots<S: Stored>(
    inner_product: &(impl InnerProduct + ?Sized),
    columns: &[Vec<S>],
    y: &[f64],
    partial: &mut Vec<f64>,
    products: &mut [f64],
) -> f64 {
    let (count, chunks) = (products.len(), Chunks { parts: inner_product.parts(), len: y.len() });
    let weights = inner_product.weights();
    partial.resize((count + 1) * chunks.count(), 0.0);
    partial.par_chunks_mut(count + 1).enumerate().for_each(|(chunk, partial)| {
        let range = chunks.range(chunk);
        let (groups, y) = (columns[..count].chunks(AT_ONCE), &y[range.clone()]);
        for (columns, partial) in groups.zip(partial.chunks_mut(AT_ONCE)) {
            let mut x: [&[S]; AT_ONCE] = [&[]; AT_ONCE];
            x.iter_mut().zip(columns).for_each(|(x, column)| *x = &column[range.clone()]);
            dots_in_chunk(weights, range.start, &x[..columns.len()], y, &mut partial[..columns.len()]);
        }
        dots_in_chunk(weights, range.start, &[y], y, &mut partial[count..]);
    });
    let mut square = 0.0;
    chunks.totals(partial, count + 1, |j, sum| if j < count { products[j] = sum } else { square = sum });
    square.sqrt()
}

/// y := y + sum_j c_j x_j for as many columns x_j as there are coefficients; returns |y|. y is read once for both.
pub fn add_combination_and_norm<S: Stored>(
    inner_product: &(impl InnerProduct + ?Sized),
    c: &[f64],
    columns: &[Vec<S>],
    y: &mut [f64],
    partial: &mut Vec<f64>,
) -> f64 {
    let chunks = Chunks { parts: inner_product.parts(), len: y.len() };
    partial.resize(chunks.count(), 0.0);
    let update = |(chunk, (y, square)): (usize, (&mut [f64], &mut f64))| {
        let start = chunks.range(chunk).start;
        add_combination_from(start, c, columns, y);
        dots_in_chunk(inner_product.weights(), start, &[&*y], y, std::slice::from_mut(square));
    };
    match inner_product.parts() {
        None => y.par_chunks_mut(CHUNK).zip(&mut *partial).enumerate().for_each(update),
        Some(_) => chunks.split(y).into_par_iter().zip(&mut *partial).enumerate().for_each(update),
    }
    let mut square = 0.0;
    chunks.totals(partial, 1, |_, sum| square = sum);
    square.sqrt()
}

/// sums_j := sum_i w_i x_ij y_i for parts of one to [`AT_ONCE`] vectors that begin at entry `start` and are as long as y, at most a chunk.
/// Without weights all w_i are one.
pub(super) fn dots_in_chunk<S: Stored>(weights: Option<&[f64]>, start: usize, x: &[&[S]], y: &[f64], sums: &mut [f64]) {
    let weights = weights.map(|weights| &weights[start..start + y.len()]);
    Arch::new().dispatch(|| chunk_dots(weights, x, y, sums));
}

/// [`dots_in_chunk`] for weights of the chunk.
#[inline(always)]
fn chunk_dots<S: Stored>(weights: Option<&[f64]>, x: &[&[S]], y: &[f64], sums: &mut [f64]) {
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
fn group_dots<const C: usize, S: Stored>(weights: Option<&[f64]>, x: [&[S]; C], y: &[f64]) -> [f64; C] {
    let whole = y.len() / LANES;
    let mut sums = [[0.0; LANES]; C];
    for pack in 0..whole {
        add_products(weights.map(|w| at(w, pack)), x.map(|x| at(x, pack)), at(y, pack), &mut sums);
    }
    if whole * LANES < y.len() {
        let start = whole * LANES;
        add_products(weights.map(|w| rest(w, start)), x.map(|x| rest(x, start)), rest(y, start), &mut sums);
    }
    let mut totals = [0.0; C];
    for c in 0..C {
        totals[c] = sums[c].iter().sum();
    }
    totals
}

/// A pack of a vector, in double precision.
#[inline(always)]
fn at<S: Stored>(vector: &[S], pack: usize) -> [f64; LANES] {
    let mut numbers = [S::default(); LANES];
    numbers.copy_from_slice(&vector[pack * LANES..(pack + 1) * LANES]);
    numbers.map(Into::into)
}

/// The entries from `start` on, fewer than a pack, and zeros.
#[inline(always)]
fn rest<S: Stored>(vector: &[S], start: usize) -> [f64; LANES] {
    let (mut numbers, rest) = ([S::default(); LANES], &vector[start..]);
    numbers[..rest.len()].copy_from_slice(rest);
    numbers.map(Into::into)
}

/// sums_c += w y x_c for one pack.
#[inline(always)]
fn add_products<const C: usize>(
    weights: Option<[f64; LANES]>,
    x: [[f64; LANES]; C],
    mut y: [f64; LANES],
    sums: &mut [[f64; LANES]; C],
) {
    if let Some(weights) = weights {
        for l in 0..LANES {
            y[l] *= weights[l];
        }
    }
    for c in 0..C {
        for l in 0..LANES {
            sums[c][l] += y[l] * x[c][l];
        }
    }
}

/// y := y + sum_j c_j x_j, for as many columns x_j as there are coefficients.
pub(crate) fn add_combination<S: Stored>(c: &[f64], columns: &[Vec<S>], y: &mut [f64]) {
    add_combination_from(0, c, columns, y);
}

/// [`add_combination`] for the part of the vectors that begins at `start` and is held in `y`.
fn add_combination_from<S: Stored>(start: usize, c: &[f64], columns: &[Vec<S>], y: &mut [f64]) {
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
fn add_group<const C: usize, S: Stored>(c: [f64; C], x: [&[S]; C], y: &mut [f64]) {
    let mut columns = x;
    for j in 0..C {
        columns[j] = &x[j][..y.len()];
    }
    for (i, y) in y.iter_mut().enumerate() {
        for j in 0..C {
            *y += c[j] * columns[j][i].into();
        }
    }
}
