//! The residual that is left where Newton's method has stopped.

use super::System;
use newton_krylov::inner_product::{InnerProduct, sum};
use newton_krylov::problem::NonlinearProblem;

/// Parts of |R| as in (norm). The squares of the parts of the flow add up to the square of its norm.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualBreakdown {
    /// The equations of the mesh, where there are any.
    pub mesh: Option<f64>,
    /// Each equation of the flow: of mass, of momentum (D), of energy.
    pub equations: Vec<f64>,
    /// The flow in each cell of the whole mesh. Empty on all ranks but the first.
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
    /// The parts of the residual at `z`; `None` where there is no residual. A collective call.
    pub fn residual_breakdown(&mut self, z: &[f64]) -> Option<ResidualBreakdown> {
        let mut r = vec![0.0; z.len()];
        self.residual(z, &mut r).ok()?;
        let (range, layout) = (self.flow_range(), self.flow.operator.layout);
        let weights = &self.weights.weights[range.clone()];
        let mut squares = vec![0.0; layout.cells * M];
        for (i, (r, w)) in r[range].iter().zip(weights).enumerate() {
            squares[layout.cell_of(i) * M + layout.component_of(i)] += w * r * r;
        }
        let squares = self.flow.operator.share.join(&squares);
        let of_cells = |m: usize| squares.iter().copied().skip(m).step_by(M).collect::<Vec<f64>>();
        let of_equation = |m: usize| sum(&of_cells(m)).sqrt();
        let mesh = (self.mesh_len() > 0).then(|| self.weights.norm_on(self.mesh_range(), &r));
        let cells = squares.chunks_exact(M).map(|of_cell| of_cell.iter().sum::<f64>().sqrt()).collect();
        Some(ResidualBreakdown { mesh, equations: (0..M).map(of_equation).collect(), cells })
    }
}
