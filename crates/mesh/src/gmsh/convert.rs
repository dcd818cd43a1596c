//! From the lists of a file to a mesh.

use super::GmshError;
use super::element::Kind;
use super::file::{Element, File};
use crate::facet::{corner_node, face_nodes};
use crate::lattice::{Lattice, digit};
use crate::{CellMap, Mesh, MeshError, PeriodicPair, Region, Side};
use basis::{Lagrange, Matrix, equidistant_points, gauss_lobatto};
use std::collections::{BTreeMap, BTreeSet};

/// z of a plane mesh is constant up to this times its size.
const PLANE: f64 = 1e-9;

type Boundaries = Vec<(String, Vec<Side>)>;

pub(super) fn mesh<const D: usize>(file: &File, periodic: &[(String, String)]) -> Result<Mesh<D>, GmshError> {
    let cells = cells::<D>(file)?;
    let degree = common_degree(&cells)?;
    let reader = CellReader::<D>::new(degree);
    let (mut corners, mut coordinates) = (Vec::new(), Vec::new());
    for cell in &cells {
        let (nodes, positions) = reader.read(file, cell)?;
        corners.extend((0..1 << D).map(|k| nodes[corner_node(D, degree + 1, k)]));
        coordinates.extend(positions);
    }
    if D == 2 {
        check_plane(file, &cells)?;
    }
    let boundaries = boundaries::<D>(file, &corners)?;
    let pairs = pairs::<D>(file, &corners, &boundaries, periodic)?;
    let refused = |error| match error {
        MeshError::Inverted { cell, .. } | MeshError::Degenerate { cell, .. } => {
            GmshError::Cell { element: cells[cell].number, source: error }
        }
        error => GmshError::Mesh(error),
    };
    let regions = regions::<D>(file, &cells);
    Mesh::of_regions(degree + 1, numbered(&corners), coordinates, boundaries, pairs, regions).map_err(refused)
}

/// The elements of dimension D, each once: an element of two physical groups is listed twice in version 2.2.
fn cells<const D: usize>(file: &File) -> Result<Vec<&Element>, GmshError> {
    let count = |dimension| file.elements.iter().filter(|element| element.kind.dimension == dimension).count();
    let (quadrilaterals, hexahedra) = (count(2), count(3));
    if count(D) == 0 || D == 2 && hexahedra > 0 {
        return Err(GmshError::Dimension { dimension: D, quadrilaterals, hexahedra });
    }
    let mut seen = BTreeSet::new();
    let cells = file.elements.iter().filter(|element| element.kind.dimension == D);
    Ok(cells.filter(|element| seen.insert(&element.nodes)).collect())
}

fn common_degree(cells: &[&Element]) -> Result<usize, GmshError> {
    let first = cells[0].kind.degree;
    match cells.iter().find(|cell| cell.kind.degree != first) {
        Some(cell) => Err(GmshError::Degree { element: cell.number, degree: cell.kind.degree, first }),
        None => Ok(first),
    }
}

/// Converts the nodes of a cell to the order and the Gauss-Lobatto nodes of this program.
struct CellReader<const D: usize> {
    /// N of the lattice.
    order: usize,
    /// For each node of the file its index in the lattice.
    indices: Vec<usize>,
    /// Interpolation from equidistant to Gauss-Lobatto nodes, exact for polynomials of the file's degree.
    to_gauss_lobatto: Matrix,
    /// The Jacobian at the Gauss-Lobatto nodes.
    map: CellMap<D>,
}

impl<const D: usize> CellReader<D> {
    fn new(degree: usize) -> Self {
        let order = degree + 1;
        let nodes = gauss_lobatto(order).points;
        CellReader {
            order,
            indices: Kind { dimension: D, degree }.lattice_indices(),
            to_gauss_lobatto: Lagrange::new(equidistant_points(order)).value_matrix(&nodes),
            map: CellMap::on_grid(order, &nodes),
        }
    }

    /// Node numbers in the order of the lattice, and the positions of the Gauss-Lobatto nodes, `[node][D]`.
    fn read(&self, file: &File, cell: &Element) -> Result<(Vec<u64>, Vec<f64>), GmshError> {
        let mut nodes = vec![0; cell.nodes.len()];
        self.indices.iter().zip(&cell.nodes).for_each(|(&index, &node)| nodes[index] = node);
        let positions = self.positions(file, cell.number, &nodes)?;
        if self.map.determinants(&positions).iter().any(|&det| det >= 0.0) {
            return Ok((nodes, positions));
        }
        // Left-handed: axes 0 and 1 are exchanged.
        let nodes: Vec<u64> = (0..nodes.len()).map(|k| nodes[exchanged(k, self.order)]).collect();
        let positions = self.positions(file, cell.number, &nodes)?;
        Ok((nodes, positions))
    }

    fn positions(&self, file: &File, element: u64, nodes: &[u64]) -> Result<Vec<f64>, GmshError> {
        let mut equidistant = Vec::with_capacity(nodes.len() * D);
        for &node in nodes {
            let position = file.nodes.get(&node).ok_or(GmshError::NoNode { element, node })?;
            equidistant.extend_from_slice(&position[..D]);
        }
        let shape = std::iter::once(D).chain([self.order; D]).collect();
        let lattice = Lattice::new(shape, equidistant);
        Ok((1..=D).fold(lattice, |lattice, axis| lattice.apply(axis, &self.to_gauss_lobatto)).values)
    }
}

