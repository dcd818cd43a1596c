//! Connectivity: facets from vertex numbers, boundaries from names.

use crate::region::{NamedSides, regions_of_cells, split_interfaces};
use crate::{BoundaryFacet, InteriorFacet, Mesh, MeshError, Orientation, PeriodicPair, Side, periodic};
use std::collections::{BTreeMap, BTreeSet};

/// Finds the facets of `mesh`, which so far has only cells and regions. Returns those of each pair of `pairs`.
pub(crate) fn connect<const D: usize>(
    mesh: &mut Mesh<D>,
    boundaries: NamedSides,
    pairs: &[PeriodicPair<D>],
) -> Result<Vec<Vec<InteriorFacet>>, MeshError> {
    let owner = boundary_of_sides(mesh, &boundaries)?;
    let (facets, between_regions) = match_faces(mesh, &owner, &boundaries)?;
    mesh.interior_facets = facets;
    periodic::check_gaps(mesh)?;
    let mut joined = Vec::with_capacity(pairs.len());
    periodic::check_pairs(pairs, boundaries.len())?;
    for pair in pairs {
        check_outside(mesh, [&boundaries[pair.minus], &boundaries[pair.plus]], &between_regions)?;
        let facets = periodic::match_pair(mesh, &boundaries, pair)?;
        mesh.interior_facets.extend(&facets);
        joined.push(facets);
    }
    mesh.interior_facets.sort_unstable_by_key(|facet| facet.minus);
    keep_named(mesh, boundaries, pairs, &between_regions);
    Ok(joined)
}

/// A boundary that is joined with another one has no facets between regions.
fn check_outside<const D: usize>(
    mesh: &Mesh<D>,
    joined: [&(String, Vec<Side>); 2],
    between_regions: &BTreeSet<Side>,
) -> Result<(), MeshError> {
    let mut sides = joined.into_iter().flat_map(|(name, sides)| sides.iter().map(move |side| (name, *side)));
    match sides.find(|(_, side)| between_regions.contains(side)) {
        Some((name, side)) => Err(inside(mesh, name, side)),
        None => Ok(()),
    }
}

/// The boundary that lists each side.
fn boundary_of_sides<const D: usize>(
    mesh: &Mesh<D>,
    boundaries: &[(String, Vec<Side>)],
) -> Result<BTreeMap<Side, usize>, MeshError> {
    let (cells, faces) = (mesh.n_cells(), 2 * D);
    let mut owner = BTreeMap::new();
    for (boundary, (name, sides)) in boundaries.iter().enumerate() {
        if boundaries[..boundary].iter().any(|(other, _)| other == name) {
            return Err(MeshError::NameTwice { name: name.clone() });
        }
        for &side in sides {
            let Side { cell, face } = side;
            if cell >= cells || face >= faces {
                return Err(MeshError::NoSuchFace { name: name.clone(), cell, face, cells, faces });
            }
            if let Some(first) = owner.insert(side, boundary) {
                let (first, second) = (boundaries[first].0.clone(), name.clone());
                return Err(MeshError::TwoBoundaries { cell, face, first, second });
            }
        }
    }
    Ok(owner)
}

/// The vertices of a face in increasing order: the same for all cells that share it.
pub(crate) fn face_key(vertices: Vec<usize>) -> Vec<usize> {
    sorted(vertices)
}

/// Numbers in increasing order: the same for every order in which they are listed.
pub(crate) fn sorted<T: Ord>(mut numbers: Vec<T>) -> Vec<T> {
    numbers.sort_unstable();
    numbers
}

