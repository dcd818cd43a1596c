//! Substructuring: the mesh is cut into blocks, which ranks share.
//!
//! Every block eliminates the nodes that it shares with no other block, by [`crate::condensation`]. What is left is a system at the nodes on
//! cuts, the interface Γ:
//!
//! ```text
//! S u_Γ = f_Γ - sum over blocks of  K_Γb K_bb^{-1} f_b,      S = sum over blocks of S_b                       (interface)
//! u_b = K_bb^{-1} (f_b - K_bΓ u_Γ)
//! ```
//!
//! | module | mathematics |
//! |---|---|
//! | `block` | one block: elimination, S_b, substitution |
//! | `interface` | the nodes on cuts, and what they share |
//! | `exchange` | messages between the ranks that own the blocks |
//! | `top` | a direct solution of (interface): the tree goes on over the blocks |
//! | `bddc` | an approximate one: balancing domain decomposition by constraints |
//!
//! A rank factors its own blocks only. Vectors are on all ranks. Blocks, not ranks, set the order of operations: results have the same bits on
//! any number of ranks.

mod bddc;
mod block;
mod exchange;
mod interface;
mod partition;
#[cfg(test)]
mod tests;
mod top;

pub use partition::{Partition, SolverOnBlocks};

use crate::ElasticityError;
use crate::condensation::{BatchMatrices, Condensation, Eliminated};
use bddc::Bddc;
use block::Block;
use exchange::Exchange;
use fem::parallel::{self, Grain};
use interface::Interface;
use mesh::NodeNumbering;
use std::sync::Arc;
use top::Top;

/// What substructuring takes from the mesh alone, without a matrix.
pub(crate) struct Cuts<const D: usize> {
    interface: Interface<D>,
    /// The blocks of this rank.
    own: Vec<Block<D>>,
    exchange: Exchange,
    /// For each block its C0 nodes that no other block has.
    interiors: Vec<Vec<usize>>,
}

impl<const D: usize> Cuts<D> {
    /// The cuts between the blocks of `partition`. `centres` are any points of the cells, `coordinates` those of the C0 nodes.
    pub(crate) fn new(
        partition: &Partition,
        numbering: &NodeNumbering,
        constrained: &[[bool; D]],
        centres: &[[f64; D]],
        coordinates: &[[f64; D]],
    ) -> Self {
        let blocks = partition.cells_of_blocks(numbering.n_cells());
        let interface = Interface::new(&blocks, numbering, constrained, coordinates);
        let block = |number: usize| Block::new(number, &blocks[number], numbering, constrained, centres, &interface);
        let numbers = partition.sums.own();
        let own = parallel::map(numbers.len(), Grain::Any, &|k| block(numbers.start + k));
        let interior = |cells: &Vec<usize>| {
            let nodes = numbering.of_cells(cells).1;
            nodes.into_iter().filter(|&node| interface.place(node).is_none()).collect()
        };
        let interiors = blocks.iter().map(interior).collect();
        Cuts { own, exchange: Exchange::new(partition.sums.clone()), interiors, interface }
    }

    /// Memory of [`Substructures`] with BDDC, for the blocks of this rank: the factors of blocks, and matrices of their interfaces.
    pub(crate) fn bytes(&self) -> usize {
        let of_interface = |block: &Block<D>| {
            let pieces = self.interface.pieces_of(block.number).map(|(_, rows)| rows.len().pow(2));
            (self.interface.of_block[block.number].len() * D).pow(2) + 2 * pieces.sum::<usize>()
        };
        self.own.iter().map(|block| block.bytes() + of_interface(block) * size_of::<f64>()).sum()
    }
}

/// The factored K_ff.
pub(crate) struct Substructures<const D: usize> {
    cuts: Arc<Cuts<D>>,
    /// Of the own blocks.
    factors: Vec<Condensation<D>>,
    coupling: Coupling<D>,
}

/// The solution of (interface).
enum Coupling<const D: usize> {
    Direct(Top),
    Bddc(Box<Bddc<D>>),
}

