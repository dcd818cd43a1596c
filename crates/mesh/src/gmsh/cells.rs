//! The cells of a mesh from the elements of a file.

use super::GmshError;
use super::file::{Element, File};
use super::split::{Corners, Splitter};
use crate::facet::corner_node;
use crate::lattice::{Lattice, digit};
use crate::{CellMap, Side};
use basis::{Lagrange, Matrix, equidistant_points, gauss_lobatto};
use std::collections::BTreeMap;
use std::ops::Range;

/// Cells with the arrays of [`crate::Mesh::new`]. The cells of an element follow one another.
pub(super) struct Cells<const D: usize> {
    /// N of the lattice.
    pub(super) order: usize,
    pub(super) corners: Vec<usize>,
    pub(super) coordinates: Vec<f64>,
    /// The first cell of each element, then the number of cells.
    first: Vec<usize>,
    /// The number of the vertex that is the mean of some nodes. Vertices are numbered in the order of first appearance.
    vertices: BTreeMap<Vec<u64>, usize>,
}

/// An error if the element names a node twice.
fn refuse_repeated_node(element: &Element) -> Result<(), GmshError> {
    let mut nodes = element.nodes.clone();
    nodes.sort_unstable();
    match nodes.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(GmshError::RepeatedNode { element: element.number, node: pair[0] }),
        None => Ok(()),
    }
}

impl<const D: usize> Cells<D> {
    /// The cells of `elements`, all of degree `degree`.
    pub(super) fn read(
        splitter: &mut Splitter,
        file: &File,
        elements: &[&Element],
        degree: usize,
    ) -> Result<Self, GmshError> {
        let (vertices, first) = (BTreeMap::new(), vec![0]);
        let mut cells = Cells { order: degree + 1, corners: Vec::new(), coordinates: Vec::new(), first, vertices };
        let reader = CellReader::<D>::new(degree);
        for element in elements {
            refuse_repeated_node(element)?;
            let whole = !splitter.cuts(element);
            let pieces = if whole { vec![reader.read(file, element)?] } else { splitter.pieces::<D>(element)? };
            for (corners, positions) in pieces {
                let (corners, positions) = reader.right_handed(corners, positions);
                cells.push(corners, positions);
            }
            cells.first.push(cells.corners.len() >> D);
        }
        Ok(cells)
    }

    fn push(&mut self, corners: Corners, positions: Vec<f64>) {
        for nodes in corners {
            let next = self.vertices.len();
            self.corners.push(*self.vertices.entry(nodes).or_insert(next));
        }
        self.coordinates.extend(positions);
    }

    /// The cells of element `index`.
    pub(super) fn of_element(&self, index: usize) -> Range<usize> {
        self.first[index]..self.first[index + 1]
    }

    /// The element of a cell, by index.
    pub(super) fn element(&self, cell: usize) -> usize {
        self.first.partition_point(|&first| first <= cell).saturating_sub(1)
    }

    /// The numbers of the vertices with the given corners; `None` if one is not a vertex of a cell.
    pub(super) fn vertices(&self, corners: &Corners) -> Option<Vec<usize>> {
        corners.iter().map(|nodes| self.vertices.get(nodes).copied()).collect()
    }

    /// The position of local corner `corner` of a cell.
    pub(super) fn corner_position(&self, cell: usize, corner: usize) -> [f64; D] {
        let node = cell * self.order.pow(D as u32) + corner_node(D, self.order, corner);
        crate::mesh::point(&self.coordinates, node)
    }

    /// The vertices of a face with the positions, in the order of its lattice.
    pub(super) fn face(&self, side: Side) -> Vec<(usize, [f64; D])> {
        let corners = crate::face_nodes(D, 2, side.face).into_iter();
        corners.map(|k| (self.corners[(side.cell << D) + k], self.corner_position(side.cell, k))).collect()
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
            indices: super::element::Kind::of_cell(D, degree).lattice_indices(),
            to_gauss_lobatto: Lagrange::new(equidistant_points(order)).value_matrix(&nodes),
            map: CellMap::on_grid(order, &nodes),
        }
    }

    /// The nodes at the corners, and the positions of the Gauss-Lobatto nodes, `[node][D]`, of a cell that is not cut.
    fn read(&self, file: &File, cell: &Element) -> Result<(Corners, Vec<f64>), GmshError> {
        let positions = file.positions::<D>(cell)?;
        let (mut nodes, mut equidistant) = (vec![0; self.indices.len()], vec![0.0; self.indices.len() * D]);
        for ((&index, &node), x) in self.indices.iter().zip(&cell.nodes).zip(positions) {
            nodes[index] = node;
            equidistant[index * D..][..D].copy_from_slice(&x);
        }
        let shape = std::iter::once(D).chain([self.order; D]).collect();
        let lattice = Lattice::new(shape, equidistant);
        let positions = (1..=D).fold(lattice, |lattice, axis| lattice.apply(axis, &self.to_gauss_lobatto)).values;
        let corners = (0..1 << D).map(|k| vec![nodes[corner_node(D, self.order, k)]]).collect();
        Ok((corners, positions))
    }

    /// The cell itself; if it is left-handed, the cell with axes 0 and 1 exchanged.
    fn right_handed(&self, corners: Corners, positions: Vec<f64>) -> (Corners, Vec<f64>) {
        if self.map.determinants(&positions).iter().any(|&det| det >= 0.0) {
            return (corners, positions);
        }
        let nodes = 0..positions.len() / D;
        let turned = nodes.flat_map(|k| crate::mesh::point::<D>(&positions, exchanged(k, self.order))).collect();
        ((0..1 << D).map(|k| corners[exchanged(k, 2)].clone()).collect(), turned)
    }
}

/// The lattice index with the digits along axes 0 and 1 exchanged.
fn exchanged(index: usize, n: usize) -> usize {
    index / (n * n) * (n * n) + digit(index, n, 0) * n + digit(index, n, 1)
}
