//! The order of elimination.
//!
//! It is that of [`minimum_discarded_fill`]. Where the mesh is cut into blocks, cells are eliminated in [`stages`]: cells of one stage in
//! different blocks are not neighbours. So all blocks work at the same time, and ranks exchange results after every stage.

mod graph;
mod minimum_discarded_fill;
mod stages;

use super::blocks::{Link, coupling_block, diagonal_block};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Accum, Mat, Par};
use fem::parallel::{self, Grain};
use fem::{Share, SpaceJacobian};
use graph::Graph;
use minimum_discarded_fill::eliminate;
use stages::stages;
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

/// The positions of cells that all blocks eliminate at the same time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// Own cells.
    pub own: Range<usize>,
    /// Ghosts, which follow them.
    pub ghosts: Range<usize>,
    /// Own cells of earlier stages.
    before: usize,
}

impl Ordering {
    /// That of a preconditioner that eliminates no cell.
    pub fn none() -> Self {
        Ordering { cells: Vec::new(), positions: Vec::new(), level_ends: vec![0], stages: Vec::new() }
    }

    /// The own cells of a rank in the order `own` in each stage, and the ghosts after the own cells of their stage. `stages` are those of own
    /// cells and ghosts; there are `count` of them in the whole mesh, some without cells of this rank.
    pub fn of_own(own: &[usize], level_ends: Vec<usize>, stages: &[usize], count: usize) -> Self {
        let mut cells: Vec<usize> = own.iter().copied().chain(own.len()..stages.len()).collect();
        let place = |cell: usize| (stages[cell], cell >= own.len());
        cells.sort_by_key(|&cell| place(cell));
        let position = |stage: usize, ghosts: bool| cells.partition_point(|&cell| place(cell) < (stage, ghosts));
        let mut before = 0;
        let stage = |number: usize| {
            let (start, middle, end) = (position(number, false), position(number, true), position(number + 1, false));
            before += middle - start;
            Stage { own: start..middle, ghosts: middle..end, before: before + start - middle }
        };
        let stages = (0..count).map(stage).collect();
        Ordering { positions: inverse(&cells), cells, level_ends, stages }
    }

    /// The order of cells that are in one stage.
    pub fn whole(cells: Vec<usize>, level_ends: Vec<usize>) -> Self {
        let stages = vec![0; cells.len()];
        Self::of_own(&cells, level_ends, &stages, 1)
    }

    /// The order of own cells without ghosts in stages with these ends, in increasing order.
    pub fn in_stages(cells: &[usize], level_ends: Vec<usize>, stage_ends: &[usize]) -> Self {
        let mut stages = vec![0; cells.len()];
        for (position, &cell) in cells.iter().enumerate() {
            stages[cell] = stage_ends.partition_point(|&end| end <= position);
        }
        Self::of_own(cells, level_ends, &stages, stage_ends.len())
    }

    /// Own cells in their order.
    pub fn own(&self) -> impl Iterator<Item = usize> {
        self.stages.iter().flat_map(|stage| self.cells[stage.own.clone()].iter().copied())
    }

    /// The number of the own cell at `position` among own cells.
    pub fn among_own(&self, position: usize) -> usize {
        let Stage { own, before, .. } = &self.stages[self.stage(position)];
        before + position - own.start
    }

    /// The number of own cells up to the end of every stage.
    pub fn stage_ends(&self) -> Vec<usize> {
        self.stages.iter().map(|Stage { own, before, .. }| before + own.len()).collect()
    }

