//! Boundaries that are translates of each other, and the distance between nodes that should coincide.

use crate::topology::{face_key, not_manifold};
use crate::{InteriorFacet, Mesh, MeshError, Orientation, Side, tangent_sign};
use std::collections::BTreeMap;
use tensor::norm;

/// Two nodes coincide if they are closer than this times the diameter of the mesh, since files have about ten digits.
pub(crate) const TOLERANCE: f64 = 1e-9;

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

/// Whether pair `number` names two boundaries that exist and are in no other pair.
pub(crate) fn check_pair<const D: usize>(
    number: usize,
    pairs: &[PeriodicPair<D>],
    count: usize,
) -> Result<(), MeshError> {
    let in_earlier = |boundary| pairs[..number].iter().any(|pair| pair.minus == boundary || pair.plus == boundary);
    let PeriodicPair { minus, plus, .. } = pairs[number];
    for (boundary, other) in [(minus, plus), (plus, minus)] {
        if boundary >= count || boundary == other || in_earlier(boundary) {
            return Err(MeshError::PairBoundary { pair: number, boundary, count });
        }
    }
    Ok(())
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
    let tolerance = TOLERANCE * mesh.diameter();
    let mismatch = |apart: Apart| {
        let (minus, plus, Apart { position, distance, tolerance }) = (minus.clone(), plus.clone(), apart);
        MeshError::PeriodicMismatch { minus, plus, position, distance, tolerance }
    };
    let (from, to) = (vertex_positions(mesh, minus_sides), vertex_positions(mesh, plus_sides));
    let twin = twins(&from, &to, &pair.translation, tolerance).map_err(mismatch)?;
    let by_vertices: BTreeMap<_, _> =
        minus_sides.iter().map(|&side| (face_key(mesh.face_corners(side)), side)).collect();

    let mut facets = Vec::with_capacity(plus_sides.len());
    for &side in plus_sides {
        let facet = twin_facet(mesh, side, &twin, &by_vertices)?;
        check_gap(mesh, &facet, &pair.translation, tolerance).map_err(mismatch)?;
        if !has_two_sides(&facet) {
            let position = mesh.face_centre(side);
            return Err(MeshError::SameSide { minus: minus.clone(), plus: plus.clone(), position });
        }
        facets.push(facet);
    }
    Ok(facets)
}

/// Whether the outward normals of both sides of `facet` are opposite.
fn has_two_sides(facet: &InteriorFacet) -> bool {
    let InteriorFacet { minus, plus, orientation, .. } = facet;
    tangent_sign(minus.face) * tangent_sign(plus.face) * orientation.parity() < 0.0
}

impl<const D: usize> Mesh<D> {
    /// Pairs of boundaries, by index, that are translates of each other and could be joined. The translation is the
    /// difference of the means of their vertices.
    pub fn translated_boundaries(&self) -> Vec<PeriodicPair<D>> {
        let sides = |boundary: usize| {
            let facets = self.boundary_facets.iter().filter(move |facet| facet.boundary == boundary);
            facets.map(|facet| facet.side).collect::<Vec<_>>()
        };
        let boundaries: Vec<_> = self.boundary_names.iter().cloned().zip((0..).map(sides)).collect();
        let centre = |boundary: &(String, Vec<Side>)| -> [f64; D] {
            let vertices = vertex_positions(self, &boundary.1);
            std::array::from_fn(|i| vertices.values().map(|x| x[i]).sum::<f64>() / vertices.len() as f64)
        };
        let pair = |minus: usize, plus: usize| {
            let (from, to) = (centre(&boundaries[minus]), centre(&boundaries[plus]));
            PeriodicPair { minus, plus, translation: std::array::from_fn(|i| to[i] - from[i]) }
        };
        let pairs = (0..boundaries.len()).flat_map(|plus| (0..plus).map(move |minus| pair(minus, plus)));
        pairs.filter(|pair| match_pair(self, &boundaries, pair).is_ok()).collect()
    }
}

