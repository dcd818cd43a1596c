//! Where K is taken: the position of the mesh at the bottom of the slab.

use super::ElasticMesh;
use crate::operator::Operator;
use crate::solver::Inverse;
use crate::{ElasticityError, Inversion, Law, Stiffness};
use tensor::Pack;

/// The displacement at the bottom of the slab, and what it takes to move the reference mesh there.
pub(super) struct Position {
    bottom: Vec<f64>,
    /// Whether the inverse is that of K there.
    is_prepared: bool,
    /// Of [`Law::Incremental`]: W and G of the initial mesh.
    initial_metric: Vec<Pack>,
    /// The power of det J in the stiffness; 0 for one that stays with the material.
    power: f64,
}

impl Position {
    /// The initial position.
    pub(super) fn new<const D: usize>(
        law: Law,
        operator: &Operator<D>,
        stiffness: Stiffness<'_, D>,
        length: usize,
    ) -> Self {
        let initial_metric = if law == Law::Incremental { operator.metric().to_vec() } else { Vec::new() };
        let power = if let Stiffness::InverseJacobian { power } = stiffness { power } else { 0.0 };
        Position { bottom: vec![0.0; length], is_prepared: true, initial_metric, power }
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
        if let Inverse::Direct(condensation) = &self.inverse {
            let matrices = |batch| self.operator.cell_matrices(bottom, batch);
            let factor = condensation.elimination().factor(self.operator.batches(), matrices)?;
            self.inverse = Inverse::Direct(Box::new(factor));
        }
        self.position.is_prepared = true;
        Ok(())
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
