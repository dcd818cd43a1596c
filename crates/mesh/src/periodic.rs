//! Boundaries that are translates of each other, and the distance between nodes that should coincide.

mod coincidence;
mod images;
mod joint;
#[cfg(test)]
mod tests;

use crate::{InteriorFacet, Mesh, MeshError, Side};
use coincidence::distance;
pub(crate) use coincidence::{LAST_PLACES, Place, TOLERANCE, coincident, last_place};
pub(crate) use images::align_images;
use joint::Joint;
use std::collections::{BTreeMap, BTreeSet};

/// Boundary `plus` is boundary `minus` translated: x_plus = x_minus + translation. Both are indices into the list of
/// boundaries passed to [`Mesh::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicPair<const D: usize> {
    /// The boundary that is translated.
    pub minus: usize,
    /// The boundary with which it coincides.
    pub plus: usize,
    /// x_plus - x_minus.
    pub translation: [f64; D],
}

/// A node of the plus side that is too far from its counterpart on the minus side.
pub(crate) struct Apart {
    position: Vec<f64>,
    distance: f64,
    tolerance: f64,
}

/// The first of `pairs` with a boundary that stands before it, also in the pair itself, and this boundary: each is in one pair, and there once.
pub(crate) fn joined_twice<T: Copy + Ord>(pairs: impl IntoIterator<Item = [T; 2]>) -> Option<(usize, T)> {
    let mut seen = BTreeSet::new();
    let mut entries = pairs.into_iter().enumerate().flat_map(|(number, pair)| pair.map(|boundary| (number, boundary)));
    entries.find(|(_, boundary)| !seen.insert(*boundary))
}

/// Whether `pairs` name boundaries that exist, of which there are `count`, and each of them once.
pub(crate) fn check_pairs<const D: usize>(pairs: &[PeriodicPair<D>], count: usize) -> Result<(), MeshError> {
    let boundaries = || pairs.iter().map(|pair| [pair.minus, pair.plus]);
    let is_unknown = |(_, boundary): &(usize, usize)| *boundary >= count;
    let mut entries = boundaries().enumerate().flat_map(|(pair, both)| both.map(|boundary| (pair, boundary)));
    match entries.find(is_unknown).or_else(|| joined_twice(boundaries())) {
        Some((pair, boundary)) => Err(MeshError::PairBoundary { pair, boundary, count }),
        None => Ok(()),
    }
}

/// The facets that join the two boundaries of `pair`.
pub(crate) fn match_pair<const D: usize>(
    mesh: &Mesh<D>,
    boundaries: &[(String, Vec<Side>)],
    pair: &PeriodicPair<D>,
) -> Result<Vec<InteriorFacet>, MeshError> {
    let ((minus, minus_sides), (plus, plus_sides)) = (&boundaries[pair.minus], &boundaries[pair.plus]);
    if minus_sides.len() != plus_sides.len() {
        let (minus_faces, plus_faces) = (minus_sides.len(), plus_sides.len());
        return Err(MeshError::PairCount { minus: minus.clone(), plus: plus.clone(), minus_faces, plus_faces });
    }
    let mut joint = Joint::new(mesh, boundaries, pair);
    plus_sides.iter().map(|&side| joint.facet(side)).collect()
}

impl<const D: usize> Mesh<D> {
    /// Pairs of boundaries, by index, that are translates of each other and could be joined.
    pub fn translated_boundaries(&self) -> Vec<PeriodicPair<D>> {
        let sides = |boundary: usize| {
            let facets = self.boundary_facets.iter().filter(move |facet| facet.boundary == boundary);
            facets.map(|facet| facet.side).collect::<Vec<_>>()
        };
        let boundaries: Vec<_> = self.boundary_names.iter().cloned().zip((0..).map(sides)).collect();
        let vertices = |(_, sides): &(String, Vec<Side>)| vertex_positions(self, sides).into_values().collect();
        let places: Vec<Vec<[f64; D]>> = boundaries.iter().map(vertices).collect();
        let pair = |minus: usize, plus: usize| PeriodicPair {
            minus,
            plus,
            translation: translation(&places[minus], &places[plus]),
        };
        let pairs = (0..boundaries.len()).flat_map(|plus| (0..plus).map(move |minus| pair(minus, plus)));
        pairs.filter(|pair| match_pair(self, &boundaries, pair).is_ok()).collect()
    }
}

/// The vertices of some faces and their positions.
fn vertex_positions<const D: usize>(mesh: &Mesh<D>, sides: &[Side]) -> BTreeMap<usize, [f64; D]> {
    sides.iter().flat_map(|&side| mesh.face_corners(side).into_iter().zip(mesh.face_corner_positions(side))).collect()
}

/// The translation between the points of two boundaries: along every axis the median of the differences of their coordinates, each in increasing
/// order. One point in a wrong place changes it little, and not at all if the order of the coordinates stays. Between means the translation would be
/// wrong for all points.
pub(crate) fn translation<const D: usize>(from: &[[f64; D]], to: &[[f64; D]]) -> [f64; D] {
    let sorted = |mut numbers: Vec<f64>| {
        numbers.sort_by(f64::total_cmp);
        numbers
    };
    std::array::from_fn(|i| {
        let [from, to] = [from, to].map(|points| sorted(points.iter().map(|x| x[i]).collect()));
        let differences = sorted(from.iter().zip(&to).map(|(from, to)| to - from).collect());
        differences.get(differences.len() / 2).copied().unwrap_or(0.0)
    })
}

/// Whether the two sides of `facet` have the same nodes after translation.
fn check_gap<const D: usize>(
    mesh: &Mesh<D>,
    facet: &InteriorFacet,
    translation: &[f64; D],
    tolerance: f64,
) -> Result<(), Apart> {
    let minus = mesh.face_positions(facet.minus);
    let plus = mesh.face_positions(facet.plus);
    for (i, x) in minus.iter().enumerate() {
        let y = &plus[facet.orientation.plus_index(D - 1, mesh.order, i)];
        let distance = distance(y, &std::array::from_fn(|i| x[i] + translation[i]));
        if distance > tolerance {
            return Err(Apart { position: y.to_vec(), distance, tolerance });
        }
    }
    Ok(())
}

/// How far the nodes of neighbours may be apart: not less than the rounding of their coordinates.
pub(crate) fn gap_tolerance<const D: usize>(mesh: &Mesh<D>) -> f64 {
    (TOLERANCE * mesh.diameter()).max(LAST_PLACES * last_place::<D>(&mesh.coordinates))
}

/// Whether two faces with the same corners are the same face, and not for instance both halves of a round hole.
pub(crate) fn is_same_face<const D: usize>(mesh: &Mesh<D>, facet: &InteriorFacet) -> bool {
    check_gap(mesh, facet, &[0.0; D], gap_tolerance(mesh)).is_ok()
}

/// Whether all neighbours share the nodes of their facets.
pub(crate) fn check_gaps<const D: usize>(mesh: &Mesh<D>) -> Result<(), MeshError> {
    let tolerance = gap_tolerance(mesh);
    for facet in &mesh.interior_facets {
        check_gap(mesh, facet, &[0.0; D], tolerance).map_err(|Apart { position, distance, tolerance }| {
            let (minus, plus) = (facet.minus.cell, facet.plus.cell);
            MeshError::Gap { minus, plus, position, distance, tolerance }
        })?;
    }
    Ok(())
}
