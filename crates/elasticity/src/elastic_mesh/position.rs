//! The position of the mesh at the bottom of the slab, where K is evaluated.

use super::ElasticMesh;
use crate::geometry::{Sample, StiffnessSampler};
use crate::low_order::{Inertia, LowOrderInverse, LowOrderTerms};
use crate::operator::Operator;
use crate::solver::Inverse;
use crate::{ElasticityError, Inversion, Law, Stiffness};
use mesh::NodeNumbering;
use tensor::Pack;

/// The displacement at the bottom of the slab, and the data needed to move the reference mesh there.
pub(super) struct Position<const D: usize> {
    bottom: Vec<f64>,
    /// Whether the prepared inverse belongs to K there.
    is_prepared: bool,
    /// Of [`Law::Incremental`]: W and G of the initial mesh.
    initial_metric: Vec<Pack>,
    /// The power of det J in the stiffness; 0 for a stiffness that is fixed to the material.
    power: f64,
    /// The data of the low-order refinement of a moved mesh, if there is one.
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
        numbering: &NodeNumbering,
        at_nodes: &StiffnessSampler<'_, D>,
    ) -> Result<(), ElasticityError> {
        if law != Law::Linear {
            let samples = (0..numbering.n_cells()).map(|cell| at_nodes.cell(cell)).collect::<Result<_, _>>()?;
            self.nodes = Some(Nodes { numbering: numbering.clone(), samples });
        }
        Ok(())
    }

    /// The displacement at the bottom of the slab; zero for [`Law::Linear`], which does not use it.
    pub(super) fn bottom(&self) -> &[f64] {
        &self.bottom
    }
}

impl<const D: usize> ElasticMesh<D> {
    /// Evaluates K at the displacement `bottom` of the slab's bottom. Earlier positions have no influence, so a run that is resumed
    /// here continues with the same bits. [`Law::Linear`] has nothing to do.
    ///
    /// # Errors
    /// [`ElasticityError::Inverted`] or [`ElasticityError::NotDefinite`] if `bottom` is not a valid and stable position of the mesh.
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
        let matrices = |batch| self.operator.cell_matrices(bottom, batch);
        self.inverse = match &self.inverse {
            Inverse::Direct(condensation) => {
                Inverse::Direct(Box::new(condensation.elimination().factor(self.operator.batches(), &matrices)?))
            }
            Inverse::Substructures(substructures) => {
                Inverse::Substructures(Box::new(substructures.with_matrices(&matrices)?))
            }
            Inverse::LowOrder(low_order) => {
                let multigrid = low_order.is_multigrid().then_some(&self.coordinates[..]);
                Inverse::LowOrder(Box::new(self.low_order_at(bottom, multigrid)?))
            }
        };
        self.position.is_prepared = true;
        Ok(())
    }

    /// The low-order refinement of linear elasticity on the mesh moved by `d`. A curved cell may be valid although a sub-cell between its
    /// nodes is inverted. Then the refinement of the initial mesh is used, which costs iterations, but no accuracy. A hierarchy for
    /// `multigrid` is made from the initial positions of all C0 nodes.
    fn low_order_at(&self, d: &[f64], multigrid: Option<&[[f64; D]]>) -> Result<LowOrderInverse<D>, ElasticityError> {
        let nodes = self.position.nodes.as_ref().expect("they are kept where the refinement moves");
        let build = |d: &[f64]| {
            let (lame, inertia) = (self.operator.lame(), Inertia::none());
            let (samples, fixed) = (|cell| Ok(nodes.moved(cell, d)), &self.constrained);
            let terms = LowOrderTerms { lame, inertia, numbering: &nodes.numbering, samples: &samples, fixed };
            LowOrderInverse::new(&terms, multigrid)
        };
        match build(d) {
            Err(ElasticityError::SubCell { .. }) => build(&vec![0.0; d.len()]),
            built => built,
        }
    }

    /// out = R(d), the forces on all nodes that hold the mesh at the displacement `d`. Nothing is allocated after a first
    /// call.
    ///
    /// # Errors
    /// [`Inversion`] where the law has no stress; `out` is then meaningless.
    pub fn forces(&self, d: &[f64], out: &mut [f64]) -> Result<(), Inversion> {
        debug_assert_eq!((d.len(), out.len()), (self.length(), self.length()));
        match self.law {
            Law::Linear | Law::NeoHookean | Law::StVenantKirchhoff => self.operator.forces(d, out),
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
