//! The same mesh with turned reference cells, so that facets meet in every orientation.

use crate::facet::{axis_and_side, face_nodes};
use crate::mesh::point;
use crate::random::SplitMix64;
use crate::{InteriorFacet, Mesh, Orientation, Side};

/// A rotation or reflection of the reference cell: new axis a runs along old axis `axes[a]`, backwards if `reversed[a]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn<const D: usize> {
    axes: [usize; D],
    reversed: [bool; D],
}

impl<const D: usize> Turn<D> {
    /// All D! 2^D signed permutations of the axes.
    pub(crate) fn all() -> Vec<Self> {
        let digits = |code: usize| std::array::from_fn(|a| code / D.pow(a as u32) % D);
        let permutations = (0..D.pow(D as u32)).map(digits).filter(|axes: &[usize; D]| (0..D).all(|a| axes.contains(&a)));
        let signs = |axes| (0..1 << D).map(move |code| Turn { axes, reversed: std::array::from_fn(|a| code >> a & 1 == 1) });
        permutations.flat_map(signs).collect()
    }

    /// Whether a right-handed cell stays right-handed: an even number of exchanges and reversals.
    pub(crate) fn is_rotation(&self) -> bool {
        let exchanges = (0..D).flat_map(|a| (0..a).map(move |b| (a, b))).filter(|&(a, b)| self.axes[b] > self.axes[a]).count();
        (exchanges + self.reversed.iter().filter(|&&reversed| reversed).count()).is_multiple_of(2)
    }

    /// The old index of the node with new index `index`, in a lattice with `n` nodes per direction.
    pub(crate) fn old_index(&self, n: usize, index: usize) -> usize {
        let new_digit = |a: usize| index / n.pow(a as u32) % n;
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
    /// The same mesh with the axes of every reference cell turned by a random rotation. A tool of tests: whatever is computed on
    /// it must be as on the original, up to round-off.
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
