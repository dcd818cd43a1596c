//! The share of a rank: its own cells, and ghosts, the cells of other ranks across their facets.
//!
//! The mesh is cut into blocks, and a rank owns whole blocks. Vectors hold own cells only. Of a state ranks send the coefficients of ghosts,
//! of a direction only the traces at the cuts. Both ranks of a cut compute the facets there, to the same bits. Everything that rounds
//! follows the blocks, so that results do not depend on the number of ranks.

mod messages;

use mesh::{Mesh, Side};
use ranks::Sums;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// The blocks of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// The block of every cell.
    pub of_cell: Vec<usize>,
    /// How many groups of cells a preconditioner may eliminate one after the other, all blocks at the same time in each. The more there are,
    /// the closer it comes to the order of elimination of one block, and the more messages it sends.
    pub groups: usize,
}

/// Faces at cuts between this rank and another one, facet by facet in the order of the whole mesh.
#[derive(Clone, Debug)]
struct Cut {
    rank: usize,
    /// Those of own cells.
    own: Vec<Side>,
    /// Those of ghosts.
    ghosts: Vec<Side>,
}

/// The cells of a rank. Local numbers are those of own cells, and then those of ghosts.
#[derive(Clone)]
pub struct Share {
    /// Own cells by their numbers in the whole mesh: block by block, in increasing order in each.
    pub own: Vec<usize>,
    /// Ghosts by their numbers in the whole mesh: rank by rank, in the order of the own cells there.
    pub ghosts: Vec<usize>,
    /// Blocks of own cells and ghosts.
    pub blocks: Blocks,
    /// The first cell of every own block, and the number of own cells.
    pub ends: Vec<usize>,
    /// Sums over all blocks.
    pub sums: Arc<Sums>,
    /// The own cells that other ranks need.
    sends: Vec<(usize, Vec<usize>)>,
    /// Where the ghosts of other ranks are among the ghosts.
    receives: Vec<(usize, Range<usize>)>,
    /// The facets between ranks.
    cuts: Vec<Cut>,
    /// Own cells by their numbers in the whole mesh, in increasing order, and their local numbers.
    sorted: Vec<(usize, usize)>,
    /// The rank of every cell of the whole mesh.
    rank_of_cell: Vec<u32>,
    /// Cells of the whole mesh.
    whole: usize,
}

impl Blocks {
    /// One block of all cells.
    pub fn one(cells: usize) -> Self {
        Blocks { of_cell: vec![0; cells], groups: 1 }
    }

    /// The cells of the blocks `range`: block by block, in increasing order in each.
    fn cells(&self, range: &Range<usize>) -> Vec<usize> {
        let mut cells: Vec<usize> =
            (0..self.of_cell.len()).filter(|cell| range.contains(&self.of_cell[*cell])).collect();
        cells.sort_by_key(|&cell| self.of_cell[cell]);
        cells
    }
}

impl Share {
    /// All cells of `mesh` in one block.
    pub fn whole<const D: usize>(mesh: &Mesh<D>) -> Self {
        Share::new(mesh, &Blocks::one(mesh.n_cells()), Arc::new(Sums::alone()))
    }

    /// The share of the rank that owns the blocks `sums.own()`.
    pub fn new<const D: usize>(mesh: &Mesh<D>, blocks: &Blocks, sums: Arc<Sums>) -> Self {
        let own = blocks.cells(&sums.own());
        let mut share = Share {
            ends: ends(&own, blocks, sums.own()),
            sorted: sorted(&own),
            own,
            ghosts: Vec::new(),
            blocks: Blocks { of_cell: Vec::new(), ..*blocks },
            rank_of_cell: Vec::new(),
            sums,
            sends: Vec::new(),
            receives: Vec::new(),
            cuts: Vec::new(),
            whole: mesh.n_cells(),
        };
        let owners = share.owners(blocks);
        share.rank_of_cell = owners.iter().map(|&rank| rank as u32).collect();
        share.meet_neighbours(mesh, blocks, &owners);
        share.find_cuts(mesh, &owners);
        share.blocks.of_cell = share.cells().map(|cell| blocks.of_cell[cell]).collect();
        share
    }

