//! The sub-cells of a cell, and the quadrature points at their corners.

use crate::ElasticityError;
use crate::geometry::{Sample, determinant_and_inverse};

/// The lattice of sub-cells in a cell: corner k of a sub-cell has bit a for the side along axis a.
pub(super) struct SubCells<const D: usize> {
    /// Nodes per direction.
    order: usize,
    /// The lattice index of corner 0 of each sub-cell.
    first: Vec<usize>,
    /// The offsets from corner 0 to corner k.
    offsets: Vec<usize>,
}

/// The quadrature point at a corner of a sub-cell.
pub(super) struct Corner<const D: usize> {
    /// det / 2^D.
    pub(super) volume: f64,
    /// The factor of the constants of Lame, and the contribution to the first constant beyond that.
    pub(super) stiffness: f64,
    pub(super) excess: f64,
    /// The functions with a gradient there, by lattice index: those of its D neighbours and of the corner itself. The corner's
    /// function is the last one, and the only one that does not vanish there.
    pub(super) gradients: Vec<(usize, [f64; D])>,
}

impl<const D: usize> SubCells<D> {
    pub(super) fn new(order: usize) -> Self {
        let stride = |axis: usize| order.pow(axis as u32);
        let is_first = |&k: &usize| (0..D).all(|axis| k / stride(axis) % order < order - 1);
        let offset = |corner: usize| (0..D).map(|axis| (corner >> axis & 1) * stride(axis)).sum();
        SubCells { order, first: (0..stride(D)).filter(is_first).collect(), offsets: (0..1 << D).map(offset).collect() }
    }

    /// The nodes of a cell that share a sub-cell with one of them, itself included.
    pub(super) fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let order = self.order;
        let step = move |axis: usize, which: usize| {
            let place = node / order.pow(axis as u32) % order + which / 3_usize.pow(axis as u32) % 3;
            (1..=order).contains(&place).then(|| (place - 1) * order.pow(axis as u32))
        };
        (0..3_usize.pow(D as u32)).filter_map(move |which| (0..D).map(|axis| step(axis, which)).sum())
    }

    /// Adds to the neighbours of each unknown those that share a sub-cell with it.
    pub(super) fn couple(&self, unknowns: &[Option<usize>], neighbours: &mut [Vec<usize>]) {
        for first in &self.first {
            let corners = || self.offsets.iter().filter_map(|offset| unknowns[first + offset]);
            corners().for_each(|unknown| neighbours[unknown].extend(corners().filter(|&other| other > unknown)));
        }
        // Sub-cells share most of their corners, so duplicates are removed at once.
        for unknown in unknowns.iter().flatten() {
            neighbours[*unknown].sort_unstable();
            neighbours[*unknown].dedup();
        }
    }

    /// Visits the corners of all sub-cells of a cell with the given samples.
    pub(super) fn visit_corners(
        &self,
        cell: usize,
        samples: &[Sample<D>],
        mut visit: impl FnMut(&Corner<D>),
    ) -> Result<(), ElasticityError> {
        for &first in &self.first {
            for corner in 0..1 << D {
                visit(&self.corner(cell, samples, first, corner)?);
            }
        }
        Ok(())
    }

    fn corner(
        &self,
        cell: usize,
        samples: &[Sample<D>],
        first: usize,
        corner: usize,
    ) -> Result<Corner<D>, ElasticityError> {
        let node = |corner: usize| first + self.offsets[corner];
        let Sample { position, stiffness, excess, .. } = samples[node(corner)];
        let (determinant, inverse) = determinant_and_inverse(&edges(samples, corner, node));
        if determinant.is_nan() || determinant <= 0.0 {
            return Err(ElasticityError::SubCell { cell, position: position.to_vec(), determinant });
        }
        let gradients = corner_gradients(corner, &inverse).into_iter().map(|(corner, g)| (node(corner), g)).collect();
        Ok(Corner { volume: determinant / (1 << D) as f64, stiffness, excess, gradients })
    }
}

/// The Jacobian of the multilinear map of a sub-cell, from [0, 1]^D, at one corner: its columns are the edges there.
fn edges<const D: usize>(samples: &[Sample<D>], corner: usize, at: impl Fn(usize) -> usize) -> [[f64; D]; D] {
    let edge = |axis: usize| {
        let (low, high) = (samples[at(corner & !(1 << axis))].position, samples[at(corner | 1 << axis)].position);
        std::array::from_fn(|i| high[i] - low[i])
    };
    tensor::matrix_from_columns(&std::array::from_fn(edge))
}

/// The gradients, at a corner, of the functions of that corner and of its neighbours along each axis.
fn corner_gradients<const D: usize>(corner: usize, inverse: &[[f64; D]; D]) -> Vec<(usize, [f64; D])> {
    let mut own = [0.0; D];
    let mut gradients = Vec::with_capacity(D + 1);
    for axis in 0..D {
        // The function of the high end grows along the axis, the function of the low end falls; their sum is constant.
        let sign = if corner >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let gradient = inverse[axis].map(|g| sign * g);
        gradients.push((corner ^ 1 << axis, gradient));
        (0..D).for_each(|i| own[i] -= gradient[i]);
    }
    gradients.push((corner, own));
    gradients
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn an_inverted_sub_cell_is_named() {
        let sample = |x, y| Sample {
            position: [x, y],
            determinant: 1.0,
            inverse_jacobian: [[0.0; 2]; 2],
            stiffness: 1.0,
            excess: 0.0,
        };
        // The last corner is moved across the diagonal.
        let samples = [sample(0.0, 0.0), sample(1.0, 0.0), sample(0.0, 1.0), sample(0.25, 0.25)];
        let error = SubCells::new(2).visit_corners(7, &samples, |_| {}).unwrap_err();
        assert!(
            matches!(&error, ElasticityError::SubCell { cell: 7, position, .. } if position == &[0.25, 0.25]),
            "{error}"
        );
    }
}