/// Pairs the faces that have the same vertices. A face without a partner must be in `owner`, a face with a partner must
/// not, unless it lies between regions: returns the facets, and the listed sides of such faces.
fn match_faces<const D: usize>(
    mesh: &Mesh<D>,
    owner: &BTreeMap<Side, usize>,
    boundaries: &[(String, Vec<Side>)],
) -> Result<(Vec<InteriorFacet>, BTreeSet<Side>), MeshError> {
    let regions = regions_of_cells(mesh.n_cells(), &mesh.regions);
    let sides = (0..mesh.n_cells()).flat_map(|cell| (0..2 * D).map(move |face| Side { cell, face }));
    let mut faces: Vec<(Vec<usize>, Side)> = sides.map(|side| (face_key(mesh.face_corners(side)), side)).collect();
    faces.sort_unstable();

    let (mut facets, mut between_regions) = (Vec::new(), BTreeSet::new());
    for group in faces.chunk_by(|a, b| a.0 == b.0) {
        let side = group[0].1;
        let Side { cell, face } = side;
        let named = group.iter().find_map(|(_, side)| owner.get(side));
        match (group, named) {
            ([_], Some(_)) => {}
            ([_], None) => return Err(MeshError::Unnamed { cell, face, position: mesh.face_centre(side) }),
            ([(_, minus), (_, plus)], Some(_)) if regions[minus.cell] != regions[plus.cell] => {
                facets.push(conforming_facet(mesh, *minus, *plus)?);
                between_regions.extend([minus, plus].into_iter().filter(|side| owner.contains_key(side)));
            }
            ([(_, minus), (_, plus)], Some(&boundary)) => {
                let facet = conforming_facet(mesh, *minus, *plus)?;
                return Err(match periodic::is_same_face(mesh, &facet) {
                    true => inside(mesh, &boundaries[boundary].0, side),
                    false => {
                        MeshError::SameCorners { cells: [minus.cell, plus.cell], position: mesh.face_centre(side) }
                    }
                });
            }
            ([(_, minus), (_, plus)], None) => facets.push(conforming_facet(mesh, *minus, *plus)?),
            _ => return Err(not_manifold(mesh, side, group.len())),
        }
    }
    Ok((facets, between_regions))
}

fn inside<const D: usize>(mesh: &Mesh<D>, name: &str, side: Side) -> MeshError {
    let (name, position) = (name.to_owned(), mesh.face_centre(side));
    MeshError::Inside { cell: side.cell, face: side.face, name, position }
}

fn conforming_facet<const D: usize>(mesh: &Mesh<D>, minus: Side, plus: Side) -> Result<InteriorFacet, MeshError> {
    let orientation = Orientation::from_corners(&mesh.face_corners(minus), &mesh.face_corners(plus));
    let orientation = orientation.ok_or_else(|| not_manifold(mesh, minus, 2))?;
    Ok(InteriorFacet { minus, plus, orientation, periodic: false })
}

pub(crate) fn not_manifold<const D: usize>(mesh: &Mesh<D>, side: Side, count: usize) -> MeshError {
    MeshError::NonManifold { cell: side.cell, face: side.face, count, position: mesh.face_centre(side) }
}

