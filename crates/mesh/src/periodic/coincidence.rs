//! Points that coincide, and how close points must be for that.

use crate::Mesh;
use crate::geometry::bounding_box;
use crate::numbering::Classes;
use tensor::{dot, norm};

/// Two nodes coincide if they are closer than this times the diameter of the mesh, since files have about ten digits.
pub(crate) const TOLERANCE: f64 = 1e-9;

/// Vertices of periodic boundaries must be closer than this times the shortest edge of their faces, too: where cells are thin, the diameter
/// of the mesh says nothing.
const EDGE_FRACTION: f64 = 0.25;

/// The distances of the nodes of two faces may differ by this times their shortest edge: then the faces have the same shape. The translation,
/// a median over all vertices, may be less exact than thin faces are.
const SHAPE_FRACTION: f64 = 1e-4;

/// No tolerance is below this many units in the last place of the largest coordinate.
pub(crate) const LAST_PLACES: f64 = 16.0;

/// How close the nodes of two faces must be, and how alike their distances.
#[derive(Clone, Copy)]
pub(super) struct FaceTolerance {
    pub(super) place: f64,
    pub(super) shape: f64,
}

impl FaceTolerance {
    pub(super) fn smaller(self, other: Self) -> Self {
        FaceTolerance { place: self.place.min(other.place), shape: self.shape.min(other.shape) }
    }
}

/// How close nodes of periodic boundaries must be.
pub(super) struct Tolerances {
    largest: f64,
    least: f64,
}

impl Tolerances {
    pub(super) fn new<const D: usize>(mesh: &Mesh<D>) -> Self {
        let largest = TOLERANCE * mesh.diameter();
        Tolerances { largest, least: (LAST_PLACES * last_place::<D>(&mesh.coordinates)).min(largest) }
    }

    /// For a face of a cell of order `order` with the nodes `nodes`, in the order of its lattice.
    pub(super) fn of_face<const D: usize>(&self, order: usize, nodes: &[[f64; D]]) -> FaceTolerance {
        let edge = |(first, stride)| {
            let node = |k: usize| nodes[first + k * stride];
            (1..order).map(|k| distance(&node(k - 1), &node(k))).sum::<f64>()
        };
        let edges: &[_] = match D {
            2 => &[(0, 1)],
            _ => &[(0, 1), (0, order), (order - 1, order), (order * (order - 1), 1)],
        };
        let shortest = edges.iter().map(|&start| edge(start)).fold(f64::INFINITY, f64::min);
        let part = |fraction: f64| (fraction * shortest).clamp(self.least, self.largest);
        FaceTolerance { place: part(EDGE_FRACTION), shape: part(SHAPE_FRACTION) }
    }
}

/// The unit in the last place of the largest of `coordinates`, `[point][D]`.
pub(crate) fn last_place<const D: usize>(coordinates: &[f64]) -> f64 {
    let (lower, upper) = bounding_box::<D>(coordinates);
    f64::EPSILON * lower.iter().chain(&upper).fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

/// A point, and how close another one must be to coincide with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<const D: usize> {
    pub(crate) position: [f64; D],
    pub(crate) tolerance: f64,
}

/// A number for each place: the same for those that coincide, by the smaller tolerance of two, or that a chain of such places connects.
///
/// Several points of one boundary may coincide: both sides of a thin plate, or of the seam of a closed pipe.
pub(crate) fn coincident<const D: usize>(places: &[Place<D>]) -> Vec<usize> {
    // Meshes follow the axes. Along an oblique direction few places have the same height.
    let direction = std::array::from_fn(|i| [0.6321, 0.5403, 0.4487][i]);
    let along = |k: usize| dot(&direction, &places[k].position);
    let mut sorted: Vec<(f64, usize)> = (0..places.len()).map(|k| (along(k), k)).collect();
    sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut classes = Classes::new(places.len());
    for (rank, &(height, k)) in sorted.iter().enumerate() {
        // Twice as far because heights are rounded.
        let reach = 2.0 * places[k].tolerance;
        let near = sorted[rank + 1..].iter().take_while(|(other, _)| other - height <= reach);
        near.filter(|(_, other)| coincide(&places[k], &places[*other])).for_each(|(_, other)| classes.join(k, *other));
    }
    classes.numbers().1
}

fn coincide<const D: usize>(a: &Place<D>, b: &Place<D>) -> bool {
    distance(&a.position, &b.position) <= a.tolerance.min(b.tolerance)
}

pub(super) fn distance<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    norm(&std::array::from_fn::<f64, D, _>(|i| x[i] - y[i]))
}
