//! A box of quadrilaterals or hexahedra.

use super::curving::{Curving, Deformation};
use crate::facet::axis_and_side;
use crate::lattice::digit;
use crate::{Mesh, MeshError, ORDERS, PeriodicPair, Region, Side};
use basis::gauss_lobatto;
use std::array::from_fn;

/// The position of a point of a box on a mapped mesh.
pub type PositionMap<'a, const D: usize> = &'a dyn Fn(&[f64; D]) -> [f64; D];

/// Names of the boundaries of a box, at the index of the face: x low, x high, y low, y high, z low, z high.
pub const BOX_BOUNDARIES: [&str; 6] = ["left", "right", "bottom", "top", "front", "back"];

/// A box with `cells[a]` cells along axis a, of equal size before curving. Boundaries are named [`BOX_BOUNDARIES`];
/// those of a periodic axis are joined and have no name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxMesh<const D: usize> {
    /// The corner with the smallest coordinates.
    pub lower: [f64; D],
    /// The corner with the largest coordinates.
    pub upper: [f64; D],
    /// Cells along each axis.
    pub cells: [usize; D],
    /// N, nodes per direction of the geometry.
    pub order: usize,
    /// The deformation of the box.
    pub curving: Curving,
    /// Along which axes the box is periodic.
    pub periodic: [bool; D],
}

impl<const D: usize> BoxMesh<D> {
    /// The mesh, with cells of equal size.
    pub fn build(&self) -> Result<Mesh<D>, MeshError> {
        self.build_graded([1.0; D])
    }

    /// The mesh, with cells whose sizes along axis a form a geometric sequence: the last is `ratios[a]` times the
    /// first.
    pub fn build_graded(&self, ratios: [f64; D]) -> Result<Mesh<D>, MeshError> {
        self.check(&ratios)?;
        self.build_on(&from_fn(|axis| graded(self.cells[axis], ratios[axis])), BOX_BOUNDARIES)
    }

    /// The mesh, with the ends of the cells along axis a at `breakpoints[a]`, a partition of [0, 1], and with names for
    /// the six faces. The parameters must have been checked.
    pub(super) fn build_on(&self, breakpoints: &[Vec<f64>; D], names: [&str; 6]) -> Result<Mesh<D>, MeshError> {
        self.build_regions_on(breakpoints, names, Vec::new(), &|x| *x)
    }

    /// The same with regions, and with the nodes where `map` has them.
    pub(super) fn build_regions_on(
        &self,
        breakpoints: &[Vec<f64>; D],
        names: [&str; 6],
        regions: Vec<Region>,
        map: PositionMap<'_, D>,
    ) -> Result<Mesh<D>, MeshError> {
        let corners = (0..self.n_cells()).flat_map(|cell| self.corners(cell)).collect();
        let boundaries = (0..2 * D).map(|face| (names[face].to_owned(), self.boundary(face))).collect();
        let periodic = (0..D).filter(|&axis| self.periodic[axis]).map(|axis| self.periodic_pair(axis, map)).collect();
        let box_coordinates = self.coordinates(breakpoints);
        let coordinates = box_coordinates.as_chunks::<D>().0.iter().flat_map(map).collect();
        Mesh::of_regions(self.order, corners, coordinates, boundaries, periodic, regions)
    }

    /// Whether order, extents, cells and ratios are possible.
    pub(super) fn check(&self, ratios: &[f64; D]) -> Result<(), MeshError> {
        let order = self.order;
        if !ORDERS.contains(&order) {
            return Err(MeshError::Order { order });
        }
        let positive = |x: f64| x.is_finite() && x > 0.0;
        for axis in 0..D {
            let extent = self.upper[axis] - self.lower[axis];
            let cells = self.cells[axis] as f64;
            for (quantity, value, accepted, fine) in [
                ("the extent", extent, "a positive number", positive(extent)),
                ("the number of cells", cells, "at least 1", cells >= 1.0),
                ("the size ratio", ratios[axis], "a positive number", positive(ratios[axis])),
                (
                    "the amplitude of the curving",
                    self.curving.amplitude(),
                    "a number",
                    self.curving.amplitude().is_finite(),
                ),
            ] {
                if !fine {
                    return Err(MeshError::Box { quantity, axis, value, accepted });
                }
            }
        }
        Ok(())
    }

