//! A shell of hexahedra between an ellipsoid and the far field.

use super::growth::{Check, Growth};
use crate::lattice::digit;
use crate::{Mesh, MeshError, ORDERS, Side, axis_and_side};
use basis::gauss_lobatto;
use std::array::from_fn;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;
use tensor::norm;

const CHECK: Check = Check { mesh: "ellipsoid" };

/// The names of `semi_axes` and `cells` in errors.
const SEMI_AXES: [&str; 3] = ["the semi-axis along x", "the semi-axis along y", "the semi-axis along z"];
const CELLS: [&str; 4] = [
    "the number of cells along x",
    "the number of cells along y",
    "the number of cells along z",
    "the number of cells outwards",
];

/// Cells between an ellipsoid around the origin and the far field, in six patches like the faces of a cube (a cubed sphere).
/// Boundaries are "wall" (the ellipsoid) and "far".
///
/// Layers of cells end on ellipsoids with common foci. Along the unit vector e they have the positions
///
/// ```text
/// x_i = sqrt(a_i^2 + l) e_i,   l = (m + h)^2 - m^2                                                     (confocal)
/// ```
///
/// Here a_i are the semi-axes of the wall, m is the shortest one, and h is the distance from the wall along that axis. Far away the
/// ellipsoids tend to spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipsoidMesh {
    /// Semi-axes of the wall along x, y and z.
    pub semi_axes: [f64; 3],
    /// The largest semi-axis of the far field.
    pub outer_radius: f64,
    /// Height of the cells at the wall, along its shortest semi-axis.
    pub first_cell: f64,
    /// Cells of the patches along x, y and z, and from the wall to the far field.
    pub cells: [usize; 4],
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// A cell of the patch over one face of the cube, and its numbers along the axes 0, 1 and 2 of the cells.
#[derive(Clone, Copy)]
struct Cell {
    face: usize,
    place: [usize; 3],
}

/// The axes of the cube along the axes 0 and 1 of the cells over a face. Axis 2 is outwards, so cells over both faces of an axis are
/// right-handed.
fn tangents(face: usize) -> [usize; 2] {
    let (axis, side) = axis_and_side(face);
    let next = [(axis + 1) % 3, (axis + 2) % 3];
    if side == 1 { next } else { [next[1], next[0]] }
}

/// A point of a patch in the lattice of the whole mesh: cells along x, y and z from the low face of the cube, and cells from the wall.
/// A point that patches share has the same numbers from each of them. `ends`: the numbers at the two faces of each axis.
fn in_cube<T: Copy>(face: usize, [i, j, k]: [T; 3], ends: [[T; 2]; 3]) -> [T; 4] {
    let (axis, side) = axis_and_side(face);
    let end = ends[axis][side];
    let mut point = [end, end, end, k];
    let [first, second] = tangents(face);
    (point[first], point[second]) = (i, j);
    point
}

impl EllipsoidMesh {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<3>, MeshError> {
        let growth = self.growth()?;
        let cells: Vec<Cell> = (0..6).flat_map(|face| self.cells_over(face)).collect();
        let boundary = |name: &str, layer: usize, face: usize| {
            let in_layer = cells.iter().enumerate().filter(|(_, cell)| cell.place[2] == layer);
            (name.to_owned(), in_layer.map(|(cell, _)| Side { cell, face }).collect())
        };
        let boundaries = vec![boundary("wall", 0, 4), boundary("far", self.cells[3] - 1, 5)];
        Mesh::new(self.order, self.corners(&cells), self.coordinates(&cells, &growth), boundaries, Vec::new())
    }

    /// The number of cells of the whole mesh.
    pub fn n_cells(&self) -> usize {
        let [x, y, z, outwards] = self.cells;
        let pairs = [(x, y), (y, z), (z, x)].map(|(a, b): (usize, usize)| a.saturating_mul(b));
        pairs.into_iter().fold(0, usize::saturating_add).saturating_mul(2).saturating_mul(outwards)
    }