/// The lattice index with the digits along axes 0 and 1 exchanged.
fn exchanged(index: usize, n: usize) -> usize {
    index / (n * n) * (n * n) + digit(index, n, 0) * n + digit(index, n, 1)
}

fn check_plane(file: &File, cells: &[&Element]) -> Result<(), GmshError> {
    let nodes: BTreeSet<u64> = cells.iter().flat_map(|cell| cell.nodes.iter().copied()).collect();
    let size = file.nodes.values().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    let first = file.nodes[&cells[0].nodes[0]][2];
    for node in nodes {
        let z = file.nodes[&node][2];
        if (z - first).abs() > PLANE * size {
            return Err(GmshError::NotPlane { node, z, first });
        }
    }
    Ok(())
}

/// Vertex numbers from node numbers, in the order of first appearance.
fn numbered(corners: &[u64]) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let mut number = |node: &u64| {
        let next = numbers.len();
        *numbers.entry(*node).or_insert(next)
    };
    corners.iter().map(&mut number).collect()
}

/// The faces of the cells that are listed as elements of a physical group, by the name of the group.
fn boundaries<const D: usize>(file: &File, corners: &[u64]) -> Result<Boundaries, GmshError> {
    let side_of = sides::<D>(corners);
    // In the order of the groups' numbers.
    let mut groups: BTreeMap<i64, Vec<Side>> = BTreeMap::new();
    for element in file.elements.iter().filter(|element| element.kind.dimension == D - 1) {
        for &group in &element.groups {
            let side = side_of.get(&face_key(&element.nodes[..1 << (D - 1)]));
            let stray = || GmshError::Stray { element: element.number, name: name(file, D - 1, group) };
            groups.entry(group).or_default().push(*side.ok_or_else(stray)?);
        }
    }
    Ok(by_name(groups.into_iter().map(|(group, sides)| (name(file, D - 1, group), sides))))
}

/// The cells of each physical group of dimension D, by its name.
fn regions<const D: usize>(file: &File, cells: &[&Element]) -> Vec<Region> {
    let number: BTreeMap<&[u64], usize> = cells.iter().enumerate().map(|(k, cell)| (&cell.nodes[..], k)).collect();
    let mut groups: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    for element in file.elements.iter().filter(|element| element.kind.dimension == D) {
        element.groups.iter().for_each(|&group| groups.entry(group).or_default().push(number[&element.nodes[..]]));
    }
    let named = by_name(groups.into_iter().map(|(group, cells)| (name(file, D, group), cells)));
    named.into_iter().map(|(name, cells)| Region { name, cells }).collect()
}

/// The lists in the order given, those of one name as one list.
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

fn name(file: &File, dimension: usize, group: i64) -> String {
    file.names.get(&(dimension, group)).cloned().unwrap_or_else(|| group.to_string())
}

/// The first side with given corners.
fn sides<const D: usize>(corners: &[u64]) -> BTreeMap<Vec<u64>, Side> {
    let mut sides = BTreeMap::new();
    for (cell, corners) in corners.chunks_exact(1 << D).enumerate() {
        for face in 0..2 * D {
            let nodes: Vec<u64> = face_nodes(D, 2, face).into_iter().map(|k| corners[k]).collect();
            sides.entry(face_key(&nodes)).or_insert(Side { cell, face });
        }
    }
    sides
}

fn face_key(nodes: &[u64]) -> Vec<u64> {
    let mut key = nodes.to_vec();
    key.sort_unstable();
    key
}

/// Pairs of boundaries by name. The translation is the one between the means of their corners.
fn pairs<const D: usize>(
    file: &File,
    corners: &[u64],
    boundaries: &Boundaries,
    periodic: &[(String, String)],
) -> Result<Vec<PeriodicPair<D>>, GmshError> {
    let number = |name: &String| {
        let known = || boundaries.iter().map(|(name, _)| name.clone()).collect();
        let found = boundaries.iter().position(|(other, _)| other == name);
        found.ok_or_else(|| GmshError::NoBoundary { name: name.clone(), known: known() })
    };
    let centre = |boundary: usize| {
        let nodes: Vec<u64> =
            boundaries[boundary].1.iter().flat_map(|&side| face_corners::<D>(corners, side)).collect();
        let sum = |i: usize| nodes.iter().map(|node| file.nodes[node][i]).sum::<f64>();
        std::array::from_fn::<f64, D, _>(|i| sum(i) / nodes.len() as f64)
    };
    let pair = |(minus, plus): &(String, String)| {
        let (minus, plus) = (number(minus)?, number(plus)?);
        let (from, to) = (centre(minus), centre(plus));
        Ok(PeriodicPair { minus, plus, translation: std::array::from_fn(|i| to[i] - from[i]) })
    };
    periodic.iter().map(pair).collect()
}

fn face_corners<const D: usize>(corners: &[u64], side: Side) -> Vec<u64> {
    let cell = &corners[side.cell << D..];
    face_nodes(D, 2, side.face).into_iter().map(|k| cell[k]).collect()
}