    pub(super) fn n_cells(&self) -> usize {
        self.cells.iter().product()
    }

    /// The position of `cell` in the box, along each axis.
    pub(super) fn place(&self, cell: usize) -> [usize; D] {
        let mut rest = cell;
        self.cells.map(|n| {
            let digit = rest % n;
            rest /= n;
            digit
        })
    }

    /// The vertices of `cell` in the lattice of `cells + 1` vertices per axis.
    fn corners(&self, cell: usize) -> impl Iterator<Item = usize> {
        let (place, cells) = (self.place(cell), self.cells);
        (0..1 << D).map(move |k| (0..D).rev().fold(0, |index, a| index * (cells[a] + 1) + place[a] + (k >> a & 1)))
    }

    /// The boundary faces of the cells that lie on face number `face` of the box.
    fn boundary(&self, face: usize) -> Vec<Side> {
        let (axis, side) = axis_and_side(face);
        let layer = side * (self.cells[axis] - 1);
        (0..self.n_cells()).filter(|&cell| self.place(cell)[axis] == layer).map(|cell| Side { cell, face }).collect()
    }

    /// The sides along `axis`, with the translation from one to the other where `map` has them.
    fn periodic_pair(&self, axis: usize, map: PositionMap<'_, D>) -> PeriodicPair<D> {
        let mut end = self.lower;
        end[axis] = self.upper[axis];
        let (from, to) = (map(&self.lower), map(&end));
        PeriodicPair { minus: 2 * axis + 1, plus: 2 * axis, translation: from_fn(|i| from[i] - to[i]) }
    }

    /// x = lower + (upper - lower) (r + d(r)) at the Gauss-Lobatto nodes.
    fn coordinates(&self, breakpoints: &[Vec<f64>; D]) -> Vec<f64> {
        let nodes = gauss_lobatto(self.order).points;
        let deformation = Deformation::new(self.curving, self.periodic);
        let mut coordinates = Vec::with_capacity(self.n_cells() * nodes.len().pow(D as u32) * D);
        for cell in 0..self.n_cells() {
            let place = self.place(cell);
            for k in 0..nodes.len().pow(D as u32) {
                let r = from_fn(|a| {
                    let xi = nodes[digit(k, nodes.len(), a)];
                    // Exact at both ends, so that neighbours have identical nodes.
                    breakpoints[a][place[a]] * (0.5 - 0.5 * xi) + breakpoints[a][place[a] + 1] * (0.5 + 0.5 * xi)
                });
                let d = deformation.displacement(&r);
                coordinates.extend((0..D).map(|i| self.lower[i] + (self.upper[i] - self.lower[i]) * (r[i] + d[i])));
            }
        }
        coordinates
    }
}

/// The ends of `cells` intervals that fill [0, 1]. Their lengths form a geometric sequence; the last is `ratio` times the first.
pub(super) fn graded(cells: usize, ratio: f64) -> Vec<f64> {
    let growth = if cells == 1 { 1.0 } else { ratio.powf(1.0 / (cells - 1) as f64) };
    partition((0..cells).map(|i| growth.powi(i as i32)).collect())
}

