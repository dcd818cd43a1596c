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

use super::blocks::{Block, BlockRows, add_block_product, add_block_vector, square_norm};
use newton_krylov::inner_product::{Euclidean, InnerProduct};

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
pub(crate) fn strong_neighbours<const R: usize>(matrix: &BlockRows<R, R>, theta: f64) -> Strong {
    let diagonal = |row: usize| matrix.row(row).find(|(column, _)| *column == row).map_or(0.0, |(_, b)| square_norm(b));
    let norms: Vec<f64> = (0..matrix.rows()).map(|row| diagonal(row).sqrt()).collect();
    let mut strong = Strong { starts: vec![0], nodes: Vec::new(), strengths: Vec::new() };
    for row in 0..matrix.rows() {
        for (column, block) in matrix.row(row).filter(|(column, _)| *column != row) {
            let strength = square_norm(block) / (norms[row] * norms[column]);
            if strength > theta * theta {
                strong.nodes.push(column as u32);
                strong.strengths.push(strength);
            }
        }
        strong.starts.push(strong.nodes.len());
    }
    strong
}

/// T and B_c by (tentative), for the modes `modes[node]` of the near-kernel, `[component][mode]`.
pub(crate) fn tentative<const R: usize, const B: usize>(
    aggregate: &[usize],
    count: usize,
    modes: &[Block<R, B>],
) -> (BlockRows<R, B>, Vec<Block<B, B>>) {
    let mut members = vec![Vec::new(); count];
    aggregate.iter().enumerate().for_each(|(node, &aggregate)| members[aggregate].push(node));
    let mut functions = modes.to_vec();
    let coarse = members.iter().map(|nodes| orthonormalise(nodes, &mut functions)).collect();
    let mut tentative = BlockRows::new();
    for (&aggregate, block) in aggregate.iter().zip(functions) {
        tentative.push_row([(aggregate as u32, block)]);
    }
    (tentative, coarse)
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

/// F by (filtered).
pub(crate) fn filtered<const R: usize>(matrix: &BlockRows<R, R>, strong: &Strong) -> BlockRows<R, R> {
    let mut filtered = BlockRows::new();
    for row in 0..matrix.rows() {
        let is_kept = |column: usize| column == row || strong.of(row).binary_search(&(column as u32)).is_ok();
        let mut diagonal = [[0.0; R]; R];
        for (_, block) in matrix.row(row).filter(|(column, _)| *column == row || !is_kept(*column)) {
            diagonal.as_flattened_mut().iter_mut().zip(block.as_flattened()).for_each(|(sum, entry)| *sum += entry);
        }
        let kept = matrix.row(row).filter(|(column, _)| is_kept(*column));
        filtered.push_row(kept.map(|(column, block)| (column as u32, if column == row { diagonal } else { *block })));
    }
    filtered
}

/// P by (smoothed), for the inverse blocks `inverses` of D, F in `matrix`, and `count` aggregates.
pub(crate) fn smoothed<const R: usize, const B: usize>(
    matrix: &BlockRows<R, R>,
    inverses: &[Block<R, R>],
    tentative: &BlockRows<R, B>,
    count: usize,
) -> BlockRows<R, B> {
    let damping = 4.0 / 3.0 / (SAFETY * largest_eigenvalue(matrix, inverses));
    let product = matrix.product(tentative, count);
    let mut prolongation = BlockRows::new();
    for row in 0..matrix.rows() {
        // A node is coupled with itself, so its aggregate is among those of the product.
        prolongation.push_row(product.row(row).map(|(column, block)| {
            let mut smoothed = [[0.0; B]; R];
            add_block_product(&inverses[row], block, &mut smoothed);
            smoothed.iter_mut().flatten().for_each(|entry| *entry *= -damping);
            let own = tentative.row(row).find(|(aggregate, _)| *aggregate == column);
            own.iter().for_each(|(_, own)| (0..R).for_each(|i| (0..B).for_each(|k| smoothed[i][k] += own[i][k])));
            (column as u32, smoothed)
        }));
    }
    prolongation
}

/// The largest eigenvalue of D^{-1} A by power iterations, from below.
fn largest_eigenvalue<const R: usize>(matrix: &BlockRows<R, R>, inverses: &[Block<R, R>]) -> f64 {
    // Any vector without symmetry works, if it is the same in every run.
    let entry = |node: usize, i: usize| ((node * R + i) as f64 * 0.754_877_666).fract() - 0.5;
    let mut x: Vec<[f64; R]> = (0..matrix.rows()).map(|node| std::array::from_fn(|i| entry(node, i))).collect();
    let mut eigenvalue = 1.0;
    for _ in 0..POWER_ITERATIONS {
        let norm = Euclidean.norm(x.as_flattened());
        x.as_flattened_mut().iter_mut().for_each(|x| *x /= norm);
        let mut product = vec![[0.0; R]; x.len()];
        matrix.add_product(1.0, &x, &mut product);
        for ((x, product), inverse) in x.iter_mut().zip(&product).zip(inverses) {
            *x = [0.0; R];
            add_block_vector(inverse, product, x);
        }
        eigenvalue = Euclidean.norm(x.as_flattened());
    }
    eigenvalue
}
