//! The order of elimination: minimum discarded fill (Persson & Peraire 2008).
//!
//! Eliminating cell k would create the fill A_ik A_kk^{-1} A_kj between its remaining neighbours i and j, which ILU(0)
//! discards; the cell whose fill is least comes next.

use super::blocks::{Link, coupling_block, diagonal_block};
use faer::linalg::solvers::DenseSolveCore;
use fem::SpaceJacobian;
use rayon::prelude::*;

/// The cells in the order of elimination, and the ranges of positions that do not depend on each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ordering {
    /// The cell at each position.
    pub cells: Vec<usize>,
    /// The position of each cell.
    pub positions: Vec<usize>,
    /// Ends of the levels: cells of one level have no links to each other and only to earlier ones of those that precede.
    pub level_ends: Vec<usize>,
}

impl Ordering {
    /// That of a preconditioner that eliminates no cell.
    pub fn none() -> Self {
        Ordering { cells: Vec::new(), positions: Vec::new(), level_ends: vec![0] }
    }

    /// Cells of the widest level: no more of them can be worked on at a time.
    pub fn widest_level(&self) -> usize {
        let starts = std::iter::once(0).chain(self.level_ends.iter().copied());
        starts.zip(&self.level_ends).map(|(start, end)| end - start).max().unwrap_or(0)
    }
}

/// The order for lambda M + dt A with one real lambda.
pub fn minimum_discarded_fill(jacobian: &SpaceJacobian, links: &[Vec<Link>], dt: f64, lambda: f64) -> Ordering {
    let strengths: Vec<Vec<f64>> =
        (0..links.len()).into_par_iter().map(|cell| strengths(jacobian, &links[cell], cell, dt, lambda)).collect();
    minimum_discarded_fill_of(links, &strengths)
}

/// The order by the strength |A_ii^{-1} A_ik| of every link of cell i.
pub fn minimum_discarded_fill_of(links: &[Vec<Link>], strengths: &[Vec<f64>]) -> Ordering {
    by_level(&eliminate(links, strengths), links)
}

/// |A_ii^{-1} A_ik| in the Frobenius norm for every link of cell i, up to the norm of a trace.
fn strengths(jacobian: &SpaceJacobian, links: &[Link], cell: usize, dt: f64, lambda: f64) -> Vec<f64> {
    let inverse = diagonal_block(jacobian, cell, dt, lambda).partial_piv_lu().inverse();
    let (n, t) = (jacobian.block, jacobian.traces.len());
    let norm = |link: &Link| {
        let b = coupling_block(jacobian, *link);
        let mut lifted = vec![0.0; n * t];
        for (lifted, b) in lifted.chunks_exact_mut(n).zip(b.chunks_exact(t)) {
            for (row, b) in b.iter().enumerate() {
                let (offset, functional) = jacobian.traces.functional(link.face, row);
                functional.iter().for_each(|&(node, weight)| lifted[offset + node] += dt * weight * b);
            }
        }
        let lifted = faer::MatRef::from_column_major_slice(&lifted, n, t);
        (&inverse * lifted).norm_l2()
    };
    links.iter().map(norm).collect()
}

/// Takes the cell of least discarded fill again and again; the lower number where two are equal.
fn eliminate(links: &[Vec<Link>], strengths: &[Vec<f64>]) -> Vec<usize> {
    let mut gone = vec![false; links.len()];
    // C_ik is stored with cell i; seen from k it is found among the links of i that lead back across the same facet.
    let towards = |from: usize, link: &Link| -> f64 {
        let back = links[link.cell].iter().position(|l| l.coupling == link.coupling && l.cell == from);
        back.map_or(0.0, |number| strengths[link.cell][number])
    };
    let weight = |k: usize, gone: &[bool]| -> f64 {
        let alive = || links[k].iter().enumerate().filter(|(_, link)| !gone[link.cell]);
        alive()
            .flat_map(|(a, i)| alive().filter(move |(b, _)| *b != a).map(move |(b, _)| (i, b)))
            .map(|(i, b)| (towards(k, i) * strengths[k][b]).powi(2))
            // A sum of nothing is -0, of which the bits are not those of the least number.
            .fold(0.0, |sum, fill| sum + fill)
    };
    let mut weights: Vec<f64> = (0..links.len()).map(|k| weight(k, &gone)).collect();
    let mut queue: std::collections::BTreeSet<(u64, usize)> =
        weights.iter().enumerate().map(|(k, w)| (w.to_bits(), k)).collect();
    let mut order = Vec::with_capacity(links.len());
    while let Some((_, k)) = queue.pop_first() {
        gone[k] = true;
        order.push(k);
        for link in links[k].iter().filter(|link| !gone[link.cell]) {
            queue.remove(&(weights[link.cell].to_bits(), link.cell));
            weights[link.cell] = weight(link.cell, &gone);
            queue.insert((weights[link.cell].to_bits(), link.cell));
        }
    }
    order
}

/// The position of each entry of an order.
fn inverse(order: &[usize]) -> Vec<usize> {
    let mut positions = vec![0; order.len()];
    order.iter().enumerate().for_each(|(position, &entry)| positions[entry] = position);
    positions
}

/// Sorts positions into levels: the factor is the same for every order that keeps each pair of neighbours in theirs.
fn by_level(order: &[usize], links: &[Vec<Link>]) -> Ordering {
    let rank = inverse(order);
    let mut level = vec![0_usize; order.len()];
    for &cell in order {
        let before = links[cell].iter().filter(|link| rank[link.cell] < rank[cell]);
        level[cell] = before.map(|link| level[link.cell] + 1).max().unwrap_or(0);
    }
    let mut cells = order.to_vec();
    cells.sort_by_key(|&cell| level[cell]);
    let positions = inverse(&cells);
    let levels = level.iter().max().map_or(0, |max| max + 1);
    let level_ends = (0..levels).map(|l| cells.partition_point(|&cell| level[cell] <= l)).collect();
    Ordering { cells, positions, level_ends }
}
