//! Boundaries whose nodes slide in their plane.

use super::mesh_crate::{Mesh, NodeNumbering};
use super::{Flow, Motion};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use std::collections::BTreeMap;
use tensor::AXES;

/// The C0 nodes of a boundary, and which components of their displacement it prescribes.
pub type Held<const D: usize> = BTreeMap<usize, [bool; D]>;

/// For every C0 node of `mesh` the components of its displacement that boundaries prescribe. A boundary prescribes all of them, unless
/// `slides` leaves some free.
pub fn constrained<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    slides: &[Option<Held<D>>],
) -> Vec<[bool; D]> {
    let mut constrained = vec![[false; D]; numbering.count];
    for (boundary, slide) in slides.iter().enumerate() {
        for node in numbering.on_boundary(mesh, boundary) {
            let held = slide.as_ref().map_or([true; D], |slide| slide[&node]);
            (0..D).for_each(|i| constrained[node][i] |= held[i]);
        }
    }
    constrained
}

/// Boundaries that slide, given at `key`, do not leave the whole mesh free along an axis.
pub(super) fn check_held<const D: usize>(checker: &Checker<'_>, key: &Key, slides: &[Option<Held<D>>]) -> Checked<()> {
    let holds =
        |slide: &Option<Held<D>>, axis: usize| slide.as_ref().is_none_or(|nodes| nodes.values().any(|held| held[axis]));
    let is_free = |axis: &usize| !slides.is_empty() && !slides.iter().any(|slide| holds(slide, *axis));
    let Some(axis) = (0..D).find(is_free) else { return Ok(()) };
    let problem = format!("nothing holds the mesh along {}: every boundary slides along it", AXES[axis]);
    Err(checker.combination(
        key,
        &problem,
        "a boundary that is \"fixed\" or moves, or one that slides in another plane",
    ))
}

/// A no-slip wall does not slide: gas would stick to nodes of the mesh, not to the wall.
pub(super) fn check_walls<const D: usize>(
    checker: &Checker<'_>,
    mesh: &Mesh<D>,
    motion: Option<&Motion<D>>,
    flow: Option<&Flow<D>>,
) -> Checked<()> {
    let (Some(Motion::Elastic { slides, .. }), Some(flow)) = (motion, flow) else { return Ok(()) };
    let both = |index: &usize| slides[*index].is_some() && flow.boundary[*index].condition.is_no_slip();
    let Some(index) = (0..slides.len()).find(both) else { return Ok(()) };
    let name = &mesh.boundary_names()[index];
    let problem =
        format!("boundary `{name}` is a wall without slip, which would drag gas along with the nodes that slide");
    let remedy = "\"fixed\" here, or \"slip_wall\" or \"symmetry\" in [flow.boundary]";
    Err(checker.combination(&Key::new("motion").child("boundary"), &problem, remedy))
}
