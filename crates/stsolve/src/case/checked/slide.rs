//! Velocities that a boundary is given go with its normal: a wall slides in its plane, an inflow enters.

use super::mesh_crate::Mesh;
use crate::case::checker::{Checked, Checker};
use crate::case::key::Key;
use crate::case::raw;

/// The part of its velocity with which a wall may leave its plane: accuracy of the geometry of a file.
const OUT_OF_PLANE: f64 = 1e-6;

/// A `boundary` of `mesh` whose condition `raw`, given at `key`, lets it slide moves along itself. The kernels take the tangential part of
/// the velocity: another part would be lost without a word.
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
    let facets = mesh.normals_of_facets(mesh.order(), boundary);
    let leaves = facets.into_iter().find(|(.., normal)| along(normal).abs() > OUT_OF_PLANE * speed);
    let Some((.., x, normal)) = leaves else { return Ok(()) };
    let problem = format!(
        "the wall does not slide in its plane: at {x:?}, where its normal is {normal:.6?}, it would move by {:.3e} along that",
        along(&normal)
    );
    let accepted = "a velocity along the wall everywhere; a wall that moves otherwise, such as one that turns, is given in [motion]";
    Err(checker.combination(&key.child(name).child("slide"), &problem, accepted))
}

/// The direction of an inflow enters the domain somewhere on its `boundary`.
pub(super) fn check_inflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    mesh: &Mesh<D>,
    boundary: usize,
) -> Checked<()> {
    let raw::Condition::Inflow(inflow) = raw else { return Ok(()) };
    let along = |normal: &[f64; D]| inflow.direction.iter().zip(normal).map(|(w, n)| w * n).sum::<f64>();
    let facets = mesh.normals_of_facets(mesh.order(), boundary);
    if facets.is_empty() || facets.iter().any(|(.., normal)| along(normal) < 0.0) {
        return Ok(());
    }
    let (.., x, normal) = &facets[0];
    let problem = format!("the inflow does not enter the domain, whose normal out of it is {normal:.6?} at {x:?}");
    let accepted = "a direction that leads into the domain; the condition `outflow` where the gas leaves";
    Err(checker.combination(&key.child("inflow").child("direction"), &problem, accepted))
}
