//! Two-dimensional meshes joined from structured blocks.

use super::smoothing::Harmonic;
use crate::facet::face_nodes;
use crate::{Mesh, MeshError, ORDERS, PeriodicPair, Region, Side};
use basis::gauss_lobatto;
use std::collections::BTreeMap;

/// Corners of blocks closer than this times the largest coordinate are one vertex.
const TOLERANCE: f64 = 1e-12;

/// Blocks of cells. Blocks are joined where their corners coincide; no list of neighbours is needed.
pub(super) struct Assembly {
    order: usize,
    nodes: Vec<f64>,
    coordinates: Vec<f64>,
    boundaries: Vec<(String, Vec<Side>)>,
    regions: Vec<Region>,
}

/// The names of the four faces of a block: low and high along axis 0, low and high along axis 1.
pub(super) type Names<'a> = [Option<&'a str>; 4];

impl Assembly {
    /// For cells of order `order`.
    pub(super) fn new(order: usize) -> Result<Self, MeshError> {
        if !ORDERS.contains(&order) {
            return Err(MeshError::Order { order });
        }
        let nodes = gauss_lobatto(order).points;
        Ok(Assembly { order, nodes, coordinates: Vec::new(), boundaries: Vec::new(), regions: Vec::new() })
    }

    /// Adds `cells[0]` x `cells[1]` cells; cell (i, j) is the image of [i, i+1] x [j, j+1] under `position`, which must
    /// be smooth in each cell. Every cell of a named face joins the boundary of that name.
    pub(super) fn add(&mut self, cells: [usize; 2], names: Names, position: impl Fn([f64; 2]) -> [f64; 2]) {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                self.name_faces(&names, [i == 0, i + 1 == cells[0], j == 0, j + 1 == cells[1]]);
                self.add_nodes([i, j], &position);
            }
        }
    }

    /// Adds cells as [`Self::add`] does, and puts them into a region.
    pub(super) fn add_to(
        &mut self,
        region: &str,
        cells: [usize; 2],
        names: Names,
        position: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let first = self.n_cells();
        self.add(cells, names, position);
        let added = first..self.n_cells();
        match self.regions.iter_mut().find(|known| known.name == region) {
            Some(known) => known.cells.extend(added),
            None => self.regions.push(Region { name: region.to_owned(), cells: added.collect() }),
        }
    }

    fn n_cells(&self) -> usize {
        self.coordinates.len() / (2 * self.order.pow(2))
    }

    /// Lists the faces of the next cell, those that are `outside`, under their names.
    fn name_faces(&mut self, names: &Names, outside: [bool; 4]) {
        let cell = self.n_cells();
        for (face, name) in names.iter().enumerate().filter(|&(face, _)| outside[face]) {
            let Some(name) = name else { continue };
            match self.boundaries.iter_mut().find(|(other, _)| other == name) {
                Some((_, sides)) => sides.push(Side { cell, face }),
                None => self.boundaries.push(((*name).to_owned(), vec![Side { cell, face }])),
            }
        }
    }

    fn add_nodes(&mut self, cell: [usize; 2], position: &impl Fn([f64; 2]) -> [f64; 2]) {
        // Exact at both ends, so that neighbours have identical nodes.
        let index = |i: usize, xi: f64| i as f64 * (0.5 - 0.5 * xi) + (i + 1) as f64 * (0.5 + 0.5 * xi);
        for &eta in &self.nodes {
            for &xi in &self.nodes {
                self.coordinates.extend(position([index(cell[0], xi), index(cell[1], eta)]));
            }
        }
    }

    /// Moves the nodes of the cells from `first` on, except those on a named face or in a cell before `first`: see
    /// [`Harmonic`].
    pub(super) fn smooth_from(&mut self, first: usize) {
        let n = self.order;
        let (points, _) = self.coordinates.as_chunks::<2>();
        let numbers = merge(points);
        let count = numbers.iter().max().map_or(0, |last| last + 1);
        let mut free = vec![true; count];
        numbers[..first * n * n].iter().for_each(|&node| free[node] = false);
        for side in self.boundaries.iter().flat_map(|(_, sides)| sides) {
            face_nodes(2, n, side.face).into_iter().for_each(|k| free[numbers[side.cell * n * n + k]] = false);
        }
        let harmonic = Harmonic::new(n, &numbers, free);
        for axis in 0..2 {
            let mut x = vec![0.0; count];
            numbers.iter().enumerate().for_each(|(k, &node)| x[node] = self.coordinates[2 * k + axis]);
            harmonic.solve(&mut x);
            numbers.iter().enumerate().for_each(|(k, &node)| self.coordinates[2 * k + axis] = x[node]);
        }
    }

    /// Maps all nodes.
    pub(super) fn map(&mut self, f: impl Fn([f64; 2]) -> [f64; 2]) {
        self.coordinates.as_chunks_mut::<2>().0.iter_mut().for_each(|x| *x = f(*x));
    }

    /// The mesh. `periodic` names two boundaries and the translation of the first onto the second.
    pub(super) fn build(self, periodic: &[(&str, &str, [f64; 2])]) -> Result<Mesh<2>, MeshError> {
        let number = |name: &str| {
            self.boundaries
                .iter()
                .position(|(other, _)| other == name)
                .expect("periodic boundaries are named by blocks")
        };
        let pairs = periodic.iter().map(|&(minus, plus, translation)| PeriodicPair {
            minus: number(minus),
            plus: number(plus),
            translation,
        });
        let (pairs, corners) = (pairs.collect(), merge(&self.corners()));
        Mesh::of_regions(self.order, corners, self.coordinates, self.boundaries, pairs, self.regions)
    }

    /// The positions of the corners of all cells, four per cell.
    fn corners(&self) -> Vec<[f64; 2]> {
        let n = self.order;
        let cells = self.coordinates.chunks_exact(2 * n * n);
        cells.flat_map(|x| [0, n - 1, n * (n - 1), n * n - 1].map(|k| [x[2 * k], x[2 * k + 1]])).collect()
    }
}

