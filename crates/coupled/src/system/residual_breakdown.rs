//! What is left of the residual where Newton has stopped.

use super::System;
use newton_krylov::inner_product::InnerProduct;
use newton_krylov::problem::NonlinearProblem;

/// Parts of |R| as in (norm): squares of the parts of the flow add up to the square of its norm.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualBreakdown {
    /// The equations of the mesh, where there are any.
    pub mesh: Option<f64>,
    /// Each equation of the flow: of mass, of momentum (D), of energy.
    pub equations: Vec<f64>,
    /// The flow in each cell.
    pub cells: Vec<f64>,
}

impl ResidualBreakdown {
    /// The cell with the largest residual.
    pub fn worst_cell(&self) -> Option<usize> {
        let cells = self.cells.iter().enumerate();
        cells.max_by(|a, b| a.1.total_cmp(b.1)).map(|(cell, _)| cell)
    }
}

impl<const D: usize, const M: usize> System<D, M> {
    /// The parts of the residual at `z`; `None` where there is no residual.
    pub fn residual_breakdown(&mut self, z: &[f64]) -> Option<ResidualBreakdown> {
        let mut r = vec![0.0; z.len()];
        self.residual(z, &mut r).ok()?;
        let (range, layout) = (self.flow_range(), self.flow.operator.layout);
        let weights = &self.weights.weights[range.clone()];
        let (mut equations, mut cells) = (vec![0.0; M], vec![0.0; layout.cells]);
        for (i, (r, w)) in r[range].iter().zip(weights).enumerate() {
            equations[i / layout.nodes % M] += w * r * r;
            cells[i / layout.cell_len()] += w * r * r;
        }
        let roots = |squares: Vec<f64>| squares.into_iter().map(f64::sqrt).collect();
        let mesh = (self.mesh_len() > 0).then(|| self.weights.norm_on(self.mesh_range(), &r));
        Some(ResidualBreakdown { mesh, equations: roots(equations), cells: roots(cells) })
    }
}
