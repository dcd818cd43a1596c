//! Whether surfaces are a mesh in the plane: all nodes have the same z.

use super::GmshError;
use super::file::{Element, File};
use tensor::{cross, dot, norm};

/// z of a plane mesh is constant up to this times its size ...
const PLANE: f64 = 1e-9;
/// ... or this many units in the last place of its largest coordinate.
const LAST_PLACES: f64 = 16.0;

/// Nodes lie in one plane, of any direction, up to this times their size. It decides between two messages only.
const TILTED: f64 = 1e-6;

/// The elements must lie at constant z.
pub(super) fn check(file: &File, elements: &[&Element]) -> Result<(), GmshError> {
    // Of the elements alone: a file may have other nodes, far away.
    let tolerance = tolerance(&positions(file, elements)?);
    let mut first = None;
    for element in elements {
        for (&node, [_, _, z]) in element.nodes.iter().zip(file.positions::<3>(element)?) {
            let first = *first.get_or_insert(z);
            if (z - first).abs() > tolerance {
                return Err(GmshError::NotPlane { node, z, first, tilted: is_plane(&positions(file, elements)?) });
            }
        }
    }
    Ok(())
}

/// How far z may vary over these positions.
fn tolerance(positions: &[[f64; 3]]) -> f64 {
    let bounds = |i: usize| {
        let along = positions.iter().map(|x| x[i]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let axes = [0, 1, 2].map(bounds);
    let size = axes.iter().fold(0.0, |size: f64, [low, high]| size.max(high - low));
    let largest = axes.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    (PLANE * size).max(LAST_PLACES * f64::EPSILON * largest)
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
