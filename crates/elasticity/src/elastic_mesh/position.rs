//! Where K is taken: the position of the mesh at the bottom of the slab.

use super::ElasticMesh;
use crate::geometry::{Sample, Sampler};
use crate::low_order::LowOrder;
use crate::operator::Operator;
use crate::solver::Inverse;
use crate::{ElasticityError, Inversion, Law, Stiffness};
use mesh::NodeNumbering;
use tensor::Pack;

/// The displacement at the bottom of the slab, and what it takes to move the reference mesh there.
pub(super) struct Position<const D: usize> {
    bottom: Vec<f64>,
    /// Whether the inverse is that of K there.
    is_prepared: bool,
    /// Of [`Law::Incremental`]: W and G of the initial mesh.
    initial_metric: Vec<Pack>,
    /// The power of det J in the stiffness; 0 for one that stays with the material.
    power: f64,
    /// What the low-order refinement of a mesh that has moved is made of, where there is one.
    nodes: Option<Nodes<D>>,
}

/// The Gauss-Lobatto nodes of the initial mesh.
struct Nodes<const D: usize> {
    numbering: NodeNumbering,
    /// `[cell][node]`
    samples: Vec<Vec<Sample<D>>>,
}

impl<const D: usize> Nodes<D> {
    /// The nodes of a cell, moved by the displacement `d`.
    fn moved(&self, cell: usize, d: &[f64]) -> Vec<Sample<D>> {
        let mut samples = self.samples[cell].clone();
        for (sample, node) in samples.iter_mut().zip(self.numbering.cell(cell)) {
            (0..D).for_each(|i| sample.position[i] += d[node * D + i]);
        }
        samples
    }
}

impl<const D: usize> Position<D> {
    /// The initial position.
    pub(super) fn new(law: Law, operator: &Operator<D>, stiffness: Stiffness<'_, D>, length: usize) -> Self {
        let initial_metric = if law == Law::Incremental { operator.metric().to_vec() } else { Vec::new() };
        let power = if let Stiffness::InverseJacobian { power } = stiffness { power } else { 0.0 };
        Position { bottom: vec![0.0; length], is_prepared: true, initial_metric, power, nodes: None }
    }

    /// Keeps the nodes if the low-order refinement will have to move.
    pub(super) fn keep_nodes(
        &mut self,
        law: Law,
        cells: usize,
        numbering: &NodeNumbering,
        at_nodes: &Sampler<'_, D>,
    ) -> Result<(), ElasticityError> {
        if law != Law::Linear {
            let samples = (0..cells).map(|cell| at_nodes.cell(cell)).collect::<Result<_, _>>()?;
            self.nodes = Some(Nodes { numbering: numbering.clone(), samples });
        }
        Ok(())
    }

    /// The displacement at the bottom of the slab; zero for [`Law::Linear`], where it does not matter.
    pub(super) fn bottom(&self) -> &[f64] {
        &self.bottom
    }
}

impl<const D: usize> ElasticMesh<D> {
    /// Takes K at the displacement `bottom`, that of the slab's bottom. What was there before has no influence: a run that is resumed
    /// here goes on with the same bits. [`Law::Linear`] has nothing to do.
    ///
    /// # Errors
    /// [`ElasticityError::Inverted`] or [`ElasticityError::NotDefinite`] if `bottom` is not a position of the mesh, or not a stable one.
    pub fn begin_slab(&mut self, bottom: &[f64]) -> Result<(), ElasticityError> {
        let is_there = self.position.is_prepared && self.position.bottom == bottom;
        if self.law == Law::Linear || is_there {
            return Ok(());
        }
        self.position.is_prepared = false;
        if self.law == Law::Incremental {
            let Position { initial_metric, power, .. } = &self.position;
            let metric = self.operator.moved_metric(initial_metric, bottom, *power)?;
            self.operator.set_metric(metric);
        }
        self.position.bottom.copy_from_slice(bottom);
        self.inverse = match &self.inverse {
            Inverse::Direct(condensation) => {
                let matrices = |batch| self.operator.cell_matrices(bottom, batch);
                Inverse::Direct(Box::new(condensation.elimination().factor(self.operator.batches(), matrices)?))
            }
            Inverse::LowOrder(low_order) => {
                let multigrid = low_order.is_multigrid().then_some(&self.coordinates[..]);
                Inverse::LowOrder(Box::new(self.low_order_at(bottom, multigrid)?))
            }
        };
        self.position.is_prepared = true;
        Ok(())
    }

    /// The low-order refinement of linear elasticity on the mesh that `d` has moved. A curved cell may be valid where a sub-cell between its
    /// nodes is inverted: then it is that of the initial mesh, which costs iterations, but no accuracy. A hierarchy for `multigrid` is made
    /// from the initial positions of all C0 nodes.
    fn low_order_at(&self, d: &[f64], multigrid: Option<&[[f64; D]]>) -> Result<LowOrder<D>, ElasticityError> {
        let nodes = self.position.nodes.as_ref().expect("they are kept where the refinement moves");
        let build = |d: &[f64]| {
            let samples = |cell| Ok(nodes.moved(cell, d));
            let (lame, cells) = (self.operator.lame(), nodes.samples.len());
            LowOrder::new(lame, 0.0, cells, &nodes.numbering, samples, &self.constrained, multigrid)
        };
        match build(d) {
            Err(ElasticityError::SubCell { .. }) => build(&vec![0.0; d.len()]),
            built => built,
        }
    }

    /// out = R(d), the forces on all nodes that hold the mesh in the position `d`. Nothing is allocated after a first call.
    ///
    /// # Errors
    /// [`Inversion`] where the law has no stress; `out` then has no meaning.
    pub fn forces(&self, d: &[f64], out: &mut [f64]) -> Result<(), Inversion> {
        debug_assert_eq!((d.len(), out.len()), (self.length(), self.length()));
        match self.law {
            Law::Linear | Law::NeoHookean => self.operator.forces(d, out),
            // The mesh at the bottom is free of stress.
            Law::Incremental => self.with_vector(|increment| {
                increment.iter_mut().zip(d).zip(&self.position.bottom).for_each(|((i, d), bottom)| *i = d - bottom);
                self.operator.forces(increment, out)
            }),
        }
    }

    /// out = dR/dd (d) w, the derivative of [`Self::forces`] at `d` along `w`. Nothing is allocated after a first call.
    pub fn product_at(&self, d: &[f64], w: &[f64], out: &mut [f64]) {
        self.operator.product(d, w, out);
    }
}