impl<const D: usize> Substructures<D> {
    /// Factors the sum of the cells' matrices, those of the batches of the whole mesh. A collective call.
    ///
    /// # Errors
    /// [`ElasticityError::NotDefinite`] on all ranks.
    pub(crate) fn new(
        cuts: Arc<Cuts<D>>,
        is_direct: bool,
        matrices: &BatchMatrices<'_>,
    ) -> Result<Self, ElasticityError> {
        let made = parallel::map(cuts.own.len(), Grain::Any, &|k| cuts.own[k].factor(matrices));
        let made = made.into_iter().collect::<Result<Vec<_>, _>>();
        let (factors, complements): (Vec<_>, Vec<_>) = cuts.exchange.agree(made)?.into_iter().unzip();
        let coupling = if is_direct {
            Coupling::Direct(Top::new(&cuts.interface, &cuts.exchange, &complements)?)
        } else {
            Coupling::Bddc(Box::new(Bddc::new(&cuts.interface, &cuts.exchange, complements)?))
        };
        Ok(Substructures { cuts, factors, coupling })
    }

    /// The same with other matrices. A collective call.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn with_matrices(&self, matrices: &BatchMatrices<'_>) -> Result<Self, ElasticityError> {
        Self::new(self.cuts.clone(), self.is_direct(), matrices)
    }

    /// Whether [`Self::solve`] is exact up to round-off.
    pub(crate) fn is_direct(&self) -> bool {
        matches!(self.coupling, Coupling::Direct(_))
    }

    /// x = P^{-1} x for right-hand sides one after the other, `[right-hand side][C0 node][component]`, that vanish at constrained entries. A
    /// collective call.
    ///
    /// 1. Own blocks eliminate their interiors.
    /// 2. All ranks add what that leaves at the interface, block after block.
    /// 3. They solve for the interface.
    /// 4. Own blocks solve for their interiors.
    /// 5. All ranks collect these.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let length = self.cuts.interface.vector_length();
        x.chunks_exact_mut(length).for_each(|x| self.solve_one(x));
    }

    fn solve_one(&self, x: &mut [f64]) {
        let Cuts { interface, own, exchange, interiors } = &*self.cuts;
        let eliminate = |k: usize| own[k].eliminate(&self.factors[k], x);
        let mut eliminated = parallel::map(own.len(), Grain::Any, &eliminate);
        let left = own.iter().zip(&eliminated).map(|(block, eliminated)| block.at_interface(eliminated)).collect();
        let mut u = interface.take(x);
        for (block, part) in exchange.gather(left, |block| interface.of_block[block].len() * D).iter().enumerate() {
            interface.add_part(block, part, &mut u);
        }
        match &self.coupling {
            Coupling::Direct(top) => top.solve(&mut u),
            Coupling::Bddc(bddc) => bddc.apply(interface, exchange, &mut u),
        }
        let substitute = |k: usize, eliminated: &mut [Eliminated]| {
            own[k].substitute(&self.factors[k], std::mem::take(&mut eliminated[0]), &u)
        };
        let inside = parallel::map_chunks(&mut eliminated, 1, &substitute);
        let inside = exchange.gather(inside, |block| interiors[block].len() * D);
        for (nodes, inside) in interiors.iter().zip(&inside) {
            put::<D>(nodes, inside, x);
        }
        put::<D>(&interface.nodes, &u, x);
    }

    /// Memory of the factors on this rank.
    pub(crate) fn bytes(&self) -> usize {
        let coupling = match &self.coupling {
            Coupling::Direct(top) => top.bytes(),
            Coupling::Bddc(bddc) => bddc.bytes(),
        };
        self.factors.iter().map(Condensation::bytes).sum::<usize>() + coupling
    }
}

/// Sets the entries of `nodes` in a vector `[C0 node][component]`.
fn put<const D: usize>(nodes: &[usize], values: &[f64], x: &mut [f64]) {
    for (&node, value) in nodes.iter().zip(values.chunks_exact(D)) {
        x[node * D..][..D].copy_from_slice(value);
    }
}

/// The entries of `nodes` of a vector `[C0 node][component]`.
fn taken<const D: usize>(nodes: &[usize], x: &[f64]) -> Vec<f64> {
    nodes.iter().flat_map(|&node| &x[node * D..][..D]).copied().collect()
}
