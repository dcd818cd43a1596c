//! The march of the mesh alone.

use crate::mesh_mover::{MeshMover, MeshQuality};
use crate::schedule::Schedule;
use crate::state::{Interval, Past, State};
use elasticity::{ElasticityError, Work};

/// What a slab of the mesh alone has done.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// What its equilibrium has cost.
    pub work: Work,
    /// The quality of the mesh.
    pub quality: MeshQuality,
    /// The first time at which a cell is not proved to be valid, if there is one.
    pub first_invalid: Option<f64>,
}

/// A mesh that moves without a flow. With a linear law it goes on when cells are inverted: that law does not notice.
pub struct MeshMarch<const D: usize> {
    /// The mesh.
    pub mover: MeshMover<D>,
    /// Where the run stands; the flow is empty.
    pub state: State,
    schedule: Schedule,
}

impl<const D: usize> MeshMarch<D> {
    /// A march through the slabs of `schedule`, at its fixed step: there is no flow to adapt it to.
    pub fn new(mover: MeshMover<D>, schedule: Schedule) -> Self {
        let state = State::new(schedule.start, Vec::new(), mover.displacement_at_start(schedule.start));
        MeshMarch { mover, state, schedule: Schedule { control: None, ..schedule } }
    }

    /// Whether the end is reached.
    pub fn is_done(&self) -> bool {
        self.schedule.is_done(&self.state)
    }

    /// Advances one slab.
    ///
    /// # Errors
    /// As [`MeshMover::begin_slab`] and [`MeshMover::velocities`].
    pub fn advance(&mut self) -> Result<MeshReport, ElasticityError> {
        let interval = self.schedule.next(&self.state);
        let dt = interval.end - interval.start;
        let bottom = self.state.d.clone();
        self.mover.begin_slab(&bottom)?;
        let time = self.mover.slab_motion.time();
        let mut g = vec![0.0; self.mover.field_len() * time.order()];
        self.mover.prescribed_in_slab(interval.start, dt, &mut g);
        let mut v = self.state.extrapolated_velocities(time, self.mover.field_len(), dt);
        let work = self.mover.velocities(interval, &bottom, &g, &mut v)?;
        let quality = self.mover.quality(&bottom, &v, interval);
        let first_invalid = if quality.is_valid() { None } else { self.mover.first_invalid(&bottom, &v, interval) };
        self.mover.slab_motion.displacement(dt, &bottom, &v, 1.0, &mut self.state.d);
        self.state.past = Some(Past { interval, dt, bottom, u: Vec::new(), v });
        self.state.pending.push(interval);
        self.state.finish(interval);
        Ok(MeshReport { slab: self.state.slab, interval, work, quality, first_invalid })
    }
}
