//! Edges of two boundaries that are translates of each other.

use super::edges::edges_of;
use crate::geometry::bounding_box;
use crate::gmsh::file::{Element, File};
use crate::mesh::point;
use crate::periodic::{self, Place, coincident};
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
    let of = |corners: &BTreeMap<u64, [f64; D]>| corners.values().copied().collect::<Vec<[f64; D]>>();
    let translation = periodic::translation(&of(&from), &of(&to));
    let all: Vec<f64> = from.values().chain(to.values()).flatten().copied().collect();
    let (lower, upper) = bounding_box::<D>(&all);
    let tolerance = periodic::TOLERANCE * norm(&from_fn::<f64, D, _>(|i| upper[i] - lower[i]));
    let translated = |x: &[f64; D]| from_fn(|i| x[i] + translation[i]);
    let positions = from.values().map(translated).chain(to.values().copied());
    let places: Vec<Place<D>> = positions.map(|position| Place { position, tolerance }).collect();
    let numbers = coincident(&places);
    let number = |corners: &BTreeMap<u64, [f64; D]>, numbers: &[usize]| -> BTreeMap<u64, usize> {
        corners.keys().copied().zip(numbers.iter().copied()).collect()
    };
    let (from, to) = (number(&from, &numbers), number(&to, &numbers[from.len()..]));
    coincident_edges(&edges_by_place(&minus, &from), &edges_by_place(&plus, &to))
}

/// The edges of some elements, by the numbers of the places of their ends. Both sides of a thin plate have edges at the same place.
fn edges_by_place(elements: &[&Element], places: &BTreeMap<u64, usize>) -> BTreeMap<[usize; 2], Vec<[u64; 2]>> {
    let mut edges: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for edge in elements.iter().flat_map(|element| edges_of(element)).flatten() {
        if let [Some(&a), Some(&b)] = edge.map(|node| places.get(&node)) {
            edges.entry([a.min(b), a.max(b)]).or_default().push(edge);
        }
    }
    edges
}

fn coincident_edges(
    minus: &BTreeMap<[usize; 2], Vec<[u64; 2]>>,
    plus: &BTreeMap<[usize; 2], Vec<[u64; 2]>>,
) -> Vec<[[u64; 2]; 2]> {
    let all = plus.iter().flat_map(|(place, edges)| edges.iter().map(move |edge| (place, *edge)));
    all.flat_map(|(place, edge)| minus.get(place).into_iter().flatten().map(move |twin| [edge, *twin])).collect()
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
