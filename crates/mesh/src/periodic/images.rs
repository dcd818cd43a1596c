//! Positions of nodes that periodicity identifies.

use super::coincidence::{TOLERANCE, distance, last_place};
use crate::facet::face_nodes;
use crate::numbering::numbered;
use crate::{InteriorFacet, Mesh};
use std::collections::{BTreeMap, BTreeSet};
use tensor::norm;

/// Nodes that are a translation apart up to this many units in the last place match exactly, and stay where they are.
const LAST_PLACES: f64 = 64.0;

/// If translations differ from the first one by less than this part of the tolerance, the images of no node are farther apart than the tolerance. A
/// corner has images across up to three facets, and the mean translation differs from the first one, too.
const CERTAIN: f64 = 0.125;

/// The nodes with which each node is identified, and the translations to them.
type Links<const D: usize> = BTreeMap<usize, Vec<(usize, [f64; D])>>;

/// Moves nodes that periodicity identifies so that they are translations apart, to round-off: files have few digits. Otherwise the two sides
/// of a facet had different normals, and a uniform flow would not stay uniform.
///
/// Every image of a node moves to the mean of all of them. `joined` has the facets of each pair of boundaries.
pub(crate) fn align_images<const D: usize>(mesh: &mut Mesh<D>, joined: &[Vec<InteriorFacet>]) {
    if joined.is_empty() {
        return;
    }
    let tolerance = LAST_PLACES * last_place::<D>(&mesh.coordinates);
    if joined.iter().all(|facets| are_translates(mesh, facets, CERTAIN * tolerance)) {
        return;
    }
    let (count, numbers) = numbered(mesh, mesh.order, |facet| !facet.periodic);
    let mut positions = vec![[0.0; D]; count];
    for (&number, x) in numbers.iter().zip(mesh.coordinates.as_chunks::<D>().0) {
        positions[number] = *x;
    }
    let mut links = Links::new();
    joined.iter().for_each(|facets| add_links(mesh, facets, &numbers, &positions, &mut links));
    if align(&mut positions, &links, tolerance) {
        let nodes = mesh.coordinates.as_chunks_mut::<D>().0.iter_mut();
        nodes.zip(numbers).for_each(|(x, number)| *x = positions[number]);
    }
}

/// Whether all nodes on both sides of `facets` are the same translation apart, up to `tolerance`. Generated meshes need no numbers of nodes.
fn are_translates<const D: usize>(mesh: &Mesh<D>, facets: &[InteriorFacet], tolerance: f64) -> bool {
    let mut first = None;
    facets.iter().all(|facet| {
        let (from, to) = (mesh.face_positions(facet.minus), mesh.face_positions(facet.plus));
        let twin = |i: usize| &to[facet.orientation.plus_index(D - 1, mesh.order, i)];
        let mut translations = from.iter().enumerate().map(|(i, x)| minus(twin(i), x));
        translations.all(|translation| distance(&translation, first.get_or_insert(translation)) <= tolerance)
    })
}

/// The links across the facets of one pair of boundaries. The translation is the mean over them: differences from the first one are small,
/// so that rounding of a long sum does not enter it.
fn add_links<const D: usize>(
    mesh: &Mesh<D>,
    facets: &[InteriorFacet],
    numbers: &[usize],
    positions: &[[f64; D]],
    links: &mut Links<D>,
) {
    let pairs: BTreeSet<(usize, usize)> = facets.iter().flat_map(|facet| twins(mesh, facet, numbers)).collect();
    let difference = |(a, b): (usize, usize)| minus(&positions[b], &positions[a]);
    let Some(first) = pairs.first().map(|&pair| difference(pair)) else { return };
    let deviation = |pair: &(usize, usize), i: usize| difference(*pair)[i] - first[i];
    let mean = |i| pairs.iter().map(|pair| deviation(pair, i)).sum::<f64>() / pairs.len() as f64;
    let translation = without_noise(std::array::from_fn(|i| first[i] + mean(i)));
    for (a, b) in pairs {
        links.entry(a).or_default().push((b, translation));
        links.entry(b).or_default().push((a, translation.map(|x| -x)));
    }
}

/// A translation along an axis has no part across it: that of nodes with few digits would move walls along the axis out of their planes.
fn without_noise<const D: usize>(translation: [f64; D]) -> [f64; D] {
    let least = TOLERANCE * norm(&translation);
    translation.map(|x| if x.abs() <= least { 0.0 } else { x })
}

/// The numbers of the nodes on both sides of `facet`.
fn twins<const D: usize>(mesh: &Mesh<D>, facet: &InteriorFacet, numbers: &[usize]) -> Vec<(usize, usize)> {
    let InteriorFacet { minus, plus, orientation, .. } = *facet;
    let lattice = |face| face_nodes(D, mesh.order, face);
    let (from, to) = (lattice(minus.face), lattice(plus.face));
    let number = |cell: usize, node: usize| numbers[cell * mesh.nodes_per_cell() + node];
    let twin = |i: usize| to[orientation.plus_index(D - 1, mesh.order, i)];
    from.iter().enumerate().map(|(i, &node)| (number(minus.cell, node), number(plus.cell, twin(i)))).collect()
}

/// Moves the nodes that are not a translation apart, up to `tolerance`; tells whether there are any.
fn align<const D: usize>(positions: &mut [[f64; D]], links: &Links<D>, tolerance: f64) -> bool {
    let (mut visited, mut has_moved) = (BTreeSet::new(), false);
    for &start in links.keys() {
        let images = images(start, links, &mut visited);
        let origin = positions[start];
        let shift = |(node, offset): &(usize, [f64; D])| minus(&minus(&positions[*node], offset), &origin);
        let shifts: Vec<[f64; D]> = images.iter().map(shift).collect();
        if shifts.iter().all(|shift| distance(shift, &[0.0; D]) <= tolerance) {
            continue;
        }
        let mean = |i: usize| shifts.iter().map(|shift| shift[i]).sum::<f64>() / shifts.len() as f64;
        let place: [f64; D] = std::array::from_fn(|i| origin[i] + mean(i));
        images.iter().for_each(|(node, offset)| positions[*node] = std::array::from_fn(|i| place[i] + offset[i]));
        has_moved = true;
    }
    has_moved
}

/// The images of node `start` that are not in `visited`, itself among them, with their translations from it: a node in a corner of a doubly
/// periodic box has four.
fn images<const D: usize>(start: usize, links: &Links<D>, visited: &mut BTreeSet<usize>) -> Vec<(usize, [f64; D])> {
    let mut images = Vec::new();
    if visited.insert(start) {
        images.push((start, [0.0; D]));
    }
    let mut next = 0;
    while let Some(&(node, offset)) = images.get(next) {
        for (image, translation) in links.get(&node).into_iter().flatten() {
            if visited.insert(*image) {
                images.push((*image, std::array::from_fn(|i| offset[i] + translation[i])));
            }
        }
        next += 1;
    }
    images
}

fn minus<const D: usize>(x: &[f64; D], y: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|i| x[i] - y[i])
}
