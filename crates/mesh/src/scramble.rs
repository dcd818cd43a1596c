//! The same mesh with turned reference cells, so that facets meet in every orientation.

use crate::facet::{axis_and_side, face_nodes};
use crate::lattice::digit;
use crate::mesh::point;
use crate::random::SplitMix64;
use crate::{InteriorFacet, Mesh, Orientation, Side};

/// A rotation or reflection of the reference cell: new axis a runs along old axis `axes[a]`, backwards if
/// `reversed[a]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn<const D: usize> {
    axes: [usize; D],
    reversed: [bool; D],
}

impl<const D: usize> Turn<D> {
    /// All D! 2^D signed permutations of the axes.
    pub(crate) fn all() -> Vec<Self> {
        let digits = |code: usize| std::array::from_fn(|a| digit(code, D, a));
        let permutations =
            (0..D.pow(D as u32)).map(digits).filter(|axes: &[usize; D]| (0..D).all(|a| axes.contains(&a)));
        let signs =
            |axes| (0..1 << D).map(move |code| Turn { axes, reversed: std::array::from_fn(|a| code >> a & 1 == 1) });
        permutations.flat_map(signs).collect()
    }

    /// Whether a right-handed cell stays right-handed: an even number of exchanges and reversals.
    pub(crate) fn is_rotation(&self) -> bool {
        let exchanges =
            (0..D).flat_map(|a| (0..a).map(move |b| (a, b))).filter(|&(a, b)| self.axes[b] > self.axes[a]).count();
        (exchanges + self.reversed.iter().filter(|&&reversed| reversed).count()).is_multiple_of(2)
    }

    /// The old index of the node with new index `index`, in a lattice with `n` nodes per direction.
    pub(crate) fn old_index(&self, n: usize, index: usize) -> usize {
        let new_digit = |a: usize| digit(index, n, a);
        let old_digit = |a: usize| if self.reversed[a] { n - 1 - new_digit(a) } else { new_digit(a) };
        (0..D).map(|a| old_digit(a) * n.pow(self.axes[a] as u32)).sum()
    }

    /// The new number of a face.
    fn new_face(&self, face: usize) -> usize {
        let (axis, side) = axis_and_side(face);
        let new_axis = (0..D).find(|&a| self.axes[a] == axis).expect("the axes are a permutation");
        2 * new_axis + (side ^ usize::from(self.reversed[new_axis]))
    }

    fn new_side(turns: &[Self], side: Side) -> Side {
        Side { cell: side.cell, face: turns[side.cell].new_face(side.face) }
    }

    /// For each corner of new face `new_face(face)` its index in the lattice of old face `face`.
    fn old_face_corners(&self, face: usize) -> Vec<usize> {
        let old = face_nodes(D, 2, face);
        let place = |corner: usize| old.iter().position(|&k| k == corner).expect("faces are turned into faces");
        face_nodes(D, 2, self.new_face(face)).into_iter().map(|k| place(self.old_index(2, k))).collect()
    }
}

impl<const D: usize> Mesh<D> {
    /// The same mesh with the axes of every reference cell turned by a random rotation, for tests: every result must
    /// agree with the original, up to round-off.
    pub fn scrambled(&self, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let rotations: Vec<Turn<D>> = Turn::all().into_iter().filter(Turn::is_rotation).collect();
        let turns: Vec<_> = (0..self.n_cells()).map(|_| rotations[random.below(rotations.len())]).collect();
        self.turned(&turns)
    }

