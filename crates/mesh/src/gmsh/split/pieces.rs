//! The pieces into which an element is cut: images of a square or cube.

use crate::gmsh::shape::{Node, Shape};
use crate::lattice::digit;

/// Corners of a simplex, by number: their mean is a corner of a piece.
type Mean = Vec<usize>;

/// A piece: a product of pieces of simplices. A piece of a simplex of dimension d has 2^d corners; bit a of their
/// number is the side along axis a.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    factors: Vec<Vec<Mean>>,
}

/// The pieces of an element of `shape`. A simplex of dimension 2 or more is always cut, a line if its entry of `cuts`
/// says so: `cuts` has an entry for each simplex.
pub(super) fn pieces(shape: Shape, cuts: &[bool]) -> Vec<Piece> {
    let mut pieces = vec![Piece { factors: Vec::new() }];
    for (&dimension, &cut) in shape.factors().iter().zip(cuts) {
        let factors = pieces_of_simplex(dimension, cut);
        let extended = |piece: &Piece, factor: &Vec<Mean>| {
            let factors = piece.factors.iter().chain([factor]).cloned().collect();
            Piece { factors }
        };
        pieces = factors.iter().flat_map(|factor| pieces.iter().map(move |piece| extended(piece, factor))).collect();
    }
    pieces
}

/// One piece for each corner of a simplex: the points nearer to it, in barycentric coordinates, than to the others.
///
/// The first corner of a piece is that corner c. Corner b is the mean of c and the corners that the bits of b select
/// from the others. Their order makes all pieces right-handed.
fn pieces_of_simplex(dimension: usize, cut: bool) -> Vec<Vec<Mean>> {
    let orders: &[&[usize]] = match (dimension, cut) {
        (1, false) => return vec![vec![vec![0], vec![1]]],
        (1, true) => return vec![vec![vec![0], vec![0, 1]], vec![vec![0, 1], vec![1]]],
        (2, _) => &[&[0, 1, 2], &[1, 2, 0], &[2, 0, 1]],
        _ => &[&[0, 1, 2, 3], &[1, 0, 3, 2], &[2, 3, 0, 1], &[3, 2, 1, 0]],
    };
    let mean = |order: &[usize], bits: usize| {
        let selected = (0..dimension).filter(|a| bits >> a & 1 == 1).map(|a| order[a + 1]);
        std::iter::once(order[0]).chain(selected).collect()
    };
    orders.iter().map(|order| (0..1 << dimension).map(|bits| mean(order, bits)).collect()).collect()
}

impl Piece {
    /// Each corner of the piece, in the order of a cell's lattice, is the mean of these corners of the element.
    pub(super) fn corners(&self, shape: Shape) -> Vec<Vec<usize>> {
        (0..1 << shape.dimension()).map(|corner| self.corner(shape, corner)).collect()
    }

    fn corner(&self, shape: Shape, mut corner: usize) -> Vec<usize> {
        let (mut positions, mut axis): (Vec<Node>, usize) = (vec![[0; 3]], 0);
        for (factor, &dimension) in self.factors.iter().zip(shape.factors()) {
            let mean = &factor[corner % factor.len()];
            let moved = |position: &Node, vertex: usize| {
                let along = |a: usize| position[a] + usize::from(vertex > 0 && a == axis + vertex - 1);
                std::array::from_fn(along)
            };
            positions = mean.iter().flat_map(|&vertex| positions.iter().map(move |x| moved(x, vertex))).collect();
            (corner, axis) = (corner / factor.len(), axis + dimension);
        }
        let number = |position: &Node| shape.corners().iter().position(|corner| corner == position);
        positions.iter().filter_map(number).collect()
    }

    /// The barycentric coordinates in each simplex of the point with the reference coordinates `xi`, in [0, 1]^D, of
    /// the piece. With the corners lambda_c of the piece of a simplex:
    ///
    /// ```text
    /// lambda(xi) = sum_c w_c(xi) lambda_c,     w_c = prod_a (xi_a if bit a of c is set, else 1 - xi_a)     (piece)
    /// ```
    pub(super) fn barycentric(&self, shape: Shape, xi: &[f64]) -> Vec<Vec<f64>> {
        let mut axis = 0;
        let in_factor = |(factor, &dimension): (&Vec<Mean>, &usize)| {
            let xi = &xi[axis..axis + dimension];
            axis += dimension;
            let mut lambda = vec![0.0; dimension + 1];
            for (c, mean) in factor.iter().enumerate() {
                let weight = (0..dimension).map(|a| if digit(c, 2, a) == 1 { xi[a] } else { 1.0 - xi[a] });
                let share = weight.product::<f64>() / mean.len() as f64;
                mean.iter().for_each(|&vertex| lambda[vertex] += share);
            }
            lambda
        };
        self.factors.iter().zip(shape.factors()).map(in_factor).collect()
    }
}

/// The pairs of corners of an element of `shape` that differ only in the coordinates of one of its simplices: for each
/// simplex, its copies of edges.
pub(super) fn edges(shape: Shape) -> Vec<Vec<[usize; 2]>> {
    let (corners, mut axis) = (shape.corners(), 0);
    let along = |&dimension: &usize| {
        let axes = axis..axis + dimension;
        axis += dimension;
        let differ_there = |i: usize, j: usize| (0..3).all(|a| axes.contains(&a) || corners[i][a] == corners[j][a]);
        let pairs = (0..corners.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        pairs.filter(|&[i, j]| differ_there(i, j)).collect()
    };
    shape.factors().iter().map(along).collect()
}
