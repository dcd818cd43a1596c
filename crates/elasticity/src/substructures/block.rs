//! One block of the mesh.

use crate::ElasticityError;
use crate::condensation::{BatchMatrices, Condensation, Eliminated, Elimination};
use crate::substructures::interface::Interface;
use crate::substructures::taken;
use faer::Mat;
use fem::NodalBatches;
use mesh::NodeNumbering;
use std::sync::Arc;
use tensor::{Pack, WIDTH, zeroed};

/// A block, with its own numbers of nodes.
pub(super) struct Block<const D: usize> {
    pub(super) number: usize,
    cells: Vec<usize>,
    /// The C0 node of every own one.
    nodes: Vec<usize>,
    batches: NodalBatches<D>,
    elimination: Arc<Elimination<D>>,
    /// The own nodes on the interface, and all others.
    kept: Vec<usize>,
    inside: Vec<usize>,
    /// The places of the former in the interface.
    places: Vec<usize>,
}

impl<const D: usize> Block<D> {
    pub(super) fn new(
        number: usize,
        cells: &[usize],
        numbering: &NodeNumbering,
        constrained: &[[bool; D]],
        centres: &[[f64; D]],
        interface: &Interface<D>,
    ) -> Self {
        let (own, nodes) = numbering.of_cells(cells);
        let is_kept = |&node: &usize| interface.place(nodes[node]).is_some();
        let (kept, inside): (Vec<usize>, Vec<usize>) = (0..nodes.len()).partition(is_kept);
        let batches = NodalBatches::new(&own);
        let constrained: Vec<_> = nodes.iter().map(|&node| constrained[node]).collect();
        let centres: Vec<_> = cells.iter().map(|&cell| centres[cell]).collect();
        let elimination = Elimination::new(numbering.order(), &batches, &constrained, &centres, &kept);
        let places = interface.of_block[number].clone();
        Block {
            number,
            cells: cells.to_vec(),
            nodes,
            batches,
            elimination: Arc::new(elimination),
            kept,
            inside,
            places,
        }
    }

    /// Memory of the factor.
    pub(super) fn bytes(&self) -> usize {
        self.elimination.bytes(&self.batches)
    }

    /// The factor of K_bb, and both triangles of S_b.
    pub(super) fn factor(&self, matrices: &BatchMatrices<'_>) -> Result<(Condensation<D>, Mat<f64>), ElasticityError> {
        let own = |batch| self.own_matrices(batch, matrices);
        let mut condensation = self.elimination.factor(&self.batches, &own)?;
        let mut complement = condensation.take_complement();
        for j in 0..complement.ncols() {
            (0..j).for_each(|i| complement[(i, j)] = complement[(j, i)]);
        }
        Ok((condensation, complement))
    }

    /// The matrices of a batch of own cells, from those of the batches of the whole mesh.
    fn own_matrices(&self, batch: usize, matrices: &BatchMatrices<'_>) -> Vec<Pack> {
        let mut own = zeroed(self.batches.cell_length().pow(2));
        let mut last: Option<(usize, Vec<Pack>)> = None;
        for lane in 0..WIDTH {
            let cell = self.cells[self.batches.cell(batch, lane)];
            let (number, from) = (cell / WIDTH, cell % WIDTH);
            let (_, whole) = match last.take() {
                Some(known) if known.0 == number => last.insert(known),
                _ => last.insert((number, matrices(number))),
            };
            own.iter_mut().zip(whole).for_each(|(own, whole)| own.0[lane] = whole.0[from]);
        }
        own
    }

    /// Eliminates the interior from the right-hand side `x`, `[C0 node][component]`.
    pub(super) fn eliminate(&self, factor: &Condensation<D>, x: &[f64]) -> Eliminated {
        let mut own = taken::<D>(&self.nodes, x);
        self.kept.iter().for_each(|&node| own[node * D..][..D].fill(0.0));
        factor.eliminate(&self.batches, &own)
    }

    /// What the elimination adds to the right-hand side at the interface.
    pub(super) fn at_interface(&self, eliminated: &Eliminated) -> Vec<f64> {
        taken::<D>(&self.kept, &eliminated.swept)
    }

    /// The solution inside, from that of the interface.
    pub(super) fn substitute(&self, factor: &Condensation<D>, mut eliminated: Eliminated, u: &[f64]) -> Vec<f64> {
        super::put::<D>(&self.kept, &taken::<D>(&self.places, u), &mut eliminated.swept);
        let mut x = vec![0.0; self.nodes.len() * D];
        factor.substitute(&self.batches, eliminated, &mut x);
        taken::<D>(&self.inside, &x)
    }
}
