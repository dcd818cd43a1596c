//! The geometry of a boundary at its C0 nodes: normals and axes.

use crate::facet::{axis_and_side, face_nodes, outward_sign};
use crate::periodic::gap_tolerance;
use crate::{BoundaryFacet, CellMap, Mesh, MeshError, NodeNumbering, Side};
use basis::gauss_lobatto;
use std::array::from_fn;
use std::collections::BTreeMap;
use tensor::{cofactor, norm};

/// A mean of unit normals shorter than this has no usable direction.
const NO_DIRECTION: f64 = 1e-8;

impl<const D: usize> Mesh<D> {
    /// The unit normal, out of the domain, at every C0 node of `boundary`:
    ///
    /// ```text
    /// n = sum_f n_f / |sum_f n_f|,    n_f = +-cof(J) e_a / |cof(J) e_a|                                       (normal)
    /// ```
    ///
    /// over the facets f of this boundary that meet in the node, face 2 a + side of their cells. Each facet counts once;
    /// facets of other boundaries do not count. On a smooth boundary all n_f agree up to the accuracy of the geometry; at
    /// an edge or a corner n lies between them.
    ///
    /// # Errors
    /// [`MeshError::NoNormal`] if facets are back to back, as at a cusp.
    pub fn boundary_normals(
        &self,
        numbering: &NodeNumbering,
        boundary: usize,
    ) -> Result<BTreeMap<usize, [f64; D]>, MeshError> {
        let map = CellMap::on_grid(self.order, &gauss_lobatto(numbering.order()).points);
        let mut sums: BTreeMap<usize, ([f64; D], [f64; D])> = BTreeMap::new();
        for side in self.sides_of(boundary) {
            let nodes = self.cell_coordinates(side.cell);
            let (positions, jacobians) = (map.positions(nodes), map.jacobians(nodes));
            for k in face_nodes(D, numbering.order(), side.face) {
                let normal = unit_normal(&jacobians[k], side.face);
                let (sum, _) = sums.entry(numbering.cell(side.cell)[k]).or_insert(([0.0; D], positions[k]));
                (0..D).for_each(|i| sum[i] += normal[i]);
            }
        }
        let normalised = |(node, (sum, position)): (usize, ([f64; D], [f64; D]))| {
            let length = norm(&sum);
            if length < NO_DIRECTION {
                let name = self.boundary_names[boundary].clone();
                return Err(MeshError::NoNormal { name, position: position.to_vec() });
            }
            Ok((node, sum.map(|x| x / length)))
        };
        sums.into_iter().map(normalised).collect()
    }

    /// The C0 nodes of `boundary`, and the axes that it is normal to there: one in a plane, several where planes meet.
    ///
    /// # Errors
    /// [`MeshError::NoAxis`] where a facet is not in a plane normal to an axis.
    pub fn normal_axes(
        &self,
        numbering: &NodeNumbering,
        boundary: usize,
    ) -> Result<BTreeMap<usize, [bool; D]>, MeshError> {
        let tolerance = gap_tolerance(self);
        let mut axes: BTreeMap<usize, [bool; D]> = BTreeMap::new();
        for side in self.sides_of(boundary) {
            let positions = self.face_positions(side);
            let extents: [f64; D] = from_fn(|axis| extent(&positions, axis));
            // A small facet may be thin along other axes, too.
            let axis =
                (0..D).min_by(|a, b| extents[*a].total_cmp(&extents[*b])).filter(|axis| extents[*axis] <= tolerance);
            let Some(axis) = axis else {
                let (name, position) = (self.boundary_names[boundary].clone(), self.face_centre(side));
                return Err(MeshError::NoAxis { name, position });
            };
            numbering.face::<D>(side).into_iter().for_each(|node| axes.entry(node).or_insert([false; D])[axis] = true);
        }
        Ok(axes)
    }

    pub(crate) fn sides_of(&self, boundary: usize) -> impl Iterator<Item = Side> {
        self.boundary_facets
            .iter()
            .filter(move |facet| facet.boundary == boundary)
            .map(|&BoundaryFacet { side, .. }| side)
    }
}

/// The extent of points along an axis.
fn extent<const D: usize>(points: &[[f64; D]], axis: usize) -> f64 {
    let along = || points.iter().map(|x| x[axis]);
    along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
}

/// The outward normal of a face, where dx/dxi is `jacobian`: cof(dx/dxi) e_axis with the sign of the side. Its length is the area of the
/// face per area of the reference face.
pub fn outward_area<const D: usize>(jacobian: &[[f64; D]; D], face: usize) -> [f64; D] {
    let (axis, _) = axis_and_side(face);
    let cofactor = cofactor(jacobian);
    from_fn(|i| outward_sign(face) * cofactor[i][axis])
}

