//! Which faces meet: facets from vertex numbers, boundaries from names.

use crate::{BoundaryFacet, InteriorFacet, Mesh, MeshError, Orientation, PeriodicPair, Side, periodic};
use std::collections::BTreeMap;

/// Finds the facets of `mesh`, which has cells only so far.
pub(crate) fn connect<const D: usize>(
    mesh: &mut Mesh<D>,
    boundaries: Vec<(String, Vec<Side>)>,
    pairs: &[PeriodicPair<D>],
) -> Result<(), MeshError> {
    let owner = boundary_of_sides(mesh, &boundaries)?;
    mesh.interior_facets = match_faces(mesh, &owner, &boundaries)?;
    periodic::check_gaps(mesh)?;
    for (number, pair) in pairs.iter().enumerate() {
        periodic::check_pair(number, pairs, boundaries.len())?;
        let facets = periodic::match_pair(mesh, &boundaries, pair)?;
        mesh.interior_facets.extend(facets);
    }
    mesh.interior_facets.sort_unstable_by_key(|facet| facet.minus);
    keep_named(mesh, boundaries, pairs);
    Ok(())
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
pub(crate) fn face_key(mut vertices: Vec<usize>) -> Vec<usize> {
    vertices.sort_unstable();
    vertices
}

/// Pairs the faces that have the same vertices. A face without a partner must be in `owner`, one with a partner must not.
fn match_faces<const D: usize>(
    mesh: &Mesh<D>,
    owner: &BTreeMap<Side, usize>,
    boundaries: &[(String, Vec<Side>)],
) -> Result<Vec<InteriorFacet>, MeshError> {
    let sides = (0..mesh.n_cells()).flat_map(|cell| (0..2 * D).map(move |face| Side { cell, face }));
    let mut faces: Vec<(Vec<usize>, Side)> = sides.map(|side| (face_key(mesh.face_corners(side)), side)).collect();
    faces.sort_unstable();

    let mut facets = Vec::new();
    for group in faces.chunk_by(|a, b| a.0 == b.0) {
        let side = group[0].1;
        let Side { cell, face } = side;
        let named = group.iter().find_map(|(_, side)| owner.get(side));
        match (group, named) {
            ([_], Some(_)) => {}
            ([_], None) => return Err(MeshError::Unnamed { cell, face, position: mesh.face_centre(side) }),
            ([_, _], Some(&boundary)) => {
                let name = boundaries[boundary].0.clone();
                return Err(MeshError::Inside { cell, face, name, position: mesh.face_centre(side) });
            }
            ([(_, minus), (_, plus)], None) => facets.push(conforming_facet(mesh, *minus, *plus)?),
            _ => return Err(not_manifold(mesh, side, group.len())),
        }
    }
    Ok(facets)
}

fn conforming_facet<const D: usize>(mesh: &Mesh<D>, minus: Side, plus: Side) -> Result<InteriorFacet, MeshError> {
    let orientation = Orientation::from_corners(&mesh.face_corners(minus), &mesh.face_corners(plus));
    let orientation = orientation.ok_or_else(|| not_manifold(mesh, minus, 2))?;
    Ok(InteriorFacet { minus, plus, orientation, periodic: false })
}

pub(crate) fn not_manifold<const D: usize>(mesh: &Mesh<D>, side: Side, count: usize) -> MeshError {
    MeshError::NonManifold { cell: side.cell, face: side.face, count, position: mesh.face_centre(side) }
}

/// Keeps the boundaries that no periodic pair has joined, in the order given, their sides in increasing order.
fn keep_named<const D: usize>(mesh: &mut Mesh<D>, boundaries: Vec<(String, Vec<Side>)>, pairs: &[PeriodicPair<D>]) {
    let joined = |boundary| pairs.iter().any(|pair| pair.minus == boundary || pair.plus == boundary);
    for (number, (name, mut sides)) in boundaries.into_iter().enumerate() {
        if joined(number) {
            continue;
        }
        let boundary = mesh.boundary_names.len();
        sides.sort_unstable();
        mesh.boundary_facets.extend(sides.into_iter().map(|side| BoundaryFacet { side, boundary }));
        mesh.boundary_names.push(name);
    }
}
