//! The low-order refined preconditioner.
//!
//! The Gauss-Lobatto nodes of a cell of order N span (N - 1)^D sub-cells. Bilinear (trilinear) elasticity on all sub-cells has the same
//! unknowns as K and is sparse. It is spectrally equivalent to K with constants that depend neither on N nor on the shape of the cells.
//! CG takes 20 to 30 iterations in 2-D, 33 to 46 in 3-D, also in boundary layers. The integrals over a sub-cell are taken at its 2^D
//! corners; with Gauss points the equivalence is lost as N grows.

use crate::ElasticityError;
use crate::geometry::{Sample, determinant_and_inverse};
use crate::material::Lame;
use crate::multigrid::{self, Cycle};
use crate::pool::Pool;
use mesh::NodeNumbering;
use sparse::{BlockMatrix, Factorisation, Kind};
use std::sync::Arc;

/// The low-order matrix of the nodes with a free component, factored or with a multigrid hierarchy.
pub(crate) struct LowOrderInverse<const D: usize> {
    /// These C0 nodes.
    free: Vec<usize>,
    inverse: Inverse,
    buffers: Pool<Buffers>,
}

/// Work space of an application: a vector of free nodes, and the work space of the sparse solver.
#[derive(Default)]
struct Buffers {
    x: Vec<f64>,
    work: Vec<f64>,
}

/// A^{-1}, exact or approximate.
enum Inverse {
    Factor(Box<Factorisation<f64>>),
    Multigrid(Box<dyn Cycle>),
}

impl<const D: usize> LowOrderInverse<D> {
    /// Assembles the matrix of K + m M with the m and M of `inertia`, at the entries `[C0 node][component]` that are not `fixed`, and
    /// factors it. For `multigrid` it makes a hierarchy from the positions of all C0 nodes instead. `samples(cell)` are the samples at
    /// the Gauss-Lobatto nodes of `numbering`'s order in a cell.
    pub(crate) fn new(
        lame: Lame,
        inertia: Inertia<'_, D>,
        numbering: &NodeNumbering,
        samples: impl Fn(usize) -> Result<Vec<Sample<D>>, ElasticityError>,
        fixed: &[[bool; D]],
        multigrid: Option<&[[f64; D]]>,
    ) -> Result<Self, ElasticityError> {
        let free: Vec<usize> = (0..numbering.count).filter(|&node| fixed[node] != [true; D]).collect();
        let mut unknowns = vec![None; numbering.count];
        free.iter().enumerate().for_each(|(unknown, &node)| unknowns[node] = Some(unknown));
        let fixed: Vec<[bool; D]> = free.iter().map(|&node| fixed[node]).collect();
        let terms = Terms { lame, mass: inertia.m * inertia.density, fixed: &fixed };
        let mut matrix = matrix(terms, numbering, samples, &unknowns)?;
        for (unknown, layer) in free.iter().filter_map(|&node| inertia.layer.get(node)).enumerate() {
            let mut block = layer.map(|row| row.map(|mass| inertia.m * mass));
            terms.decouple(unknown, unknown, &mut block);
            matrix.add(unknown, unknown, |i, j| block[i][j]);
        }
        let inverse = match multigrid {
            None => Inverse::Factor(Box::new(matrix.factor(Arc::new(matrix.elimination_tree()?))?)),
            Some(coordinates) => {
                let of_free: Vec<_> = free.iter().map(|&node| coordinates[node]).collect();
                Inverse::Multigrid(multigrid::hierarchy::<D>(&matrix, &of_free, &fixed)?)
            }
        };
        Ok(LowOrderInverse { free, inverse, buffers: Pool::new() })
    }

    /// z = P^{-1} r at free entries, 0 at the others; both `[C0 node][component]`. `r` vanishes at fixed entries.
    pub(crate) fn apply(&self, r: &[f64], z: &mut [f64]) {
        let mut buffers = self.buffers.take(Buffers::default);
        let Buffers { x, work } = &mut buffers;
        x.resize(self.free.len() * D, 0.0);
        for (x, &node) in x.chunks_exact_mut(D).zip(&self.free) {
            x.copy_from_slice(&r[node * D..][..D]);
        }
        match &self.inverse {
            Inverse::Factor(factor) => factor.solve(x, 1, work),
            Inverse::Multigrid(cycle) => cycle.apply(x),
        }
        z.fill(0.0);
        for (x, &node) in x.chunks_exact(D).zip(&self.free) {
            z[node * D..][..D].copy_from_slice(x);
        }
        self.buffers.give(buffers);
    }

