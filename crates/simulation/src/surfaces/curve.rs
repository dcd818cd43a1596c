//! The facets of a wall in the plane as curves: one after the other, with the domain on their right.

use crate::nodal::dot_of;
use basis::{Lagrange, Rule, gauss};
use mesh::{BoundaryFacet, Mesh, NodeNumbering, curve_order, first_node, tangent_sign};

/// A facet, as a part of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Its first and its last node.
    pub ends: [usize; 2],
    /// Their positions.
    pub positions: [[f64; 2]; 2],
    /// Its number in the list of facets.
    pub facet: usize,
}

/// A curve of a wall: facets that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The facets, by their numbers in a list.
    pub facets: Vec<usize>,
    /// The position of each facet's start, from the end of the facet before: zero, but across a periodic boundary.
    pub jumps: Vec<[f64; 2]>,
    /// Whether the first facet follows the last one.
    pub is_closed: bool,
}

impl Curve {
    fn new(arcs: &[Arc]) -> Self {
        let (first, last) = (&arcs[0], &arcs[arcs.len() - 1]);
        let is_closed = last.ends[1] == first.ends[0];
        let begin = if is_closed { last.positions[1] } else { first.positions[0] };
        let before = std::iter::once(begin).chain(arcs.iter().map(|arc| arc.positions[1]));
        let jump = |(arc, end): (&Arc, [f64; 2])| [0, 1].map(|i| arc.positions[0][i] - end[i]);
        Curve {
            facets: arcs.iter().map(|arc| arc.facet).collect(),
            jumps: arcs.iter().zip(before).map(jump).collect(),
            is_closed,
        }
    }
}

/// Whether the curve passes the points of a face in decreasing order.
pub fn is_reversed(face: usize) -> bool {
    tangent_sign(face) > 0.0
}

/// The facets of the `boundary`.
pub fn facets_of<const D: usize>(mesh: &Mesh<D>, boundary: usize) -> Vec<BoundaryFacet> {
    mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary).copied().collect()
}

/// The `facets` of a wall in the order of its curves, by their numbers in the list. Not in the plane: in the order of the list.
pub fn in_order<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering, facets: &[BoundaryFacet]) -> Vec<usize> {
    if D != 2 {
        return (0..facets.len()).collect();
    }
    curves(mesh, numbering, facets).into_iter().flat_map(|curve| curve.facets).collect()
}

/// The curves of a wall in the plane with these `facets`. A curve begins at its end or, if it is closed, at the node with the largest x and
/// then the smallest y, at which the fraction s of formulas begins, too. So do several curves among each other.
pub(super) fn curves<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    facets: &[BoundaryFacet],
) -> Vec<Curve> {
    let arc = |(number, facet): (usize, &BoundaryFacet)| {
        let (nodes, places) = (numbering.face::<D>(facet.side), mesh.face_positions(facet.side));
        let mut ends = [nodes[0], nodes[nodes.len() - 1]];
        let mut positions = [places[0], places[places.len() - 1]].map(|x| [x[0], x[1]]);
        if is_reversed(facet.side.face) {
            ends.reverse();
            positions.reverse();
        }
        Arc { ends, positions, facet: number }
    };
    chained(facets.iter().enumerate().map(arc).collect())
}

/// The curves of `arcs`, in which an arc follows the one at whose end it begins.
pub(super) fn chained(mut arcs: Vec<Arc>) -> Vec<Curve> {
    // From now on the order does not depend on that of the mesh.
    arcs.sort_by(|a, b| curve_order(&a.positions[0], &b.positions[0]));
    let mut curves = Vec::new();
    while !arcs.is_empty() {
        let is_open = |arc: &Arc| arcs.iter().all(|other| other.ends[1] != arc.ends[0]);
        let (mut next, mut curve) = (arcs.iter().position(is_open).or_else(|| first_of_closed(&arcs)), Vec::new());
        while let Some(position) = next {
            let arc = arcs.remove(position);
            next = arcs.iter().position(|other| other.ends[0] == arc.ends[1]);
            curve.push(arc);
        }
        curves.push(Curve::new(&curve));
    }
    curves
}

