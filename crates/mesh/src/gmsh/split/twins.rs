//! Edges of two boundaries that are translates of each other.

use super::edges::{edges_of, sorted};
use crate::geometry::bounding_box;
use crate::gmsh::file::{Element, File};
use crate::mesh::point;
use crate::periodic;
use std::array::from_fn;
use std::collections::BTreeMap;
use tensor::norm;

/// Pairs of edges that coincide after the translation between the pairs of boundaries. Boundaries without a twin give
/// none: they are refused later.
pub(super) fn edges<const D: usize>(file: &File, pairs: &[(String, String)]) -> Vec<[[u64; 2]; 2]> {
    pairs.iter().flat_map(|(minus, plus)| edges_of_pair::<D>(file, minus, plus)).collect()
}

fn edges_of_pair<const D: usize>(file: &File, minus: &str, plus: &str) -> Vec<[[u64; 2]; 2]> {
    let (minus, plus) = (boundary::<D>(file, minus), boundary::<D>(file, plus));
    let (from, to) = (corners::<D>(file, &minus), corners::<D>(file, &plus));
    let (start, end) = (mean(&from), mean(&to));
    let all: Vec<f64> = from.values().chain(to.values()).flatten().copied().collect();
    let (lower, upper) = bounding_box::<D>(&all);
    let tolerance = periodic::TOLERANCE * norm(&from_fn::<f64, D, _>(|i| upper[i] - lower[i]));
    let translation = from_fn(|i| end[i] - start[i]);
    let Ok(twin) = periodic::twins(&from, &to, &translation, tolerance) else { return Vec::new() };
    let edges = plus.iter().flat_map(|element| edges_of(element)).flatten();
    edges.filter_map(|[a, b]| Some([[a, b], sorted([*twin.get(&a)?, *twin.get(&b)?])])).collect()
}

/// The elements of the boundary `name`.
fn boundary<'a, const D: usize>(file: &'a File, name: &str) -> Vec<&'a Element> {
    let is_there = |element: &&Element| {
        element.kind.dimension() == D - 1 && element.groups.iter().any(|&group| file.name(D - 1, group) == name)
    };
    file.elements.iter().filter(is_there).collect()
}

/// The corners of some elements and their positions.
fn corners<const D: usize>(file: &File, elements: &[&Element]) -> BTreeMap<u64, [f64; D]> {
    let nodes = elements.iter().flat_map(|element| &element.nodes[..element.kind.shape.corners().len()]);
    nodes.filter_map(|node| Some((*node, point(file.nodes.get(node)?, 0)))).collect()
}

fn mean<const D: usize>(points: &BTreeMap<u64, [f64; D]>) -> [f64; D] {
    from_fn(|i| points.values().map(|x| x[i]).sum::<f64>() / points.len() as f64)
}
