//! The order of elimination: minimum discarded fill (Persson & Peraire 2008).
//!
//! Eliminating cell k would create the fill A_ik A_kk^{-1} A_kj between its remaining neighbours i and j, which ILU(0)
//! discards; the cell whose fill is least comes next.
//!
//! Where the mesh is cut into blocks, inner cells of all blocks come first, then the cells at cuts, colour by colour. Cells of one colour in
//! different blocks are not neighbours. So all blocks work at the same time, and a sweep sends one message per colour.

use super::blocks::{Link, coupling_block, diagonal_block};
use faer::linalg::solvers::DenseSolveCore;
use fem::{Share, SpaceJacobian};
use rayon::prelude::*;
use std::ops::Range;

/// The cells in the order of elimination, and the ranges of positions that do not depend on each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ordering {
    /// The cell at each position, own cells and ghosts.
    pub cells: Vec<usize>,
    /// The position of each cell.
    pub positions: Vec<usize>,
    /// Ends of the levels of own cells: cells of one level have no links to each other and only to earlier ones of those that precede.
    pub level_ends: Vec<usize>,
    /// The stages, in the order of elimination.
    pub stages: Vec<Stage>,
}

/// The positions of cells that all blocks eliminate at the same time: inner cells, or cells at cuts of one colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Own cells.
    pub own: Range<usize>,
    /// Ghosts, which follow them.
    pub ghosts: Range<usize>,
}

impl Ordering {
    /// That of a preconditioner that eliminates no cell.
    pub fn none() -> Self {
        Ordering { cells: Vec::new(), positions: Vec::new(), level_ends: vec![0], stages: Vec::new() }
    }

    /// The own cells of a rank in the order `own` of their stages, and the ghosts after the own cells of their stage.
    pub fn of_own(own: &[usize], level_ends: Vec<usize>, share: &Share) -> Self {
        let ghosts = share.own.len()..share.own.len() + share.ghosts.len();
        let (mut cells, mut stages) = (Vec::with_capacity(ghosts.end), Vec::new());
        for stage in 0..=share.colours {
            let start = cells.len();
            cells.extend(own.iter().copied().filter(|&cell| stage_of(share, cell) == stage));
            let middle = cells.len();
            cells.extend(ghosts.clone().filter(|&cell| stage_of(share, cell) == stage));
            stages.push(Stage { own: start..middle, ghosts: middle..cells.len() });
        }
        Ordering { positions: inverse(&cells), cells, level_ends, stages }
    }

    /// The order of all cells of a mesh in one block.
    pub fn whole(cells: Vec<usize>, level_ends: Vec<usize>) -> Self {
        let all = cells.len();
        Ordering {
            positions: inverse(&cells),
            cells,
            level_ends,
            stages: vec![Stage { own: 0..all, ghosts: all..all }],
        }
    }

    /// Own cells in their order.
    pub fn own(&self) -> impl Iterator<Item = usize> {
        self.stages.iter().flat_map(|stage| self.cells[stage.own.clone()].iter().copied())
    }

    /// The number of `position` among those of own cells.
    pub fn among_own(&self, position: usize) -> usize {
        let before = self.stages.iter().take_while(|stage| stage.own.start <= position);
        position
            - before.map(|stage| if stage.ghosts.start <= position { stage.ghosts.len() } else { 0 }).sum::<usize>()
    }

    /// The stage of `position`.
    pub fn stage(&self, position: usize) -> usize {
        self.stages.partition_point(|stage| stage.ghosts.end <= position)
    }

    /// Cells of the widest level: no more of them can be worked on at a time.
    pub fn widest_level(&self) -> usize {
        let starts = std::iter::once(0).chain(self.level_ends.iter().copied());
        starts.zip(&self.level_ends).map(|(start, end)| end - start).max().unwrap_or(0)
    }
}

/// The order for lambda M + dt A with one real lambda.
pub fn minimum_discarded_fill(
    jacobian: &SpaceJacobian,
    links: &[Vec<Link>],
    share: &Share,
    dt: f64,
    lambda: f64,
) -> Ordering {
    let links: Vec<Vec<Link>> = (0..share.own.len()).map(|cell| in_block(&links[cell], cell, share)).collect();
    let strengths: Vec<Vec<f64>> =
        (0..links.len()).into_par_iter().map(|cell| strengths(jacobian, &links[cell], cell, dt, lambda)).collect();
    minimum_discarded_fill_of(&links, &strengths, share)
}

/// The order by the strength |A_ii^{-1} A_ik| of every link of the own cell i inside of its block.
pub fn minimum_discarded_fill_of(links: &[Vec<Link>], strengths: &[Vec<f64>], share: &Share) -> Ordering {
    let mut order = eliminate(links, strengths);
    order.sort_by_key(|&cell| stage_of(share, cell));
    by_level(order, links, share)
}

/// The links of `cell` inside of its block.
fn in_block(links: &[Link], cell: usize, share: &Share) -> Vec<Link> {
    let of_cell = &share.blocks.of_cell;
    links.iter().filter(|link| of_cell[link.cell] == of_cell[cell]).copied().collect()
}

/// 0 for inner cells, else one more than the colour.
fn stage_of(share: &Share, cell: usize) -> usize {
    share.blocks.colours[cell].map_or(0, |colour| colour + 1)
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

/// Sorts the positions of each stage into levels: the factor is the same for every order that keeps each pair of neighbours in theirs.
fn by_level(order: Vec<usize>, links: &[Vec<Link>], share: &Share) -> Ordering {
    let rank = inverse(&order);
    let mut level = vec![0_usize; order.len()];
    for &cell in &order {
        let before = links[cell].iter().filter(|link| rank[link.cell] < rank[cell]);
        level[cell] = before.map(|link| level[link.cell] + 1).max().unwrap_or(0);
    }
    let mut cells = order;
    let place = |cell: usize| (stage_of(share, cell), level[cell]);
    cells.sort_by_key(|&cell| place(cell));
    let levels = cells.chunk_by(|&a, &b| place(a) == place(b));
    let end = |end: &mut usize, level: &[usize]| {
        *end += level.len();
        Some(*end)
    };
    let level_ends = levels.scan(0, end).collect();
    Ordering::of_own(&cells, level_ends, share)
}
