//! The march of the mesh alone.

use crate::march::{March, SlabSolver};
use crate::mesh_mover::{MeshMover, MeshQuality};
use crate::schedule::Schedule;
use crate::slab_error::SlabError;
use crate::state::{Interval, Past, State};
use elasticity::Work;
use fem::Clock;
use std::sync::Arc;

/// The report of a slab of the mesh alone.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// How often an attempt was rejected before.
    pub rejected: usize,
    /// The cost of its equilibrium.
    pub work: Work,
    /// The quality of the mesh.
    pub quality: MeshQuality,
    /// The first time at which a cell is not proved to be valid, if there is one.
    pub first_invalid: Option<f64>,
    /// The first time at which det J <= 0 at a sampled point, if there is one, see [`MeshMover::first_invalid_sampled`].
    pub first_invalid_sampled: Option<f64>,
}

/// A mesh that moves without a flow.
pub struct MeshAlone<const D: usize> {
    /// The mesh.
    pub mover: MeshMover<D>,
}

/// A run of the mesh alone; the flow of its state is empty. A linear law also solves for meshes with inverted cells, so the run continues.
pub type MeshMarch<const D: usize> = March<MeshAlone<D>>;

/// A slab that is solved: the cost of its equilibrium, and its velocities.
pub struct Solved {
    work: Work,
    v: Vec<f64>,
}

impl<const D: usize> MeshMarch<D> {
    /// A march through the slabs of `schedule`, at its fixed step: only a flow can adapt it. A slab that cannot be solved is halved, at
    /// most `max_halvings` times.
    pub fn new(mover: MeshMover<D>, schedule: Schedule, max_halvings: u32) -> Self {
        let state = State::new(schedule.start, Vec::new(), mover.displacement_at_start(schedule.start));
        March::from(MeshAlone { mover }, state, Schedule { control: None, ..schedule }, max_halvings)
    }
}

impl<const D: usize> SlabSolver for MeshAlone<D> {
    type Solved = Solved;
    type Report = MeshReport;

    /// Puts the mesh into equilibrium with its boundary in one slab.
    fn solve(&mut self, state: &State, interval: Interval) -> Result<Solved, SlabError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let dt = interval.length();
        self.mover.begin_slab(&state.d)?;
        let time = self.mover.slab_motion.time();
        let mut g = vec![0.0; self.mover.field_len() * time.order()];
        self.mover.prescribed_in_slab(Clock::running(interval.start, dt), dt, &state.d, &mut g);
        let mut v = state.extrapolated_velocities(time, self.mover.field_len(), dt);
        let work = self.mover.velocities(interval, &state.d, &g, &mut v)?;
        Ok(Solved { work, v })
    }

    fn finish(&mut self, state: &mut State, interval: Interval, solved: Solved) -> MeshReport {
        let (Solved { work, v }, bottom) = (solved, state.d.clone());
        let dt = interval.length();
        let quality = self.mover.quality(&bottom, &v, interval);
        let (mut first_invalid, mut first_invalid_sampled) = (None, None);
        if !quality.is_valid() {
            first_invalid = self.mover.first_invalid(&bottom, &v, interval);
            first_invalid_sampled = self.mover.first_invalid_sampled(&bottom, &v, interval);
        }
        self.mover.slab_motion.displacement(dt, &bottom, &v, 1.0, &mut state.d);
        state.past = Some(Past { interval, dt, bottom, u: Arc::default(), v: Arc::new(v), bodies: Vec::new() });
        let (slab, rejected) = (state.slab + 1, state.rejected);
        MeshReport { slab, interval, rejected, work, quality, first_invalid, first_invalid_sampled }
    }
}
