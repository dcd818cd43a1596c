//! Flow, mesh and bodies in equilibrium.
//!
//! ```text
//! dt_k = 2^k dt_0,   N_t = 1                                                                             (equilibrium)
//! ```
//!
//! The slabs of a march with one node in time (implicit Euler) become longer and longer, on data of one time. Inertia and jumps divide by dt,
//! so what is left in the end is the balance of the flow, of the stresses or springs of bodies, and of the loads between them. A short first
//! slab lets bodies start gently.
//!
//! Pressures act at all times of a slab, (pressure impulse), and stresses at its top. In a slab much longer than a period, the top
//! answers the bottom with a factor that depends on the pressure. Under a large one it is below -1: a body that is stable swings. Slabs
//! that are shorter again damp this.

use crate::block::{BodyState, Ledger};
use crate::coupled_slab::{FlowMarch, SlabReport};
use crate::schedule::StepControl;
use crate::slab_error::MarchError;
use crate::state::State;
use newton_krylov::inner_product::{Euclidean, InnerProduct, largest};

/// The longest slab, in units of the first one. The change from slab to slab then falls by about this factor.
const LONGEST: f64 = 1e5;

/// The least length of a slab that shows an equilibrium, in the same units. Heavy bodies hardly move in a short one.
const TELLING: f64 = 1e3;

/// The shortest slab, in the same units.
const SHORTEST: f64 = 1e-3;

/// Changes smaller than this count as if they were as large, in units of the reference state and of the reference length: they may be
/// rounding, as the lift of a symmetric body.
const SMALL: f64 = 1e-2;

/// A flow that changes by less is at rest also if its change rises again: inviscid gas at rest has modes that nothing damps.
const UNDAMPED: f64 = 1e-5;

/// The same holds if the change per time has fallen to this part of its largest value: such modes drift, in slabs that become longer.
const DRIFT: f64 = 1e-6;

/// This many rising changes in a row indicate such a mode.
const RISES: usize = 3;

/// Bodies swing if they go back by at least this part of their way, in so many slabs one after the other.
const SWINGS: (usize, f64) = (3, 0.5);

/// Slabs then become shorter by this factor.
const SHORTER: f64 = 8.0;

/// Slabs of the same longest length after which the search is given up.
const SLABS: usize = 80;

/// Flow and bodies that rest.
#[derive(Debug)]
pub struct Equilibrium<const M: usize> {
    /// The last slab, as one of length zero at the start.
    pub report: SlabReport<M>,
    /// Slabs.
    pub slabs: usize,
    /// Newton steps of all slabs.
    pub steps: usize,
    /// Krylov iterations of all slabs.
    pub iterations: usize,
}

/// Why there is no equilibrium.
#[derive(Debug, thiserror::Error)]
pub enum NoEquilibrium {
    /// A slab could not be solved.
    #[error(
        "no equilibrium of flow and bodies was found: slab {slab} of the search, {length:.3e} long, could not be solved"
    )]
    Slab {
        /// Its number, from 1.
        slab: usize,
        /// Its length.
        length: f64,
        /// Why.
        #[source]
        source: MarchError,
    },
    /// The caller wants no more slabs.
    #[error("the search for an equilibrium was stopped after {slabs} slabs")]
    Stopped {
        /// The slabs of the search.
        slabs: usize,
    },
    /// The state still changes.
    #[error(
        "flow and bodies do not come to rest: after {slabs} slabs the flow still changes by {flow:.1e} of its largest change, and the bodies move \
         by {bodies:.1e} of their way"
    )]
    Moves {
        /// The slabs of the search.
        slabs: usize,
        /// The jump of the flow, relative to the largest one.
        flow: f64,
        /// The largest change of a displacement in a slab, relative to the largest displacement.
        bodies: f64,
    },
}

/// Replaces the state of `march`, a run at its start with one node in time, by the equilibrium of flow, mesh and bodies on the data of that
/// time. It is found when the change from slab to slab has fallen by the factor `tolerance`. Bodies, of the size `length`, then rest, and their
/// energy balance begins anew. The search ends before a slab if `is_stopped`, which must give the same answer on all ranks.
///
/// # Errors
/// [`NoEquilibrium`]; the state is then that of the last slab.
pub fn find_equilibrium<const D: usize, const M: usize>(
    march: &mut FlowMarch<D, M>,
    (tolerance, length): (f64, f64),
    is_stopped: &dyn Fn() -> bool,
) -> Result<Equilibrium<M>, NoEquilibrium> {
    let start = march.state.time;
    march.solver.system.hold_time(start);
    (march.schedule.end, march.schedule.begins) = (f64::INFINITY, Vec::new());
    let mut lengths = Lengths::new(march);
    // The jump is an L2 norm over the domain.
    let system = &march.solver.system;
    let mut largest_jump = SMALL * (system.mover().reference.volume() / system.volume_scale).sqrt();
    let (mut slabs, mut steps, mut iterations) = (0, 0, 0);
    let mut changes = Changes { flow: f64::INFINITY, bodies: 1.0, rises: 0, rate: 0.0, fastest: 0.0 };
    while slabs < lengths.set_at + SLABS {
        if is_stopped() {
            return Err(NoEquilibrium::Stopped { slabs });
        }
        slabs += 1;
        let before = march.state.d.clone();
        let step = march.state.step;
        let report = march.advance().map_err(|source| NoEquilibrium::Slab { slab: slabs, length: step, source })?;
        steps += report.newton.steps.len();
        iterations += report.newton.krylov_iterations;
        largest_jump = largest_jump.max(report.jump);
        // A slab that could not be solved has been shortened.
        let solved = report.interval.length();
        changes.add(report.jump / largest_jump, travel(&before, &march.state.d, SMALL * length), solved);
        tracing::info!(slabs, length = solved, flow = changes.flow, bodies = changes.bodies, "equilibrium");
        if changes.are_rest(tolerance) && solved >= lengths.telling {
            return Ok(Equilibrium { report: at_rest(start, report, &mut march.state), slabs, steps, iterations });
        }
        lengths.adapt(march, &before, (slabs, solved, changes.bodies > tolerance));
    }
    Err(NoEquilibrium::Moves { slabs, flow: changes.flow, bodies: changes.bodies })
}