    fn cells_over(&self, face: usize) -> impl Iterator<Item = Cell> {
        let [first, second] = tangents(face).map(|axis| self.cells[axis]);
        let cell = move |k: usize| Cell { face, place: [k % first, k / first % second, k / first / second] };
        (0..first * second * self.cells[3]).map(cell)
    }

    /// Vertex numbers, in the order of first appearance.
    fn corners(&self, cells: &[Cell]) -> Vec<usize> {
        let ends = from_fn(|axis| [0, self.cells[axis]]);
        let mut numbers = BTreeMap::new();
        let mut number = |vertex| {
            let next = numbers.len();
            *numbers.entry(vertex).or_insert(next)
        };
        let vertices = |&Cell { face, place }: &Cell| {
            (0..8).map(move |k| in_cube(face, from_fn(|axis| place[axis] + (k >> axis & 1)), ends))
        };
        cells.iter().flat_map(vertices).map(&mut number).collect()
    }

    /// The positions of the nodes of all cells.
    fn coordinates(&self, cells: &[Cell], growth: &Growth) -> Vec<f64> {
        let nodes = &gauss_lobatto(self.order).points;
        let ends = from_fn(|axis| [0.0, self.cells[axis] as f64]);
        // Exact at both ends, so that neighbours have identical nodes.
        let index = |i: usize, xi: f64| i as f64 * (0.5 - 0.5 * xi) + (i + 1) as f64 * (0.5 + 0.5 * xi);
        let of_cell = |&Cell { face, place }: &Cell| {
            let in_patch = move |node| from_fn(|axis| index(place[axis], nodes[digit(node, nodes.len(), axis)]));
            (0..nodes.len().pow(3)).flat_map(move |node| self.position(in_cube(face, in_patch(node), ends), growth))
        };
        cells.iter().flat_map(of_cell).collect()
    }

    /// (confocal). Seen from the centre of a sphere, the cells of a patch divide its right angle evenly (equiangular patches).
    fn position(&self, point: [f64; 4], growth: &Growth) -> [f64; 3] {
        let on_cube: [f64; 3] = from_fn(|i| (FRAC_PI_4 * (2.0 * point[i] / self.cells[i] as f64 - 1.0)).tan());
        let (length, h) = (norm(&on_cube), growth.size(point[3]));
        let l = h * (2.0 * self.shortest() + h);
        from_fn(|i| (self.semi_axes[i].powi(2) + l).sqrt() * on_cube[i] / length)
    }

    fn shortest(&self) -> f64 {
        self.semi_axes.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// h at the far field, where the longest semi-axis is the outer radius.
    fn width(&self) -> f64 {
        let (shortest, longest) = (self.shortest(), self.semi_axes.into_iter().fold(0.0, f64::max));
        let l = (self.outer_radius - longest) * (self.outer_radius + longest);
        l / ((shortest * shortest + l).sqrt() + shortest)
    }

    fn growth(&self) -> Result<Growth, MeshError> {
        self.check()?;
        let (first, width) = (self.first_cell, self.width());
        CHECK.positive("the height of the first cell", first)?;
        let accepted = "less than the distance of the far field along the shortest semi-axis";
        CHECK.first_cell((self.cells[3], first), width, accepted)?;
        Ok(Growth::new(self.cells[3], first, width))
    }

    /// Whether order, radii and numbers of cells are possible.
    fn check(&self) -> Result<(), MeshError> {
        if !ORDERS.contains(&self.order) {
            return Err(MeshError::Order { order: self.order });
        }
        let (axes, radius) = (self.semi_axes, self.outer_radius);
        SEMI_AXES.iter().zip(axes).try_for_each(|(name, a)| CHECK.positive(name, a))?;
        let fits = radius.is_finite() && axes.iter().all(|a| *a < radius);
        CHECK.that(fits, "the radius of the far field", radius, "more than every semi-axis of the wall")?;
        CELLS.iter().zip(self.cells).try_for_each(|(name, n)| CHECK.count(name, n))
    }
}

#[cfg(test)]
mod tests;
