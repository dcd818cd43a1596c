//! Values in cells on any tensor grid of reference points, for output, errors and integrals. Plain numbers, one cell at
//! a time.

use crate::StateField;
use crate::moving_mesh::MovingMesh;
use crate::operator::SlabOperator;
use crate::parallel::{self, Grain};
use basis::{Lagrange, Matrix, gauss};
use tensor::{cofactor, det, determinant};

/// Values of flow and mesh polynomials on the tensor grid of some points per direction.
pub struct Sampler<const D: usize> {
    flow: Matrix,
    flow_derivatives: Matrix,
    mesh: Matrix,
    mesh_derivatives: Matrix,
}

impl<const D: usize> Sampler<D> {
    /// The grid of `points` in every direction, for a flow and a mesh of the given orders.
    pub fn new(flow_order: usize, mesh_order: usize, points: &[f64]) -> Self {
        let (flow, mesh) = (Lagrange::gauss_lobatto(flow_order), Lagrange::gauss_lobatto(mesh_order));
        Sampler {
            flow: flow.value_matrix(points),
            flow_derivatives: flow.derivative_matrix(points),
            mesh: mesh.value_matrix(points),
            mesh_derivatives: mesh.derivative_matrix(points),
        }
    }

    /// Points of the grid.
    pub fn points(&self) -> usize {
        self.flow.rows().pow(D as u32)
    }

    /// A cell's coefficients `[component][node]` to `[component][point]`.
    pub fn state(&self, coefficients: &[f64]) -> Vec<f64> {
        along_axes::<D>(coefficients, |_| &self.flow)
    }

    /// A cell's nodal positions `[component][node]` to positions `[component][point]`.
    pub fn positions(&self, nodal: &[f64]) -> Vec<f64> {
        let mut x = along_axes::<D>(&relative::<D>(nodal), |_| &self.mesh);
        let points = self.points();
        let first_nodes = nodal.iter().step_by(nodal.len() / D);
        x.chunks_exact_mut(points).zip(first_nodes).for_each(|(x, first)| x.iter_mut().for_each(|x| *x += first));
        x
    }

    /// dx/dxi at the points, `[point][i][j]`.
    fn jacobians(&self, nodal: &[f64]) -> Vec<[[f64; D]; D]> {
        let nodal = relative::<D>(nodal);
        let columns: Vec<Vec<f64>> =
            (0..D).map(|j| derivative::<D>(&nodal, j, &self.mesh, &self.mesh_derivatives)).collect();
        let n = self.points();
        (0..n).map(|p| std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i * n + p]))).collect()
    }

    /// det dx/dxi at the points.
    pub fn determinants(&self, nodal: &[f64]) -> Vec<f64> {
        self.jacobians(nodal).iter().map(det).collect()
    }

    /// grad_x of a cell's coefficients `[component][node]` on a cell at `nodal`: `[direction][component][point]`.
    pub fn gradients(&self, coefficients: &[f64], nodal: &[f64]) -> [Vec<f64>; D] {
        let n = self.points();
        let reference: Vec<Vec<f64>> =
            (0..D).map(|j| derivative::<D>(coefficients, j, &self.flow, &self.flow_derivatives)).collect();
        let inverses: Vec<[[f64; D]; D]> = (self.jacobians(nodal).iter())
            .map(|m| (cofactor(m), m))
            .map(|(cof, m)| cof.map(|row| row.map(|c| c / determinant(m, &cof))))
            .collect();
        std::array::from_fn(|k| {
            (0..reference[0].len()).map(|i| (0..D).map(|j| inverses[i % n][k][j] * reference[j][i]).sum()).collect()
        })
    }
}

/// Positions `[component][node]` relative to the first node: a common offset would cost digits.
fn relative<const D: usize>(nodal: &[f64]) -> Vec<f64> {
    nodal.chunks_exact(nodal.len() / D).flat_map(|x| x.iter().map(move |value| value - x[0])).collect()
}

/// The derivative of tensors `[component][node]` in reference direction `j`.
fn derivative<const D: usize>(input: &[f64], j: usize, values: &Matrix, derivatives: &Matrix) -> Vec<f64> {
    along_axes::<D>(input, |axis| if axis == j { derivatives } else { values })
}

