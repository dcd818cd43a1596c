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
    fn displacement<T: Transcendental, const D: usize>(&self, x: &[f64; D], t: T) -> [T; D] {
        let value = |(direction, motion, release): &(Direction, Program, Option<f64>)| {
            // After its release nothing is known of it.
            let t = release.map_or(t, |release| t.min(T::from(release)));
            (*direction, motion.evaluate(&[], t))
        };
        let x = in_space(x);
        let arm = std::array::from_fn(|i| x[i] - self.pivot[i]);
        BodyPosition::new(self.drives.iter().map(value)).displacement(&arm, 1.0)
    }
}

impl<const D: usize> BoundaryField<D> for DrivenBody {
    fn displacement(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        DrivenBody::displacement(self, x, t)
    }

    fn velocity(&self, _: usize, x: &[f64; D], t: f64) -> [f64; D] {
        DrivenBody::displacement(self, x, Dual::new(t, 1.0)).map(|d| d.derivative)
    }
}

/// The C0 nodes on the walls of bodies with prescribed coordinates, with the motion that these give them.
pub fn nodes_of_driven_bodies<const D: usize>(case: &Case<D>) -> Vec<PrescribedNode<D>> {
    let mut nodes = Vec::new();
    if case.bodies.is_empty() {
        return nodes;
    }
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let positions = numbering.positions(&case.mesh);
    for body in &case.bodies {
        let drive = |freedom: &case::Freedom| Some((freedom.direction, freedom.motion.clone()?, freedom.release));
        let drives: Vec<_> = body.freedoms.iter().filter_map(drive).collect();
        if drives.is_empty() {
            continue;
        }
        let field: Arc<dyn BoundaryField<D>> = Arc::new(DrivenBody { pivot: in_space(&body.pivot), drives });
        let walls = body.walls.iter().flat_map(|&wall| numbering.on_boundary(&case.mesh, wall));
        nodes.extend(walls.map(|node| (node, positions[node], field.clone())));
    }
    nodes
}
