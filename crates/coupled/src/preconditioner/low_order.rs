//! The preconditioner by low-order refinement: the flow on the control volumes of its nodes, `fem::LowOrder`.
//!
//! ```text
//! lambda + dt A,    A_ij = (M_i M_j)^(-1/2) S^(-1) dR_i/du_j S                                                     (node blocks)
//! P r ~ (lambda + dt A)^(-1) r  by a few steps of generalised conjugate residuals, preconditioned by
//! D_i = lambda + dt A_ii - sum_(j before i) dt^2 A_ij D_j^(-1) A_ji                                                (node ilu)
//! ```
//!
//! with the scales S of the components, for every temporal mode. A node has 2 D neighbours. No two of them are neighbours of each other, so
//! ILU(0) changes the diagonal alone: the A_ij are real and serve all modes. Memory per unknown does not depend on the order. Blocks are kept
//! in bfloat16. The iteration inside makes the preconditioner depend on r, so the solver around it must be flexible.

mod factor;
mod inner;
mod matrix;
mod stencil;
mod sweeps;
mod vectors;
mod walk;

use super::modal::largest;
use super::ordering::Ordering;
use super::{FactoredModes, FlowPreconditioner, TimeScales};
use basis::TemporalModes;
use factor::Factor;
use faer::c64;
use fem::SlabOperator;
use inner::Iteration;
pub use inner::VECTORS;
use matrix::NodeBlocks;
use newton_krylov::operator::Preconditioner;
use vectors::Modes;
use walk::Walk;

/// Makes the preconditioner of the flow in the middle of a slab; the order of elimination is found anew unless one is given.
pub fn low_order<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    scales: TimeScales,
    ordering: Option<Ordering>,
) -> Box<dyn FlowPreconditioner<D, M>> {
    if const { M <= 4 } {
        Box::new(NodeIlu::<D, M, 4>::new(operator, scales, ordering))
    } else {
        Box::new(NodeIlu::<D, M, 8>::new(operator, scales, ordering))
    }
}

/// (node ilu) with blocks of `M` rows, `W` >= M of which are treated at a time.
struct NodeIlu<const D: usize, const M: usize, const W: usize> {
    modes: TemporalModes,
    matrix: NodeBlocks<D, M>,
    walk: Walk,
    factor: Factor,
    iteration: Iteration,
}

impl<const D: usize, const M: usize, const W: usize> NodeIlu<D, M, W> {
    fn new(operator: &SlabOperator<D, M>, scales: TimeScales, ordering: Option<Ordering>) -> Self {
        let (layout, modes) = (operator.layout, TemporalModes::new(&operator.tables.time));
        let matrix = NodeBlocks::new(operator);
        let ordering = ordering.filter(|ordering| ordering.own().count() == layout.cells);
        let ordering = ordering.map(|known| Ordering::whole(known.own().collect(), known.level_ends));
        let ordering = ordering.unwrap_or_else(|| matrix.ordering(modes.mean_shift()));
        let walk = Walk::new(&matrix, ordering);
        let factor = Factor::empty(layout.cells, &modes);
        let iteration = Iteration::new(layout, &operator.share);
        let mut preconditioner = NodeIlu { modes, matrix, walk, factor, iteration };
        preconditioner.factor(scales);
        preconditioner
    }
}

impl<const D: usize, const M: usize, const W: usize> FlowPreconditioner<D, M> for NodeIlu<D, M, W> {
    fn updated(self: Box<Self>, flow: &SlabOperator<D, M>, scales: TimeScales) -> Box<dyn FlowPreconditioner<D, M>> {
        // The old one gives its memory back before the new one is made.
        let ordering = self.ordering();
        drop(self);
        low_order(flow, scales, Some(ordering))
    }
}

impl<const D: usize, const M: usize, const W: usize> Preconditioner for NodeIlu<D, M, W> {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let scale = largest(&self.matrix.share, r);
        if scale == 0.0 {
            return z.fill(0.0);
        }
        let between = Modes { modes: &self.modes, matrix: &self.matrix };
        between.split(r, 1.0 / scale, &self.iteration.vector);
        let operator = sweeps::Operator::<D, M, W> { matrix: &self.matrix, walk: &self.walk, factor: &self.factor };
        self.iteration.run(&operator);
        between.join(&self.iteration.vector, scale, z);
    }
}

impl<const D: usize, const M: usize, const W: usize> FactoredModes for NodeIlu<D, M, W> {
    fn factor(&mut self, TimeScales { dt, damping }: TimeScales) {
        let shifts: Vec<c64> = self.modes.eigenvalues.iter().map(|lambda| lambda + damping).collect();
        self.factor.compute::<D, M, W>(&self.matrix, &self.walk, self.matrix.ratio(dt), shifts);
    }

    fn ordering(&self) -> Ordering {
        self.walk.ordering.clone()
    }

    fn bytes(&self) -> usize {
        self.matrix.bytes() + self.factor.bytes()
    }
}
