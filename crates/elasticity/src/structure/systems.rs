//! Systems of a structure: low-order matrices, scales of forces, wet boundaries.

use super::Structure;
use crate::ElasticityError;
use crate::geometry::{StiffnessSampler, node_spacing, rigid_motions};
use crate::low_order::{Inertia, LowOrderInverse, LowOrderTerms};
use crate::shifted::Shifted;
use basis::gauss_lobatto;
use faer::{Mat, Side};
use newton_krylov::inner_product::largest;
use std::array::from_fn;
use tensor::norm;

/// Supports that let a rigid motion go with this part of the product of the one that they hold most let it go: rounding.
const HELD: f64 = 1e-12;

/// All pairs of numbers below `count`.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |k| (0..count).map(move |l| (k, l)))
}

/// The eigenvalues of a symmetric matrix, increasing; none if they are not found. Compiled here once, and not for every dimension.
fn eigenvalues(matrix: &Mat<f64>) -> Vec<f64> {
    matrix.self_adjoint_eigenvalues(Side::Lower).unwrap_or_default()
}

impl<const D: usize> Structure<D> {
    /// The system K(d) + m M at free entries with its low-order matrix. `position` is d; empty means at rest. `layer` is an additional mass
    /// of every node; empty means none.
    ///
    /// The low-order matrix is that of linear elasticity on the mesh that d has moved. A curved cell may be valid although a sub-cell
    /// between its nodes is inverted. Then the mesh at rest is used, which costs iterations, but no accuracy.
    ///
    /// With a layer, K(d) omits the part that is proportional to the stress. The pressure of the fluid stresses the body, and it follows
    /// the surface of the body. Both effects cancel: with the first one alone, K(d) of a flag under pressure would be indefinite.
    pub(crate) fn shifted(
        &self,
        m: f64,
        layer: Vec<[[f64; D]; D]>,
        position: &[f64],
    ) -> Result<Shifted<D>, ElasticityError> {
        let rest = vec![0.0; if self.law().is_linear() { 0 } else { self.length() }];
        let moved = !rest.is_empty() && position.iter().any(|d| *d != 0.0);
        let low_order = match self.low_order(m, &layer, if moved { position } else { &[] }) {
            Err(ElasticityError::SubCell { .. }) if moved => self.low_order(m, &layer, &[])?,
            built => built?,
        };
        let material = !layer.is_empty();
        Ok(Shifted { m, low_order, layer, position: if moved { position.to_vec() } else { rest }, material })
    }

    fn low_order(&self, m: f64, layer: &[[[f64; D]; D]], d: &[f64]) -> Result<LowOrderInverse<D>, ElasticityError> {
        let base = self.solid.base()?;
        let nodes = gauss_lobatto(self.numbering.order());
        let at_nodes = StiffnessSampler::of_solid(&self.mesh, &self.solid, base, nodes);
        let inertia = Inertia { m, density: self.mass.density(), layer };
        let samples = |cell: usize| {
            let mut samples = at_nodes.cell(cell)?;
            for (sample, node) in samples.iter_mut().zip(self.numbering.cell(cell)).filter(|_| !d.is_empty()) {
                (0..D).for_each(|i| sample.position[i] += d[node * D + i]);
            }
            Ok(samples)
        };
        let (numbering, fixed) = (&self.numbering, &self.fixed);
        LowOrderInverse::new(&LowOrderTerms { lame: base, inertia, numbering, samples: &samples, fixed }, None)
    }

    /// Whether its supports leave no rigid motion: the products of rigid motions at fixed entries are a definite matrix.
    ///
    /// # Errors
    /// [`ElasticityError::RigidMotion`] if not.
    pub fn require_held(&self) -> Result<(), ElasticityError> {
        let held: Vec<(&[f64; D], &[bool; D])> =
            self.coordinates.iter().zip(&self.fixed).filter(|(_, fixed)| fixed.contains(&true)).collect();
        let centre: [f64; D] = from_fn(|i| held.iter().map(|(x, _)| x[i]).sum::<f64>() / held.len() as f64);
        let arm = |x: &[f64; D]| -> [f64; D] { from_fn(|i| x[i] - centre[i]) };
        let size = largest(held.iter().map(|(x, _)| norm(&arm(x))));
        let count = rigid_motions(&centre).count();
        let mut products = Mat::<f64>::zeros(count, count);
        for (x, fixed) in held {
            let scaled = if size > 0.0 { arm(x).map(|arm| arm / size) } else { [0.0; D] };
            let motions: Vec<[f64; D]> = rigid_motions(&scaled).collect();
            for (i, (k, l)) in (0..D).filter(|i| fixed[*i]).flat_map(|i| pairs(count).map(move |pair| (i, pair))) {
                products[(k, l)] += motions[k][i] * motions[l][i];
            }
        }
        match eigenvalues(&products)[..] {
            [least, .., most] if least > HELD * most => Ok(()),
            _ => Err(ElasticityError::RigidMotion),
        }
    }

    /// The number of entries whose motion is not prescribed.
    pub fn count_free(&self) -> usize {
        self.fixed().iter().filter(|fixed| !**fixed).count()
    }

    /// Whether it has `count` natural modes.
    ///
    /// # Errors
    /// [`ElasticityError::TooManyModes`] if not.
    pub fn require_modes(&self, count: usize) -> Result<(), ElasticityError> {
        let free = self.count_free();
        if count <= free { Ok(()) } else { Err(ElasticityError::TooManyModes { wanted: count, free }) }
    }

    /// The lumped integral of n n^T over the boundary facets with `wet` nodes only, by C0 node.
    pub fn wet_areas(&self, wet: &[bool]) -> Vec<[[f64; D]; D]> {
        self.surface.areas(wet)
    }

    /// The diagonal of K + m M with lumped masses: the scale of the forces at every entry.
    pub fn force_scales(&self, m: f64) -> Vec<f64> {
        let (mut scales, mut excess, mut masses) =
            (vec![0.0; self.length()], vec![0.0; self.length()], vec![0.0; self.length()]);
        self.operator.diagonal(&mut scales);
        if let Some(operator) = &self.excess {
            operator.diagonal(&mut excess);
        }
        self.apply_mass(&vec![1.0; self.length()], &mut masses);
        scales.iter_mut().zip(excess.iter().zip(&masses)).for_each(|(k, (excess, mass))| *k += excess + m * mass);
        scales
    }

    /// The distance of every C0 node to its nearest neighbour along the lines of its cells.
    pub fn node_spacing(&self) -> Vec<f64> {
        node_spacing(&self.mesh, &self.numbering)
    }

    /// An m of the size of the lowest squared frequency of a compact body: (mu / rho) / (diameter)^2.
    pub(crate) fn typical_shift(&self) -> f64 {
        self.shear_modulus / self.mass.density() / self.mesh.diameter().powi(2)
    }
}
