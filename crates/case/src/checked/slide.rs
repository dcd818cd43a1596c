//! The sliding of a wall in its own plane.

use super::mesh_crate::Mesh;
use super::openings::nodes_with_normals;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;

/// The fraction of its velocity with which a wall may leave its plane, for the accuracy of the geometry of a file.
const OUT_OF_PLANE: f64 = 1e-6;

/// Checks that a `boundary` of `mesh` slides along itself if its condition `raw`, given at `key`, lets it slide. The kernels take only the
/// tangential part of the velocity, so another part would be ignored silently.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    mesh: &Mesh<D>,
    boundary: usize,
) -> Checked<()> {
    let (name, slide) = match raw {
        raw::Condition::AdiabaticWall(wall) => ("adiabatic_wall", &wall.slide),
        raw::Condition::IsothermalWall(wall) => ("isothermal_wall", &wall.slide),
        _ => return Ok(()),
    };
    let Some(slide) = slide else { return Ok(()) };
    let along = |normal: &[f64; D]| slide.iter().zip(normal).map(|(w, n)| w * n).sum::<f64>();
    let speed = slide.iter().map(|w| w * w).sum::<f64>().sqrt();
    let nodes = nodes_with_normals(mesh, boundary);
    let leaves = nodes.into_iter().find(|(_, normal)| along(normal).abs() > OUT_OF_PLANE * speed);
    let Some((x, normal)) = leaves else { return Ok(()) };
    let problem = format!(
        "the wall does not slide in its plane: at {x:?}, where its normal is {normal:.6?}, it would move by {:.3e} along that",
        along(&normal)
    );
    let accepted = "a velocity along the wall everywhere; a wall that moves otherwise, such as one that turns, is given in [motion]";
    Err(checker.combination(&key.child(name).child("slide"), &problem, accepted))
}
