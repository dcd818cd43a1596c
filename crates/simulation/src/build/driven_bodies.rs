//! The prescribed motions of rigid bodies, for checks before a run.

use super::PrescribedNode;
use crate::bodies::in_space;
use case::Case;
use case::expression::Program;
use coupled::BoundaryField;
use coupled::blocks::rigid_body::{BodyPosition, Freedom as Direction, Vec3};
use mesh::NodeNumbering;
use std::sync::Arc;
use tensor::{Dual, Transcendental};

/// A body whose free coordinates rest.
struct DrivenBody {
    pivot: Vec3,
    /// The coordinates that are driven: direction, value, and the time when the drive ends.
    drives: Vec<(Direction, Program, Option<f64>)>,
}

impl DrivenBody {
    /// The body, if it is driven.
    fn new<const D: usize>(body: &case::RigidBody<D>) -> Option<DrivenBody> {
        let drive = |freedom: &case::Freedom| Some((freedom.direction, freedom.motion.clone()?, freedom.release));
        let drives: Vec<_> = body.freedoms.iter().filter_map(drive).collect();
        (!drives.is_empty()).then(|| DrivenBody { pivot: in_space(&body.pivot), drives })
    }

    /// The displacement of the point that is at `x` at rest, with the `weight` of (rigid motion).
    fn displacement<T: Transcendental, const D: usize>(&self, x: &[f64; D], weight: f64, t: T) -> [T; D] {
        let value = |(direction, motion, release): &(Direction, Program, Option<f64>)| {
            // After its release nothing is known of it.
            let t = release.map_or(t, |release| t.min(T::from(release)));
            (*direction, motion.evaluate(&[], t))
        };
        let x = in_space(x);
        let arm = std::array::from_fn(|i| x[i] - self.pivot[i]);
        BodyPosition::new(self.drives.iter().map(value)).displacement(&arm, weight)
    }
}

impl<const D: usize> BoundaryField<D> for DrivenBody {
    fn displacement(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        DrivenBody::displacement(self, x, 1.0, t)
    }

    fn velocity(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        DrivenBody::displacement(self, x, 1.0, Dual::new(t, 1.0)).map(|d| d.derivative)
    }
}

/// A mesh that follows driven bodies by weights.
pub(super) struct MeshOfDrivenBodies<const D: usize>(Vec<(case::RigidBody<D>, DrivenBody)>);

impl<const D: usize> MeshOfDrivenBodies<D> {
    pub(super) fn new(case: &Case<D>) -> MeshOfDrivenBodies<D> {
        let driven = |body: &case::RigidBody<D>| Some((body.clone(), DrivenBody::new(body)?));
        MeshOfDrivenBodies(case.bodies.iter().filter_map(driven).collect())
    }

    fn displacement<T: Transcendental>(&self, x: &[f64; D], t: T) -> [T; D] {
        let of_body = |(body, driven): &(case::RigidBody<D>, DrivenBody)| {
            body.weight(x).map(|weight| driven.displacement(x, weight, t))
        };
        let sum = |a: [T; D], b: [T; D]| std::array::from_fn(|d| a[d] + b[d]);
        self.0.iter().filter_map(of_body).fold([T::from(0.0); D], sum)
    }
}

impl<const D: usize> BoundaryField<D> for MeshOfDrivenBodies<D> {
    fn displacement(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        MeshOfDrivenBodies::displacement(self, x, t)
    }

    fn velocity(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        MeshOfDrivenBodies::displacement(self, x, Dual::new(t, 1.0)).map(|d| d.derivative)
    }
}

/// The motion of every driven body, and the C0 nodes on its walls.
pub(super) fn driven_bodies<const D: usize>(
    case: &Case<D>,
    numbering: &NodeNumbering,
) -> Vec<(Arc<dyn BoundaryField<D>>, Vec<usize>)> {
    let on_walls = |body: &case::RigidBody<D>| {
        body.walls.iter().flat_map(|&wall| numbering.on_boundary(&case.mesh, wall)).collect()
    };
    let field = |body| DrivenBody::new(body).map(|driven| Arc::new(driven) as Arc<dyn BoundaryField<D>>);
    case.bodies.iter().filter_map(|body| Some((field(body)?, on_walls(body)))).collect()
}

/// The C0 nodes on the walls of bodies with prescribed coordinates, with the motion that these give them.
pub fn nodes_of_driven_bodies<const D: usize>(case: &Case<D>) -> Vec<PrescribedNode<D>> {
    if case.bodies.is_empty() {
        return Vec::new();
    }
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let positions = numbering.positions(&case.mesh);
    let bodies = driven_bodies(case, &numbering).into_iter();
    bodies
        .flat_map(|(field, nodes)| nodes.into_iter().map(move |node| (node, field.clone())))
        .map(|(node, field)| (node, positions[node], field))
        .collect()
}