    /// The same mesh with cell c turned by `turns[c]`.
    pub(crate) fn turned(&self, turns: &[Turn<D>]) -> Self {
        let mut mesh = self.clone();
        mesh.corners = (0..self.n_cells()).flat_map(|cell| self.turned_corners(cell, turns[cell])).collect();
        mesh.coordinates = (0..self.n_cells()).flat_map(|cell| self.turned_coordinates(cell, turns[cell])).collect();
        mesh.interior_facets.iter_mut().for_each(|facet| *facet = turned_facet(facet, turns));
        mesh.boundary_facets.iter_mut().for_each(|facet| facet.side = Turn::new_side(turns, facet.side));
        for side in mesh.interfaces.iter_mut().flat_map(|(_, sides)| sides) {
            *side = Turn::new_side(turns, *side);
        }
        mesh.interfaces.iter_mut().for_each(|(_, sides)| sides.sort_unstable());
        mesh.interior_facets.sort_unstable_by_key(|facet| facet.minus);
        mesh.boundary_facets.sort_unstable_by_key(|facet| (facet.boundary, facet.side));
        mesh
    }

    fn turned_corners(&self, cell: usize, turn: Turn<D>) -> impl Iterator<Item = usize> {
        (0..1 << D).map(move |k| self.corners(cell)[turn.old_index(2, k)])
    }

    fn turned_coordinates(&self, cell: usize, turn: Turn<D>) -> impl Iterator<Item = f64> {
        let old = move |k| point::<D>(self.cell_coordinates(cell), turn.old_index(self.order, k));
        (0..self.nodes_per_cell()).flat_map(old)
    }
}

