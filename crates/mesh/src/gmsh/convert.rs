//! From the lists of a file to a mesh.

use super::cells::Cells;
use super::file::{Element, File};
use super::shape::Shape;
use super::split::{Corners, CutEdges, Splitter};
use super::{GmshError, Simplices, plane};
use crate::periodic::{joined_twice, translation};
use crate::topology::{face_key, sorted};
use crate::{Mesh, MeshError, PeriodicPair, Region, Side};
use std::collections::{BTreeMap, BTreeSet};

type Boundaries = Vec<(String, Vec<Side>)>;

pub(super) fn mesh<const D: usize>(
    file: &File,
    periodic: &[(String, String)],
    simplices: Simplices,
) -> Result<Mesh<D>, GmshError> {
    let elements = elements::<D>(file)?;
    // The surface of a body is no plane mesh: advice about its shapes and degrees would mislead.
    if D == 2 {
        plane::check(file, &elements)?;
    }
    let degree = common_degree(&elements)?;
    if simplices == Simplices::Refuse {
        refuse_simplices::<D>(file, &elements)?;
    }
    let mut splitter = Splitter::new(file, CutEdges::new::<D>(file, &elements, periodic));
    let cells = Cells::read(&mut splitter, file, &elements, degree)?;
    let boundaries = boundaries(file, &splitter, &cells)?;
    let pairs = pairs(&cells, &boundaries, periodic)?;
    let regions = regions(file, &elements, &cells);
    let refused = |error| refused(file, &elements, &cells, error);
    let (corners, coordinates) = (cells.corners.clone(), cells.coordinates.clone());
    Mesh::of_regions(degree + 1, corners, coordinates, boundaries, pairs, regions).map_err(refused)
}

/// The elements of dimension D, each once: an element of two physical groups is listed twice in version 2.2. Programs may begin the second list
/// of nodes elsewhere.
fn elements<const D: usize>(file: &File) -> Result<Vec<&Element>, GmshError> {
    let count = |dimension| file.elements.iter().filter(|element| element.kind.dimension() == dimension).count();
    let (surface, volume) = (count(2), count(3));
    if count(D) == 0 || D == 2 && volume > 0 {
        return Err(GmshError::Dimension { dimension: D, surface, volume });
    }
    let mut seen = BTreeSet::new();
    let elements = file.elements.iter().filter(|element| element.kind.dimension() == D);
    Ok(elements.filter(|element| seen.insert(sorted(element.nodes.clone()))).collect())
}

fn common_degree(elements: &[&Element]) -> Result<usize, GmshError> {
    let first = elements[0].kind.degree;
    match elements.iter().find(|element| element.kind.degree != first) {
        Some(element) => Err(GmshError::Degree { element: element.number, degree: element.kind.degree, first }),
        None => Ok(first),
    }
}

/// Cells, and faces of boundaries, must be quadrilaterals and hexahedra.
fn refuse_simplices<const D: usize>(file: &File, elements: &[&Element]) -> Result<(), GmshError> {
    let is_face = |element: &&Element| element.kind.dimension() == D - 1 && !element.groups.is_empty();
    let all: Vec<&Element> = elements.iter().copied().chain(file.elements.iter().filter(is_face)).collect();
    let Some(first) = all.iter().find(|element| !element.kind.shape.is_product_of_lines()) else { return Ok(()) };
    let shape = first.kind.shape;
    let count = all.iter().filter(|element| element.kind.shape == shape).count();
    let kind = match shape {
        Shape::Tetrahedron => "tetrahedra",
        Shape::Prism => "prisms",
        _ => "triangles",
    };
    Err(GmshError::Simplices { kind, count, element: first.number, dimension: D })
}

/// The faces of the cells that are listed as elements of a physical group, by the name of the group.
fn boundaries<const D: usize>(file: &File, splitter: &Splitter, cells: &Cells<D>) -> Result<Boundaries, GmshError> {
    let side_of = sides(cells);
    // In the order of the groups' numbers.
    let mut groups: BTreeMap<i64, Vec<Side>> = BTreeMap::new();
    let elements = file.elements.iter().filter(|element| element.kind.dimension() == D - 1);
    for element in elements.filter(|element| !element.groups.is_empty()) {
        let side = |corners: &Corners| side_of.get(&face_key(cells.vertices(corners)?)).copied();
        let found: Option<Vec<Side>> = splitter.corners(element).iter().map(side).collect();
        for &group in &element.groups {
            let stray = || GmshError::Stray { element: element.number, name: file.name(D - 1, group) };
            groups.entry(group).or_default().extend(found.as_ref().ok_or_else(stray)?);
        }
    }
    let mut named = by_name(groups.into_iter().map(|(group, sides)| (file.name(D - 1, group), sides)));
    named.iter_mut().for_each(|(_, sides)| keep_first(sides));
    Ok(named)
}