fn unit_normal<const D: usize>(jacobian: &[[f64; D]; D], face: usize) -> [f64; D] {
    let normal = outward_area(jacobian, face);
    let length = norm(&normal);
    normal.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::generate::{AirfoilMesh, AnnulusMesh, Extrusion, RotatingBoxMesh};
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    fn named<const D: usize>(mesh: &Mesh<D>, name: &str) -> usize {
        mesh.boundary_names().iter().position(|known| known == name).unwrap()
    }

    /// Positions of the C0 nodes.
    fn places<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> BTreeMap<usize, [f64; D]> {
        let fine = mesh.with_order(numbering.order());
        let nodes = |cell| numbering.cell(cell).iter().copied().zip(fine.cell_coordinates(cell).chunks_exact(D));
        let place = |(node, x): (usize, &[f64])| (node, from_fn(|i| x[i]));
        (0..mesh.n_cells()).flat_map(nodes).map(place).collect()
    }

    fn annulus() -> Mesh<2> {
        AnnulusMesh { inner_radius: 1.0, outer_radius: 3.0, first_cell: 0.5, cells: [12, 2], order: 8 }.build().unwrap()
    }

    #[test]
    fn normals_of_a_circle_point_to_its_centre_and_its_arcs_are_its_angles() {
        let mesh = annulus().scrambled(3);
        let numbering = NodeNumbering::new(&mesh, 6);
        let (places, wall) = (places(&mesh, &numbering), named(&mesh, "wall"));
        let normals = mesh.boundary_normals(&numbering, wall).unwrap();
        assert_eq!(normals.keys().copied().collect::<Vec<_>>(), numbering.on_boundary(&mesh, wall));
        for (node, normal) in &normals {
            // The direction out of the domain points into the body.
            assert!((0..2).all(|i| (normal[i] + places[node][i]).abs() < 1e-7), "{normal:?} at {:?}", places[node]);
        }
        let fractions = mesh.arc_fractions(&numbering, wall).unwrap();
        assert_eq!(fractions.len(), normals.len());
        // For the far field the domain is inside, so the curve runs clockwise.
        let far = mesh.arc_fractions(&numbering, named(&mesh, "far")).unwrap();
        for (fractions, sense) in [(fractions, 1.0), (far, -1.0)] {
            for (node, s) in fractions {
                let [x, y] = places[&node];
                let apart = s - sense * y.atan2(x) / TAU;
                assert!((apart - apart.round()).abs() < 1e-9 && (0.0..1.0).contains(&s), "{s} at {x} {y}");
            }
        }
    }

    #[test]
    fn a_plane_boundary_is_normal_to_an_axis_and_its_corners_to_two() {
        let mesh = RotatingBoxMesh::unit(5, 3).build().unwrap().scrambled(2);
        let numbering = NodeNumbering::new(&mesh, 3);
        let (places, inner) = (places(&mesh, &numbering), named(&mesh, "inner"));
        let axes = mesh.normal_axes(&numbering, inner).unwrap();
        assert_eq!(axes.keys().copied().collect::<Vec<_>>(), numbering.on_boundary(&mesh, inner));
        for (node, axes) in axes {
            let on_side = places[&node].map(|x| (x.abs() - 0.1).abs() < 1e-12);
            assert_eq!(axes, on_side, "{:?}", places[&node]);
        }
        let (round, numbering) = (annulus(), NodeNumbering::new(&annulus(), 3));
        let error = round.normal_axes(&numbering, named(&round, "wall")).unwrap_err();
        assert!(matches!(error, MeshError::NoAxis { name, .. } if name == "wall"));
    }

    #[test]
    fn a_corner_has_the_normal_between_its_sides() {
        let mesh = RotatingBoxMesh::unit(5, 3).build().unwrap();
        let numbering = NodeNumbering::new(&mesh, 3);
        let places = places(&mesh, &numbering);
        for (node, normal) in mesh.boundary_normals(&numbering, named(&mesh, "inner")).unwrap() {
            let x = places[&node];
            let corner = x[0].abs() == x[1].abs();
            let expected = if corner { FRAC_1_SQRT_2 } else { 1.0 };
            assert!((normal[0].abs().max(normal[1].abs()) - expected).abs() < 1e-14, "{normal:?} at {x:?}");
            assert!(normal[0] * x[0] + normal[1] * x[1] < 0.0);
        }
        // From the lower right corner upwards.
        let fractions = mesh.arc_fractions(&numbering, named(&mesh, "inner")).unwrap();
        let at = |x: f64, y: f64| {
            let node = places.iter().find(|(_, p)| (p[0] - x).abs() < 1e-12 && (p[1] - y).abs() < 1e-12).unwrap().0;
            fractions[node]
        };
        let found = [at(0.1, -0.1), at(0.1, 0.0), at(0.1, 0.1), at(-0.1, 0.1), at(-0.1, -0.1)];
        assert!(found.iter().zip([0.0, 0.125, 0.25, 0.5, 0.75]).all(|(s, t)| (s - t).abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn normals_of_an_extruded_mesh_are_those_of_its_cross_section() {
        let extrusion = Extrusion { lower: 0.0, depth: 1.0, layers: 2, periodic: true };
        let mesh = annulus().extruded(&extrusion).unwrap().scrambled(1);
        let numbering = NodeNumbering::new(&mesh, 4);
        let (places, wall) = (places(&mesh, &numbering), named(&mesh, "wall"));
        for (node, normal) in mesh.boundary_normals(&numbering, wall).unwrap() {
            let x = places[&node];
            assert!((0..2).all(|i| (normal[i] + x[i]).abs() < 1e-7) && normal[2].abs() < 1e-14);
        }
        // The wall begins at its largest x and runs counter-clockwise, at every height.
        let fractions = mesh.arc_fractions(&numbering, wall).unwrap();
        assert_eq!(fractions.keys().copied().collect::<Vec<_>>(), numbering.on_boundary(&mesh, wall));
        for (node, fraction) in fractions {
            let [x, y, _] = places[&node];
            let angle = y.atan2(x).rem_euclid(TAU) / TAU;
            assert!((angle - fraction).abs() < 1e-7 || (angle - fraction).abs() > 1.0 - 1e-7, "{angle}, {fraction}");
        }
    }

    #[test]
    fn an_airfoil_begins_at_its_trailing_edge_and_a_far_field_of_two_pieces_is_one_curve() {
        let mesh = AirfoilMesh::naca0012(4).build().unwrap();
        let numbering = NodeNumbering::new(&mesh, 4);
        let (places, airfoil) = (places(&mesh, &numbering), named(&mesh, "airfoil"));
        let fractions = mesh.arc_fractions(&numbering, airfoil).unwrap();
        let (first, _) = fractions.iter().find(|(_, s)| **s == 0.0).unwrap();
        assert!((places[first][0] - 1.0).abs() < 1e-12);
        // By symmetry the nose is half-way; the upper side comes first.
        for (node, s) in &fractions {
            assert!((places[node][1] >= -1e-12) == (*s <= 0.5 + 1e-12), "{s} at {:?}", places[node]);
        }
        let normal = mesh.boundary_normals(&numbering, airfoil).unwrap()[first];
        assert!((normal[0] + 1.0).abs() < 1e-9, "{normal:?} at the trailing edge");
        assert!(mesh.arc_fractions(&numbering, named(&mesh, "far")).is_some());
    }

    fn channel(cells: usize, is_periodic: bool) -> Mesh<2> {
        crate::BoxMesh {
            lower: [0.0; 2],
            upper: [1.0; 2],
            cells: [cells, 2],
            order: 2,
            curving: crate::Curving::None,
            periodic: [is_periodic, false],
        }
        .build()
        .unwrap()
    }

    /// A facet may span the whole curve: it begins at 0 and ends at 1, in one node.
    #[test]
    fn a_single_facet_has_its_fractions() {
        let mesh = channel(1, true);
        let numbering = NodeNumbering::new(&mesh, 3);
        for (name, expected) in [("top", [0.0, 0.5, 1.0]), ("bottom", [1.0, 0.5, 0.0])] {
            let [of_face] = &mesh.arc_fractions_of_faces(&numbering, named(&mesh, name)).unwrap()[..] else { panic!() };
            assert!(of_face.iter().zip(expected).all(|(s, t)| (s - t).abs() < 1e-14), "{name}: {of_face:?}");
        }
    }

    /// The wall at the top began a cell after the largest x: its arcs run along x, so that none of them starts there.
    #[test]
    fn periodic_walls_begin_at_their_largest_x() {
        for cells in [2, 5] {
            let mesh = channel(cells, true);
            let numbering = NodeNumbering::new(&mesh, 3);
            let places = places(&mesh, &numbering);
            for (name, sense) in [("top", 1.0), ("bottom", -1.0)] {
                for (node, s) in mesh.arc_fractions(&numbering, named(&mesh, name)).unwrap() {
                    let apart = s - sense * places[&node][0];
                    assert!((apart - apart.round()).abs() < 1e-14, "{name}: {s} at {:?}", places[&node]);
                }
            }
        }
    }

    #[test]
    fn walls_of_a_channel_are_not_closed() {
        let mesh = channel(2, false);
        assert_eq!(mesh.arc_fractions(&NodeNumbering::new(&mesh, 2), 0), None);
    }
}
