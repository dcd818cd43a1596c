//! When the flow's Jacobian is frozen, and when its preconditioner is factored anew.
//!
//! One Jacobian serves many slabs: it is frozen where none is there or where the iterations have grown too much since. In between,
//! another slab length or pseudo-time needs new factors of its modes only.

use crate::preconditioner::{
    BlockIlu, CoarseLevelUse, FlowPreconditioner, LinePreconditioner, Ordering, TimeScales, TwoLevel, low_order,
};
use crate::reuse_policy::{FREEZING, RebuiltInSlab};
use fem::{Bottom, SlabOperator};
use std::sync::Arc;

/// A slab length, or a damping, that differs by this part needs new factors.
const CHANGED: f64 = 0.1;

/// Iterations of a slab with its own Jacobian from which a coarse level saves more of them than it costs, on meshes of more cells than
/// there are aggregates.
const MANY_ITERATIONS: usize = 15;

/// Where the flow's Jacobian was frozen: what the preconditioner is made of, so that a resumed run has the same one.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// The start of the slab, and its length.
    pub start: f64,
    /// See `start`.
    pub dt: f64,
    /// Displacement at its bottom.
    pub bottom: Vec<f64>,
    /// Mesh velocities.
    pub velocities: Vec<f64>,
    /// The flow. A checkpoint shares it.
    pub state: Arc<Vec<f64>>,
    /// The times for which the modes are factored now.
    pub built_for: TimeScales,
    /// The order of elimination.
    pub ordering: Ordering,
    /// Whether there is a coarse level.
    pub coarse_level: bool,
}

/// What an update has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Update {
    /// The factors are those from before.
    Kept,
    /// The modes were factored anew.
    Refactored,
    /// The Jacobian was frozen anew.
    Rebuilt,
}

/// The preconditioners of the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Block ILU(0), cells with all their unknowns as blocks: for slabs and flows of any kind.
    BlockIlu,
    /// [`LinePreconditioner`], for short slabs. Steady flows take blocks all the same.
    LineAdi,
    /// [`low_order`]: memory per unknown does not depend on the order.
    LowOrder,
}

/// The preconditioner of the flow and what it is made of.
pub struct LaggedPreconditioner<const D: usize, const M: usize> {
    /// Set to have the Jacobian frozen at the next update.
    pub stale: bool,
    /// What kind of preconditioner is made next.
    pub method: Method,
    /// Whether the flow is steady: its Jacobian is frozen at every update that damps, and else where it has served for as many iterations
    /// as it has cost. It has a coarse level then.
    pub steady: bool,
    /// Whether what is made next has a coarse level, where blocks precondition slabs.
    coarse_level: bool,
    /// When more iterations than these are done in a slab, the Jacobian is frozen at the next update.
    pub patience: usize,
    /// Times the preconditioner was applied since the Jacobian was frozen, or since the bottom of the slab.
    applications: usize,
    in_slab: RebuiltInSlab,
    preconditioner: Option<Box<dyn FlowPreconditioner<D, M>>>,
    frozen: Option<Linearisation>,
}

impl<const D: usize, const M: usize> Default for LaggedPreconditioner<D, M> {
    /// Nothing is frozen yet.
    fn default() -> Self {
        LaggedPreconditioner {
            stale: false,
            method: Method::BlockIlu,
            steady: false,
            coarse_level: false,
            patience: usize::MAX,
            applications: 0,
            in_slab: RebuiltInSlab::No,
            preconditioner: None,
            frozen: None,
        }
    }
}

impl<const D: usize, const M: usize> LaggedPreconditioner<D, M> {
    /// Counts applications from here, the bottom of a slab.
    pub fn begin_slab(&mut self) {
        self.applications = 0;
        self.in_slab = RebuiltInSlab::No;
    }

    /// Krylov iterations since the Jacobian was frozen, or since the bottom of the slab.
    pub fn iterations_since_frozen(&self) -> usize {
        self.applications
    }

    /// Whether the Jacobian was frozen in this slab.
    pub fn frozen_in_slab(&self) -> RebuiltInSlab {
        self.in_slab
    }

    /// Takes a coarse level if a slab of the flow of `operator` takes `iterations` with a Jacobian of its own. Whether it does so is seen in
    /// the next slab.
    pub fn reconsider_coarse_level(&mut self, operator: &SlabOperator<D, M>, iterations: usize) {
        let most = CoarseLevelUse::Always.most_aggregates(M, D as u32, operator.tables.orders.flow);
        let large = operator.share.whole_cells() > most;
        if !self.coarse_level && self.method == Method::BlockIlu && large && iterations > MANY_ITERATIONS {
            self.coarse_level = true;
            self.preconditioner = None;
            self.stale = true;
        }
    }