    /// Whether it is a hierarchy.
    pub(crate) fn is_multigrid(&self) -> bool {
        matches!(self.inverse, Inverse::Multigrid(_))
    }

    /// Memory of the factor or the hierarchy.
    pub(crate) fn bytes(&self) -> usize {
        match &self.inverse {
            Inverse::Factor(factor) => factor.bytes(),
            Inverse::Multigrid(cycle) => cycle.bytes(),
        }
    }
}

/// The mass in K + m M.
#[derive(Clone, Copy)]
pub(crate) struct Inertia<'a, const D: usize> {
    /// m
    pub(crate) m: f64,
    /// rho
    pub(crate) density: f64,
    /// The additional mass of every C0 node; may be empty.
    pub(crate) layer: &'a [[[f64; D]; D]],
}

impl<const D: usize> Inertia<'_, D> {
    pub(crate) fn none() -> Self {
        Inertia { m: 0.0, density: 0.0, layer: &[] }
    }
}

/// The input of a low-order matrix.
#[derive(Clone, Copy)]
struct Terms<'a, const D: usize> {
    lame: Lame,
    /// The factor of the mass matrix of unit density.
    mass: f64,
    /// The decoupled components, by unknown.
    fixed: &'a [[bool; D]],
}

/// The low-order matrix K + m M of the nodes that have an unknown, `unknowns[C0 node]`, numbered from 0.
fn matrix<const D: usize>(
    terms: Terms<'_, D>,
    numbering: &NodeNumbering,
    samples: impl Fn(usize) -> Result<Vec<Sample<D>>, ElasticityError>,
    unknowns: &[Option<usize>],
) -> Result<BlockMatrix<f64>, ElasticityError> {
    let sub_cells = SubCells::<D>::new(numbering.order());
    let of_cell = |cell| -> Vec<Option<usize>> { numbering.cell(cell).iter().map(|&node| unknowns[node]).collect() };
    let mut neighbours = vec![Vec::new(); unknowns.iter().flatten().count()];
    let cells = 0..numbering.n_cells();
    cells.clone().for_each(|cell| sub_cells.couple(&of_cell(cell), &mut neighbours));
    let mut matrix = BlockMatrix::new(Kind::Cholesky, D, neighbours);
    for cell in cells {
        sub_cells.add_cell(terms, cell, &samples(cell)?, &of_cell(cell), &mut matrix)?;
    }
    Ok(matrix)
}

/// The lattice of sub-cells in a cell: corner k of a sub-cell has bit a for the side along axis a.
struct SubCells<const D: usize> {
    /// The lattice index of corner 0 of each sub-cell.
    first: Vec<usize>,
    /// The offsets from corner 0 to corner k.
    offsets: Vec<usize>,
}

/// The quadrature point at a corner of a sub-cell.
struct Corner<const D: usize> {
    /// det / 2^D.
    volume: f64,
    /// The factor of the constants of Lame, and the contribution to the first constant beyond that.
    stiffness: f64,
    excess: f64,
    /// The functions with a gradient there, by lattice index: those of its D neighbours and of the corner itself. The corner's
    /// function is the last one, and the only one that does not vanish there.
    gradients: Vec<(usize, [f64; D])>,
}

impl<const D: usize> SubCells<D> {
    fn new(order: usize) -> Self {
        let stride = |axis: usize| order.pow(axis as u32);
        let is_first = |&k: &usize| (0..D).all(|axis| k / stride(axis) % order < order - 1);
        let offset = |corner: usize| (0..D).map(|axis| (corner >> axis & 1) * stride(axis)).sum();
        SubCells { first: (0..stride(D)).filter(is_first).collect(), offsets: (0..1 << D).map(offset).collect() }
    }