/// The facet between turned cells. Its corners are recognised by their index in the old lattice of the minus face.
fn turned_facet<const D: usize>(facet: &InteriorFacet, turns: &[Turn<D>]) -> InteriorFacet {
    let minus = turns[facet.minus.cell].old_face_corners(facet.minus.face);
    let plus = turns[facet.plus.cell].old_face_corners(facet.plus.face);
    let old_minus = |plus_index| {
        let meets = |&i: &usize| facet.orientation.plus_index(D - 1, 2, i) == plus_index;
        (0..minus.len()).find(meets).expect("an orientation is a permutation")
    };
    let plus: Vec<usize> = plus.into_iter().map(old_minus).collect();
    InteriorFacet {
        minus: Turn::new_side(turns, facet.minus),
        plus: Turn::new_side(turns, facet.plus),
        orientation: Orientation::from_corners(&minus, &plus).expect("turned squares are squares"),
        periodic: facet.periodic,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{BoxMesh, Curving, MeshError, axis_and_side, outward_sign, tangent_sign};
    use tensor::cofactor;

    fn two_cells<const D: usize>() -> Mesh<D> {
        let mut cells = [1; D];
        cells[0] = 2;
        let curving = Curving::Wavy { amplitude: 0.04 };
        BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: 4, curving, periodic: [false; D] }.build().unwrap()
    }

    /// The same mesh, its facets found again from corners and names.
    fn rebuilt<const D: usize>(mesh: &Mesh<D>) -> Result<Mesh<D>, MeshError> {
        let sides = |boundary| {
            let facets = mesh.boundary_facets.iter().filter(move |facet| facet.boundary == boundary);
            facets.map(|facet| facet.side).collect()
        };
        let boundaries = mesh.boundary_names.iter().cloned().enumerate().map(|(i, name)| (name, sides(i))).collect();
        Mesh::new(mesh.order, mesh.corners.clone(), mesh.coordinates.clone(), boundaries, vec![])
    }

    /// The two sides of each facet have the same nodes and opposite normals of the same length (where not periodic).
    fn assert_sides_meet<const D: usize>(mesh: &Mesh<D>, periods: [f64; D]) {
        for facet in mesh.interior_facets() {
            let n = mesh.order();
            let (minus, plus) = (mesh.face_positions(facet.minus), mesh.face_positions(facet.plus));
            let (minus_normals, plus_normals) = (area_normals(mesh, facet.minus), area_normals(mesh, facet.plus));
            for i in 0..minus.len() {
                let j = facet.orientation.plus_index(D - 1, n, i);
                for a in 0..D {
                    let gap = (minus[i][a] - plus[j][a]).abs();
                    assert!(gap < 1e-13 || facet.periodic && (gap - periods[a]).abs() < 1e-13, "{facet:?}");
                    assert!((minus_normals[i][a] + plus_normals[j][a]).abs() < 1e-12, "{facet:?}");
                }
            }
        }
    }

    /// Outward normals times area at the nodes of a face, sign det J J^{-T} e_axis, and by tangents: they must agree.
    fn area_normals<const D: usize>(mesh: &Mesh<D>, side: Side) -> Vec<[f64; D]> {
        let nodes = basis::gauss_lobatto(mesh.order()).points;
        let jacobians = crate::CellMap::<D>::on_grid(mesh.order(), &nodes).jacobians(mesh.cell_coordinates(side.cell));
        let (axis, _) = axis_and_side(side.face);
        let normal = |k: usize| cofactor(&jacobians[k]).map(|row| outward_sign(side.face) * row[axis]);
        let by_tangents = |k: usize| tangent_normal(&jacobians[k], axis).map(|x| tangent_sign(side.face) * x);
        let face = face_nodes(D, mesh.order(), side.face);
        for &k in &face {
            assert!((0..D).all(|i| (normal(k)[i] - by_tangents(k)[i]).abs() < 1e-13));
        }
        face.into_iter().map(normal).collect()
    }

    /// t_0 x t_1 of the tangents along the axes of the face's lattice; in 2-D (t_y, -t_x).
    fn tangent_normal<const D: usize>(jacobian: &[[f64; D]; D], axis: usize) -> [f64; D] {
        let t: Vec<[f64; D]> = (0..D).filter(|&a| a != axis).map(|a| jacobian.map(|row| row[a])).collect();
        std::array::from_fn(|i| match D {
            2 => [t[0][1], -t[0][0]][i],
            _ => t[0][(i + 1) % 3] * t[1][(i + 2) % 3] - t[0][(i + 2) % 3] * t[1][(i + 1) % 3],
        })
    }

    fn every_turn<const D: usize>(rotations: usize) {
        let mesh = two_cells::<D>();
        let identity = Turn { axes: std::array::from_fn(|a| a), reversed: [false; D] };
        let mut right_handed = 0;
        for turn in Turn::<D>::all() {
            let turned = mesh.turned(&[identity, turn]);
            if turn.is_rotation() {
                right_handed += 1;
                assert_sides_meet(&turned, [0.0; D]);
                assert_eq!(rebuilt(&turned).unwrap(), turned);
            } else {
                let error = rebuilt(&turned).unwrap_err();
                assert!(matches!(error, MeshError::Inverted { cell: 1, determinant, .. } if determinant < 0.0));
            }
        }
        assert_eq!((right_handed, Turn::<D>::all().len()), (rotations, 2 * rotations));
    }

    #[test]
    fn quadrilaterals_meet_in_4_rotations() {
        every_turn::<2>(4);
    }

    #[test]
    fn hexahedra_meet_in_24_rotations() {
        every_turn::<3>(24);
    }

    #[test]
    fn scrambled_periodic_boxes_meet_in_every_orientation() {
        let curving = Curving::Random { amplitude: 0.03, seed: 4 };
        let mesh = BoxMesh {
            lower: [0.0; 3],
            upper: [1.0, 2.0, 3.0],
            cells: [3, 1, 8],
            order: 4,
            curving,
            periodic: [true; 3],
        };
        let mesh = mesh.build().unwrap().scrambled(7);
        assert_sides_meet(&mesh, [1.0, 2.0, 3.0]);
        let mut orientations: Vec<Orientation> = mesh.interior_facets().iter().map(|facet| facet.orientation).collect();
        orientations.sort_unstable();
        orientations.dedup();
        assert_eq!(orientations.len(), 8);
        assert_eq!(mesh.interior_facets().len(), 3 * mesh.n_cells());
    }

    #[test]
    fn scrambling_depends_on_the_seed_only() {
        let mesh = two_cells::<3>();
        assert_eq!(mesh.scrambled(3), mesh.scrambled(3));
        assert_ne!(mesh.scrambled(3), mesh.scrambled(4));
    }
}
