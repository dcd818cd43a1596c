//! Whether surfaces are a mesh in the plane: all nodes have the same z.

use super::GmshError;
use super::file::{Element, File};
use crate::geometry::bounding_box;
use crate::periodic::{LAST_PLACES, last_place};
use tensor::{cross, dot, norm};

/// z of a plane mesh is constant up to this times its size, or up to the rounding of its coordinates.
const PLANE: f64 = 1e-9;

/// Nodes lie in one plane, of any direction, up to this times their size. It decides between two messages only.
const TILTED: f64 = 1e-6;

/// The elements must lie at constant z.
pub(super) fn check(file: &File, elements: &[&Element]) -> Result<(), GmshError> {
    // Of the elements alone: a file may have other nodes, far away.
    let positions = positions(file, elements)?;
    let Some(&[_, _, first]) = positions.first() else { return Ok(()) };
    let tolerance = tolerance(positions.as_flattened());
    let mut nodes = elements.iter().flat_map(|element| &element.nodes).zip(&positions);
    match nodes.find(|(_, [_, _, z])| (z - first).abs() > tolerance) {
        Some((&node, &[_, _, z])) => Err(GmshError::NotPlane { node, z, first, tilted: is_plane(&positions) }),
        None => Ok(()),
    }
}

/// How far z may vary over these coordinates, `[point][3]`.
fn tolerance(coordinates: &[f64]) -> f64 {
    let (lower, upper) = bounding_box::<3>(coordinates);
    let size = lower.iter().zip(upper).fold(0.0, |size: f64, (lower, upper)| size.max(upper - lower));
    (PLANE * size).max(LAST_PLACES * last_place::<3>(coordinates))
}

/// The positions of the nodes of all elements.
fn positions(file: &File, elements: &[&Element]) -> Result<Vec<[f64; 3]>, GmshError> {
    let mut all = Vec::new();
    for element in elements {
        all.extend(file.positions::<3>(element)?);
    }
    Ok(all)
}

/// Whether all points lie in one plane: the one through the first point, the point farthest from it, and the point farthest
/// from the line through both.
fn is_plane(points: &[[f64; 3]]) -> bool {
    let Some(first) = points.first() else { return true };
    let offsets: Vec<[f64; 3]> = points.iter().map(|x| std::array::from_fn(|i| x[i] - first[i])).collect();
    let along = longest(offsets.iter().copied());
    let normal = longest(offsets.iter().map(|offset| cross(&along, offset)));
    let tolerance = TILTED * norm(&along) * norm(&normal);
    offsets.iter().all(|offset| dot(&normal, offset).abs() <= tolerance)
}

/// The longest of some vectors.
fn longest(vectors: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    vectors.fold([0.0; 3], |longest, vector| if norm(&vector) > norm(&longest) { vector } else { longest })
}
