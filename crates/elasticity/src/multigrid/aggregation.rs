//! Coarse spaces by smoothed aggregation (Vanek, Mandel & Brezina 1996).
//!
//! Nodes that are strongly coupled form aggregates. On an aggregate the coarse functions are the orthonormalised modes of the
//! near-kernel. With the modes B of its nodes,
//!
//! ```text
//! B = T B_c,     T^T T = I                                                                                 (tentative)
//! P = (I - omega / lambda D^{-1} F) T,     omega = 4 / 3,     lambda = largest eigenvalue of D^{-1} F          (smoothed)
//! F_ij = A_ij where i and j are strongly coupled,     F_ii = A_ii + sum of the other A_ij                       (filtered)
//! ```
//!
//! B_c are the modes of the next level. Smoothing reduces the energy at the edges of aggregates. With F in place of A functions do not
//! spread along weak couplings, so that coarse levels stay sparse where cells are thin.

use super::blocks::{Block, add_block_product, add_block_vector, square_norm};
use super::matrix::BlockRows;
use super::prolongation::{Prolongation, entry_of};
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use rayon::prelude::*;

/// A few power iterations underestimate the largest eigenvalue of D^{-1} A by less than this factor.
const SAFETY: f64 = 1.1;
const POWER_ITERATIONS: usize = 12;

/// A mode is dropped on an aggregate if less than this fraction of its norm is independent of the other modes.
const INDEPENDENT: f64 = 1e-9;

/// The aggregate of every node, and their number.
pub(crate) fn aggregates(strong: &Strong) -> (Vec<usize>, usize) {
    let rows = strong.starts.len() - 1;
    let mut aggregate = vec![None; rows];
    let mut count = 0;
    // A node without an aggregated neighbour starts an aggregate with all its neighbours.
    for node in 0..rows {
        let neighbours = strong.of(node);
        if aggregate[node].is_none() && neighbours.iter().all(|&other| aggregate[other as usize].is_none()) {
            aggregate[node] = Some(count);
            neighbours.iter().for_each(|&other| aggregate[other as usize] = Some(count));
            count += 1;
        }
    }
    // The others join the neighbour with the strongest coupling.
    let first = aggregate.clone();
    for node in (0..rows).filter(|&node| first[node].is_none()) {
        let couplings = strong.of(node).iter().zip(strong.strengths(node));
        let joined = couplings.filter_map(|(&other, strength)| first[other as usize].map(|joined| (strength, joined)));
        aggregate[node] = joined.max_by(|a, b| a.0.total_cmp(b.0)).map(|(_, joined)| joined);
    }
    // The remaining nodes have only neighbours without an aggregate.
    for node in 0..rows {
        if aggregate[node].is_none() {
            aggregate[node] = Some(count);
            let left = strong.of(node).iter().map(|&other| other as usize);
            left.for_each(|other| aggregate[other] = aggregate[other].or(Some(count)));
            count += 1;
        }
    }
    (aggregate.into_iter().flatten().collect(), count)
}

/// The strongly coupled neighbours of each node, and the strength.
pub(crate) struct Strong {
    starts: Vec<usize>,
    nodes: Vec<u32>,
    strengths: Vec<f64>,
}

impl Strong {
    fn of(&self, node: usize) -> &[u32] {
        &self.nodes[self.starts[node]..self.starts[node + 1]]
    }
    fn strengths(&self, node: usize) -> &[f64] {
        &self.strengths[self.starts[node]..self.starts[node + 1]]
    }
}

/// Nodes i and j are strongly coupled if |A_ij| > theta sqrt(|A_ii| |A_jj|).
pub(crate) fn strong_neighbours<const R: usize>(matrix: &BlockRows<R>, theta: f64) -> Strong {
    let norms: Vec<f64> = (0..matrix.rows()).map(|row| square_norm(&matrix.diagonal(row)).sqrt()).collect();
    let mut strong = Strong { starts: vec![0], nodes: Vec::new(), strengths: Vec::new() };
    for row in 0..matrix.rows() {
        for (column, block) in matrix.row(row).filter(|(column, _)| *column != row) {
            let strength = square_norm(&block) / (norms[row] * norms[column]);
            if strength > theta * theta {
                strong.nodes.push(column as u32);
                strong.strengths.push(strength);
            }
        }
        strong.starts.push(strong.nodes.len());
    }
    strong
}

/// T and B_c by (tentative), for the modes `modes[node]` of the near-kernel, `[component][mode]`. T has one block per node, in the column of
/// its aggregate.
pub(crate) fn tentative<const R: usize, const B: usize>(
    aggregate: &[usize],
    count: usize,
    mut modes: Vec<Block<R, B>>,
) -> (Vec<Block<R, B>>, Vec<Block<B, B>>) {
    let mut members = vec![Vec::new(); count];
    aggregate.iter().enumerate().for_each(|(node, &aggregate)| members[aggregate].push(node));
    let coarse = members.iter().map(|nodes| orthonormalise(nodes, &mut modes)).collect();
    (modes, coarse)
}

