//! Inverses of dense blocks in single precision, in place.
//!
//! Gauss-Jordan elimination with pivots from the rows below, columns K at a time. These become a panel P, and every other
//! column y follows by one product:
//!
//! ```text
//! P_K = A_KK^{-1},   P_i = -A_iK A_KK^{-1} elsewhere,     y := (y with 0 in place of y_K) + P y_K                   (gauss-jordan)
//! ```
//!
//! A complex matrix is stored as its parts, `[column][part][padded row]`, and multiplied as the real matrix
//! [re, -im; im, re].

use super::panel::{Multiply, Panels, padded};
use basis::is_real;
use faer::c64;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// Columns that are eliminated before the others follow.
const COLUMNS: usize = 16;

/// A square matrix of order `n` with `parts` = 1 if real, 2 if complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// The order.
    pub n: usize,
    /// 1 or 2.
    pub parts: usize,
}

impl Shape {
    /// Of a block of order `n` that is shifted by `shift`.
    pub fn shifted(n: usize, shift: c64) -> Self {
        Shape { n, parts: if is_real(shift) { 1 } else { 2 } }
    }
    /// Numbers per column.
    pub fn stride(self) -> usize {
        self.parts * padded(self.n)
    }
    /// Numbers in all.
    pub fn len(self) -> usize {
        self.n * self.stride()
    }
}

/// A := A^{-1} for A of `shape`.
pub fn invert(arch: Arch, shape: Shape, a: &mut [f32]) {
    let (n, stride) = (shape.n, shape.stride());
    let mut pivots = vec![0; n];
    for start in (0..n).step_by(COLUMNS) {
        let end = (start + COLUMNS).min(n);
        let pivots = &mut pivots[start..end];
        arch.dispatch(Eliminate { panel: &mut a[start * stride..end * stride], shape, start, pivots });
        let y_k = take_rows(shape, start, pivots, a);
        let panel = as_real(shape, &a[start * stride..end * stride]);
        arch.dispatch(Multiply { matrix: &panel, rows: stride, columns: n, x: &y_k, y: a });
    }
    // Rows were swapped first, columns are swapped back last.
    for (k, &pivot) in pivots.iter().enumerate().rev().filter(|(k, pivot)| k != *pivot) {
        let (before, after) = a.split_at_mut(pivot * stride);
        before[k * stride..(k + 1) * stride].swap_with_slice(&mut after[..stride]);
    }
}

/// Brings the pivots of the columns from `start` on into place in all other columns, takes y_K out of these and leaves 0; 0 for the
/// columns themselves. `[column][part][K]`.
fn take_rows(shape: Shape, start: usize, pivots: &[usize], a: &mut [f32]) -> Vec<f32> {
    let (count, rows) = (pivots.len(), padded(shape.n));
    let swaps: Vec<_> = (start..).zip(pivots.iter().copied()).filter(|(row, pivot)| row != pivot).collect();
    let mut taken = vec![0.0; shape.n * shape.parts * count];
    let columns = a.chunks_exact_mut(shape.stride()).zip(taken.chunks_exact_mut(shape.parts * count)).enumerate();
    for (_, (column, taken)) in columns.filter(|(j, _)| !(start..start + count).contains(j)) {
        for (part, taken) in column.chunks_exact_mut(rows).zip(taken.chunks_exact_mut(count)) {
            swaps.iter().for_each(|&(row, pivot)| part.swap(row, pivot));
            taken.copy_from_slice(&part[start..start + count]);
            part[start..start + count].fill(0.0);
        }
    }
    taken
}

/// The columns of `panel` as a real matrix: parts of rows by parts of columns.
pub fn as_real(shape: Shape, panel: &[f32]) -> Vec<f32> {
    let (stride, rows) = (shape.stride(), padded(shape.n));
    let count = panel.len() / stride;
    let panels = Panels { rows: stride, columns: shape.parts * count };
    let mut real = vec![0.0; panels.len()];
    let mut turned = vec![0.0; stride];
    for (j, column) in panel.chunks_exact(stride).enumerate() {
        panels.put(&mut real, j, column);
        if shape.parts == 2 {
            // i (re + i im) = - im + i re
            turned[rows..].copy_from_slice(&column[..rows]);
            turned[..rows].iter_mut().zip(&column[rows..]).for_each(|(turned, im)| *turned = -im);
            panels.put(&mut real, count + j, &turned);
        }
    }
    real
}

