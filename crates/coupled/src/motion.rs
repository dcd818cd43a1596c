//! How the mesh of a run moves.

use elasticity::{Accuracy, ElasticMesh, ElasticSlab, ElasticityError, Guard, SlabMotion, Work};
use fem::{Clock, VectorField};
use std::sync::Arc;

/// The displacement of a boundary that moves.
pub trait BoundaryField<const D: usize>: Send + Sync {
    /// The displacement of C0 node `node`, at `x` at rest, at time `t`.
    fn displacement(&self, node: usize, x: &[f64; D], t: f64) -> [f64; D];
    /// Its time derivative.
    fn velocity(&self, node: usize, x: &[f64; D], t: f64) -> [f64; D];
}

/// A displacement that is known everywhere.
impl<F: VectorField<D>, const D: usize> BoundaryField<D> for F {
    fn displacement(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        self.value(x, t)
    }
    fn velocity(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        self.rate(x, t)
    }
}

/// The displacement prescribed at boundary nodes.
#[derive(Clone)]
pub struct BoundaryDisplacement<const D: usize> {
    /// The displacement of each moving boundary.
    pub fields: Vec<Arc<dyn BoundaryField<D>>>,
    /// For every C0 node the field that moves it in all components, if there is one. All other constrained entries stand still.
    pub field_of_node: Vec<Option<usize>>,
}

/// Where the displacement of the mesh comes from.
pub enum MeshMotion<const D: usize> {
    /// The mesh stands still.
    Still,
    /// The displacement of every node is prescribed.
    Prescribed(Arc<dyn BoundaryField<D>>),
    /// Bodies move every node.
    Followed,
    /// Boundaries move as prescribed and the interior follows like an elastic body.
    Elastic {
        /// K and its preconditioner.
        mesh: Box<ElasticMesh<D>>,
        /// The boundary.
        boundary: BoundaryDisplacement<D>,
        /// The accuracy of its equilibrium.
        accuracy: Accuracy,
    },
}

/// What determines the motion of a mesh in a slab.
#[derive(Clone, Copy, Debug)]
pub struct SlabData<'a> {
    /// The length of the slab.
    pub dt: f64,
    /// The displacement at its bottom, `[C0 node][component]`.
    pub bottom: &'a [f64],
    /// The displacement prescribed at its time nodes, `[time node][C0 node][component]`.
    pub prescribed: &'a [f64],
}

impl<const D: usize> MeshMotion<D> {
    /// The field that moves `node`, if its motion is prescribed.
    fn field_of(&self, node: usize) -> Option<&dyn BoundaryField<D>> {
        match self {
            MeshMotion::Still | MeshMotion::Followed => None,
            MeshMotion::Prescribed(field) => Some(&**field),
            MeshMotion::Elastic { boundary, .. } => boundary.field_of_node[node].map(|field| &*boundary.fields[field]),
        }
    }

    /// The displacement of nodes with reference positions `x`, `[node][component]`, at time `t`; for an elastic mesh zero at free
    /// entries.
    pub fn prescribed(&self, x: &[[f64; D]], t: f64, out: &mut [f64]) {
        for (node, (x, out)) in x.iter().zip(out.chunks_exact_mut(D)).enumerate() {
            let displacement = self.field_of(node).map_or([0.0; D], |field| field.displacement(node, x, t));
            out.copy_from_slice(&displacement);
        }
    }

    /// Sets the velocity `v`, `[node][component]`, of nodes whose motion is prescribed to the prescribed one at time `t`, if that is
    /// finite: a displacement like sqrt(t) has an infinite velocity at t = 0.
    pub fn prescribe_velocity(&self, x: &[[f64; D]], t: f64, v: &mut [f64]) {
        for (node, (x, v)) in x.iter().zip(v.chunks_exact_mut(D)).enumerate() {
            let velocity = self.field_of(node).map(|field| field.velocity(node, x, t));
            if let Some(velocity) = velocity.filter(|velocity| velocity.iter().all(|v| v.is_finite())) {
                v.copy_from_slice(&velocity);
            }
        }
    }

    /// The displacements at the time nodes of a slab of length `dt`, `[time node][node][component]`, of nodes that start from `bottom` and have
    /// the prescribed velocity, (prescribed) of `elasticity::slab`. Zero where nothing is prescribed, and for an elastic mesh at free entries.
    pub fn prescribed_in_slab(
        &self,
        x: &[[f64; D]],
        motion: &SlabMotion,
        (clock, dt): (Clock, f64),
        bottom: &[f64],
        out: &mut [f64],
    ) {
        out.fill(0.0);
        for (node, (x, at_bottom)) in x.iter().zip(bottom.chunks_exact(D)).enumerate() {
            let Some(field) = self.field_of(node) else { continue };
            let times = motion.times_of_prescribed().iter();
            let g: Vec<f64> = times.flat_map(|s| field.displacement(node, x, clock.time(*s))).collect();
            let (top, v) = (g[g.len() - D..].to_vec(), motion.prescribed(dt, at_bottom, g));
            for (a, out) in out.chunks_exact_mut(bottom.len()).enumerate() {
                motion.displacement_at_node(dt, at_bottom, &v, a, &mut out[node * D..][..D]);
            }
            // Without round-off.
            let last = out.len() - bottom.len();
            out[last + node * D..][..D].copy_from_slice(&top);
        }
    }

    /// Replaces the guess `v` by velocities that meet the prescribed displacement at the time nodes. An elastic mesh is in equilibrium at
    /// all of them, and no iterate violates `guard`.
    ///
    /// # Errors
    /// As [`ElasticSlab::equilibrium`].
    pub fn velocities(
        &self,
        motion: &SlabMotion,
        data: SlabData<'_>,
        v: &mut [f64],
        guard: Guard<'_>,
    ) -> Result<Work, ElasticityError> {
        let SlabData { dt, bottom, prescribed: g } = data;
        match self {
            MeshMotion::Still => v.fill(0.0),
            MeshMotion::Prescribed(_) | MeshMotion::Followed => {
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