/// Makes the columns of `functions` at `nodes` orthonormal by Gram-Schmidt, every column twice; returns the triangular factor. A
/// column that depends on earlier ones becomes zero: an aggregate of one node has no rotations.
fn orthonormalise<const R: usize, const B: usize>(nodes: &[usize], functions: &mut [Block<R, B>]) -> Block<B, B> {
    let mut factor = [[0.0; B]; B];
    let product = |functions: &[Block<R, B>], a: usize, b: usize| -> f64 {
        nodes.iter().map(|&node| functions[node].iter().map(|row| row[a] * row[b]).sum::<f64>()).sum()
    };
    for b in 0..B {
        let whole = product(functions, b, b).sqrt();
        for a in (0..b).chain(0..b) {
            let part = product(functions, a, b);
            factor[a][b] += part;
            nodes.iter().for_each(|&node| functions[node].iter_mut().for_each(|row| row[b] -= part * row[a]));
        }
        let norm = product(functions, b, b).sqrt();
        let is_independent = norm > INDEPENDENT * whole;
        factor[b][b] = if is_independent { norm } else { 0.0 };
        let scale = if is_independent { 1.0 / norm } else { 0.0 };
        nodes.iter().for_each(|&node| functions[node].iter_mut().for_each(|row| row[b] *= scale));
    }
    factor
}

/// F by (filtered), or A itself without strong neighbours.
pub(crate) struct Filtered<'a, const R: usize> {
    pub(crate) matrix: &'a BlockRows<R>,
    pub(crate) strong: Option<&'a Strong>,
}

impl<const R: usize> Filtered<'_, R> {
    /// Visits the columns and blocks of a row.
    fn visit(&self, row: usize, mut visit: impl FnMut(usize, &Block<R, R>)) {
        let Some(strong) = self.strong else {
            return self.matrix.row(row).for_each(|(column, block)| visit(column, &block));
        };
        let mut diagonal = [[0.0; R]; R];
        for (column, block) in self.matrix.row(row) {
            if column != row && strong.of(row).binary_search(&(column as u32)).is_ok() {
                visit(column, &block);
            } else {
                diagonal.as_flattened_mut().iter_mut().zip(block.as_flattened()).for_each(|(sum, entry)| *sum += entry);
            }
        }
        visit(row, &diagonal);
    }
}

/// P by (smoothed), for the inverse blocks `inverses` of D and the blocks `tentative` of T.
pub(crate) fn smoothed<const R: usize, const B: usize>(
    filtered: &Filtered<'_, R>,
    inverses: &[Block<R, R>],
    aggregate: &[usize],
    tentative: &[Block<R, B>],
) -> Prolongation<R, B> {
    let damping = 4.0 / 3.0 / (SAFETY * largest_eigenvalue(filtered, inverses));
    let (mut rows, mut products, mut row) = (Prolongation::new(), Vec::new(), Vec::new());
    for (node, inverse) in inverses.iter().enumerate() {
        products.clear();
        filtered.visit(node, |column, block| {
            add_block_product(block, &tentative[column], entry_of(&mut products, aggregate[column]));
        });
        row.clear();
        *entry_of(&mut row, aggregate[node]) = tentative[node];
        let damped = inverse.map(|entries| entries.map(|entry| -damping * entry));
        products.iter().for_each(|(column, product)| add_block_product(&damped, product, entry_of(&mut row, *column)));
        rows.push(row.iter().copied());
    }
    rows
}

/// The largest eigenvalue of D^{-1} F by power iterations, from below.
fn largest_eigenvalue<const R: usize>(filtered: &Filtered<'_, R>, inverses: &[Block<R, R>]) -> f64 {
    // Any vector without symmetry works, if it is the same in every run.
    let entry = |node: usize, i: usize| ((node * R + i) as f64 * 0.754_877_666).fract() - 0.5;
    let mut x: Vec<[f64; R]> = (0..inverses.len()).map(|node| std::array::from_fn(|i| entry(node, i))).collect();
    let mut eigenvalue = 1.0;
    for _ in 0..POWER_ITERATIONS {
        let norm = Euclidean.norm(x.as_flattened());
        x.as_flattened_mut().iter_mut().for_each(|x| *x /= norm);
        let product = |(row, inverse): (usize, &Block<R, R>)| {
            let (mut sum, mut product) = ([0.0; R], [0.0; R]);
            filtered.visit(row, |column, block| add_block_vector(block, &x[column], &mut sum));
            add_block_vector(inverse, &sum, &mut product);
            product
        };
        x = inverses.par_iter().with_min_len(64).enumerate().map(product).collect();
        eigenvalue = Euclidean.norm(x.as_flattened());
    }
    eigenvalue
}
