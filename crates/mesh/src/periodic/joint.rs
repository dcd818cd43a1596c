//! The facets between two boundaries that are translates of each other.

use super::coincidence::{FaceTolerance, Place, Tolerances, coincident, distance};
use super::{Apart, PeriodicPair, check_gap};
use crate::topology::{face_key, not_manifold};
use crate::{InteriorFacet, Mesh, MeshError, Orientation, Side, tangent_sign};
use std::collections::BTreeMap;

/// Which of two boundaries, and a vertex there.
type Vertex = (Part, usize);

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Minus,
    Plus,
}

/// Two boundaries that are to be joined. Faces are matched, not vertices: on both sides of a thin plate, or of the seam of a pipe, different
/// vertices of one boundary are at the same place.
pub(super) struct Joint<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    names: [&'a str; 2],
    translation: [f64; D],
    /// Of each face of both boundaries.
    tolerances: BTreeMap<Side, FaceTolerance>,
    /// The positions of vertices, after translation.
    places: BTreeMap<Vertex, Place<D>>,
    /// Numbers of vertices, the same for those that coincide.
    classes: BTreeMap<Vertex, usize>,
    /// The faces of the minus side that have no partner yet, by the classes of their corners.
    free: BTreeMap<Vec<usize>, Vec<Side>>,
}

impl<'a, const D: usize> Joint<'a, D> {
    pub(super) fn new(mesh: &'a Mesh<D>, boundaries: &'a [(String, Vec<Side>)], pair: &PeriodicPair<D>) -> Self {
        let ((minus, minus_sides), (plus, plus_sides)) = (&boundaries[pair.minus], &boundaries[pair.plus]);
        let (names, translation, of_mesh) = ([&minus[..], &plus[..]], pair.translation, Tolerances::new(mesh));
        let tolerance = |side: &Side| (*side, of_mesh.of_face(mesh.order, &mesh.face_positions(*side)));
        let tolerances = minus_sides.iter().chain(plus_sides).map(tolerance).collect();
        let (places, classes, free) = Default::default();
        let mut joint = Joint { mesh, names, translation, tolerances, places, classes, free };
        joint.add_places(Part::Minus, minus_sides);
        joint.add_places(Part::Plus, plus_sides);
        let places: Vec<Place<D>> = joint.places.values().copied().collect();
        joint.classes = joint.places.keys().copied().zip(coincident(&places)).collect();
        for &side in minus_sides {
            joint.free.entry(face_key(joint.corners(Part::Minus, side))).or_default().push(side);
        }
        joint
    }

    /// The vertices of `sides`, each with the least tolerance of its faces.
    fn add_places(&mut self, part: Part, sides: &[Side]) {
        for &side in sides {
            let tolerance = self.tolerances[&side].place;
            let positions = self.mesh.face_corner_positions(side);
            for (vertex, mut position) in self.mesh.face_corners(side).into_iter().zip(positions) {
                if part == Part::Minus {
                    position = std::array::from_fn(|i| position[i] + self.translation[i]);
                }
                let place = self.places.entry((part, vertex)).or_insert(Place { position, tolerance });
                place.tolerance = place.tolerance.min(tolerance);
            }
        }
    }

    /// The classes of the corners of `side`, in the order of its lattice.
    fn corners(&self, part: Part, side: Side) -> Vec<usize> {
        self.mesh.face_corners(side).into_iter().map(|vertex| self.classes[&(part, vertex)]).collect()
    }

    /// The facet of the face `plus` and a face of the other boundary that has no partner yet.
    pub(super) fn facet(&mut self, plus: Side) -> Result<InteriorFacet, MeshError> {
        let corners = self.corners(Part::Plus, plus);
        let key = face_key(corners.clone());
        let candidates = self.free.get(&key).cloned().unwrap_or_default();
        let mut refusal = None;
        for (place, &minus) in candidates.iter().enumerate() {
            match self.joined(minus, plus, &corners) {
                Ok(facet) => {
                    self.free.entry(key).or_default().remove(place);
                    return Ok(facet);
                }
                Err(error) => refusal = Some(error),
            }
        }
        // Only now: it searches all vertices of the other side.
        Err(refusal.unwrap_or_else(|| self.unmatched(plus)))
    }

    /// The facet of two faces whose corners coincide. Where corners of one face coincide, it may be turned in several ways.
    fn joined(&self, minus: Side, plus: Side, corners: &[usize]) -> Result<InteriorFacet, MeshError> {
        let from = self.corners(Part::Minus, minus);
        let carries = |o: &Orientation| (0..from.len()).all(|i| from[i] == corners[o.plus_index(D - 1, 2, i)]);
        let mut refusal = not_manifold(self.mesh, plus, 2);
        for orientation in Orientation::all(D - 1).into_iter().filter(carries) {
            let facet = InteriorFacet { minus, plus, orientation, periodic: true };
            match self.check_nodes(&facet) {
                Ok(()) if has_two_sides(&facet) => return Ok(facet),
                Ok(()) => refusal = self.same_side(plus),
                Err(apart) => refusal = self.mismatch(apart),
            }
        }
        Err(refusal)
    }

    /// Whether the nodes of both sides coincide, and the sides have the same shape.
    fn check_nodes(&self, facet: &InteriorFacet) -> Result<(), Apart> {
        let tolerance = self.tolerances[&facet.minus].smaller(self.tolerances[&facet.plus]);
        check_gap(self.mesh, facet, &self.translation, tolerance.place)?;
        let first = self.mesh.face_positions(facet.minus)[0];
        let twin = self.mesh.face_positions(facet.plus)[facet.orientation.plus_index(D - 1, self.mesh.order, 0)];
        let own_translation = std::array::from_fn(|i| twin[i] - first[i]);
        check_gap(self.mesh, facet, &own_translation, tolerance.shape)
    }

    /// The error for a face that coincides with none: its corner that is farthest from the other boundary, if it is too far.
    fn unmatched(&self, plus: Side) -> MeshError {
        let apart = self.mesh.face_corners(plus).into_iter().map(|vertex| self.apart(vertex));
        match apart.max_by(|a, b| a.distance.total_cmp(&b.distance)) {
            Some(apart) if apart.distance > apart.tolerance => self.mismatch(apart),
            _ => not_manifold(self.mesh, plus, 1),
        }
    }

    /// How far a vertex of the plus side is from all of the other side.
    fn apart(&self, vertex: usize) -> Apart {
        let Place { position, tolerance } = self.places[&(Part::Plus, vertex)];
        let minus = self.places.iter().take_while(|((part, _), _)| *part == Part::Minus);
        let nearest = minus.map(|(_, place)| (distance(&place.position, &position), place.tolerance));
        let (distance, other) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, tolerance));
        Apart { position: position.to_vec(), distance, tolerance: tolerance.min(other) }
    }

    fn mismatch(&self, Apart { position, distance, tolerance }: Apart) -> MeshError {
        let [minus, plus] = self.names.map(str::to_owned);
        MeshError::PeriodicMismatch { minus, plus, position, distance, tolerance }
    }

    fn same_side(&self, side: Side) -> MeshError {
        let [minus, plus] = self.names.map(str::to_owned);
        MeshError::SameSide { minus, plus, position: self.mesh.face_centre(side) }
    }
}

/// Whether the outward normals of both sides of `facet` are opposite.
fn has_two_sides(facet: &InteriorFacet) -> bool {
    let InteriorFacet { minus, plus, orientation, .. } = facet;
    tangent_sign(minus.face) * tangent_sign(plus.face) * orientation.parity() < 0.0
}
