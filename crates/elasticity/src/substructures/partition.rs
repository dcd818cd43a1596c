//! Which blocks the mesh consists of, and who owns them.

use crate::Solver;
use ranks::Sums;
use std::sync::Arc;

/// The blocks of the mesh and the ranks that own them.
#[derive(Clone, Debug)]
pub struct Partition {
    /// The block of every cell, from [`mesh::blocks`]; empty for one block.
    pub block_of_cell: Vec<usize>,
    /// The blocks of this rank.
    pub sums: Arc<Sums>,
}

/// The solver of a mesh, and the blocks on which it works.
#[derive(Clone, Debug)]
pub struct SolverOnBlocks {
    /// The solver.
    pub solver: Solver,
    /// The blocks.
    pub partition: Partition,
}

impl Partition {
    /// One block on one rank.
    pub fn whole() -> Self {
        Partition { block_of_cell: Vec::new(), sums: Arc::new(Sums::alone()) }
    }

    /// Whether there are several blocks.
    pub(crate) fn is_cut(&self) -> bool {
        self.sums.blocks() > 1
    }

    /// The cells of every block, increasing.
    pub(crate) fn cells_of_blocks(&self, cells: usize) -> Vec<Vec<usize>> {
        let mut blocks = vec![Vec::new(); self.sums.blocks()];
        (0..cells).for_each(|cell| blocks[self.block_of_cell.get(cell).copied().unwrap_or(0)].push(cell));
        blocks
    }
}

impl From<Solver> for SolverOnBlocks {
    fn from(solver: Solver) -> Self {
        SolverOnBlocks { solver, partition: Partition::whole() }
    }
}