/// How long slabs are.
struct Lengths {
    /// The first slab.
    first: f64,
    /// The least length of a slab that shows an equilibrium.
    telling: f64,
    /// The number of slabs when the longest length was set.
    set_at: usize,
    way: Way,
}

impl Lengths {
    /// Slabs of `march` become longer, each by a factor.
    fn new<const D: usize, const M: usize>(march: &mut FlowMarch<D, M>) -> Self {
        let first = march.state.step;
        march.adapt(control(first, LONGEST * first));
        Lengths { first, telling: TELLING * first, set_at: 0, way: Way::default() }
    }

    /// Adds a slab of `march` on top of the displacement `before`, with its number, its length, and whether bodies move. Shortens the next ones
    /// if bodies swing.
    fn adapt<const D: usize, const M: usize>(
        &mut self,
        march: &mut FlowMarch<D, M>,
        before: &[f64],
        (number, length, moves): (usize, f64, bool),
    ) {
        let swings = self.way.swings(before, &march.state.d, moves);
        if !swings || length <= SHORTER * self.first {
            return;
        }
        let longest = length / SHORTER;
        march.adapt(control(self.first, longest));
        march.state.step = march.state.step.min(longest);
        // Bodies that swing are not too heavy to move.
        (self.telling, self.set_at, self.way) = (self.telling.min(longest), number, Way::default());
    }
}

/// Slabs of any length up to the `longest`.
fn control(first: f64, longest: f64) -> StepControl {
    StepControl { tolerance: f64::INFINITY, smallest: SHORTEST * first, largest: longest }
}

/// The way of the mesh in the last slab.
#[derive(Default)]
struct Way {
    last: Vec<f64>,
    /// How often in a row it went back.
    returns: usize,
}

impl Way {
    /// Adds a slab from the displacement `before` to `after`. Whether bodies swing. Those that do not move show rounding alone.
    fn swings(&mut self, before: &[f64], after: &[f64], moves: bool) -> bool {
        let (count, part) = SWINGS;
        let way: Vec<f64> = before.iter().zip(after).map(|(before, after)| after - before).collect();
        let back = -Euclidean.dot(&self.last, &way[..self.last.len()]);
        let returns = moves && back > 0.0 && back >= part * Euclidean.dot(&self.last, &self.last);
        (self.last, self.returns) = (way, if returns { self.returns + 1 } else { 0 });
        self.returns >= count
    }
}

/// The changes in the last slab, and what is needed of those before.
struct Changes {
    /// Of the flow.
    flow: f64,
    /// Of the bodies.
    bodies: f64,
    /// How often in a row the change of the flow has risen.
    rises: usize,
    /// The change of the flow per time, and its largest value so far.
    rate: f64,
    fastest: f64,
}

impl Changes {
    /// Adds a slab of some `length`.
    fn add(&mut self, flow: f64, bodies: f64, length: f64) {
        self.rises = if flow > self.flow { self.rises + 1 } else { 0 };
        (self.flow, self.bodies, self.rate) = (flow, bodies, flow / length);
        self.fastest = self.fastest.max(self.rate);
    }

    /// Whether flow and bodies rest, or only modes move that nothing damps.
    fn are_rest(&self, tolerance: f64) -> bool {
        let is_undamped = self.flow <= UNDAMPED || self.rate <= DRIFT * self.fastest;
        self.bodies <= tolerance && (self.flow <= tolerance || (self.rises >= RISES && is_undamped))
    }
}

/// The largest change of a displacement of the mesh in a slab, relative to the largest displacement, which is at least `least`. Coordinates of
/// bodies cannot be compared: some are lengths and some are angles.
fn travel(before: &[f64], after: &[f64], least: f64) -> f64 {
    let change = largest(before.iter().zip(after).map(|(old, new)| (new - old).abs()));
    change / largest(after.iter().map(|x| x.abs())).max(least)
}

/// Makes `state` one at the time `start`, where bodies rest and nothing has happened yet, and `report` that of a slab of length zero there.
fn at_rest<const M: usize>(start: f64, mut report: SlabReport<M>, state: &mut State) -> SlabReport<M> {
    for stored in &mut state.bodies {
        let coordinates = BodyState::coordinates(stored);
        stored[coordinates..].fill(0.0);
        debug_assert_eq!(stored.len(), 2 * coordinates + Ledger::LEN, "positions, rates, ledger");
    }
    let State { u, d, bodies, step, .. } = std::mem::replace(state, State::new(start, Vec::new(), Vec::new()));
    *state = State { bodies, step, ..State::new(start, u, d) };
    report.slab = 0;
    (report.interval.start, report.interval.end, report.jump) = (start, start, 0.0);
    report.fluxes.drain(..report.fluxes.len().saturating_sub(1));
    report.fluxes.iter_mut().for_each(|top| top.time = start);
    report
}