    /// The stage of every cell.
    pub fn stages_of_cells(&self) -> Vec<usize> {
        self.positions.iter().map(|&position| self.stage(position)).collect()
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

/// The order for lambda M + dt A with one real lambda, where the components of the state have these `scales`. A collective call.
///
/// The Jacobian is in double precision: where the flow is uniform, many fills are equal up to rounding, and an order that follows the rounding of
/// single precision is a bad one.
pub fn minimum_discarded_fill(
    jacobian: &SpaceJacobian<f64>,
    links: &[Vec<Link>],
    share: &Share,
    scales: &[f64],
    (dt, lambda): (f64, f64),
) -> Ordering {
    let links = &links[..share.own.len()];
    let of_cell = |cell: usize| strengths(jacobian, &links[cell], cell, scales, (dt, lambda));
    let strengths = parallel::map(links.len(), Grain::Any, &of_cell);
    let graph = Graph::of_all(links, &strengths, share);
    let order = eliminate(&graph);
    let stages = stages(&graph, &order, share.blocks.groups);
    let position = inverse(&order);
    let number: Vec<usize> = share.cells().collect();
    let mut own: Vec<usize> = (0..links.len()).collect();
    own.sort_by_key(|&cell| (stages[number[cell]], position[number[cell]]));
    let links: Vec<Vec<Link>> = (0..links.len()).map(|cell| in_block(&links[cell], cell, share)).collect();
    // Ranks wait for each other after every stage, so all count the same stages.
    let count = stages.iter().max().map_or(1, |stage| stage + 1);
    let stages: Vec<usize> = number.iter().map(|&cell| stages[cell]).collect();
    by_level(own, &links, &stages, count)
}

/// The order by the strength |A_ii^{-1} A_ik| of every link of the own cell i, where no link leads to another block.
pub fn minimum_discarded_fill_of(links: &[Vec<Link>], strengths: &[Vec<f64>]) -> Ordering {
    by_level(eliminate(&Graph::of_own(links, strengths)), links, &vec![0; links.len()], 1)
}

/// The links of `cell` inside of its block.
fn in_block(links: &[Link], cell: usize, share: &Share) -> Vec<Link> {
    let of_cell = &share.blocks.of_cell;
    links.iter().filter(|link| of_cell[link.cell] == of_cell[cell]).copied().collect()
}

/// |A_ii^{-1} A_ik| in the Frobenius norm for every link of cell i, up to the norm of a trace. Components count in units of their `scales`: the
/// order is the same in all units.
fn strengths(
    jacobian: &SpaceJacobian<f64>,
    links: &[Link],
    cell: usize,
    scales: &[f64],
    (dt, lambda): (f64, f64),
) -> Vec<f64> {
    // Allocated first. After the large matrices it would lie in the space that they leave, and split it for the next cell.
    let mut strengths = Vec::with_capacity(links.len());
    let factors = diagonal_block(jacobian, cell, dt, lambda).partial_piv_lu();
    let inverse = factors.inverse();
    drop(factors);
    let (n, t) = (jacobian.block, jacobian.traces.len());
    let (mut lifted, mut product) = (vec![0.0; n * t], Mat::zeros(n, t));
    let norm = |link: &Link| {
        let b = coupling_block(jacobian, *link);
        lifted.fill(0.0);
        for (lifted, b) in lifted.chunks_exact_mut(n).zip(b.chunks_exact(t)) {
            for (row, b) in b.iter().enumerate() {
                let (offset, functional) = jacobian.traces.functional(link.face, row);
                functional.iter().for_each(|&(node, weight)| lifted[offset + node] += dt * weight * b);
            }
        }
        let lifted = faer::MatRef::from_column_major_slice(&lifted, n, t);
        matmul(product.as_mut(), Accum::Replace, inverse.as_ref(), lifted, 1.0, Par::Seq);
        let scale = |offset: usize| scales[offset / jacobian.traces.nodes];
        let of_trace = |j: usize| scale(jacobian.traces.functional(link.other_face, j).0);
        let of_column = |j: usize| product.col(j).iter().enumerate().map(|(i, x)| (x / scale(i)).powi(2)).sum::<f64>();
        (0..t).map(|j| of_trace(j).powi(2) * of_column(j)).sum::<f64>().sqrt()
    };
    strengths.extend(links.iter().map(norm));
    strengths
}

/// The position of each entry of an order.
fn inverse(order: &[usize]) -> Vec<usize> {
    let mut positions = vec![0; order.len()];
    order.iter().enumerate().for_each(|(position, &entry)| positions[entry] = position);
    positions
}

/// Sorts the positions of each stage into levels: the factor is the same for every order that keeps each pair of neighbours in theirs.
fn by_level(order: Vec<usize>, links: &[Vec<Link>], stages: &[usize], count: usize) -> Ordering {
    let rank = inverse(&order);
    let mut level = vec![0_usize; order.len()];
    for &cell in &order {
        let before = links[cell].iter().filter(|link| rank[link.cell] < rank[cell]);
        level[cell] = before.map(|link| level[link.cell] + 1).max().unwrap_or(0);
    }
    let mut cells = order;
    let place = |cell: usize| (stages[cell], level[cell]);
    cells.sort_by_key(|&cell| place(cell));
    let levels = cells.chunk_by(|&a, &b| place(a) == place(b));
    let end = |end: &mut usize, level: &[usize]| {
        *end += level.len();
        Some(*end)
    };
    let level_ends = levels.scan(0, end).collect();
    Ordering::of_own(&cells, level_ends, stages, count)
}
