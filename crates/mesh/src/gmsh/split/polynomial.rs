//! The polynomial of an element at the nodes of a piece.

use super::pieces::Piece;
use crate::gmsh::element::Kind;
use crate::gmsh::shape::Node;
use crate::lattice::digit;
use basis::{Matrix, gauss_lobatto};

/// The positions of the Gauss-Lobatto nodes of `piece`, axis 0 fastest, from those of the nodes of an element in the
/// order of the file: `[node of the piece][node of the element]`.
///
/// The polynomial of an element is a product of polynomials of total degree p, one of each simplex. The map of a piece
/// is linear along each axis. So the polynomial has degree p along each axis of the piece: its values at the p + 1
/// nodes per axis determine it, and nothing of the shape is lost.
///
/// On a face of the element the functions of the other nodes are exactly zero. So two elements with a common face have
/// the same pieces of it.
pub(super) fn to_gauss_lobatto(kind: Kind, piece: &Piece) -> Matrix {
    let (n, dimension) = (kind.degree + 1, kind.dimension());
    let (points, nodes) = (gauss_lobatto(n).points, kind.nodes());
    let mut values = Vec::with_capacity(n.pow(dimension as u32) * nodes.len());
    for q in 0..n.pow(dimension as u32) {
        let xi: Vec<f64> = (0..dimension).map(|axis| 0.5 * (1.0 + points[digit(q, n, axis)])).collect();
        let lambda = piece.barycentric(kind.shape, &xi);
        values.extend(nodes.iter().map(|node| function(kind.degree, node, &lambda)));
    }
    Matrix::new(n.pow(dimension as u32), nodes.len(), values)
}

/// The function of the element's `node`, with barycentric coordinates alpha / p in each simplex:
///
/// ```text
/// phi = prod_simplices prod_i P_{alpha_i}(p lambda_i),     P_m(z) = prod_{k<m} (z - k) / (k + 1)      (Silvester)
/// ```
fn function(degree: usize, node: &Node, lambda: &[Vec<f64>]) -> f64 {
    let mut axis = 0;
    let of_simplex = |lambda: &Vec<f64>| {
        let others = &node[axis..axis + lambda.len() - 1];
        axis += others.len();
        let first = degree.saturating_sub(others.iter().sum());
        let alpha = std::iter::once(first).chain(others.iter().copied());
        alpha.zip(lambda).map(|(m, &lambda)| silvester(m, degree as f64 * lambda)).product::<f64>()
    };
    lambda.iter().map(of_simplex).product()
}

/// P_m(z) of (Silvester).
fn silvester(m: usize, z: f64) -> f64 {
    (0..m).map(|k| (z - k as f64) / (k + 1) as f64).product()
}
