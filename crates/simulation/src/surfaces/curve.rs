//! The facets of a wall in the plane as curves: one after the other, with the domain on their right.

use basis::{Lagrange, Rule, gauss};
use mesh::{BoundaryFacet, Mesh, NodeNumbering, tangent_sign};

/// A facet, as a part of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc {
    /// Its first and its last node.
    ends: [usize; 2],
    /// The position of the first.
    start: [f64; 2],
    /// Its number in the list of facets.
    facet: usize,
}

/// Whether the curve passes the points of a face in decreasing order.
pub fn is_reversed(face: usize) -> bool {
    tangent_sign(face) > 0.0
}

/// The `facets` of a wall in the order of its curves, by their numbers in the list. A curve begins at its end or, if it is closed, at the
/// facet with the largest x and then the smallest y; so do several curves among each other. Not in the plane: in the order of the list.
pub fn in_order<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering, facets: &[BoundaryFacet]) -> Vec<usize> {
    if D != 2 {
        return (0..facets.len()).collect();
    }
    let arc = |(number, facet): (usize, &BoundaryFacet)| {
        let nodes = numbering.face::<D>(facet.side);
        let mut ends = [nodes[0], nodes[nodes.len() - 1]];
        if is_reversed(facet.side.face) {
            ends.reverse();
        }
        let of_cell = numbering.cell(facet.side.cell);
        let place = of_cell.iter().position(|node| *node == ends[0]).unwrap_or_default();
        let position = &mesh.cell_coordinates(facet.side.cell)[place * D..];
        Arc { ends, start: [position[0], position[1]], facet: number }
    };
    chained(facets.iter().enumerate().map(arc).collect())
}

/// The numbers of `arcs`, so that an arc follows the one at whose end it begins.
fn chained(mut arcs: Vec<Arc>) -> Vec<usize> {
    // From now on the order does not depend on that of the mesh.
    arcs.sort_by(|a, b| {
        (-a.start[0], a.start[1]).partial_cmp(&(-b.start[0], b.start[1])).unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut order = Vec::new();
    while !arcs.is_empty() {
        let is_open = |arc: &Arc| arcs.iter().all(|other| other.ends[1] != arc.ends[0]);
        let mut next = arcs.iter().position(is_open).or(Some(0));
        while let Some(position) = next {
            let arc = arcs.remove(position);
            order.push(arc.facet);
            next = arcs.iter().position(|other| other.ends[0] == arc.ends[1]);
        }
    }
    order
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

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(facet: usize, ends: [usize; 2], start: [f64; 2]) -> Arc {
        Arc { ends, start, facet }
    }

    #[test]
    fn open_curves_begin_at_their_ends_and_closed_ones_at_the_right() {
        let open = [arc(0, [2, 3], [0.0, 0.0]), arc(1, [1, 2], [0.5, 0.0]), arc(2, [3, 4], [9.0, 0.0])];
        assert_eq!(chained(open.to_vec()), [1, 0, 2]);
        let closed = [arc(0, [1, 2], [0.0, 0.0]), arc(1, [3, 1], [0.5, 1.0]), arc(2, [2, 3], [1.0, 0.0])];
        assert_eq!(chained(closed.to_vec()), [2, 1, 0]);
        let two = [arc(0, [1, 1], [0.0, 0.0]), arc(1, [2, 2], [1.0, 0.0])];
        assert_eq!(chained(two.to_vec()), [1, 0]);
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
