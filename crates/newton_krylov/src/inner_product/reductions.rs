//! Sums, maxima and minima over the mesh. All code that needs one uses these functions: the order is fixed, and a mesh that is distributed
//! over ranks needs messages here alone.

use super::tree_sum;
use ranks::Sums;

/// sum_i x_i, by the tree of the inner products. All other sums over the mesh use this function or [`sum_over_blocks`].
pub fn sum(x: &[f64]) -> f64 {
    tree_sum(0..x.len(), &|chunk| x[chunk].iter().sum())
}

/// The same over the blocks of all ranks. `x` has equally many entries for every cell of this rank; its blocks end at the cells `ends`.
/// A collective call.
pub fn sum_over_blocks(x: &[f64], ends: &[usize], sums: &Sums) -> f64 {
    let per_cell = x.len() / ends.last().copied().unwrap_or(0).max(1);
    let of_blocks: Vec<f64> = ends.windows(2).map(|ends| sum(&x[ends[0] * per_cell..ends[1] * per_cell])).collect();
    sums.total(&of_blocks, 1)[0]
}

/// The largest of the `values`, which all ranks have alike; -infinity without values. NaN is ignored.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The smallest of the `values`, which all ranks have alike; infinity without values. NaN is ignored.
pub fn smallest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// max_i |x_i| over the entries of all ranks; zero without entries. NaN is ignored. A collective call.
pub fn largest_size(x: &[f64], sums: &Sums) -> f64 {
    sums.largest(x.iter().fold(0.0, |size: f64, x_i| size.max(x_i.abs())))
}

/// The `values`, which all ranks have alike, combined from the first to the last; `None` without values. For results with more than one
/// number, such as a minimum and its location.
pub fn reduce<T>(values: impl IntoIterator<Item = T>, combine: impl FnMut(T, T) -> T) -> Option<T> {
    values.into_iter().reduce(combine)
}
