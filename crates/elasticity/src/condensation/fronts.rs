//! Cholesky factorisation along a tree of parts of the mesh (the multifrontal method of Duff & Reid 1983).
//!
//! The matrix of a part is the sum of what its two halves have left. With the nodes that no other part needs (e) first, then its boundary
//! (b),
//!
//! ```text
//! F_ee = L_ee L_ee^T,      L_be = F_be L_ee^{-T},      F_bb - L_be L_be^T                                        (front)
//! ```
//!
//! and the last one is what the part leaves to its union with another one.

use super::dissection::{Dissection, Members, Part};
use crate::ElasticityError;
use crate::cholesky::eliminate_leading;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, Par};

/// A symmetric matrix with D x D blocks, and the number of the node of each block row; without a node where it is left out.
pub(crate) struct Contribution<'a> {
    pub(crate) nodes: Vec<Option<usize>>,
    pub(crate) matrix: &'a Mat<f64>,
}

/// L of all parts, in the order of the dissection: of each one L_ee above L_be.
pub(crate) struct Fronts<const D: usize>(Vec<Mat<f64>>);

impl<const D: usize> Fronts<D> {
    /// Factors the sum of the cells' matrices `cell(cell)`, of both triangles.
    pub(crate) fn new<'a>(
        dissection: &Dissection,
        cell: impl Fn(usize) -> Contribution<'a> + Sync,
    ) -> Result<Self, ElasticityError> {
        let mut factors = vec![Mat::new(); dissection.parts.len()];
        factor::<D>(&dissection.parts, &cell, &mut factors)?;
        Ok(Fronts(factors))
    }

    /// Memory of the factor.
    pub(crate) fn bytes(&self) -> usize {
        self.0.iter().map(|factor| factor.nrows() * factor.ncols() * size_of::<f64>()).sum()
    }

    /// Solves for every column of `x`, rows `[number][component]`, in place. `work` has the rows of the largest boundary.
    pub(crate) fn solve(&self, dissection: &Dissection, mut x: MatMut<'_, f64>, mut work: MatMut<'_, f64>) {
        for (part, factor) in dissection.parts.iter().zip(&self.0) {
            forward::<D>(part, factor, x.as_mut(), work.as_mut());
        }
        for (part, factor) in dissection.parts.iter().zip(&self.0).rev() {
            backward::<D>(part, factor, x.as_mut(), work.as_mut());
        }
    }
}

/// Factors the last of `parts` after all others; returns what it leaves. Halves are factored side by side: the result is the same.
fn factor<'a, const D: usize>(
    parts: &[Part],
    cell: &(impl Fn(usize) -> Contribution<'a> + Sync),
    factors: &mut [Mat<f64>],
) -> Result<Mat<f64>, ElasticityError> {
    let (Some((part, below)), Some((own, factors))) = (parts.split_last(), factors.split_last_mut()) else {
        return Ok(Mat::new());
    };
    let eliminated = part.eliminated.len() * D;
    let size = eliminated + part.boundary.len() * D;
    let mut front = Mat::zeros(size, size);
    match part.members {
        Members::Cell(number) => add::<D>(&mut front, part, &cell(number)),
        Members::Parts { second } => {
            let middle = below.len() - second;
            let (first_parts, second_parts) = below.split_at(middle);
            let (first_factors, second_factors) = factors.split_at_mut(middle);
            let (first, second) = rayon::join(
                || factor::<D>(first_parts, cell, first_factors),
                || factor::<D>(second_parts, cell, second_factors),
            );
            add::<D>(&mut front, part, &left_by(first_parts, &first?));
            add::<D>(&mut front, part, &left_by(second_parts, &second?));
        }
    }
    eliminate_leading(front.as_mut(), eliminated)?;
    *own = front.subcols(0, eliminated).to_owned();
    Ok(front.submatrix(eliminated, eliminated, size - eliminated, size - eliminated).to_owned())
}

/// What the last of `parts` leaves, as a contribution.
fn left_by<'a>(parts: &[Part], matrix: &'a Mat<f64>) -> Contribution<'a> {
    let nodes = parts.last().map_or(vec![], |part| part.boundary.iter().map(|&node| Some(node)).collect());
    Contribution { nodes, matrix }
}

/// Adds a contribution to the lower triangle of the front of a part.
fn add<const D: usize>(front: &mut Mat<f64>, part: &Part, contribution: &Contribution<'_>) {
    let positions: Vec<_> = contribution.nodes.iter().map(|node| node.map(|node| part.position(node) * D)).collect();
    for (l, column) in positions.iter().enumerate().filter_map(|(l, p)| p.map(|p| (l, p))) {
        for j in 0..D {
            let (to, from) = (front.col_as_slice_mut(column + j), contribution.matrix.col_as_slice(l * D + j));
            for (from, row) in from.chunks_exact(D).zip(&positions) {
                if let Some(row) = row.filter(|row| *row >= column) {
                    to[row..row + D].iter_mut().zip(from).for_each(|(to, from)| *to += from);
                }
            }
        }
    }
}

impl Part {
    /// Where a node stands in the front: nodes that are eliminated come first.
    fn position(&self, node: usize) -> usize {
        if self.eliminated.contains(&node) {
            node - self.eliminated.start
        } else {
            self.eliminated.len() + self.boundary.partition_point(|&other| other < node)
        }
    }
}

/// x_e = L_ee^{-1} x_e,  x_b = x_b - L_be x_e.
fn forward<const D: usize>(part: &Part, factor: &Mat<f64>, mut x: MatMut<'_, f64>, mut work: MatMut<'_, f64>) {
    let (e, columns) = (factor.ncols(), x.ncols());
    let (l_ee, l_be) = factor.split_at_row(e);
    let mut x_e = x.as_mut().subrows_mut(part.eliminated.start * D, e);
    solve_lower_triangular_in_place(l_ee, x_e.as_mut(), Par::Seq);
    let mut product = work.as_mut().subrows_mut(0, l_be.nrows());
    matmul(product.as_mut(), Accum::Replace, l_be, x_e, 1.0, Par::Seq);
    for column in 0..columns {
        for (k, node) in part.boundary.iter().enumerate() {
            (0..D).for_each(|i| x[(node * D + i, column)] -= product[(k * D + i, column)]);
        }
    }
}

/// x_e = L_ee^{-T} (x_e - L_be^T x_b).
fn backward<const D: usize>(part: &Part, factor: &Mat<f64>, mut x: MatMut<'_, f64>, mut work: MatMut<'_, f64>) {
    let (e, columns) = (factor.ncols(), x.ncols());
    let (l_ee, l_be) = factor.split_at_row(e);
    let mut x_b = work.as_mut().subrows_mut(0, l_be.nrows());
    for column in 0..columns {
        for (k, node) in part.boundary.iter().enumerate() {
            (0..D).for_each(|i| x_b[(k * D + i, column)] = x[(node * D + i, column)]);
        }
    }
    let mut x_e = x.as_mut().subrows_mut(part.eliminated.start * D, e);
    matmul(x_e.as_mut(), Accum::Add, l_be.transpose(), x_b, -1.0, Par::Seq);
    solve_upper_triangular_in_place(l_ee.transpose(), x_e, Par::Seq);
}
