//! The graph of cells and the strengths of its edges.

use crate::preconditioner::blocks::Link;
use fem::Share;

/// A coupling of a cell to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The other cell.
    pub cell: usize,
    /// The face of this cell.
    pub face: usize,
    /// The face of the other cell.
    pub other_face: usize,
    /// |A_ii^{-1} A_ik|, i this cell, k the other one.
    pub strength: f64,
}

/// Cells and their couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// For every cell its edges.
    pub edges: Vec<Vec<Edge>>,
    /// The block of every cell.
    pub blocks: Vec<usize>,
}

impl Graph {
    /// That of the own cells of a rank, of which all `links` are in one block.
    pub fn of_own(links: &[Vec<Link>], strengths: &[Vec<f64>]) -> Self {
        let edges = links.iter().zip(strengths).map(|(links, strengths)| edges(links, strengths, |cell| cell));
        Graph { edges: edges.collect(), blocks: vec![0; links.len()] }
    }

    /// That of the whole mesh, on all ranks, from the `strengths` of the links of own cells. Cells have their numbers in the whole mesh. A
    /// collective call.
    pub fn of_all(links: &[Vec<Link>], strengths: &[Vec<f64>], share: &Share) -> Self {
        let number: Vec<usize> = share.cells().collect();
        let mut own = Vec::new();
        for (cell, (links, strengths)) in links.iter().zip(strengths).enumerate() {
            own.extend([number[cell], share.blocks.of_cell[cell], links.len()].map(|number| number as f64));
            for Edge { cell, face, other_face, strength } in edges(links, strengths, |cell| number[cell]) {
                own.extend([cell as f64, face as f64, other_face as f64, strength]);
            }
        }
        let parts = share.sums.communicator().all_gather(&own);
        let mut graph = Graph { edges: vec![Vec::new(); share.whole_cells()], blocks: vec![0; share.whole_cells()] };
        parts.iter().for_each(|part| graph.add(part));
        graph
    }

    /// Adds the cells of a rank: number, block and number of edges of each, and its edges.
    fn add(&mut self, mut part: &[f64]) {
        while let [cell, block, count, rest @ ..] = part {
            let (edges, others) = rest.split_at(rest.len().min(4 * *count as usize));
            let edge = |e: &[f64]| Edge {
                cell: e[0] as usize,
                face: e[1] as usize,
                other_face: e[2] as usize,
                strength: e[3],
            };
            self.edges[*cell as usize] = edges.chunks_exact(4).map(edge).collect();
            self.blocks[*cell as usize] = *block as usize;
            part = others;
        }
    }

    /// Whether an edge leads to another block.
    pub fn is_cut(&self, cell: usize, edge: &Edge) -> bool {
        self.blocks[cell] != self.blocks[edge.cell]
    }
}

fn edges(links: &[Link], strengths: &[f64], number: impl Fn(usize) -> usize) -> Vec<Edge> {
    let edge = |(link, &strength): (&Link, &f64)| Edge {
        cell: number(link.cell),
        face: link.face,
        other_face: link.other_face,
        strength,
    };
    links.iter().zip(strengths).map(edge).collect()
}
