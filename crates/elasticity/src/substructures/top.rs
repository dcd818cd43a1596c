//! The direct solution of the interface: the elimination tree goes on over the blocks.

use crate::ElasticityError;
use crate::substructures::exchange::{Exchange, packed, packed_length, unpacked};
use crate::substructures::interface::Interface;
use faer::Mat;
use sparse::{EliminationTree, Factorisation, Kind};
use std::sync::Arc;

/// The factored S, on all ranks.
pub(super) struct Top {
    factor: Factorisation<f64>,
}

impl Top {
    /// Factors S from the S_b of the own blocks. A collective call.
    pub(super) fn new<const D: usize>(
        interface: &Interface<D>,
        exchange: &Exchange,
        own: &[Mat<f64>],
    ) -> Result<Self, ElasticityError> {
        let size = |block: usize| interface.of_block[block].len() * D;
        let parts = exchange.gather(own.iter().map(packed).collect(), |block| packed_length(size(block)));
        let (blocks, count) = (&interface.of_block, interface.nodes.len());
        let centres: Vec<_> = blocks.iter().map(|places| interface.centre(places)).collect();
        let tree = Arc::new(EliminationTree::by_dissection(blocks, &centres, count, &[]));
        let factor = Factorisation::new(tree.clone(), D, Kind::Cholesky, |front| {
            if let Some(block) = front.front.cell {
                let positions = blocks[block].iter().map(|&place| tree.positions[place]);
                front.add(positions, &unpacked(&parts[block], size(block)));
            }
        })?;
        Ok(Top { factor })
    }

    /// u = S^{-1} u.
    pub(super) fn solve(&self, u: &mut [f64]) {
        self.factor.solve(u, 1, &mut Vec::new());
    }

    pub(super) fn bytes(&self) -> usize {
        self.factor.bytes()
    }
}
