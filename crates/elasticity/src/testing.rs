//! Meshes, vectors and the assembled K for comparison in tests.
#![allow(clippy::unwrap_used)]

use crate::geometry::{StiffnessSampler, quadrature_points};
use crate::{ElasticMesh, Lame, Material, Solver, Stiffness};
use basis::{Lagrange, Matrix, gauss};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};

/// A box [0, 1]^D of `cells` cells, curved inside and on the boundary if `amplitude` is not zero.
pub(crate) fn unit_box<const D: usize>(cells: [usize; D], order: usize, amplitude: f64) -> Mesh<D> {
    let curving = Curving::Wavy { amplitude };
    BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order, curving, periodic: [false; D] }.build().unwrap()
}

/// All components of the C0 nodes on a boundary.
pub(crate) fn boundary_nodes<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Vec<[bool; D]> {
    let mut constrained = vec![[false; D]; numbering.count];
    for boundary in 0..mesh.boundary_names().len() {
        numbering.on_boundary(mesh, boundary).into_iter().for_each(|node| constrained[node] = [true; D]);
    }
    constrained
}

/// The ends of a box along x held in all components, its other walls along their normals only.
pub(crate) fn between_sliding_walls<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Vec<[bool; D]> {
    let mut constrained = vec![[false; D]; numbering.count];
    for boundary in 0..mesh.boundary_names().len() {
        // Boundaries of a box are two for each axis.
        let axis = boundary / 2;
        let nodes = numbering.on_boundary(mesh, boundary);
        nodes.into_iter().for_each(|node| (0..D).for_each(|i| constrained[node][i] |= axis == 0 || axis == i));
    }
    constrained
}

pub(crate) fn material() -> Material {
    Material::new(1.0, 0.4).unwrap()
}

/// The elastic mesh with its whole boundary constrained.
pub(crate) fn clamped<const D: usize>(mesh: &Mesh<D>, order: usize, stiffness: Stiffness<'_, D>) -> ElasticMesh<D> {
    clamped_with(mesh, order, stiffness, Solver::Automatic)
}

/// The same with the given solver.
pub(crate) fn clamped_with<const D: usize>(
    mesh: &Mesh<D>,
    order: usize,
    stiffness: Stiffness<'_, D>,
    solver: Solver,
) -> ElasticMesh<D> {
    let numbering = NodeNumbering::new(mesh, order);
    let constrained = boundary_nodes(mesh, &numbering);
    ElasticMesh::with_solver(mesh, &numbering, material(), stiffness, &constrained, solver).unwrap()
}

/// Pseudo-random numbers in [-1, 1): the fractional parts of a quadratic sequence.
pub(crate) fn noise(length: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..length).map(|_| next()).collect()
}

/// The vector with `value(x)` at every node.
pub(crate) fn nodal<const D: usize>(elastic: &ElasticMesh<D>, value: impl Fn(&[f64; D]) -> [f64; D]) -> Vec<f64> {
    elastic.coordinates().iter().flat_map(value).collect()
}

/// max |a - b|
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

pub(crate) fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// K as a dense matrix, from the same law, stiffness and quadrature, but node by node and point by point.
pub(crate) fn assembled<const D: usize>(
    mesh: &Mesh<D>,
    order: usize,
    lame: Lame,
    stiffness: Stiffness<'_, D>,
) -> Mat<f64> {
    let numbering = NodeNumbering::new(mesh, order);
    let rule = gauss(quadrature_points(D, order));
    let sampler = StiffnessSampler::new(mesh, stiffness, rule.clone());
    let lagrange = Lagrange::gauss_lobatto(order);
    let (values, derivatives) = (lagrange.value_matrix(&rule.points), lagrange.derivative_matrix(&rule.points));
    let mut k = Mat::zeros(numbering.count * D, numbering.count * D);
    for cell in 0..mesh.n_cells() {
        let nodes = numbering.cell(cell);
        let samples = sampler.cell(cell).unwrap();
        for (point, (sample, weight)) in samples.iter().zip(rule.tensor_weights(D)).enumerate() {
            let gradients = gradients_at::<D>(&values, &derivatives, point, &sample.inverse_jacobian);
            for (row, grad_row) in nodes.iter().zip(&gradients) {
                for (column, grad_column) in nodes.iter().zip(&gradients) {
                    let block = lame.block(grad_row, grad_column);
                    for i in 0..D {
                        for j in 0..D {
                            k[(row * D + i, column * D + j)] +=
                                weight * sample.determinant * sample.stiffness * block[i][j];
                        }
                    }
                }
            }
        }
    }
    k
}

/// The physical gradients of all nodal functions of a cell at one point.
fn gradients_at<const D: usize>(
    values: &Matrix,
    derivatives: &Matrix,
    point: usize,
    inverse: &[[f64; D]; D],
) -> Vec<[f64; D]> {
    let (n, q) = (values.cols(), values.rows());
    let digit = |index: usize, base: usize, axis: usize| index / base.pow(axis as u32) % base;
    let factor = |node, axis, derived: bool| {
        let matrix = if derived { derivatives } else { values };
        matrix[(digit(point, q, axis), digit(node, n, axis))]
    };
    let reference = |node, a| (0..D).map(|axis| factor(node, axis, axis == a)).product::<f64>();
    let physical = |node, j| (0..D).map(|a| reference(node, a) * inverse[a][j]).sum();
    (0..n.pow(D as u32)).map(|node| std::array::from_fn(|j| physical(node, j))).collect()
}

/// The solution of K_ff d_f = f_f - K_fc d_c by a dense factorisation; constrained entries of `d` are kept.
pub(crate) fn solve_densely(k: &Mat<f64>, constrained: &[bool], f: &[f64], d: &mut [f64]) {
    let free: Vec<usize> = (0..d.len()).filter(|&i| !constrained[i]).collect();
    let given: Vec<usize> = (0..d.len()).filter(|&i| constrained[i]).collect();
    let matrix = Mat::from_fn(free.len(), free.len(), |i, j| k[(free[i], free[j])]);
    let boundary = |i: usize| given.iter().map(|&j| k[(i, j)] * d[j]).sum::<f64>();
    let b = Mat::from_fn(free.len(), 1, |i, _| f[free[i]] - boundary(free[i]));
    let x = matrix.llt(Side::Lower).unwrap().solve(&b);
    free.iter().enumerate().for_each(|(number, &i)| d[i] = x[(number, 0)]);
}