/// The facet of side `plus` and the side of the other boundary that has the twins of its vertices.
fn twin_facet<const D: usize>(
    mesh: &Mesh<D>,
    plus: Side,
    twin: &BTreeMap<usize, usize>,
    by_vertices: &BTreeMap<Vec<usize>, Side>,
) -> Result<InteriorFacet, MeshError> {
    let corners: Vec<usize> = mesh.face_corners(plus).iter().map(|vertex| twin[vertex]).collect();
    let minus = *by_vertices.get(&face_key(corners.clone())).ok_or_else(|| not_manifold(mesh, plus, 1))?;
    let orientation = Orientation::from_corners(&mesh.face_corners(minus), &corners);
    let orientation = orientation.ok_or_else(|| not_manifold(mesh, plus, 2))?;
    Ok(InteriorFacet { minus, plus, orientation, periodic: true })
}

/// For each vertex of `plus` the vertex of `minus` that coincides with it after translation: the nearest one, if near
/// enough.
pub(crate) fn twins<K: Copy + Ord, const D: usize>(
    minus: &BTreeMap<K, [f64; D]>,
    plus: &BTreeMap<K, [f64; D]>,
    translation: &[f64; D],
    tolerance: f64,
) -> Result<BTreeMap<K, K>, Apart> {
    let mut twin = BTreeMap::new();
    for (&vertex, x) in plus {
        let distances = minus.iter().map(|(&candidate, y)| (distance(x, y, translation), candidate));
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((d, candidate)) if d <= tolerance => twin.insert(vertex, candidate),
            Some((distance, _)) => return Err(Apart { position: x.to_vec(), distance, tolerance }),
            None => return Err(Apart { position: x.to_vec(), distance: f64::INFINITY, tolerance }),
        };
    }
    Ok(twin)
}

/// The vertices of some faces and their positions.
fn vertex_positions<const D: usize>(mesh: &Mesh<D>, sides: &[Side]) -> BTreeMap<usize, [f64; D]> {
    sides.iter().flat_map(|&side| mesh.face_corners(side).into_iter().zip(mesh.face_corner_positions(side))).collect()
}

/// |x_plus - x_minus - translation|
fn distance<const D: usize>(plus: &[f64; D], minus: &[f64; D], translation: &[f64; D]) -> f64 {
    norm(&std::array::from_fn::<f64, D, _>(|i| plus[i] - minus[i] - translation[i]))
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
        let distance = distance(y, x, translation);
        if distance > tolerance {
            return Err(Apart { position: y.to_vec(), distance, tolerance });
        }
    }
    Ok(())
}

/// Whether all neighbours share the nodes of their facets.
pub(crate) fn check_gaps<const D: usize>(mesh: &Mesh<D>) -> Result<(), MeshError> {
    let tolerance = TOLERANCE * mesh.diameter();
    for facet in &mesh.interior_facets {
        check_gap(mesh, facet, &[0.0; D], tolerance).map_err(|Apart { position, distance, tolerance }| {
            let (minus, plus) = (facet.minus.cell, facet.plus.cell);
            MeshError::Gap { minus, plus, position, distance, tolerance }
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{BoxMesh, Curving};

    #[test]
    fn opposite_sides_of_a_box_could_be_joined() {
        let translated = |curving| {
            let cells = [3, 2];
            let frame = BoxMesh { lower: [0.0; 2], upper: [2.0, 1.0], cells, order: 3, curving, periodic: [false; 2] };
            frame.build().unwrap().scrambled(2).translated_boundaries()
        };
        let pair = |minus, plus, translation| PeriodicPair { minus, plus, translation };
        assert_eq!(translated(Curving::None), [pair(0, 1, [2.0, 0.0]), pair(2, 3, [0.0, 1.0])]);
        // Opposite sides that bulge further than their cells are thick.
        let (cells, curving) = ([32, 2], Curving::Wavy { amplitude: 0.05 });
        let frame = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells, order: 5, curving, periodic: [true; 2] };
        assert_eq!(frame.build().unwrap().boundary_names(), [""; 0]);
        // Inside the box nodes move, on the boundary they do not.
        assert_eq!(translated(Curving::Random { amplitude: 0.02, seed: 1 }).len(), 2);
    }
}
