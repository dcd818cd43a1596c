//! The state of a run: all that the next slab depends on.

use crate::reuse_policy::JacobianReusePolicy;
use crate::start_layer::EasedStart;
use basis::RadauTime;
use std::sync::Arc;

/// A slab, or a part of one that was halved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Time at the bottom.
    pub start: f64,
    /// Time at the top.
    pub end: f64,
    /// How often the slab was halved to get here.
    pub halvings: u32,
}

/// The shortest part of a slab, in units of the round-off of its times.
const SHORTEST: f64 = 16.0 * f64::EPSILON;

impl Interval {
    /// dt
    pub fn length(&self) -> f64 {
        self.end - self.start
    }

    /// How often it can be halved before its length drowns in the round-off of the time.
    pub(crate) fn possible_halvings(&self) -> u32 {
        let shortest = SHORTEST * self.start.abs().max(self.end.abs());
        (self.length() / shortest).log2().floor() as u32
    }
}

/// The slab before: its polynomials are extended to guess the next one. An observer of the run may keep the flow and the velocities: they
/// are shared and never change.
#[derive(Clone, Debug, PartialEq)]
pub struct Past {
    /// Its interval.
    pub interval: Interval,
    /// Its length.
    pub dt: f64,
    /// Displacement at its bottom, `[C0 node][component]`.
    pub bottom: Vec<f64>,
    /// Its flow, laid out over the slab.
    pub u: Arc<Vec<f64>>,
    /// Its mesh velocities, `[time node][C0 node][component]`.
    pub v: Arc<Vec<f64>>,
    /// The unknowns of every body.
    pub bodies: Vec<Vec<f64>>,
}

/// The state of a run between two slabs.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Slabs done, parts of halved ones included.
    pub slab: usize,
    /// Slabs of the schedule done: all parts of a halved slab count as one.
    pub nominal: usize,
    /// The time reached.
    pub time: f64,
    /// The flow at that time, laid out at one time.
    pub u: Vec<f64>,
    /// The displacement at that time, `[C0 node][component]`.
    pub d: Vec<f64>,
    /// J at the nodes of the flow, `[cell][node]`, if the quadrature of the flow carries it from slab to slab, see [`fem::Bottom`].
    /// Otherwise empty.
    pub determinants: Vec<f64>,
    /// The stored state of every body.
    pub bodies: Vec<Vec<f64>>,
    /// The slab before.
    pub past: Option<Past>,
    /// Parts of the current slab that remain, the next one last.
    pub pending: Vec<Interval>,
    /// The slab that could not be solved and is halved, until its end is reached.
    pub failed: Option<Interval>,
    /// Attempts at the next slab that were rejected.
    pub rejected: usize,
    /// What has made the first slab easier, until that is done.
    pub eased: Option<EasedStart>,
    /// The length of the next slab, if it is adapted.
    pub step: f64,
    /// Whether the boundary jumps at the bottom of the next slab: the shorter that is, the faster the boundary moves in it.
    pub boundary_jumps: bool,
    /// The age of the flow's frozen Jacobian.
    pub reuse_policy: JacobianReusePolicy,
}

impl State {
    /// The state at the start of a run.
    pub fn new(time: f64, u: Vec<f64>, d: Vec<f64>) -> Self {
        State {
            slab: 0,
            nominal: 0,
            time,
            u,
            d,
            determinants: Vec::new(),
            bodies: Vec::new(),
            past: None,
            pending: Vec::new(),
            failed: None,
            rejected: 0,
            eased: None,
            step: 0.0,
            boundary_jumps: false,
            reuse_policy: JacobianReusePolicy::default(),
        }
    }

    /// The mesh velocities of the slab before, extended to one of length `dt`; at rest in the first slab.
    pub fn extrapolated_velocities(&self, time: &RadauTime, field_len: usize, dt: f64) -> Vec<f64> {
        let mut v = vec![0.0; field_len * time.order()];
        if let Some(past) = &self.past {
            extend(time, dt / past.dt, &past.v, &mut v);
        }
        v
    }

    /// Sets the length of the next slab and drops pending parts.
    pub fn set_step(&mut self, step: f64) {
        self.pending.clear();
        self.step = step;
    }

    /// Replaces the next interval by its halves, and the first of them `times` - 1 times more.
    pub fn halve(&mut self, times: u32) {
        (0..times).for_each(|_| self.halve_once());
    }

    fn halve_once(&mut self) {
        if let Some(Interval { start, end, halvings }) = self.pending.pop() {
            let middle = start + 0.5 * (end - start);
            self.pending.push(Interval { start: middle, end, halvings: halvings + 1 });
            self.pending.push(Interval { start, end: middle, halvings: halvings + 1 });
        }
    }

    /// Records that `interval`, the next one, is done.
    pub fn finish(&mut self, interval: Interval) {
        self.pending.pop();
        self.slab += 1;
        self.rejected = 0;
        self.boundary_jumps = false;
        self.time = interval.end;
        self.failed = self.failed.filter(|failed| failed.end > self.time);
        if self.pending.is_empty() {
            self.nominal += 1;
        }
    }
}

/// Extrapolates the polynomials `past` of a slab, `[time node][..]`, to the time nodes of the next slab, which is `ratio` times as long.
pub(crate) fn extend(time: &RadauTime, ratio: f64, past: &[f64], out: &mut [f64]) {
    let length = out.len() / time.order();
    for (s, out) in time.nodes().iter().zip(out.chunks_exact_mut(length)) {
        out.fill(0.0);
        for (phi, past) in time.extrapolation(ratio, *s).iter().zip(past.chunks_exact(length)) {
            out.iter_mut().zip(past).for_each(|(out, past)| *out += phi * past);
        }
    }
}
