//! The march of the mesh alone.

use crate::march::{MarchError, SlabError, chain};
use crate::mesh_mover::{MeshMover, MeshQuality};
use crate::schedule::Schedule;
use crate::state::{Interval, Past, State};
use elasticity::Work;

/// What a slab of the mesh alone has done.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// How often an attempt was rejected before.
    pub rejected: usize,
    /// What its equilibrium has cost.
    pub work: Work,
    /// The quality of the mesh.
    pub quality: MeshQuality,
    /// The first time at which a cell is not proved to be valid, if there is one.
    pub first_invalid: Option<f64>,
    /// The first time at which det J <= 0 at a sampled point, if there is one, see [`MeshMover::first_invalid_sampled`].
    pub first_invalid_sampled: Option<f64>,
}

/// A mesh that moves without a flow. With a linear law it goes on when cells are inverted: that law does not notice.
pub struct MeshMarch<const D: usize> {
    /// The mesh.
    pub mover: MeshMover<D>,
    /// Where the run stands; the flow is empty.
    pub state: State,
    schedule: Schedule,
    max_halvings: u32,
}

/// A slab that is solved: what its equilibrium has cost, and its velocities.
struct Solved {
    work: Work,
    v: Vec<f64>,
}

impl<const D: usize> MeshMarch<D> {
    /// A march through the slabs of `schedule`, at its fixed step: there is no flow to adapt it to. A slab that cannot be solved is
    /// halved, at most `max_halvings` times.
    pub fn new(mover: MeshMover<D>, schedule: Schedule, max_halvings: u32) -> Self {
        let state = State::new(schedule.start, Vec::new(), mover.displacement_at_start(schedule.start));
        MeshMarch { mover, state, schedule: Schedule { control: None, ..schedule }, max_halvings }
    }

    /// Whether the end is reached.
    pub fn is_done(&self) -> bool {
        self.schedule.is_done(&self.state)
    }

    /// Advances one slab, a shorter one if need be.
    ///
    /// # Errors
    /// [`MarchError`]; the state is then that of the last slab that succeeded.
    pub fn advance(&mut self) -> Result<MeshReport, MarchError> {
        let mut rejected = 0;
        loop {
            let interval = self.schedule.pending(&mut self.state);
            match self.attempt(interval) {
                Ok(solved) => return Ok(self.accept(interval, rejected, solved)),
                Err(source) => {
                    let cause = chain(&source);
                    if !self.schedule.shorten(&mut self.state, interval, self.max_halvings) {
                        return Err(MarchError::new(&self.state, interval, source));
                    }
                    tracing::warn!(start = interval.start, end = interval.end, cause, "slab rejected, halving it");
                }
            }
            rejected += 1;
        }
    }

    /// Puts the mesh into equilibrium with its boundary in one slab.
    fn attempt(&mut self, interval: Interval) -> Result<Solved, SlabError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let (dt, bottom) = (interval.end - interval.start, &self.state.d);
        self.mover.begin_slab(bottom)?;
        let time = self.mover.slab_motion.time();
        let mut g = vec![0.0; self.mover.field_len() * time.order()];
        self.mover.prescribed_in_slab(interval.start, dt, &mut g);
        let mut v = self.state.extrapolated_velocities(time, self.mover.field_len(), dt);
        let work = self.mover.velocities(interval, bottom, &g, &mut v)?;
        Ok(Solved { work, v })
    }

    /// Moves the state to the top of the slab.
    fn accept(&mut self, interval: Interval, rejected: usize, Solved { work, v }: Solved) -> MeshReport {
        let (dt, bottom) = (interval.end - interval.start, self.state.d.clone());
        let quality = self.mover.quality(&bottom, &v, interval);
        let (mut first_invalid, mut first_invalid_sampled) = (None, None);
        if !quality.is_valid() {
            first_invalid = self.mover.first_invalid(&bottom, &v, interval);
            first_invalid_sampled = self.mover.first_invalid_sampled(&bottom, &v, interval);
        }
        self.mover.slab_motion.displacement(dt, &bottom, &v, 1.0, &mut self.state.d);
        self.state.past = Some(Past { interval, dt, bottom, u: Vec::new(), v });
        self.state.finish(interval);
        MeshReport { slab: self.state.slab, interval, rejected, work, quality, first_invalid, first_invalid_sampled }
    }
}