/// The ends of intervals that fill [0, 1], with lengths in the proportions of `lengths`.
pub(super) fn partition(lengths: Vec<f64>) -> Vec<f64> {
    let total: f64 = lengths.iter().sum();
    let mut ends = vec![0.0];
    for i in 1..lengths.len() {
        ends.push(ends[i - 1] + lengths[i - 1] / total);
    }
    ends.push(1.0);
    ends
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn unit<const D: usize>(cells: [usize; D], curving: Curving) -> BoxMesh<D> {
        BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: 4, curving, periodic: [false; D] }
    }

    #[test]
    fn boundaries_lie_where_their_names_say() {
        let mesh = BoxMesh { lower: [-1.0, 2.0, 5.0], upper: [1.0, 3.0, 9.0], ..unit([2, 3, 2], Curving::None) }
            .build()
            .unwrap();
        assert_eq!(mesh.boundary_names(), BOX_BOUNDARIES);
        let place = [-1.0, 1.0, 2.0, 3.0, 5.0, 9.0];
        for facet in mesh.boundary_facets() {
            assert_eq!(mesh.face_centre(facet.side)[facet.boundary / 2], place[facet.boundary]);
        }
        assert_eq!(mesh.boundary_facets().len(), 2 * (3 * 2 + 2 * 2 + 2 * 3));
        assert_eq!(mesh.interior_facets().len(), 3 * 2 + 2 * 2 * 2 + 2 * 3);
        assert!((mesh.volume() - 8.0).abs() < 1e-13);
    }

    #[test]
    fn graded_cells_grow_by_a_constant_factor() {
        let mesh = unit([4, 1], Curving::None).build_graded([27.0, 1.0]).unwrap();
        let sizes: Vec<f64> = mesh.volumes_and_centroids().iter().map(|(volume, _)| *volume).collect();
        for cell in 0..4 {
            assert!((sizes[cell] - 3_f64.powi(cell as i32) / 40.0).abs() < 1e-14);
        }
    }

    /// The largest distance between nodes of the straight and the curved mesh.
    fn displacement<const D: usize>(straight: &Mesh<D>, curved: &Mesh<D>) -> f64 {
        straight.coordinates().iter().zip(curved.coordinates()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn every_curving_gives_valid_cells_within_its_amplitude() {
        let amplitude = 0.05;
        let curvings = [Curving::Smooth { amplitude }, Curving::Wavy { amplitude }];
        let random = (0..20).map(|seed| Curving::Random { amplitude, seed });
        for curving in curvings.into_iter().chain(random) {
            for periodic in [false, true] {
                let (flat, space) = (unit([3, 4], curving), unit([2, 3, 2], curving));
                let flat = BoxMesh { periodic: [periodic; 2], ..flat }.build().unwrap();
                let space = BoxMesh { periodic: [periodic; 3], ..space }.build().unwrap();
                let moved = displacement(&unit([3, 4], Curving::None).build().unwrap(), &flat);
                assert!(moved <= amplitude + 1e-15 && moved > 0.1 * amplitude, "{curving:?} {moved}");
                let moved = displacement(&unit([2, 3, 2], Curving::None).build().unwrap(), &space);
                assert!(moved <= amplitude + 1e-15 && moved > 0.05 * amplitude, "{curving:?} {moved}");
            }
        }
    }

    #[test]
    fn random_fields_depend_on_the_seed_only() {
        let mesh = |seed| unit([2, 2], Curving::Random { amplitude: 0.03, seed }).build().unwrap();
        assert_eq!(mesh(1), mesh(1));
        assert!(displacement(&mesh(1), &mesh(2)) > 1e-3);
    }

    #[test]
    fn impossible_boxes_are_refused() {
        let refused = |spoil: fn(&mut BoxMesh<2>)| {
            let mut mesh = unit([2, 2], Curving::None);
            spoil(&mut mesh);
            mesh.build().unwrap_err()
        };
        assert!(matches!(refused(|b| b.cells[1] = 0), MeshError::Box { quantity: "the number of cells", axis: 1, .. }));
        assert!(matches!(
            refused(|b| b.upper[0] = 0.0),
            MeshError::Box { quantity: "the extent", axis: 0, value: 0.0, .. }
        ));
        assert!(matches!(refused(|b| b.lower[1] = f64::NAN), MeshError::Box { quantity: "the extent", .. }));
        assert_eq!(refused(|b| b.order = 17), MeshError::Order { order: 17 });
        assert!(matches!(refused(|b| b.curving = Curving::Smooth { amplitude: 0.5 }), MeshError::Inverted { .. }));
        let error = unit([2, 2], Curving::None).build_graded([1.0, -1.0]).unwrap_err();
        assert!(matches!(error, MeshError::Box { axis: 1, value: -1.0, .. }));
    }
}
