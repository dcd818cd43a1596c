//! Block ILU(0) with a coarse level: for steady flows, and for long slabs of large meshes.

use super::aggregates::functions_per_direction;
use super::coarse::CoarseLevel;
use super::coarse_modes::Entry;
use super::ilu::BlockIlu;
use super::ordering::Ordering;
use super::{FactoredModes, FlowPreconditioner, TimeScales};
use fem::SlabOperator;
use newton_krylov::operator::Preconditioner;

/// When there is a coarse level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoarseLevelUse {
    /// As soon as pseudo-time does not damp the flow: in the search for a steady flow. With exact solves Newton's method can converge to
    /// spurious solutions; loose ones keep to the path of the flow in time.
    Undamped,
    /// Always: in slabs.
    Always,
}

impl CoarseLevelUse {
    /// Whether there is one at these scales.
    pub fn serves(self, scales: TimeScales) -> bool {
        self == CoarseLevelUse::Always || scales.damping == 0.0
    }

    /// Coarse unknowns for which the direct solver pays. The work of a slab grows with their number in every iteration, that of a steady flow
    /// falls more; and in three dimensions factors fill more.
    fn affordable(self, dimension: u32) -> usize {
        if self == CoarseLevelUse::Undamped && dimension == 2 { 60_000 } else { 16_000 }
    }

    /// The most aggregates of a flow of so many `components` and this `order`.
    pub fn most_aggregates(self, components: usize, dimension: u32, order: usize) -> usize {
        self.affordable(dimension) / (components * functions_per_direction(order).pow(dimension))
    }
}

/// Block ILU(0) with a coarse level. The sweeps work alone where a coarse matrix is singular, or the memory does not suffice to order it.
///
/// For steady flows the Jacobian is in double precision: without a time step, large entries cancel in the coarse matrix.
pub struct TwoLevel<T: Entry> {
    sweeps: BlockIlu<T>,
    coarse: Option<CoarseLevel<T>>,
    when: CoarseLevelUse,
    /// The most aggregates.
    most: usize,
}

impl<T: Entry> TwoLevel<T> {
    /// The preconditioner of the Jacobian of `operator` in the middle of its slab.
    pub fn new<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        scales: TimeScales,
        ordering: Option<Ordering>,
        when: CoarseLevelUse,
    ) -> Self {
        let most = when.most_aggregates(M, D as u32, operator.tables.orders.flow);
        Self::with_aggregates(operator, scales, ordering, (when, most))
    }

    /// The same with at most `most` aggregates of cells, if pairing gets there.
    pub fn with_aggregates<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        scales: TimeScales,
        ordering: Option<Ordering>,
        (when, most): (CoarseLevelUse, usize),
    ) -> Self {
        let mut sweeps = BlockIlu::unfactored(operator, scales.dt, ordering);
        let new = |sweeps: &BlockIlu<T>| CoarseLevel::new(operator, sweeps, scales.damping, most);
        let coarse = sweeps.factor_beside(scales, |sweeps| if when.serves(scales) { new(sweeps) } else { None });
        TwoLevel { sweeps, coarse, when, most }
    }
}

impl<const D: usize, const M: usize, T: Entry + 'static> FlowPreconditioner<D, M> for TwoLevel<T> {
    fn updated(
        mut self: Box<Self>,
        flow: &SlabOperator<D, M>,
        scales: TimeScales,
    ) -> Box<dyn FlowPreconditioner<D, M>> {
        let (when, most) = (self.when, self.most);
        // A resumed run has nothing but the new Jacobian, so its aggregates follow from that.
        self.coarse = None;
        self.coarse = self.sweeps.update_beside(flow, scales, |sweeps| {
            if when.serves(scales) { CoarseLevel::new(flow, sweeps, scales.damping, most) } else { None }
        });
        self
    }
}

impl<T: Entry> Preconditioner for TwoLevel<T> {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let TwoLevel { sweeps, coarse, .. } = self;
        match coarse {
            Some(coarse) => {
                let scale = sweeps.apply_to(r, z, |sweeps, scale| coarse.solve(sweeps, r, scale));
                coarse.add_prolonged(&sweeps.modes, scale, z);
            }
            None => sweeps.apply(r, z),
        }
    }
}

impl<T: Entry> FactoredModes for TwoLevel<T> {
    fn factor(&mut self, scales: TimeScales) {
        let old = self.coarse.take();
        self.coarse = self.sweeps.factor_beside(scales, |sweeps| old?.updated(sweeps, scales.damping));
    }
    fn ordering(&self) -> Ordering {
        self.sweeps.ordering()
    }
    fn bytes(&self) -> usize {
        self.sweeps.bytes() + self.coarse.as_ref().map_or(0, CoarseLevel::bytes)
    }
}
