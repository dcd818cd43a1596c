//! Arc length along a closed curve, and along a wall whose cross-section is a closed curve.

use crate::facet::tangent_sign;
use crate::{CellMap, Mesh, NodeNumbering, Side, outward_area};
use basis::{Lagrange, gauss, gauss_lobatto};
use std::array::from_fn;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use tensor::norm;

/// A face that is a strip of straight lines along z, along an arc in the plane x, y with the domain on its right.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Where the arc begins and ends.
    pub ends: [[f64; 2]; 2],
    /// The C0 nodes of the lines there.
    pub end_nodes: [Vec<usize>; 2],
    /// The speeds |dx/dxi| at points of the arc.
    pub speeds: Vec<f64>,
    /// The points of the face on the line through each of them, axis 0 of the face fastest.
    pub lines: Vec<Vec<usize>>,
}

/// A face along a curve in the plane x, y. In space it is a strip of straight lines along z.
struct Arc {
    /// The axis of the lattice of the face that is along z; in the plane 1.
    across: usize,
    /// The curve through the nodes of the mesh, from the start on.
    curve: Vec<[f64; 2]>,
    /// Whether it passes the nodes of the face in decreasing order.
    is_reversed: bool,
    /// Its C0 nodes, in the order of the lattice of the face.
    nodes: Vec<usize>,
    /// Rows along the curve, by the lattice: one in the plane, in space one for each height, the lowest first.
    rows: Vec<Vec<usize>>,
    /// The length of the curve up to the nodes of a row.
    lengths: Vec<f64>,
    /// z of the lowest row.
    height: f64,
}

impl Arc {
    fn start(&self) -> [f64; 2] {
        self.curve[0]
    }

    fn end(&self) -> [f64; 2] {
        self.curve[self.curve.len() - 1]
    }

    /// The nodes at which its lowest row begins and ends.
    fn end_nodes(&self) -> [usize; 2] {
        let row = &self.rows[0];
        [row[0], row[row.len() - 1]].map(|index| self.nodes[index])
    }

    /// The same with their positions.
    fn ends(&self) -> [([f64; 2], usize); 2] {
        let [first, last] = self.end_nodes();
        [(self.start(), first), (self.end(), last)]
    }

    /// The same, with `points` along the curve and along z.
    fn strip(self, points: &[f64]) -> Strip {
        let n = points.len();
        let lines = (0..n).map(|k| (0..n).map(|row| index(self.across, n, k, row)).collect());
        let speeds = speeds(&self.curve, points);
        let mut lines: Vec<Vec<usize>> = lines.collect();
        if self.is_reversed {
            // The points lie symmetrically, so that only those of the face turn round.
            lines.reverse();
        }
        let column = |k: usize| self.rows.iter().map(|row| self.nodes[row[k]]).collect();
        let end_nodes = [column(0), column(self.rows[0].len() - 1)];
        Strip { ends: [self.start(), self.end()], end_nodes, speeds, lines }
    }
}

impl<const D: usize> Mesh<D> {
    /// For every C0 node of a `boundary` that is one closed curve, the length of the curve up to the node over its whole length, in [0, 1).
    /// The curve begins at the end of a facet with the largest x; among several, at the one with the smallest y. A node of a periodic wall
    /// has two positions, and the larger x decides. The domain lies on the right of the curve, so it runs counter-clockwise around a body.
    /// In three dimensions the same for a wall that is such a curve extruded along z, up to the round-off of a file.
    /// `None` for other boundaries.
    pub fn arc_fractions(&self, numbering: &NodeNumbering, boundary: usize) -> Option<BTreeMap<usize, f64>> {
        let of_faces = self.arc_fractions_of_faces(numbering, boundary)?;
        let nodes = self.sides_of(boundary).flat_map(|side| numbering.face::<D>(side));
        // The end of the last arc is the start of the first.
        let wrapped = |fraction: f64| if fraction >= 1.0 { 0.0 } else { fraction };
        Some(nodes.zip(of_faces.concat().into_iter().map(wrapped)).collect())
    }

    /// The same for every facet of the `boundary`, in the order of the lattice of its face. At the end of the curve it is 1.
    pub fn arc_fractions_of_faces(&self, numbering: &NodeNumbering, boundary: usize) -> Option<Vec<Vec<f64>>> {
        let tolerance = self.same_place();
        let arcs: Vec<Arc> =
            self.sides_of(boundary).map(|side| self.arc(numbering, side, tolerance)).collect::<Option<_>>()?;
        let lowest = arcs.iter().map(|arc| arc.height).fold(f64::INFINITY, f64::min);
        let of_curve = follow(arcs.iter().filter(|arc| arc.height <= lowest + tolerance).collect())?;
        let places = Places::new(of_curve, tolerance);
        let of_face = |arc: &Arc| {
            let (of_row, mut fractions) = (places.at(arc.start())?, vec![0.0; arc.nodes.len()]);
            for (index, fraction) in arc.rows.iter().flat_map(|row| row.iter().zip(of_row)) {
                fractions[*index] = *fraction;
            }
            Some(fractions)
        };
        arcs.iter().map(of_face).collect()
    }