/// The arc at which a closed curve begins.
fn first_of_closed(arcs: &[Arc]) -> Option<usize> {
    let first = first_node(arcs.iter().flat_map(|arc| arc.positions.into_iter().zip(arc.ends)))?;
    arcs.iter().position(|arc| arc.ends[0] == first).or(Some(0))
}

/// The integrals of the polynomials of the points of `rule` from -1 to each of them, `[point][polynomial]`: they turn the speed along a
/// facet into lengths up to its points.
pub fn integrals(rule: &Rule) -> Vec<Vec<f64>> {
    let polynomials = Lagrange::new(rule.points.clone());
    let up_to = |end: &f64| {
        let inner = gauss(rule.points.len()).on(-1.0, *end);
        let mut sums = vec![0.0; rule.points.len()];
        for (x, weight) in inner.points.iter().zip(&inner.weights) {
            sums.iter_mut().zip(polynomials.values(*x)).for_each(|(sum, value)| *sum += weight * value);
        }
        sums
    };
    rule.points.iter().map(up_to).collect()
}

/// The lengths up to the points of a facet that begins at `start`, from the speeds at them and the [`integrals`].
pub fn lengths_up_to(speeds: &[f64], integrals: &[Vec<f64>], start: f64) -> Vec<f64> {
    integrals.iter().map(|integrals| start + dot_of(speeds, integrals)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(facet: usize, ends: [usize; 2], start: [f64; 2]) -> Arc {
        Arc { ends, positions: [start, start], facet }
    }

    fn order(arcs: &[Arc]) -> Vec<usize> {
        chained(arcs.to_vec()).into_iter().flat_map(|curve| curve.facets).collect()
    }

    #[test]
    fn open_curves_begin_at_their_ends_and_closed_ones_at_the_right() {
        let open = [arc(0, [2, 3], [0.0, 0.0]), arc(1, [1, 2], [0.5, 0.0]), arc(2, [3, 4], [9.0, 0.0])];
        assert_eq!(order(&open), [1, 0, 2]);
        let closed = [arc(0, [1, 2], [0.0, 0.0]), arc(1, [3, 1], [0.5, 1.0]), arc(2, [2, 3], [1.0, 0.0])];
        assert_eq!(order(&closed), [2, 1, 0]);
        let two = [arc(0, [1, 1], [0.0, 0.0]), arc(1, [2, 2], [1.0, 0.0])];
        assert_eq!(order(&two), [1, 0]);
    }

    /// Two walls of a channel were one curve, and a zero of the friction lay between them.
    #[test]
    fn curves_of_a_wall_end_where_no_facet_follows() {
        let all = [arc(0, [1, 2], [1.0, 0.0]), arc(1, [5, 5], [9.0, 0.0]), arc(2, [2, 3], [0.5, 0.0])];
        let curves = chained(all.to_vec());
        assert_eq!(curves.iter().map(|curve| &curve.facets[..]).collect::<Vec<_>>(), [&[0, 2][..], &[1]]);
        assert_eq!(curves.iter().map(|curve| curve.is_closed).collect::<Vec<_>>(), [false, true]);
    }

    /// The curve began one facet after the periodic boundary where its arcs run along x.
    #[test]
    fn curves_jump_across_periodic_boundaries_where_they_begin() {
        let along = |facet, ends, x: f64| Arc { ends, positions: [[x, 0.0], [x + 1.0, 0.0]], facet };
        let [curve] = &chained(vec![along(0, [1, 2], 0.0), along(1, [2, 1], 1.0)])[..] else { panic!("one curve") };
        assert_eq!((&curve.facets[..], curve.is_closed), (&[0, 1][..], true));
        assert_eq!(curve.jumps, [[-2.0, 0.0], [0.0, 0.0]]);
    }

    #[test]
    fn lengths_up_to_points_are_exact_for_polynomials() {
        let rule = gauss(4);
        for (row, end) in integrals(&rule).iter().zip(&rule.points) {
            let found: f64 = row.iter().zip(&rule.points).map(|(integral, x)| integral * x * x).sum();
            assert!((found - (end.powi(3) + 1.0) / 3.0).abs() < 1e-15);
        }
    }
}
