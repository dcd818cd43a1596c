//! When the flow's Jacobian is frozen, and when its preconditioner is factored anew.
//!
//! One Jacobian serves many slabs: it is frozen where none is there or where the iterations have grown too much since. In between,
//! another slab length or pseudo-time needs new factors of its modes only.

use crate::preconditioner::{
    CoarseLevel, FlowPreconditioner, LinePreconditioner, LowOrderPreconditioner, Ordering, low_order,
};
use crate::reuse_policy::{FREEZING, RebuiltInSlab};
use basis::TemporalModes;
use fem::{Bottom, SlabOperator};

/// A slab length, or a damping, that differs by this part needs new factors.
const CHANGED: f64 = 0.1;

/// Where the flow's Jacobian was frozen: what the preconditioner is made of, so that a resumed run has the same one.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearisation {
    /// Start and length of the slab.
    pub interval: (f64, f64),
    /// Displacement at its bottom.
    pub bottom: Vec<f64>,
    /// Mesh velocities.
    pub velocities: Vec<f64>,
    /// The flow.
    pub state: Vec<f64>,
    /// Slab length and damping for which the modes are factored now.
    pub built_for: (f64, f64),
    /// The order of elimination.
    pub ordering: Ordering,
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
    /// [`LowOrderPreconditioner`]: memory per unknown does not depend on the order.
    LowOrder,
}

enum Preconditioner {
    BlockIlu(Box<FlowPreconditioner>, Option<Box<CoarseLevel>>),
    LineAdi(Box<LinePreconditioner>),
    LowOrder(Box<dyn LowOrderPreconditioner>),
}

/// The preconditioner of the flow and what it is made of.
pub struct LaggedPreconditioner {
    /// Set to have the Jacobian frozen at the next update.
    pub stale: bool,
    /// What kind of preconditioner is made next.
    pub method: Method,
    /// Whether the flow is steady: its Jacobian is frozen at every update that damps, and else where it has served for as many iterations
    /// as it has cost. It has a coarse level then.
    pub steady: bool,
    /// When more iterations than these are done in a slab, the Jacobian is frozen at the next update.
    pub patience: usize,
    /// Times the preconditioner was applied since the Jacobian was frozen, or since the bottom of the slab.
    applications: usize,
    in_slab: RebuiltInSlab,
    preconditioner: Option<Preconditioner>,
    frozen: Option<Linearisation>,
}

impl Default for LaggedPreconditioner {
    /// Nothing is frozen yet.
    fn default() -> Self {
        LaggedPreconditioner {
            stale: false,
            method: Method::BlockIlu,
            steady: false,
            patience: usize::MAX,
            applications: 0,
            in_slab: RebuiltInSlab::No,
            preconditioner: None,
            frozen: None,
        }
    }
}

impl LaggedPreconditioner {
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