/// Keeps the boundaries that are not joined by a periodic pair, in the given order, their sides in increasing order; those between
/// regions apart from the others.
fn keep_named<const D: usize>(
    mesh: &mut Mesh<D>,
    boundaries: NamedSides,
    pairs: &[PeriodicPair<D>],
    between_regions: &BTreeSet<Side>,
) {
    let joined = |boundary| pairs.iter().any(|pair| pair.minus == boundary || pair.plus == boundary);
    let kept = boundaries.into_iter().enumerate().filter(|(number, _)| !joined(*number)).map(|(_, named)| named);
    let (outer, interfaces) = split_interfaces(kept.collect(), between_regions);
    mesh.interfaces = interfaces;
    for (name, mut sides) in outer {
        let boundary = mesh.boundary_names.len();
        sides.sort_unstable();
        mesh.boundary_facets.extend(sides.into_iter().map(|side| BoundaryFacet { side, boundary }));
        mesh.boundary_names.push(name);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{BoxMesh, Curving};

    /// Two unit squares side by side, order 2, before any check.
    struct Parts {
        order: usize,
        corners: Vec<usize>,
        coordinates: Vec<f64>,
        boundaries: Vec<(String, Vec<Side>)>,
        periodic: Vec<PeriodicPair<2>>,
    }

    fn side(cell: usize, face: usize) -> Side {
        Side { cell, face }
    }

    fn two_squares() -> Parts {
        let corners = vec![0, 1, 3, 4, 1, 2, 4, 5];
        let coordinates = corners.iter().flat_map(|&v| [(v % 3) as f64, (v / 3) as f64]).collect();
        let named = |name: &str, sides: &[Side]| (name.to_owned(), sides.to_vec());
        let boundaries = vec![
            named("inflow", &[side(0, 0)]),
            named("outflow", &[side(1, 1)]),
            named("wall", &[side(0, 2), side(1, 2), side(0, 3), side(1, 3)]),
        ];
        Parts { order: 2, corners, coordinates, boundaries, periodic: vec![] }
    }

    impl Parts {
        fn build(self) -> Result<Mesh<2>, MeshError> {
            Mesh::new(self.order, self.corners, self.coordinates, self.boundaries, self.periodic)
        }
        fn refused(mut self, spoil: impl FnOnce(&mut Self)) -> MeshError {
            spoil(&mut self);
            self.build().unwrap_err()
        }
    }

    #[test]
    fn two_squares_have_one_facet_and_six_sides() {
        let mesh = two_squares().build().unwrap();
        let orientation = Orientation::default();
        let facet = InteriorFacet { minus: side(0, 1), plus: side(1, 0), orientation, periodic: false };
        assert_eq!(mesh.interior_facets(), [facet]);
        let listed: Vec<_> = mesh.boundary_facets().iter().map(|f| (f.boundary, f.side.cell, f.side.face)).collect();
        assert_eq!(listed, [(0, 0, 0), (1, 1, 1), (2, 0, 2), (2, 0, 3), (2, 1, 2), (2, 1, 3)]);
        assert_eq!(mesh.boundary_names(), ["inflow", "outflow", "wall"]);
    }

    #[test]
    fn a_periodic_pair_becomes_a_facet_and_loses_its_names() {
        let mut parts = two_squares();
        parts.periodic.push(PeriodicPair { minus: 1, plus: 0, translation: [-2.0, 0.0] });
        let mesh = parts.build().unwrap();
        assert_eq!(mesh.boundary_names(), ["wall"]);
        assert!(mesh.boundary_facets().iter().all(|facet| facet.boundary == 0));
        let facet = mesh.interior_facets()[1];
        assert_eq!((facet.minus, facet.plus, facet.periodic), (side(1, 1), side(0, 0), true));
    }

    #[test]
    fn bad_arrays_are_refused() {
        for order in [0, 1, 17] {
            assert_eq!(two_squares().refused(|p| p.order = order), MeshError::Order { order });
        }
        let error = two_squares().refused(|p| p.coordinates.truncate(15));
        assert_eq!(error, MeshError::Length { array: "coordinates", found: 15, expected: 16 });
        let error = two_squares().refused(|p| p.corners.truncate(7));
        assert_eq!(error, MeshError::Length { array: "corners", found: 7, expected: 4 });
        assert!(matches!(two_squares().refused(|p| p.corners.clear()), MeshError::Length { found: 0, .. }));
        let error = two_squares().refused(|p| p.coordinates[9] = f64::INFINITY);
        assert_eq!(error, MeshError::NotFinite { cell: 1, value: f64::INFINITY });
    }

    #[test]
    fn bad_boundaries_are_refused() {
        let error = two_squares().refused(|p| p.boundaries.truncate(1));
        assert_eq!(error, MeshError::Unnamed { cell: 0, face: 2, position: vec![0.5, 0.0] });
        assert!(
            error.to_string().contains("face 2 of cell 0") && error.to_string().contains("boundary without a name")
        );
        let error = two_squares().refused(|p| p.boundaries[1].0 = "inflow".to_owned());
        assert_eq!(error, MeshError::NameTwice { name: "inflow".to_owned() });
        let error = two_squares().refused(|p| p.boundaries[2].1.push(side(1, 1)));
        let (first, second) = ("outflow".to_owned(), "wall".to_owned());
        assert_eq!(error, MeshError::TwoBoundaries { cell: 1, face: 1, first, second });
        let error = two_squares().refused(|p| p.boundaries[0].1.push(side(1, 0)));
        assert!(
            matches!(error, MeshError::Inside { name, position, .. } if name == "inflow" && position == [1.0, 0.5])
        );
        for wrong in [side(2, 0), side(0, 4)] {
            let error = two_squares().refused(|p| p.boundaries[0].1.push(wrong));
            assert!(matches!(error, MeshError::NoSuchFace { cell, face, .. } if side(cell, face) == wrong));
        }
    }

    #[test]
    fn bad_cells_are_refused() {
        // Cell 1 mirrored: its corners are ordered left-handed.
        let error = two_squares().refused(|p| {
            p.coordinates[8..].copy_from_slice(&[2.0, 0.0, 1.0, 0.0, 2.0, 1.0, 1.0, 1.0]);
            p.corners[4..].copy_from_slice(&[2, 1, 5, 4]);
            p.boundaries[1].1[0].face = 0;
        });
        assert!(matches!(error, MeshError::Inverted { cell: 1, determinant: -0.25, .. }), "{error}");
        // Cell 1 moved away from its vertices.
        let error = two_squares().refused(|p| p.coordinates[9] -= 0.125);
        assert!(matches!(error, MeshError::Gap { minus: 0, plus: 1, distance: 0.125, .. }), "{error}");
        // A third cell on the facet between the two.
        let error = two_squares().refused(|p| {
            p.corners.extend([1, 6, 4, 7]);
            p.coordinates.extend([1.0, 0.0, 2.0, 0.5, 1.0, 1.0, 2.0, 1.5]);
        });
        assert!(matches!(error, MeshError::NonManifold { count: 3, .. }), "{error}");
        // A corner collapsed onto its neighbour: det J = 0 there.
        let mut parts = two_squares();
        parts.coordinates[12..16].copy_from_slice(&[1.0, 1.0, 1.0, 1.0]);
        assert!(matches!(
            parts.build(),
            Err(MeshError::Inverted { cell: 1, .. } | MeshError::Degenerate { cell: 1, .. })
        ));
    }

    #[test]
    fn bad_periodic_pairs_are_refused() {
        let pair = |minus, plus, x| PeriodicPair { minus, plus, translation: [x, 0.0] };
        let error = two_squares().refused(|p| p.periodic.push(pair(1, 0, -1.875)));
        assert!(
            matches!(&error, MeshError::PeriodicMismatch { distance: 0.125, minus, .. } if minus == "outflow"),
            "{error}"
        );
        // The upper sides of both squares are translates of each other, but both cells lie below them.
        let error = two_squares().refused(|p| {
            p.boundaries[2].1 = vec![side(0, 2), side(1, 2)];
            p.boundaries.push(("left".into(), vec![side(0, 3)]));
            p.boundaries.push(("right".into(), vec![side(1, 3)]));
            p.periodic.push(pair(3, 4, 1.0));
        });
        assert!(matches!(&error, MeshError::SameSide { minus, .. } if minus == "left"), "{error}");
        let error = two_squares().refused(|p| p.periodic.push(pair(1, 2, 0.0)));
        assert!(matches!(error, MeshError::PairCount { minus_faces: 1, plus_faces: 4, .. }));
        for (pairs, wrong) in
            [(vec![pair(1, 3, 0.0)], 3), (vec![pair(1, 1, 0.0)], 1), (vec![pair(1, 0, -2.0), pair(0, 2, 0.0)], 0)]
        {
            let pair = pairs.len() - 1;
            assert_eq!(
                two_squares().refused(|p| p.periodic = pairs),
                MeshError::PairBoundary { pair, boundary: wrong, count: 3 }
            );
        }
    }

    #[test]
    fn a_periodic_pair_with_different_curves_is_refused() {
        let curving = Curving::Wavy { amplitude: 0.02 };
        let mesh = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [1, 1], order: 4, curving, periodic: [false; 2] }
            .build()
            .unwrap();
        let mut coordinates = mesh.coordinates.clone();
        coordinates[2 * 4] += 1e-3;
        let boundaries = (0..4).map(|face| (face.to_string(), vec![side(0, face)])).collect();
        let periodic = vec![PeriodicPair { minus: 1, plus: 0, translation: [-1.0, 0.0] }];
        let error = Mesh::new(4, mesh.corners.clone(), coordinates, boundaries, periodic).unwrap_err();
        assert!(
            matches!(error, MeshError::PeriodicMismatch { distance, .. } if (distance - 1e-3).abs() < 1e-12),
            "{error}"
        );
    }

    /// Both halves of a round hole have the same corners: they were blamed to be one face inside of the mesh.
    #[test]
    fn two_curves_between_the_same_corners_are_told() {
        let place = |(r, turns): (f64, f64)| {
            let (sin, cos) = (std::f64::consts::TAU * turns).sin_cos();
            [r * cos, r * sin]
        };
        let cell =
            |half: usize| (0..9).map(move |k| (1.0 + 0.5 * (k % 3) as f64, 0.5 * half as f64 + 0.25 * (k / 3) as f64));
        let coordinates = (0..2).flat_map(cell).flat_map(place).collect();
        let both = |face| vec![Side { cell: 0, face }, Side { cell: 1, face }];
        let boundaries = vec![("hole".to_owned(), both(0)), ("far".to_owned(), both(1))];
        let error = Mesh::<2>::new(3, vec![0, 2, 1, 3, 1, 3, 0, 2], coordinates, boundaries, vec![]).unwrap_err();
        assert!(matches!(error, MeshError::SameCorners { cells: [0, 1], .. }), "{error}");
    }
}