/// Files may list a facet twice under the same name: it belongs to the boundary once.
fn keep_first(sides: &mut Vec<Side>) {
    let mut seen = BTreeSet::new();
    sides.retain(|side| seen.insert(*side));
}

/// The cells of each physical group of dimension D, by its name.
fn regions<const D: usize>(file: &File, elements: &[&Element], cells: &Cells<D>) -> Vec<Region> {
    let index: BTreeMap<Vec<u64>, usize> =
        elements.iter().enumerate().map(|(k, cell)| (sorted(cell.nodes.clone()), k)).collect();
    let mut groups: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for element in file.elements.iter().filter(|element| element.kind.dimension() == D) {
        let of_element = cells.of_element(index[&sorted(element.nodes.clone())]);
        element.groups.iter().for_each(|&group| groups.entry(group).or_default().extend(of_element.clone()));
    }
    let named = by_name(groups.into_iter().map(|(group, cells)| (file.name(D, group), cells)));
    named.into_iter().map(|(name, cells)| Region { name, cells }).collect()
}

/// The lists in the given order. Lists of the same name are joined.
fn by_name<T>(lists: impl Iterator<Item = (String, Vec<T>)>) -> Vec<(String, Vec<T>)> {
    let mut named: Vec<(String, Vec<T>)> = Vec::new();
    for (name, list) in lists {
        match named.iter_mut().find(|(other, _)| *other == name) {
            Some((_, listed)) => listed.extend(list),
            None => named.push((name, list)),
        }
    }
    named
}

/// The first side with given vertices.
fn sides<const D: usize>(cells: &Cells<D>) -> BTreeMap<Vec<usize>, Side> {
    let mut sides = BTreeMap::new();
    for cell in 0..cells.corners.len() >> D {
        for side in (0..2 * D).map(|face| Side { cell, face }) {
            let vertices = cells.face(side).into_iter().map(|(vertex, _)| vertex).collect();
            sides.entry(face_key(vertices)).or_insert(side);
        }
    }
    sides
}

/// Pairs of boundaries by name, with the translation between their corners.
fn pairs<const D: usize>(
    cells: &Cells<D>,
    boundaries: &Boundaries,
    periodic: &[(String, String)],
) -> Result<Vec<PeriodicPair<D>>, GmshError> {
    check_once(periodic)?;
    let number = |name: &String| {
        let known = || boundaries.iter().map(|(name, _)| name.clone()).collect();
        let found = boundaries.iter().position(|(other, _)| other == name);
        found.ok_or_else(|| GmshError::NoBoundary { name: name.clone(), known: known() })
    };
    let corners = |boundary: usize| -> Vec<[f64; D]> {
        let once: BTreeMap<usize, [f64; D]> =
            boundaries[boundary].1.iter().flat_map(|&side| cells.face(side)).collect();
        once.into_values().collect()
    };
    let pair = |(minus, plus): &(String, String)| {
        let (minus, plus) = (number(minus)?, number(plus)?);
        Ok(PeriodicPair { minus, plus, translation: translation(&corners(minus), &corners(plus)) })
    };
    periodic.iter().map(pair).collect()
}

/// Every boundary is in one pair, and there once.
fn check_once(periodic: &[(String, String)]) -> Result<(), GmshError> {
    match joined_twice(periodic.iter().map(|(minus, plus)| [minus, plus])) {
        Some((pair, name)) => Err(GmshError::JoinedTwice { pair, name: name.clone() }),
        None => Ok(()),
    }
}

/// The error of a mesh, with the element of the file.
fn refused<const D: usize>(file: &File, elements: &[&Element], cells: &Cells<D>, error: MeshError) -> GmshError {
    let element = |cell: usize| elements[cells.element(cell)];
    match error {
        MeshError::Inverted { cell, .. } | MeshError::Degenerate { cell, .. } => {
            let element = element(cell);
            GmshError::Cell { element: element.number, degree: element.kind.degree, source: error }
        }
        MeshError::Unnamed { cell, .. } => {
            let groups = file.elements.iter().filter(|element| element.kind.dimension() == D - 1);
            let named = groups.flat_map(|element| &element.groups).next().is_some();
            let volumes = file.volumes;
            GmshError::Unnamed { element: element(cell).number, dimension: D, named, volumes, source: error }
        }
        MeshError::TwoBoundaries { cell, .. } | MeshError::Inside { cell, .. } => {
            GmshError::Listed { element: element(cell).number, dimension: D, source: error }
        }
        error => GmshError::Mesh(error),
    }
}
