//! The share of a rank: its own cells, and ghosts, the cells of other ranks across their facets.
//!
//! The mesh is cut into blocks, and a rank owns whole blocks. Vectors hold own cells only. Before traces are taken, the coefficients of
//! ghosts are received from their owners. Both ranks of a cut compute the facets there, to the same bits. Everything that rounds follows
//! the blocks, so that results do not depend on the number of ranks.

mod messages;

use mesh::Mesh;
use ranks::Sums;
use std::ops::Range;
use std::sync::Arc;

/// The blocks of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// The block of every cell.
    pub of_cell: Vec<usize>,
    /// The colour of every cell at a cut, see [`mesh::colours`].
    pub colours: Vec<Option<usize>>,
}

/// The cells of a rank. Local numbers are those of own cells, and then those of ghosts.
#[derive(Clone)]
pub struct Share {
    /// Own cells by their numbers in the whole mesh: block by block, in increasing order in each.
    pub own: Vec<usize>,
    /// Ghosts by their numbers in the whole mesh: rank by rank, in the order of the own cells there.
    pub ghosts: Vec<usize>,
    /// Blocks and colours of own cells and ghosts.
    pub blocks: Blocks,
    /// Colours of the whole mesh.
    pub colours: usize,
    /// The first cell of every own block, and the number of own cells.
    pub ends: Vec<usize>,
    /// Sums over all blocks.
    pub sums: Arc<Sums>,
    /// The own cells that other ranks need.
    sends: Vec<(usize, Vec<usize>)>,
    /// Where the ghosts of other ranks are among the ghosts.
    receives: Vec<(usize, Range<usize>)>,
    /// Cells of the whole mesh.
    whole: usize,
}

impl Blocks {
    /// One block of all cells.
    pub fn one(cells: usize) -> Self {
        Blocks { of_cell: vec![0; cells], colours: vec![None; cells] }
    }

    fn subset(&self, cells: impl Iterator<Item = usize> + Clone) -> Self {
        let of_cell = cells.clone().map(|cell| self.of_cell[cell]).collect();
        Blocks { of_cell, colours: cells.map(|cell| self.colours[cell]).collect() }
    }
}

impl Share {
    /// All cells of `mesh` in one block.
    pub fn whole<const D: usize>(mesh: &Mesh<D>) -> Self {
        Share::new(mesh, &Blocks::one(mesh.n_cells()), Arc::new(Sums::alone()))
    }

    /// The share of the rank that owns the blocks `sums.own()`.
    pub fn new<const D: usize>(mesh: &Mesh<D>, blocks: &Blocks, sums: Arc<Sums>) -> Self {
        let own: Vec<usize> = sums.own().flat_map(|block| cells_of(blocks, block)).collect();
        let mut share = Share {
            ends: ends(&own, blocks, sums.own()),
            own,
            ghosts: Vec::new(),
            blocks: Blocks { of_cell: Vec::new(), colours: Vec::new() },
            colours: blocks.colours.iter().flatten().map(|colour| colour + 1).max().unwrap_or(0),
            sums,
            sends: Vec::new(),
            receives: Vec::new(),
            whole: mesh.n_cells(),
        };
        share.meet_neighbours(mesh, blocks);
        share.blocks = blocks.subset(share.cells());
        share
    }

    /// Finds the ghosts, and the own cells that are ghosts elsewhere.
    fn meet_neighbours<const D: usize>(&mut self, mesh: &Mesh<D>, blocks: &Blocks) {
        let rank = self.sums.communicator().rank();
        let ranks: Vec<usize> =
            (0..).zip(self.sums.blocks_of_rank()).flat_map(|(rank, own)| own.clone().map(move |_| rank)).collect();
        let owner = |cell: usize| ranks[blocks.of_cell[cell]];
        let place = |cell: usize| (owner(cell), blocks.of_cell[cell], cell);
        let (mut ghosts, mut needed) = (Vec::new(), Vec::new());
        for facet in mesh.interior_facets() {
            for (here, there) in [(facet.minus.cell, facet.plus.cell), (facet.plus.cell, facet.minus.cell)] {
                if owner(here) == rank && owner(there) != rank {
                    ghosts.push(place(there));
                    needed.push((owner(there), blocks.of_cell[here], here));
                }
            }
        }
        for list in [&mut ghosts, &mut needed] {
            list.sort_unstable();
            list.dedup();
        }
        let mut local = vec![usize::MAX; self.whole];
        self.own.iter().enumerate().for_each(|(number, &cell)| local[cell] = number);
        let same_rank = |a: &(usize, usize, usize), b: &(usize, usize, usize)| a.0 == b.0;
        let sent = |list: &[(usize, usize, usize)]| (list[0].0, list.iter().map(|&(_, _, cell)| local[cell]).collect());
        self.sends = needed.chunk_by(same_rank).map(sent).collect();
        let mut end = 0;
        let received = |list: &[(usize, usize, usize)]| {
            end += list.len();
            (list[0].0, end - list.len()..end)
        };
        self.receives = ghosts.chunk_by(same_rank).map(received).collect();
        self.ghosts = ghosts.into_iter().map(|(_, _, cell)| cell).collect();
    }

    /// Own cells and ghosts by their numbers in the whole mesh.
    pub fn cells(&self) -> impl Iterator<Item = usize> + Clone {
        self.own.iter().chain(&self.ghosts).copied()
    }

    /// The own cells alone, as if blocks did not touch.
    pub fn without_cuts(&self) -> Share {
        let blocks = Blocks { colours: vec![None; self.own.len()], of_cell: self.blocks.of_cell.clone() };
        Share { ghosts: Vec::new(), blocks, colours: 0, sends: Vec::new(), receives: Vec::new(), ..self.clone() }
    }

    /// The ranks that have own cells as ghosts, and how many.
    pub fn sent(&self) -> impl Iterator<Item = (usize, usize)> {
        self.sends.iter().map(|(rank, cells)| (*rank, cells.len()))
    }

    /// Whether this is the only rank and the mesh is one block.
    pub fn is_whole(&self) -> bool {
        self.ghosts.is_empty() && self.sums.blocks() == 1
    }

    /// Whether there are several ranks.
    pub fn is_distributed(&self) -> bool {
        self.sums.communicator().size() > 1
    }

    /// The own part of `whole`, `len` numbers for every cell of the whole mesh.
    pub fn own_part(&self, whole: &[f64]) -> Vec<f64> {
        let len = whole.len() / self.whole;
        self.own.iter().flat_map(|&cell| whole[cell * len..(cell + 1) * len].iter().copied()).collect()
    }
}

/// The cells of `block` in increasing order.
fn cells_of(blocks: &Blocks, block: usize) -> impl Iterator<Item = usize> {
    blocks.of_cell.iter().enumerate().filter(move |(_, other)| **other == block).map(|(cell, _)| cell)
}

/// The first of the cells `own` in each of the blocks, and the number of all.
fn ends(own: &[usize], blocks: &Blocks, range: Range<usize>) -> Vec<usize> {
    (range.start..=range.end).map(|block| own.partition_point(|&cell| blocks.of_cell[cell] < block)).collect()
}