    /// The face `side` of a mesh in three dimensions as a strip with the Gauss `points` along its arc. x and y on its lines along z differ by
    /// `tolerance` at most. `None` if it is not such a strip.
    pub fn strip(&self, numbering: &NodeNumbering, side: Side, points: &[f64], tolerance: f64) -> Option<Strip> {
        (D == 3).then(|| self.arc(numbering, side, tolerance))?.map(|arc| arc.strip(points))
    }

    /// The face `side` with the domain on its right; None if it is not a strip along z.
    fn arc(&self, numbering: &NodeNumbering, side: Side, tolerance: f64) -> Option<Arc> {
        let (n, m) = (self.order, numbering.order());
        let positions = self.face_positions(side);
        // The axis of the lattice of the face that is along z: one of two.
        let across = if D == 2 { 1 } else { (0..2).find(|&axis| is_along_z(&positions, n, axis, tolerance))? };
        let mut curve: Vec<[f64; 2]> = (0..n).map(|k| from_fn(|i| positions[index(across, n, k, 0)][i])).collect();
        let nodes = numbering.face::<D>(side);
        let count = if D == 2 { 1 } else { m };
        let mut rows: Vec<Vec<usize>> =
            (0..count).map(|row| (0..m).map(|k| index(across, m, k, row)).collect()).collect();
        let is_reversed = self.is_domain_left(side, [curve[0], curve[n - 1]]);
        if is_reversed {
            curve.reverse();
            rows.iter_mut().for_each(|row| row.reverse());
        }
        let height = |row: usize| positions[index(across, n, 0, row)][D - 1];
        if D == 3 && height(n - 1) < height(0) {
            rows.reverse();
        }
        let height = if D == 2 { 0.0 } else { height(0).min(height(n - 1)) };
        let lengths = lengths(&curve, m);
        Some(Arc { across, curve, is_reversed, nodes, rows, lengths, height })
    }

    /// Whether the domain is on the left of a face that runs between `ends` in the plane. The right of (t_x, t_y) is (t_y, -t_x).
    fn is_domain_left(&self, side: Side, ends: [[f64; 2]; 2]) -> bool {
        if D == 2 {
            return tangent_sign(side.face) > 0.0;
        }
        let middle = CellMap::on_grid(self.order, &[0.0]);
        let outward: [f64; D] = outward_area(&middle.jacobians(self.cell_coordinates(side.cell))[0], side.face);
        let tangent: [f64; 2] = from_fn(|i| ends[1][i] - ends[0][i]);
        tangent[1] * outward[0] - tangent[0] * outward[1] > 0.0
    }
}

/// The number of a point in a lattice of `n` x `n` points of a face whose axis `across` counts the rows.
fn index(across: usize, n: usize, along: usize, row: usize) -> usize {
    if across == 0 { row + n * along } else { along + n * row }
}

/// Whether x and y of a lattice of `n` x `n` positions change along `axis` by `tolerance` at most.
fn is_along_z<const D: usize>(positions: &[[f64; D]], n: usize, axis: usize, tolerance: f64) -> bool {
    let first = |k: usize| if axis == 0 { k / n * n } else { k % n };
    (0..positions.len()).all(|k| (0..2).all(|i| (positions[k][i] - positions[first(k)][i]).abs() <= tolerance))
}

/// Values at positions in the plane. They are found at positions that differ by a tolerance.
struct Places<T> {
    tolerance: f64,
    /// By the squares of a lattice with twice the tolerance as its width.
    values: BTreeMap<[i64; 2], T>,
}

impl<T> Places<T> {
    fn new(values: impl IntoIterator<Item = ([f64; 2], T)>, tolerance: f64) -> Self {
        let values = values.into_iter().map(|(x, value)| (Self::square(x, tolerance), value)).collect();
        Places { tolerance, values }
    }

    fn square(x: [f64; 2], tolerance: f64) -> [i64; 2] {
        x.map(|x| (x / (2.0 * tolerance)).floor() as i64)
    }

    /// The value of a position near x, which lies in the square of a corner of the box around x.
    fn at(&self, x: [f64; 2]) -> Option<&T> {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        corners.iter().find_map(|corner| {
            let near = from_fn(|i| x[i] + self.tolerance * corner[i]);
            self.values.get(&Self::square(near, self.tolerance))
        })
    }
}