    /// Adds to the neighbours of each unknown those that share a sub-cell with it.
    fn couple(&self, unknowns: &[Option<usize>], neighbours: &mut [Vec<usize>]) {
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

    /// Adds the sub-cells of one cell with the given samples and unknowns at its nodes.
    fn add_cell(
        &self,
        terms: Terms<'_, D>,
        cell: usize,
        samples: &[Sample<D>],
        unknowns: &[Option<usize>],
        matrix: &mut BlockMatrix<f64>,
    ) -> Result<(), ElasticityError> {
        for &first in &self.first {
            for corner in 0..1 << D {
                add_corner(terms, &self.corner(cell, samples, first, corner)?, unknowns, matrix);
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

/// Adds W block(grad phi_row, grad phi_column) for all pairs of functions, and the mass of the corner.
fn add_corner<const D: usize>(
    terms: Terms<'_, D>,
    corner: &Corner<D>,
    unknowns: &[Option<usize>],
    matrix: &mut BlockMatrix<f64>,
) {
    let own = corner.gradients.len() - 1;
    let lame = Lame { lambda: terms.lame.lambda + corner.excess / corner.stiffness, ..terms.lame };
    for (k, (row, grad_row)) in corner.gradients.iter().enumerate() {
        for (l, (column, grad_column)) in corner.gradients.iter().enumerate() {
            if let (Some(row), Some(column)) = (unknowns[*row], unknowns[*column]) {
                let weighted = grad_column.map(|g| g * corner.volume * corner.stiffness);
                let mut block = lame.block(grad_row, &weighted);
                if (k, l) == (own, own) {
                    (0..D).for_each(|i| block[i][i] += terms.mass * corner.volume);
                }
                terms.decouple(row, column, &mut block);
                matrix.add(row, column, |i, j| block[i][j]);
            }
        }
    }
}

impl<const D: usize> Terms<'_, D> {
    /// Sets the rows and columns of fixed components to zero, except the diagonal.
    fn decouple(&self, row: usize, column: usize, block: &mut [[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                let diagonal = row == column && i == j;
                if !diagonal && (self.fixed[row][i] || self.fixed[column][j]) {
                    block[i][j] = 0.0;
                }
            }
        }
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
    use crate::Stiffness;
    use crate::geometry::{StiffnessSampler, nodal_coordinates};
    use crate::testing::{material, unit_box};
    use basis::gauss_lobatto;
    use mesh::Mesh;
    use tensor::dot;

    /// The matrix of all nodes, none constrained, times a displacement.
    fn product<const D: usize>(
        mesh: &Mesh<D>,
        order: usize,
        d: impl Fn(&[f64; D]) -> [f64; D],
    ) -> (Vec<f64>, Vec<f64>) {
        let numbering = NodeNumbering::new(mesh, order);
        let sampler = StiffnessSampler::new(mesh, Stiffness::Constant, gauss_lobatto(order));
        let unknowns: Vec<_> = (0..numbering.count).map(Some).collect();
        let terms = Terms { lame: material().lame(), mass: 0.0, fixed: &vec![[false; D]; numbering.count] };
        let matrix = matrix(terms, &numbering, |cell| sampler.cell(cell), &unknowns).unwrap();
        let d: Vec<f64> = nodal_coordinates(mesh, &numbering).iter().flat_map(d).collect();
        (matrix.product(&d), d)
    }

    #[test]
    fn rigid_motions_cost_nothing() {
        for order in [2, 4, 7] {
            let (forces, _) = product(&unit_box([3, 2], order, 0.03), order, |x| [1.0 - x[1], x[0]]);
            assert!(forces.iter().all(|f| f.abs() < 1e-13), "D = 2, N = {order}");
            let rotation = |x: &[f64; 3]| [x[1] - x[2], x[2] - x[0], 2.0 + x[0] - x[1]];
            let (forces, _) = product(&unit_box([2, 1, 2], order, 0.03), order, rotation);
            assert!(forces.iter().all(|f| f.abs() < 1e-13), "D = 3, N = {order}");
        }
    }

    /// The corners integrate the energy of a homogeneous strain exactly: the sub-cells fill the unit cube.
    #[test]
    fn energy_of_a_homogeneous_strain() {
        let gradient = [[0.3, 0.1, 0.0], [-0.2, 0.4, 0.5], [0.0, 0.7, -0.6]];
        let (forces, d) = product(&unit_box([2, 1, 2], 4, 0.0), 4, |x| gradient.map(|row| dot(&row, x)));
        let sigma = material().lame().stress(&gradient);
        let expected: f64 = sigma.as_flattened().iter().zip(gradient.as_flattened()).map(|(s, h)| s * h).sum();
        let found: f64 = d.iter().zip(&forces).map(|(d, f)| d * f).sum();
        assert!((found - expected).abs() < 1e-13);
    }

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
        let mut matrix = BlockMatrix::new(Kind::Cholesky, 2, vec![]);
        let terms = Terms { lame: material().lame(), mass: 0.0, fixed: &[] };
        let error = SubCells::new(2).add_cell(terms, 7, &samples, &[None; 4], &mut matrix).unwrap_err();
        assert!(
            matches!(&error, ElasticityError::SubCell { cell: 7, position, .. } if position == &[0.25, 0.25]),
            "{error}"
        );
    }
}
