//! The partition of a mesh into blocks of cells.
//!
//! Cells are the vertices of a graph, facets its edges. An edge weighs as much as the coupling through its facet, so that
//! thin cells at a wall stay together. The graph is bisected recursively: [`multilevel`] bisects a coarser graph first, and
//! [`refinement`] moves cells across the cut while it becomes weaker. Weights are integers and ties go to the lower cell
//! number: the partition is the same on every machine.
//!
//! | module | holds |
//! |---|---|
//! | `graph` | graphs with weights, their parts and contractions |
//! | `coupling` | the graph of a mesh |
//! | `multilevel` | the bisection of a graph |
//! | `refinement` | Fiduccia-Mattheyses moves across a cut |
//! | `sizes` | the sizes that blocks may have |

mod coupling;
mod graph;
mod multilevel;
mod refinement;
mod sizes;
#[cfg(test)]
mod tests;

use crate::{Mesh, MeshError};
use graph::Graph;
use sizes::Limits;

/// The block of every cell: `count` blocks of nearly equal numbers of cells, cut where couplings are weak. Sizes differ from
/// their mean by at most one cell or 3 %. Blocks are in one piece where possible. Small blocks of some 16 cells, and blocks of cells with
/// aspect ratios beyond 1000, may consist of several parts.
///
/// The result depends only on the mesh and on `count`. Blocks with near numbers are near each other: the first half of the numbers is one
/// side of the first cut, and so on.
///
/// # Errors
/// [`MeshError::Blocks`] if `count` is 0 or larger than the number of cells.
pub fn blocks<const D: usize>(mesh: &Mesh<D>, count: usize) -> Result<Vec<usize>, MeshError> {
    let cells = mesh.n_cells();
    if !(1..=cells).contains(&count) {
        return Err(MeshError::Blocks { count, cells });
    }
    let mut block = vec![0; cells];
    let whole = Piece { graph: coupling::graph(mesh), cells: (0..cells).collect(), first: 0, count };
    whole.divide(&Limits::new(cells, count), WORK / cells, &mut block);
    Ok(block)
}

/// The work on a mesh: cells times attempts to bisect a part of it.
const WORK: usize = 20_000;

/// A part of the mesh that will become the blocks `first..first + count`.
struct Piece {
    graph: Graph,
    /// The cell of every vertex of the graph.
    cells: Vec<usize>,
    first: usize,
    count: usize,
}

impl Piece {
    fn divide(&self, limits: &Limits, attempts: usize, block: &mut [usize]) {
        if self.count == 1 {
            return self.cells.iter().for_each(|&cell| block[cell] = self.first);
        }
        let counts = [self.count / 2, self.count - self.count / 2];
        let sides = multilevel::bisect(&self.graph, limits.first_side(self.cells.len(), counts), attempts);
        self.half(&sides, false, self.first, counts[0]).divide(limits, attempts, block);
        self.half(&sides, true, self.first + counts[0], counts[1]).divide(limits, attempts, block);
    }

    /// The part on one side of a cut.
    fn half(&self, sides: &[bool], side: bool, first: usize, count: usize) -> Piece {
        let vertices: Vec<usize> = (0..sides.len()).filter(|&v| sides[v] == side).collect();
        let cells = vertices.iter().map(|&v| self.cells[v]).collect();
        Piece { graph: self.graph.part(&vertices), cells, first, count }
    }
}