    /// z = P^{-1} r; r itself as long as there is no preconditioner.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.applications += 1;
        match &mut self.preconditioner {
            Some(Preconditioner::BlockIlu(sweeps, Some(coarse))) => coarse.apply(sweeps, r, z),
            Some(Preconditioner::BlockIlu(sweeps, None)) => sweeps.apply(r, z),
            Some(Preconditioner::LineAdi(lines)) => lines.apply(r, z),
            Some(Preconditioner::LowOrder(nodes)) => nodes.apply(r, z),
            None => z.copy_from_slice(r),
        }
    }

    /// Bytes held by the preconditioner.
    pub fn bytes(&self) -> usize {
        match &self.preconditioner {
            Some(Preconditioner::BlockIlu(sweeps, _)) => sweeps.bytes(),
            Some(Preconditioner::LineAdi(lines)) => lines.bytes(),
            Some(Preconditioner::LowOrder(nodes)) => nodes.bytes(),
            None => 0,
        }
    }

    /// What the preconditioner is made of.
    pub fn frozen(&self) -> Option<&Linearisation> {
        self.frozen.as_ref()
    }

    /// Freezes, refactors or keeps the Jacobian of `flow`, linearised in a slab with displacement `bottom` and mesh `velocities`, with
    /// pseudo-time of `rate` = 1/dtau.
    pub fn update<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        bottom: &[f64],
        velocities: &[f64],
        rate: f64,
    ) -> Update {
        self.stale |= self.applications > self.patience || self.steady && self.has_served(rate);
        let (_, dt) = flow.interval();
        let built_for = (dt, dt * rate);
        let change = |old: f64, new: f64| (old - new).abs() > CHANGED * old.abs().max(new.abs());
        match (&mut self.preconditioner, &mut self.frozen) {
            (Some(preconditioner), Some(frozen)) if !self.stale => {
                if !change(frozen.built_for.0, built_for.0) && !change(frozen.built_for.1, built_for.1) {
                    return Update::Kept;
                }
                match preconditioner {
                    Preconditioner::BlockIlu(sweeps, _) => sweeps.factor(built_for.0, built_for.1),
                    Preconditioner::LineAdi(lines) => lines.factor(built_for.0, built_for.1),
                    Preconditioner::LowOrder(nodes) => nodes.factor(built_for.0, built_for.1),
                }
                frozen.built_for = built_for;
                Update::Refactored
            }
            _ => {
                self.freeze(flow, bottom, velocities, built_for);
                Update::Rebuilt
            }
        }
    }

    /// Whether the Jacobian of a steady flow, damped by `rate`, has paid for itself, or was damped.
    fn has_served(&self, rate: f64) -> bool {
        let damped = rate > 0.0 || self.frozen.as_ref().is_some_and(|frozen| frozen.built_for.1 > 0.0);
        damped || self.applications >= FREEZING
    }

    /// Freezes the flow's Jacobian here, with the order of elimination of the first time.
    fn freeze<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        bottom: &[f64],
        velocities: &[f64],
        built_for: (f64, f64),
    ) {
        let ordering = self.frozen.take().map(|frozen| frozen.ordering);
        let ordering = self.build(flow, built_for, ordering);
        self.frozen = Some(Linearisation {
            interval: flow.interval(),
            bottom: bottom.to_vec(),
            velocities: velocities.to_vec(),
            state: flow.linearisation(),
            built_for,
            ordering,
        });
        let first = self.applications == 0 && self.in_slab == RebuiltInSlab::No;
        self.in_slab = if first { RebuiltInSlab::AtFirst } else { RebuiltInSlab::Later };
        self.applications = 0;
        self.stale = false;
    }

    /// Makes the preconditioner again from what it was made of. The slab, the mesh and the linearisation of `flow` are then those of
    /// `frozen`.
    pub fn rebuild<const D: usize, const M: usize>(&mut self, flow: &mut SlabOperator<D, M>, frozen: Linearisation) {
        let (start, dt) = frozen.interval;
        let nothing = vec![0.0; flow.layout.at_one_time().len()];
        flow.begin_slab(start, dt, Bottom::new(&nothing, &frozen.bottom));
        flow.set_mesh(&frozen.velocities);
        flow.linearise(&frozen.state);
        // One that is there may have another order of elimination.
        self.preconditioner = None;
        self.build(flow, frozen.built_for, Some(frozen.ordering.clone()));
        self.frozen = Some(frozen);
    }

    /// Makes the preconditioner of the Jacobian of `flow`; returns its order of elimination, which lines have not.
    fn build<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        built_for: (f64, f64),
        ordering: Option<Ordering>,
    ) -> Ordering {
        if self.method == Method::LineAdi && !self.steady {
            self.preconditioner = Some(Preconditioner::LineAdi(lines(self.preconditioner.take(), flow, built_for)));
            return Ordering::none();
        }
        if self.method == Method::LowOrder {
            // The old one gives its memory back before the new one is made.
            self.preconditioner = None;
            let nodes = low_order(flow, built_for, ordering);
            let ordering = nodes.ordering().clone();
            self.preconditioner = Some(Preconditioner::LowOrder(nodes));
            return ordering;
        }
        let (sweeps, coarse) = self.blocks(flow, built_for, ordering);
        let ordering = sweeps.ordering().clone();
        self.preconditioner = Some(Preconditioner::BlockIlu(sweeps, coarse));
        ordering
    }

    fn blocks<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        (dt, damping): (f64, f64),
        ordering: Option<Ordering>,
    ) -> (Box<FlowPreconditioner>, Option<Box<CoarseLevel>>) {
        let (mut sweeps, old) = match self.preconditioner.take() {
            Some(Preconditioner::BlockIlu(mut old, coarse)) => {
                old.replace_jacobian(|jacobian| flow.update_space_jacobian(0.5, jacobian));
                (old, coarse)
            }
            _ => {
                let modes = TemporalModes::new(&flow.tables.time);
                let ordering = ordering.filter(|ordering| ordering.own().count() == flow.layout.cells);
                let jacobian = flow.space_jacobian(0.5);
                (
                    Box::new(FlowPreconditioner::unfactored(
                        flow.layout,
                        modes,
                        jacobian,
                        dt,
                        (ordering, flow.share.clone()),
                    )),
                    None,
                )
            }
        };
        // As long as pseudo-time damps the sweeps do alone, and loose solves keep to the path of the flow in time: exact ones were seen to
        // lead to a solution of the discrete equations that no flow has.
        if !self.steady || damping != 0.0 {
            sweeps.factor(dt, damping);
            return (sweeps, None);
        }
        let coarse = sweeps.factor_beside(dt, damping, |sweeps| coarse_level(old.map(|old| *old), sweeps, flow));
        (sweeps, coarse.map(Box::new))
    }
}

/// The preconditioner by lines, in the memory of an old one if it is such.
fn lines<const D: usize, const M: usize>(
    old: Option<Preconditioner>,
    flow: &SlabOperator<D, M>,
    (dt, damping): (f64, f64),
) -> Box<LinePreconditioner> {
    let jacobian = flow.line_jacobian(0.5);
    match old {
        Some(Preconditioner::LineAdi(mut lines)) => {
            lines.replace_jacobian(jacobian);
            lines.factor(dt, damping);
            lines
        }
        _ => {
            let modes = TemporalModes::new(&flow.tables.time);
            Box::new(LinePreconditioner::new((flow.layout, flow.share.clone()), modes, jacobian, dt, damping))
        }
    }
}

/// The coarse level of an undamped steady flow, in the memory of an `old` one; None where its matrix is singular, or too large.
fn coarse_level<const D: usize, const M: usize>(
    old: Option<CoarseLevel>,
    sweeps: &FlowPreconditioner,
    flow: &SlabOperator<D, M>,
) -> Option<CoarseLevel> {
    match old {
        Some(coarse) => coarse.updated(sweeps),
        None => CoarseLevel::new(sweeps, flow.layout, flow.tables.orders.flow).ok().flatten(),
    }
}
