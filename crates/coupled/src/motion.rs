//! How the mesh of a run moves.

use elasticity::{Accuracy, ElasticMesh, ElasticSlab, ElasticityError, Guard, SlabMotion, Work};
use fem::VectorField;
use std::sync::Arc;

/// The displacement prescribed at boundary nodes.
#[derive(Clone)]
pub struct BoundaryMotion<const D: usize> {
    /// The displacement of each moving boundary as a function of reference position and time.
    pub fields: Vec<Arc<dyn VectorField<D>>>,
    /// For every C0 node the field that moves it, if it is constrained and does not stand still.
    pub field_of_node: Vec<Option<usize>>,
}

/// Where the displacement of the mesh comes from.
pub enum MeshMotion<const D: usize> {
    /// The mesh stands still.
    Still,
    /// The displacement of every node is prescribed.
    Prescribed(Arc<dyn VectorField<D>>),
    /// Boundaries move as prescribed and the interior follows like an elastic body.
    Elastic {
        /// K and its preconditioner.
        mesh: Box<ElasticMesh<D>>,
        /// The boundary.
        boundary: BoundaryMotion<D>,
        /// How exactly it is put into equilibrium.
        accuracy: Accuracy,
    },
}

impl<const D: usize> MeshMotion<D> {
    /// The displacement of nodes with reference positions `x`, `[node][component]`, at time `t`; for an elastic mesh zero at free
    /// nodes.
    pub fn prescribed(&self, x: &[[f64; D]], t: f64, out: &mut [f64]) {
        out.fill(0.0);
        for (node, (x, out)) in x.iter().zip(out.chunks_exact_mut(D)).enumerate() {
            let field = match self {
                MeshMotion::Still => None,
                MeshMotion::Prescribed(field) => Some(field),
                MeshMotion::Elastic { boundary, .. } => boundary.field_of_node[node].map(|f| &boundary.fields[f]),
            };
            if let Some(field) = field {
                out.copy_from_slice(&field.value(x, t));
            }
        }
    }

    /// Velocities whose displacement meets the prescribed one `g` at the time nodes; for an elastic mesh in equilibrium at
    /// all of them; found from the guess in `v` without leaving what `guard` allows.
    ///
    /// # Errors
    /// As [`ElasticSlab::equilibrium`].
    pub fn velocities(
        &self,
        motion: &SlabMotion,
        dt: f64,
        bottom: &[f64],
        g: &[f64],
        v: &mut [f64],
        guard: Guard<'_>,
    ) -> Result<Work, ElasticityError> {
        match self {
            MeshMotion::Still => v.fill(0.0),
            MeshMotion::Prescribed(_) => {
                v.copy_from_slice(g);
                motion.velocities(dt, bottom, v);
            }
            MeshMotion::Elastic { mesh, accuracy, .. } => {
                return ElasticSlab { mesh, motion, dt }.equilibrium(bottom, g, v, *accuracy, guard);
            }
        }
        Ok(Work::default())
    }
}
