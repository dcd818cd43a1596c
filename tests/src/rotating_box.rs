//! A box that turns within a larger one: section III.C of Diosady & Murman, AIAA 2018-0919. Time is the angle in degrees.

use coupled::{BoundaryDisplacement, MarchError, MeshMarch, MeshMotion, MeshMover, MeshReport, Schedule};
use elasticity::{Accuracy, ElasticMesh, Law, Material, Stiffness};
use fem::VectorField;
use mesh::NodeNumbering;
use mesh::generate::RotatingBoxMesh;
use std::sync::Arc;

/// Rotation about the origin by t degrees.
struct Turning;

impl VectorField<2> for Turning {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let (sin, cos) = t.to_radians().sin_cos();
        [cos * x[0] - sin * x[1] - x[0], sin * x[0] + cos * x[1] - x[1]]
    }
    fn rate(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let (sin, cos) = t.to_radians().sin_cos();
        [-sin * x[0] - cos * x[1], cos * x[0] - sin * x[1]].map(f64::to_radians)
    }
}

/// (5) of the paper: stiff at the inner box and, less so, at the outer one.
fn stiffness(x: &[f64; 2]) -> f64 {
    let d0 = 0.05;
    let beyond = x.map(|x| (x.abs() - 0.1).max(0.0));
    let inner = beyond[0].hypot(beyond[1]);
    let outer = 0.5 - x[0].abs().max(x[1].abs());
    let d = (inner - d0).min(outer + 2.0 * d0).max(0.0);
    1.0 + 100.0 / (1.0 + (d / d0).powi(2))
}

/// The setting of a run.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Nodes per direction; the mesh has 80 / order cells per side.
    pub order: usize,
    /// Nodes per slab.
    pub time_order: usize,
    /// The law of the mesh.
    pub law: Law,
    /// Degrees per slab.
    pub step: f64,
    /// The end, in degrees.
    pub end: f64,
    /// The tolerance of Newton's method, relative to the node spacing.
    pub accuracy: f64,
}

impl Turn {
    /// The march from rest to the end.
    pub fn march(&self) -> MeshMarch<2> {
        let mesh = RotatingBoxMesh::unit(80 / self.order, self.order).build().unwrap();
        let numbering = NodeNumbering::new(&mesh, self.order);
        let (mut constrained, mut field_of_node) = (vec![[false; 2]; numbering.count], vec![None; numbering.count]);
        for (boundary, name) in mesh.boundary_names().iter().enumerate() {
            for node in numbering.on_boundary(&mesh, boundary) {
                constrained[node] = [true; 2];
                field_of_node[node] = (name == "inner").then_some(0);
            }
        }
        let material = Material::new(1.0, 0.4).unwrap().with_law(self.law);
        let elastic = ElasticMesh::new(&mesh, &numbering, material, Stiffness::Function(&stiffness), &constrained);
        let motion = MeshMotion::Elastic {
            mesh: Box::new(elastic.unwrap()),
            boundary: BoundaryDisplacement { fields: vec![Arc::new(Turning)], field_of_node },
            accuracy: Accuracy { solve: if self.law.is_linear() { 1e-13 } else { 1e-3 }, position: self.accuracy },
        };
        let mover = MeshMover::new(motion, mesh, numbering, self.time_order);
        MeshMarch::new(mover, Schedule::uniform(self.end, (self.end / self.step).round() as usize), 0)
    }

    /// Turns until the end, or until a slab is not proved valid. Returns the reports of the valid slabs, and the error that ended the
    /// run.
    pub fn run(&self) -> (Vec<MeshReport>, Option<MarchError>) {
        let mut march = self.march();
        let mut reports = Vec::new();
        while !march.is_done() {
            match march.advance() {
                Ok(report) if report.quality.is_valid() => reports.push(report),
                Ok(_) => break,
                Err(error) => return (reports, Some(error)),
            }
        }
        (reports, None)
    }
}