/// The fractions along the nodes of arcs that form one closed curve, with the positions where the arcs begin.
fn follow(arcs: Vec<&Arc>) -> Option<Vec<([f64; 2], Vec<f64>)>> {
    let first = first_node(arcs.iter().flat_map(|arc| arc.ends()))?;
    let mut by_node: BTreeMap<usize, &Arc> = BTreeMap::new();
    for arc in arcs {
        // Two facets that begin in one node do not form a curve.
        if by_node.insert(arc.end_nodes()[0], arc).is_some() {
            return None;
        }
    }
    let (mut fractions, mut length, mut node) = (Vec::new(), 0.0, first);
    loop {
        let arc = by_node.remove(&node)?;
        let row: Vec<f64> = arc.lengths.iter().map(|along| length + along).collect();
        (length, node) = (row[row.len() - 1], arc.end_nodes()[1]);
        fractions.push((arc.start(), row));
        if node == first {
            break;
        }
    }
    fractions.iter_mut().flat_map(|(_, row)| row).for_each(|fraction| *fraction /= length);
    by_node.is_empty().then_some(fractions)
}

/// The node at which a closed curve in the plane begins: the first by [`curve_order`] among the `ends` of its arcs, positions with their nodes. A
/// node of a periodic wall has two positions.
pub fn first_node(ends: impl Iterator<Item = ([f64; 2], usize)>) -> Option<usize> {
    ends.min_by(|(a, _), (b, _)| curve_order(a, b)).map(|(_, node)| node)
}

/// The order of positions in which curves begin: the largest x first, then the smallest y.
pub fn curve_order(a: &[f64; 2], b: &[f64; 2]) -> Ordering {
    (-a[0], a[1]).partial_cmp(&(-b[0], b[1])).unwrap_or(Ordering::Equal)
}

/// int_{-1}^{xi_k} |dx/dxi| dxi at the Gauss-Lobatto nodes xi_k of order `n`, for the curve through the nodes `positions`.
fn lengths(positions: &[[f64; 2]], n: usize) -> Vec<f64> {
    let rule = gauss(2 * positions.len());
    let up_to = |xi: f64| {
        let half = 0.5 * (xi + 1.0);
        let points: Vec<f64> = rule.points.iter().map(|point| half * (point + 1.0) - 1.0).collect();
        speeds(positions, &points).iter().zip(&rule.weights).map(|(speed, weight)| half * weight * speed).sum()
    };
    gauss_lobatto(n).points.iter().map(|&xi| up_to(xi)).collect()
}

/// |dx/dxi| at `points` of the curve through the nodes `positions`.
fn speeds(positions: &[[f64; 2]], points: &[f64]) -> Vec<f64> {
    let derivatives = Lagrange::gauss_lobatto(positions.len()).derivative_matrix(points);
    let speed = |q: usize| {
        norm(&from_fn::<f64, 2, _>(|i| derivatives.row(q).iter().zip(positions).map(|(l, x)| l * x[i]).sum()))
    };
    (0..points.len()).map(speed).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::generate::AirfoilMesh;

    /// Near the trailing edge facets of the upper side had the fractions of the lower one.
    #[test]
    fn short_facets_of_a_large_mesh_have_fractions_of_their_own() {
        let airfoil = AirfoilMesh::naca0012(2);
        let fine = AirfoilMesh { surface_cells: 24, trailing_edge_cell: 0.0012, ..airfoil };
        let airfoil = AirfoilMesh { far_field: 1e5, wake_cells: 30, normal_cells: 20, ..fine };
        let mesh = airfoil.build().unwrap();
        let numbering = NodeNumbering::new(&mesh, 2);
        let wall = mesh.boundary_names().iter().position(|name| name == "airfoil").unwrap();
        let of_faces = mesh.arc_fractions_of_faces(&numbering, wall).unwrap();
        let ends = |fractions: &Vec<f64>| {
            fractions.iter().fold([1.0_f64, 0.0_f64], |[low, high], x| [low.min(*x), high.max(*x)])
        };
        let covered: f64 = of_faces.iter().map(ends).map(|[low, high]| high - low).sum();
        let mut starts: Vec<f64> = of_faces.iter().map(ends).map(|[low, _]| low).collect();
        starts.sort_by(f64::total_cmp);
        starts.dedup();
        assert!(
            starts.len() == of_faces.len() && (covered - 1.0).abs() < 1e-12,
            "{} of {}",
            starts.len(),
            of_faces.len()
        );
    }

    /// Positions of an extruded wall from a file agree up to the digits of the file: none of them was found.
    #[test]
    fn places_are_found_up_to_the_tolerance() {
        let places = Places::new([([0.3, -1.0], 'a'), ([0.3, 2e-9], 'b')], 1e-9);
        for (dx, dy) in [(0.0, 0.0), (9e-10, -9e-10), (-9e-10, 9e-10)] {
            assert_eq!(places.at([0.3 + dx, -1.0 + dy]), Some(&'a'));
            assert_eq!(places.at([0.3 + dx, 2e-9 + dy]), Some(&'b'));
        }
        assert_eq!(places.at([0.3, -1.0 + 1e-8]), None);
    }
}