/// Applies one matrix per axis to tensors `[component][node]`, axis 0 fastest.
fn along_axes<'a, const D: usize>(input: &[f64], matrix: impl Fn(usize) -> &'a Matrix) -> Vec<f64> {
    let mut tensor = input.to_vec();
    let mut inner = 1;
    for axis in 0..D {
        let matrix = matrix(axis);
        let (rows, cols) = (matrix.rows(), matrix.cols());
        let mut output = vec![0.0; tensor.len() / cols * rows];
        for (input, output) in tensor.chunks_exact(cols * inner).zip(output.chunks_exact_mut(rows * inner)) {
            for (r, output) in output.chunks_exact_mut(inner).enumerate() {
                for (weight, input) in matrix.row(r).iter().zip(input.chunks_exact(inner)) {
                    output.iter_mut().zip(input).for_each(|(o, i)| *o += weight * i);
                }
            }
        }
        tensor = output;
        inner *= rows;
    }
    tensor
}

/// The nodal functions of a cell of order `order` at the reference point `xi`, axis 0 fastest.
pub fn functions_at<const D: usize>(order: usize, xi: &[f64; D]) -> Vec<f64> {
    let basis = Lagrange::gauss_lobatto(order);
    xi.iter().fold(vec![1.0], |product, &xi| {
        basis.values(xi).iter().flat_map(|phi| product.iter().map(move |p| p * phi)).collect()
    })
}

/// The sum of [`squared_errors_of_cells`].
pub fn squared_errors<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    state: &[f64],
    row: &[f64],
    exact: &dyn StateField<D, M>,
    t: f64,
) -> [f64; M] {
    let errors = squared_errors_of_cells(operator, state, row, exact, t);
    errors.iter().fold([0.0; M], |sum, e| std::array::from_fn(|m| sum[m] + e[m]))
}

/// int (u_m - exact_m)^2 over each cell for every component, by Gauss quadrature with twice the order.
///
/// `state` is laid out at one time; at this time the mesh has the position row `row` (see `TimePoint::position_row`).
pub fn squared_errors_of_cells<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    state: &[f64],
    row: &[f64],
    exact: &dyn StateField<D, M>,
    t: f64,
) -> Vec<[f64; M]> {
    let orders = operator.tables.orders;
    let rule = gauss(2 * orders.flow.max(orders.mesh));
    let sampler = Sampler::<D>::new(orders.flow, orders.mesh, &rule.points);
    let errors = CellErrors { sampler, weights: rule.tensor_weights(D), moving: &operator.mesh, row, exact, t };
    let layout = operator.layout.at_one_time();
    let of_cell = |cell: usize| errors.squared(cell, &state[layout.cell(cell)]);
    parallel::map(layout.cells, Grain::Any, &of_cell)
}

/// An exact state at a time, and the grid on which cells are compared with it.
struct CellErrors<'a, const D: usize, const M: usize> {
    sampler: Sampler<D>,
    /// Quadrature weights of the grid.
    weights: Vec<f64>,
    moving: &'a MovingMesh,
    /// The row of positions of the mesh.
    row: &'a [f64],
    exact: &'a dyn StateField<D, M>,
    t: f64,
}

impl<const D: usize, const M: usize> CellErrors<'_, D, M> {
    /// The squared errors in one cell with the coefficients `state`.
    fn squared(&self, cell: usize, state: &[f64]) -> [f64; M] {
        let CellErrors { sampler, moving, .. } = self;
        let mut nodal = vec![0.0; moving.slot_len()];
        moving.relative_positions(cell, self.row, &mut nodal);
        let (x, det, u) = (sampler.positions(&nodal), sampler.determinants(&nodal), sampler.state(state));
        let (origin, n) = (moving.origin(cell), sampler.points());
        let mut sum = [0.0; M];
        for p in 0..n {
            let exact = self.exact.value(&std::array::from_fn(|d| origin[d] + x[d * n + p]), self.t);
            for m in 0..M {
                sum[m] += self.weights[p] * det[p] * (u[m * n + p] - exact[m]).powi(2);
            }
        }
        sum
    }
}
