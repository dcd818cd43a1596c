//! Block ILU(0) with a coarse level, for steady flows.

use super::coarse::CoarseLevel;
use super::ilu::BlockIlu;
use super::ordering::Ordering;
use super::{FactoredModes, FlowPreconditioner, TimeScales};
use fem::SlabOperator;
use newton_krylov::operator::Preconditioner;

/// Block ILU(0), with a coarse level as soon as pseudo-time does not damp the flow.
///
/// As long as it does, the sweeps work alone. With exact solves Newton's method can then converge to spurious solutions; loose ones keep to
/// the path of the flow in time.
///
/// The Jacobian is in double precision, for the coarse level: in it large entries cancel.
pub struct TwoLevel {
    sweeps: BlockIlu<f64>,
    coarse: Option<CoarseLevel>,
}

impl TwoLevel {
    /// The preconditioner of the Jacobian of `operator` in the middle of its slab.
    pub fn new<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        scales: TimeScales,
        ordering: Option<Ordering>,
    ) -> Self {
        let mut levels = TwoLevel { sweeps: BlockIlu::new(operator, scales, ordering), coarse: None };
        if scales.damping == 0.0 {
            levels.update_both(operator, scales);
        }
        levels
    }

    /// Both levels; the sweeps alone where the coarse matrix is singular, or too large.
    fn update_both<const D: usize, const M: usize>(&mut self, operator: &SlabOperator<D, M>, scales: TimeScales) {
        let (old, order) = (self.coarse.take(), operator.tables.orders.flow);
        self.coarse = self.sweeps.update_beside(operator, scales, |sweeps| match old {
            Some(coarse) => coarse.updated(sweeps),
            None => CoarseLevel::new(sweeps, order).ok().flatten(),
        });
    }
}

impl<const D: usize, const M: usize> FlowPreconditioner<D, M> for TwoLevel {
    fn updated(
        mut self: Box<Self>,
        flow: &SlabOperator<D, M>,
        scales: TimeScales,
    ) -> Box<dyn FlowPreconditioner<D, M>> {
        if scales.damping == 0.0 {
            self.update_both(flow, scales);
        } else {
            self.coarse = None;
            self.sweeps.update(flow, scales);
        }
        self
    }
}

impl Preconditioner for TwoLevel {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        match &mut self.coarse {
            Some(coarse) => coarse.apply(&mut self.sweeps, r, z),
            None => self.sweeps.apply(r, z),
        }
    }
}

impl FactoredModes for TwoLevel {
    fn factor(&mut self, scales: TimeScales) {
        self.sweeps.factor(scales);
    }
    fn ordering(&self) -> Ordering {
        self.sweeps.ordering()
    }
    fn bytes(&self) -> usize {
        self.sweeps.bytes() + self.coarse.as_ref().map_or(0, CoarseLevel::bytes)
    }
}