/// The elimination of the columns of a panel by each other: P of (gauss-jordan).
struct Eliminate<'a> {
    panel: &'a mut [f32],
    shape: Shape,
    start: usize,
    pivots: &'a mut [usize],
}

impl WithSimd for Eliminate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Eliminate { panel, shape, start, pivots } = self;
        for q in 0..pivots.len() {
            pivots[q] = swap_in_pivot(panel, shape, q, start + q);
            if shape.parts == 1 {
                eliminate_real(panel, shape.stride(), q, start + q);
            } else {
                eliminate_complex(panel, shape.stride(), q, start + q);
            }
        }
    }
}

/// Swaps row `p` with the one, from there on, where column `q` is largest; returns that row.
#[inline(always)]
fn swap_in_pivot(panel: &mut [f32], shape: Shape, q: usize, p: usize) -> usize {
    let (stride, rows) = (shape.stride(), padded(shape.n));
    let column = &panel[q * stride..(q + 1) * stride];
    // Squares of entries far from 1 leave the range of numbers.
    let mut entries = column[p..shape.n].iter().map(|a| a.abs()).fold(0.0, f32::max);
    if shape.parts == 2 {
        entries = column[rows + p..rows + shape.n].iter().map(|a| a.abs()).fold(entries, f32::max);
    }
    let unit = reciprocal_power(entries);
    let (mut pivot, mut largest) = (p, -1.0);
    for i in p..shape.n {
        let mut square = (column[i] * unit).powi(2);
        if shape.parts == 2 {
            square += (column[rows + i] * unit).powi(2);
        }
        if square > largest {
            (pivot, largest) = (i, square);
        }
    }
    if pivot != p {
        for part in panel.chunks_exact_mut(rows) {
            part.swap(p, pivot);
        }
    }
    pivot
}

/// 2^-e for `x` from 2^e to 2^(e + 1), within the range of normal numbers: products with it are exact.
#[inline(always)]
fn reciprocal_power(x: f32) -> f32 {
    match (x.to_bits() >> 23) & 0xff {
        0 | 0xff => 1.0,
        exponent => f32::from_bits((254 - exponent).max(1) << 23),
    }
}

/// One step with the pivot in row `p` of column `q`: the column becomes 1/d there and -a/d elsewhere, the others follow.
#[inline(always)]
fn eliminate_real(panel: &mut [f32], stride: usize, q: usize, p: usize) {
    let (before, rest) = panel.split_at_mut(q * stride);
    let (column, after) = rest.split_at_mut(stride);
    let inverse = 1.0 / column[p];
    column[p] = -1.0;
    for a in column.iter_mut() {
        *a *= -inverse;
    }
    for others in [before, after] {
        for y in others.chunks_exact_mut(stride) {
            let factor = y[p];
            y[p] = 0.0;
            for i in 0..stride {
                y[i] += factor * column[i];
            }
        }
    }
}