/// A number for each point, equal for points that coincide, in the order of first appearance.
fn merge(points: &[[f64; 2]]) -> Vec<usize> {
    let size = points.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    let tolerance = TOLERANCE * size;
    let mut by_x: Vec<usize> = (0..points.len()).collect();
    by_x.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]));
    let mut representative: Vec<usize> = (0..points.len()).collect();
    for (rank, &k) in by_x.iter().enumerate() {
        let near = |&&other: &&usize| points[k][0] - points[other][0] <= tolerance;
        let same = |&&other: &&usize| (points[k][1] - points[other][1]).abs() <= tolerance;
        if let Some(&twin) = by_x[..rank].iter().rev().take_while(near).find(same) {
            representative[k] = representative[twin];
        }
    }
    let mut numbers = BTreeMap::new();
    let mut number = |&r: &usize| {
        let next = numbers.len();
        *numbers.entry(r).or_insert(next)
    };
    representative.iter().map(&mut number).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn points_within_round_off_are_one() {
        let points = [[0.0, 1.0], [2.0, 0.0], [1e-13, 1.0 - 1e-13], [0.0, 0.0], [2.0, 1e-13], [0.0, -1e-13]];
        assert_eq!(merge(&points), [0, 1, 0, 2, 1, 2]);
    }

    #[test]
    fn blocks_join_where_they_touch_in_any_orientation() {
        let mut assembly = Assembly::new(3).unwrap();
        assembly.add([2, 3], [Some("left"), None, Some("wall"), Some("wall")], |[s, t]| [s, t]);
        // The same height, turned by half: its axis 1 runs down.
        assembly.add([4, 3], [Some("right"), None, Some("wall"), Some("wall")], |[s, t]| [6.0 - s, 3.0 - t]);
        let mesh = assembly.build(&[]).unwrap();
        assert_eq!((mesh.n_cells(), mesh.interior_facets().len()), (18, 3 * 5 + 2 * 6));
        assert_eq!(mesh.boundary_names(), ["left", "wall", "right"]);
        assert!((mesh.volume() - 18.0).abs() < 1e-13);
    }
}