    /// The rank of every cell of the whole mesh.
    fn owners(&self, blocks: &Blocks) -> Vec<usize> {
        let ranks: Vec<usize> =
            (0..).zip(self.sums.blocks_of_rank()).flat_map(|(rank, own)| own.clone().map(move |_| rank)).collect();
        blocks.of_cell.iter().map(|&block| ranks[block]).collect()
    }

    /// Finds the facets between this rank and others.
    fn find_cuts<const D: usize>(&mut self, mesh: &Mesh<D>, owners: &[usize]) {
        let rank = self.sums.communicator().rank();
        let mut local = vec![usize::MAX; self.whole];
        self.cells().enumerate().for_each(|(number, cell)| local[cell] = number);
        let here = |side: Side| Side { cell: local[side.cell], ..side };
        let mut cuts: BTreeMap<usize, Cut> = BTreeMap::new();
        for facet in mesh.interior_facets() {
            for (own, ghost) in [(facet.minus, facet.plus), (facet.plus, facet.minus)] {
                let other = owners[ghost.cell];
                if owners[own.cell] == rank && other != rank {
                    let new = || Cut { rank: other, own: Vec::new(), ghosts: Vec::new() };
                    let cut = cuts.entry(other).or_insert_with(new);
                    cut.own.push(here(own));
                    cut.ghosts.push(here(ghost));
                }
            }
        }
        self.cuts = cuts.into_values().collect();
    }

    /// Finds the ghosts, and the own cells that are ghosts elsewhere.
    fn meet_neighbours<const D: usize>(&mut self, mesh: &Mesh<D>, blocks: &Blocks, owners: &[usize]) {
        let rank = self.sums.communicator().rank();
        let owner = |cell: usize| owners[cell];
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

    /// The number of cells of the whole mesh.
    pub fn whole_cells(&self) -> usize {
        self.whole
    }

    /// The ranks that have own cells as ghosts, and how many.
    pub fn sent(&self) -> impl Iterator<Item = (usize, usize)> {
        self.sends.iter().map(|(rank, cells)| (*rank, cells.len()))
    }

    /// The ranks across the cuts, and the number of facets to each.
    pub fn cut_facets(&self) -> impl Iterator<Item = (usize, usize)> {
        self.cuts.iter().map(|cut| (cut.rank, cut.own.len()))
    }

    /// Whether this is the only rank and the mesh is one block.
    pub fn is_whole(&self) -> bool {
        self.ghosts.is_empty() && self.sums.blocks() == 1
    }

    /// Whether there are several ranks.
    pub fn is_distributed(&self) -> bool {
        self.sums.communicator().size() > 1
    }

    /// The local numbers of the own cells in a range of cells of the whole mesh, in the order of the whole mesh.
    fn own_within(&self, range: &Range<usize>) -> impl Iterator<Item = usize> + '_ {
        let before = |end: usize| self.sorted.partition_point(|(cell, _)| *cell < end);
        self.sorted[before(range.start)..before(range.end)].iter().map(|(_, place)| *place)
    }

    /// The local numbers of those of `cells`, numbers in the whole mesh, that are own cells.
    fn own_among<'a>(&'a self, cells: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
        let place = |cell: &usize| self.sorted.binary_search_by_key(cell, |own| own.0).ok();
        cells.iter().filter_map(place).map(|place| self.sorted[place].1)
    }
}

/// The numbers of `cells`, of which every cell has `len` in `values`.
fn numbers_of(cells: impl Iterator<Item = usize>, values: &[f64], len: usize) -> Vec<f64> {
    cells.flat_map(|cell| &values[cell * len..(cell + 1) * len]).copied().collect()
}

/// The cells `own` in increasing order, with their places.
fn sorted(own: &[usize]) -> Vec<(usize, usize)> {
    let mut sorted: Vec<(usize, usize)> = own.iter().copied().zip(0..).collect();
    sorted.sort_unstable();
    sorted
}

/// The first of the cells `own` in each of the blocks, and the number of all.
fn ends(own: &[usize], blocks: &Blocks, range: Range<usize>) -> Vec<usize> {
    (range.start..=range.end).map(|block| own.partition_point(|&cell| blocks.of_cell[cell] < block)).collect()
}
