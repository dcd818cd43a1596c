//! The coarse problem: S_c c = f_c for the values of all constraints, on all ranks.

use crate::ElasticityError;
use crate::substructures::bddc::constraints::Constraints;
use crate::substructures::exchange::{Exchange, packed, packed_length, unpacked};
use faer::Mat;
use sparse::{BlockMatrix, Factorisation, Kind};
use std::sync::Arc;

/// The factored sum of the S_c of all blocks.
pub(super) struct Coarse {
    factor: Factorisation<f64>,
    /// The numbers of the constraints of every block.
    of_block: Vec<Vec<usize>>,
    count: usize,
}

impl Coarse {
    /// From the S_c of the own blocks. A collective call.
    pub(super) fn new(
        constraints: &Constraints,
        exchange: &Exchange,
        energies: &[Mat<f64>],
    ) -> Result<Self, ElasticityError> {
        let (of_block, count) = (constraints.of_block.clone(), constraints.count);
        let own = energies.iter().map(packed).collect();
        let energies = exchange.gather(own, |block| packed_length(of_block[block].len()));
        let mut neighbours = vec![Vec::new(); count];
        of_block.iter().for_each(|own| own.iter().for_each(|&k| neighbours[k].extend(own)));
        let mut matrix = BlockMatrix::new(Kind::Cholesky, 1, neighbours);
        for (own, energy) in of_block.iter().zip(&energies) {
            let energy = unpacked(energy, own.len());
            for (j, &column) in own.iter().enumerate() {
                own.iter().enumerate().for_each(|(i, &row)| matrix.add(row, column, |_, _| energy[(i, j)]));
            }
        }
        let factor = matrix.factor(Arc::new(matrix.elimination_tree()?))?;
        Ok(Coarse { factor, of_block, count })
    }

    /// c from the loads of the own blocks. A collective call.
    pub(super) fn solve(&self, exchange: &Exchange, loads: Vec<Vec<f64>>) -> Vec<f64> {
        let loads = exchange.gather(loads, |block| self.of_block[block].len());
        let mut c = vec![0.0; self.count];
        for (own, load) in self.of_block.iter().zip(&loads) {
            own.iter().zip(load).for_each(|(&k, load)| c[k] += load);
        }
        self.factor.solve(&mut c, 1, &mut Vec::new());
        c
    }

    /// The entries of c that belong to a block.
    pub(super) fn of_block(&self, block: usize, c: &[f64]) -> Vec<f64> {
        self.of_block[block].iter().map(|&k| c[k]).collect()
    }

    pub(super) fn bytes(&self) -> usize {
        self.factor.bytes()
    }
}
