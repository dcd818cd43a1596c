//! The march of a structure.

use crate::schedule::Schedule;
use crate::state::{Interval, Past, State};
use elasticity::{Dynamics, DynamicsReport, ElasticityError, SlabBottom};
use fem::VectorField;
use std::sync::Arc;

/// What a slab of a structure has done.
#[derive(Clone, Debug, PartialEq)]
pub struct StructureReport {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// Iterations and work.
    pub dynamics: DynamicsReport,
    /// v . M v / 2 at the top.
    pub kinetic_energy: f64,
    /// d . K d / 2 at the top.
    pub strain_energy: f64,
}

/// How the fixed entries of a structure move.
#[derive(Clone)]
pub struct Supports<const D: usize> {
    /// The displacement of each support that moves, as a function of position at rest and time.
    pub fields: Vec<Arc<dyn VectorField<D>>>,
    /// For every C0 node the field that moves its fixed entries; without one they rest.
    pub field_of_node: Vec<Option<usize>>,
}

/// A structure, slab by slab.
pub struct StructureMarch<const D: usize> {
    /// The structure and its equations.
    pub dynamics: Dynamics<D>,
    /// Where the run stands; the flow is empty, and velocities are those of the past slab.
    pub state: State,
    /// How its fixed entries move; those of no field rest.
    supports: Supports<D>,
    velocity_at_start: Vec<f64>,
    schedule: Schedule,
}

impl<const D: usize> StructureMarch<D> {
    /// A march through the slabs of `schedule`, at its fixed step, from the displacement `d` and the velocity `v`, both
    /// `[C0 node][component]`; fixed entries have the velocity of their support.
    pub fn new(dynamics: Dynamics<D>, supports: Supports<D>, d: Vec<f64>, mut v: Vec<f64>, schedule: Schedule) -> Self {
        let (state, velocity_at_start) = (State::new(schedule.start, Vec::new(), d), Vec::new());
        let schedule = Schedule { control: None, ..schedule };
        let march = StructureMarch { dynamics, state, supports, velocity_at_start, schedule };
        march.move_supports(schedule.start, &mut v);
        StructureMarch { velocity_at_start: v, ..march }
    }

    /// Whether the end is reached.
    pub fn is_done(&self) -> bool {
        self.schedule.is_done(&self.state)
    }

    /// The velocity at the time reached, `[C0 node][component]`.
    pub fn velocity(&self) -> &[f64] {
        match &self.state.past {
            Some(past) => &past.v[past.v.len() - self.state.d.len()..],
            None => &self.velocity_at_start,
        }
    }

    /// Kinetic and strain energy at the time reached.
    pub fn energies(&self) -> [f64; 2] {
        let structure = self.dynamics.structure();
        [structure.kinetic_energy(self.velocity()), structure.strain_energy(&self.state.d)]
    }

    /// Advances one slab.
    ///
    /// # Errors
    /// As [`Dynamics::solve`].
    pub fn advance(&mut self) -> Result<StructureReport, ElasticityError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let interval = self.schedule.next(&self.state);
        let dt = interval.end - interval.start;
        let mut v = self.guess(interval.start, dt);
        let (bottom, velocity) = (self.state.d.clone(), self.velocity().to_vec());
        let at_bottom = SlabBottom { time: interval.start, displacement: &bottom, velocity: &velocity };
        let dynamics = self.dynamics.solve(at_bottom, dt, &mut v)?;
        self.dynamics.motion().displacement(dt, &bottom, &v, 1.0, &mut self.state.d);
        self.state.past = Some(Past { interval, dt, bottom, u: Vec::new(), v });
        self.state.pending.push(interval);
        self.state.finish(interval);
        let [kinetic_energy, strain_energy] = self.energies();
        Ok(StructureReport { slab: self.state.slab, interval, dynamics, kinetic_energy, strain_energy })
    }

    /// The velocities of the slab before, extended, at free entries; those of the supports at fixed ones.
    fn guess(&self, start: f64, dt: f64) -> Vec<f64> {
        let (time, length) = (self.dynamics.motion().time(), self.state.d.len());
        let mut v = match self.state.past {
            Some(_) => self.state.extrapolated_velocities(time, length, dt),
            None => self.velocity_at_start.repeat(time.order()),
        };
        for (s, v) in time.nodes().iter().zip(v.chunks_exact_mut(length)) {
            self.move_supports(start + s * dt, v);
        }
        v
    }

    /// Sets the fixed entries to the velocity of their support at time `t`.
    fn move_supports(&self, t: f64, v: &mut [f64]) {
        let structure = self.dynamics.structure();
        let entries = structure.coordinates().iter().zip(structure.fixed().chunks_exact(D)).zip(v.chunks_exact_mut(D));
        for (((x, fixed), v), field) in entries.zip(&self.supports.field_of_node) {
            let rate = field.map_or([0.0; D], |field| self.supports.fields[field].rate(x, t));
            (0..D).filter(|&i| fixed[i]).for_each(|i| v[i] = rate[i]);
        }
    }
}