    /// z = P^{-1} r; r itself as long as there is no preconditioner.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.applications += 1;
        match &mut self.preconditioner {
            Some(preconditioner) => preconditioner.apply(r, z),
            None => z.copy_from_slice(r),
        }
    }

    /// Bytes held by the preconditioner.
    pub fn bytes(&self) -> usize {
        self.preconditioner.as_ref().map_or(0, |preconditioner| preconditioner.bytes())
    }

    /// What the preconditioner is made of.
    pub fn frozen(&self) -> Option<&Linearisation> {
        self.frozen.as_ref()
    }

    /// Freezes, refactors or keeps the Jacobian of `flow`, linearised in a slab with displacement `bottom` and mesh `velocities`, with
    /// pseudo-time of `rate` = 1/dtau.
    pub fn update(&mut self, flow: &SlabOperator<D, M>, bottom: &[f64], velocities: &[f64], rate: f64) -> Update {
        self.stale |= self.applications > self.patience || self.steady && self.has_served(rate);
        let (_, dt) = flow.interval();
        let scales = TimeScales { dt, damping: dt * rate };
        match (&mut self.preconditioner, &mut self.frozen) {
            (Some(preconditioner), Some(frozen)) if !self.stale => {
                if !differ(frozen.built_for, scales) {
                    return Update::Kept;
                }
                preconditioner.factor(scales);
                frozen.built_for = scales;
                Update::Refactored
            }
            _ => {
                self.freeze(flow, bottom, velocities, scales);
                Update::Rebuilt
            }
        }
    }

    /// Whether the Jacobian of a steady flow, damped by `rate`, has paid for itself, or was damped.
    fn has_served(&self, rate: f64) -> bool {
        let damped = rate > 0.0 || self.frozen.as_ref().is_some_and(|frozen| frozen.built_for.damping > 0.0);
        damped || self.applications >= FREEZING
    }

    /// Freezes the flow's Jacobian here, with the order of elimination of the first time.
    fn freeze(&mut self, flow: &SlabOperator<D, M>, bottom: &[f64], velocities: &[f64], scales: TimeScales) {
        let known = self.frozen.take().map(|frozen| frozen.ordering);
        let preconditioner = match self.preconditioner.take() {
            Some(old) => old.updated(flow, scales),
            None => self.made(flow, scales, known),
        };
        let (start, dt) = flow.interval();
        self.frozen = Some(Linearisation {
            start,
            dt,
            bottom: bottom.to_vec(),
            velocities: velocities.to_vec(),
            state: Arc::new(flow.linearisation()),
            built_for: scales,
            ordering: preconditioner.ordering(),
            coarse_level: self.coarse_level,
        });
        self.preconditioner = Some(preconditioner);
        let first = self.applications == 0 && self.in_slab == RebuiltInSlab::No;
        self.in_slab = if first { RebuiltInSlab::AtFirst } else { RebuiltInSlab::Later };
        self.applications = 0;
        self.stale = false;
    }

    /// Makes the preconditioner again from what it was made of. The slab, the mesh and the linearisation of `flow` are then those of
    /// `frozen`.
    pub fn rebuild(&mut self, flow: &mut SlabOperator<D, M>, frozen: Linearisation) {
        let Linearisation { start, dt, .. } = frozen;
        let nothing = vec![0.0; flow.layout.at_one_time().len()];
        flow.begin_slab(start, dt, Bottom::new(&nothing, &frozen.bottom));
        flow.set_mesh(&frozen.velocities);
        flow.linearise(&frozen.state);
        // One that is there may have another order of elimination.
        self.preconditioner = None;
        self.coarse_level = frozen.coarse_level;
        self.preconditioner = Some(self.made(flow, frozen.built_for, Some(frozen.ordering.clone())));
        self.frozen = Some(frozen);
    }

    /// A new preconditioner of the Jacobian of `flow`, with the order of elimination that is `known`.
    fn made(
        &self,
        flow: &SlabOperator<D, M>,
        scales: TimeScales,
        known: Option<Ordering>,
    ) -> Box<dyn FlowPreconditioner<D, M>> {
        match self.method {
            Method::LowOrder => low_order(flow, scales, known),
            _ if self.steady => Box::new(TwoLevel::<f64>::new(flow, scales, known, CoarseLevelUse::Undamped)),
            Method::LineAdi => Box::new(LinePreconditioner::new(flow, scales)),
            Method::BlockIlu if self.coarse_level => {
                Box::new(TwoLevel::<f32>::new(flow, scales, known, CoarseLevelUse::Always))
            }
            Method::BlockIlu => Box::new(BlockIlu::<f32>::new(flow, scales, known)),
        }
    }
}

/// Whether a length or a damping has changed so much that new factors are needed.
fn differ(old: TimeScales, new: TimeScales) -> bool {
    let change = |old: f64, new: f64| (old - new).abs() > CHANGED * old.abs().max(new.abs());
    change(old.dt, new.dt) || change(old.damping, new.damping)
}