/// [`eliminate_real`] for columns `[part][row]`.
#[inline(always)]
fn eliminate_complex(panel: &mut [f32], stride: usize, q: usize, p: usize) {
    let (before, rest) = panel.split_at_mut(q * stride);
    let (column, after) = rest.split_at_mut(stride);
    let (re, im) = column.split_at_mut(stride / 2);
    let unit = reciprocal_power(re[p].abs().max(im[p].abs()));
    let d = (re[p] * unit, im[p] * unit);
    let size = d.0 * d.0 + d.1 * d.1;
    let inverse = (d.0 / size * unit, -d.1 / size * unit);
    (re[p], im[p]) = (-1.0, 0.0);
    for i in 0..re.len() {
        (re[i], im[i]) = (-(re[i] * inverse.0 - im[i] * inverse.1), -(re[i] * inverse.1 + im[i] * inverse.0));
    }
    for others in [before, after] {
        for y in others.chunks_exact_mut(stride) {
            let (y_re, y_im) = y.split_at_mut(stride / 2);
            let factor = (y_re[p], y_im[p]);
            (y_re[p], y_im[p]) = (0.0, 0.0);
            for i in 0..re.len() {
                y_re[i] += factor.0 * re[i] - factor.1 * im[i];
                y_im[i] += factor.0 * im[i] + factor.1 * re[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries in [-1, 1], larger by `shift` on the diagonal of the first part.
    fn matrix(shape: Shape, shift: f32) -> Vec<f32> {
        let mut a = vec![0.0; shape.len()];
        for (j, column) in a.chunks_exact_mut(shape.stride()).enumerate() {
            for (p, part) in column.chunks_exact_mut(padded(shape.n)).enumerate() {
                (0..shape.n)
                    .for_each(|i| part[i] = ((7 * i * i + 13 * j * j + 5 * i * j + 3 * p) % 101) as f32 / 50.0 - 1.0);
            }
            column[j] += shift;
        }
        a
    }

    /// The largest entry of A B - I.
    fn deviation(shape: Shape, a: &[f32], b: &[f32]) -> f32 {
        let (n, rows) = (shape.n, padded(shape.n));
        let entry = |m: &[f32], i: usize, j: usize| -> faer::c32 {
            let column = &m[j * shape.stride()..];
            faer::c32::new(column[i], if shape.parts == 2 { column[rows + i] } else { 0.0 })
        };
        let product = |i, j| (0..n).map(|k| entry(a, i, k) * entry(b, k, j)).sum::<faer::c32>();
        let error = |i, j| (product(i, j) - if i == j { 1.0 } else { 0.0 }).norm();
        (0..n * n).map(|k| error(k / n, k % n)).fold(0.0, f32::max)
    }

    #[test]
    fn blocks_of_any_order_are_inverted_with_and_without_a_large_diagonal() {
        for parts in [1, 2] {
            for (n, shift, bar) in
                [(1, 3.0, 1e-6), (16, 0.0, 1e-3), (20, 9.0, 1e-5), (37, 0.0, 1e-3), (100, 30.0, 1e-5)]
            {
                let shape = Shape { n, parts };
                let a = matrix(shape, shift);
                let mut inverse = a.clone();
                invert(Arch::new(), shape, &mut inverse);
                let error = deviation(shape, &a, &inverse);
                assert!(error < bar, "order {n}, {parts} parts: {error:e}");
            }
        }
    }

    /// Squares of the entries left the range of single precision: in steady flows of long lengths, pivots were no longer chosen.
    #[test]
    fn blocks_far_from_one_have_the_same_inverses() {
        for parts in [1, 2] {
            let shape = Shape { n: 37, parts };
            let a = matrix(shape, 0.0);
            let inverse_of = |scale: f32| {
                let mut inverse: Vec<f32> = a.iter().map(|a| a * scale).collect();
                invert(Arch::new(), shape, &mut inverse);
                inverse.iter().map(|x| (x * scale).to_bits()).collect::<Vec<_>>()
            };
            for exponent in [-90, 90] {
                assert_eq!(inverse_of(2.0_f32.powi(exponent)), inverse_of(1.0), "{parts} parts, 2^{exponent}");
            }
        }
    }

    #[test]
    fn a_zero_in_the_place_of_the_first_pivot_is_swapped_away() {
        let shape = Shape { n: 2, parts: 1 };
        let mut a = vec![0.0; shape.len()];
        // [0, 2; 4, 0]
        (a[1], a[shape.stride()]) = (4.0, 2.0);
        invert(Arch::new(), shape, &mut a);
        assert_eq!((a[0], a[1], a[shape.stride()], a[shape.stride() + 1]), (0.0, 0.5, 0.25, 0.0));
    }
}
