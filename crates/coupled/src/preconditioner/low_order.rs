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
use basis::TemporalModes;
use factor::Factor;
use faer::c64;
use fem::SlabOperator;
use inner::Iteration;
pub use inner::VECTORS;
use matrix::NodeBlocks;
use vectors::Modes;
use walk::Walk;

/// A preconditioner made of a low-order operator, for any dimension and number of components.
pub trait LowOrderPreconditioner: Send + Sync {
    /// Factors the modes of a slab of length `dt`, damped by `damping` = dt / dtau.
    fn factor(&mut self, dt: f64, damping: f64);
    /// z = P r.
    fn apply(&mut self, r: &[f64], z: &mut [f64]);
    /// The order of elimination.
    fn ordering(&self) -> &Ordering;
    /// Bytes of the blocks and of what they are made from.
    fn bytes(&self) -> usize;
}

/// Makes the preconditioner of the flow in the middle of a slab; the order of elimination is found anew unless one is given.
pub fn low_order<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    (dt, damping): (f64, f64),
    ordering: Option<Ordering>,
) -> Box<dyn LowOrderPreconditioner> {
    if M <= 4 {
        Box::new(NodeIlu::<D, M, 4>::new(operator, dt, damping, ordering))
    } else {
        Box::new(NodeIlu::<D, M, 8>::new(operator, dt, damping, ordering))
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
    fn new(operator: &SlabOperator<D, M>, dt: f64, damping: f64, ordering: Option<Ordering>) -> Self {
        let (layout, modes) = (operator.layout, TemporalModes::new(&operator.tables.time));
        let matrix = NodeBlocks::new(operator, dt);
        let ordering = ordering.filter(|ordering| ordering.own().count() == layout.cells);
        let alone = operator.share.without_cuts();
        let ordering =
            ordering.map(|known| Ordering::of_own(&known.own().collect::<Vec<_>>(), known.level_ends, &alone));
        let ordering = ordering.unwrap_or_else(|| matrix.ordering(modes.mean_shift()));
        let walk = Walk::new(&matrix, ordering);
        let factor = Factor::empty(layout.cells, &modes);
        let iteration = Iteration::new(layout, &operator.share);
        let mut preconditioner = NodeIlu { modes, matrix, walk, factor, iteration };
        preconditioner.factor(dt, damping);
        preconditioner
    }
}

impl<const D: usize, const M: usize, const W: usize> LowOrderPreconditioner for NodeIlu<D, M, W> {
    fn factor(&mut self, dt: f64, damping: f64) {
        let shifts: Vec<c64> = self.modes.eigenvalues.iter().map(|lambda| lambda + damping).collect();
        self.factor.compute::<D, M, W>(&self.matrix, &self.walk, self.matrix.ratio(dt), shifts);
    }

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

    fn ordering(&self) -> &Ordering {
        &self.walk.ordering
    }

    fn bytes(&self) -> usize {
        self.matrix.bytes() + self.factor.bytes()
    }
}
