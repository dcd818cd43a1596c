//! The march of a structure, with or without inertia.

use crate::march::{March, SlabSolver};
use crate::schedule::Schedule;
use crate::slab_error::SlabError;
use crate::state::{Interval, Past, State};
use elasticity::{
    Dynamics, DynamicsReport, ElasticityError, NaturalMode, SlabBottom, SlabMotion, Stability, Statics, Structure,
};
use fem::{Clock, VectorField};
use std::sync::Arc;

/// The report of a slab of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct StructureReport {
    /// The number of the slab, from 1.
    pub slab: usize,
    /// Its interval.
    pub interval: Interval,
    /// How often an attempt was rejected before.
    pub rejected: usize,
    /// Iterations and work.
    pub dynamics: DynamicsReport,
    /// v . M v / 2 at the top.
    pub kinetic_energy: f64,
    /// d . K d / 2 at the top.
    pub strain_energy: f64,
    /// The forces of the supports, see [`Reactions::forces`].
    pub reactions: Vec<f64>,
}

/// How the fixed entries of a structure move.
#[derive(Clone)]
pub struct Supports<const D: usize> {
    /// The displacement of each support that moves, as a function of position at rest and time.
    pub fields: Vec<Arc<dyn VectorField<D>>>,
    /// For every C0 node the field that moves its fixed entries; without one they rest.
    pub field_of_node: Vec<Option<usize>>,
    /// Whose reaction an entry counts for.
    pub reactions: Reactions,
}

/// The reactions of supports: one number for each component that a boundary prescribes.
#[derive(Clone, Debug, Default)]
pub struct Reactions {
    /// How many they are.
    pub count: usize,
    /// For every entry the reaction that it counts for, `[C0 node][component]`; none at free entries.
    pub of_entry: Vec<Option<usize>>,
}

impl Reactions {
    /// Their values: the sums of the nodal forces `reaction` over the entries of each. They are not numbers as long as that is empty.
    pub fn forces(&self, reaction: &[f64]) -> Vec<f64> {
        let mut forces = vec![if reaction.is_empty() { f64::NAN } else { 0.0 }; self.count];
        let entries = self.of_entry.iter().zip(reaction);
        entries.filter_map(|(number, force)| Some(((*number)?, force))).for_each(|(number, f)| forces[number] += f);
        forces
    }
}

impl<const D: usize> Supports<D> {
    /// Sets the fixed entries of `structure` to the `value` of their support, zero where it does not move.
    pub fn set(
        &self,
        structure: &Structure<D>,
        vector: &mut [f64],
        value: impl Fn(&dyn VectorField<D>, &[f64; D]) -> [f64; D],
    ) {
        let entries = structure.coordinates().iter().zip(structure.fixed().chunks_exact(D));
        let entries = entries.zip(vector.chunks_exact_mut(D)).zip(&self.field_of_node);
        for (((x, fixed), entry), field) in entries {
            let value = field.map_or([0.0; D], |field| value(&*self.fields[field], x));
            (0..D).filter(|&i| fixed[i]).for_each(|i| entry[i] = value[i]);
        }
    }

    /// Sets the fixed entries of `v`, `[time node][C0 node][component]`, to the velocities of the supports in a slab of length `dt`. It begins
    /// with the displacement `bottom`.
    ///
    /// ```text
    /// V_a = g'(s_a) + ( g(1) - d_n - dt sum_b omega_b g'(s_b) ) / dt                                              (support)
    /// ```
    ///
    /// The second term takes the support to g at the top of the slab, also where g bends or jumps. Where g is smooth, it is of the order
    /// 2 N_t - 1.
    pub fn set_velocities(
        &self,
        structure: &Structure<D>,
        motion: &SlabMotion,
        (clock, dt): (Clock, f64),
        bottom: &[f64],
        v: &mut [f64],
    ) {
        let nodes = motion.time().nodes().iter().zip(v.chunks_exact_mut(bottom.len()));
        nodes.for_each(|(s, v)| self.set(structure, v, |field, x| field.rate(x, clock.time(*s))));
        let mut top = vec![0.0; bottom.len()];
        motion.displacement(dt, bottom, v, 1.0, &mut top);
        for (entry, field, x) in self.moved_entries(structure) {
            top[entry] = field.value(x, clock.time(1.0))[entry % D];
        }
        motion.lead_to(dt, bottom, &top, v);
    }

    /// The fixed entries that a field moves, each with the field and the position at rest.
    fn moved_entries<'a>(
        &'a self,
        structure: &'a Structure<D>,
    ) -> impl Iterator<Item = (usize, &'a dyn VectorField<D>, &'a [f64; D])> {
        let nodes = structure.coordinates().iter().zip(&self.field_of_node).enumerate();
        let moved = nodes.filter_map(|(node, (x, field))| Some((node, x, &*self.fields[(*field)?])));
        let fixed = structure.fixed();
        moved.flat_map(move |(node, x, field)| {
            (node * D..(node + 1) * D).filter(|&entry| fixed[entry]).map(move |entry| (entry, field, x))
        })
    }
}

/// The equations of a structure.
pub enum Equations<const D: usize> {
    /// With inertia.
    Dynamic(Box<Dynamics<D>>),
    /// Without.
    Static(Box<Statics<D>>),
}

impl<const D: usize> Equations<D> {
    fn structure(&self) -> &Structure<D> {
        match self {
            Equations::Dynamic(dynamics) => dynamics.structure(),
            Equations::Static(statics) => statics.structure(),
        }
    }
    fn motion(&self) -> &SlabMotion {
        match self {
            Equations::Dynamic(dynamics) => dynamics.motion(),
            Equations::Static(statics) => statics.motion(),
        }
    }
}

/// A structure, slab by slab.
pub struct StructureAlone<const D: usize> {
    equations: Equations<D>,
    /// How its fixed entries move; those of no field rest.
    supports: Supports<D>,
    velocity_at_start: Vec<f64>,
}

/// A run of a structure; the flow of its state is empty, and velocities are those of the past slab.
pub type StructureMarch<const D: usize> = March<StructureAlone<D>>;

impl<const D: usize> StructureMarch<D> {
    /// A march through the slabs of `schedule`, at its fixed step, from the displacement `d` and the velocity `v`, both
    /// `[C0 node][component]`; fixed entries have the velocity of their support. Without inertia it starts from the equilibrium at the
    /// start of the schedule, which is found from the guess `d`. A slab that cannot be solved is halved, at most `max_halvings` times.
    ///
    /// # Errors
    /// As [`Statics::equilibrium`].
    pub fn new(
        equations: Equations<D>,
        supports: Supports<D>,
        mut d: Vec<f64>,
        mut v: Vec<f64>,
        schedule: Schedule,
        max_halvings: u32,
    ) -> Result<Self, ElasticityError> {
        let mut alone = StructureAlone { equations, supports, velocity_at_start: Vec::new() };
        if let Equations::Static(statics) = &alone.equations {
            alone.set_supports(&mut d, |field, x| field.value(x, schedule.start));
            statics.equilibrium(schedule.start, &mut d)?;
        }
        alone.set_supports(&mut v, |field, x| field.rate(x, schedule.start));
        alone.velocity_at_start = v;
        let state = State::new(schedule.start, Vec::new(), d);
        Ok(March::from(alone, state, Schedule { control: None, ..schedule }, max_halvings))
    }

    /// The structure.
    pub fn structure(&self) -> &Structure<D> {
        self.solver.equations.structure()
    }

    /// The velocity at the time reached, `[C0 node][component]`.
    pub fn velocity(&self) -> &[f64] {
        self.solver.velocity(&self.state)
    }

    /// The stability of the equilibrium reached, see [`Statics::stability`]; None with inertia.
    ///
    /// # Errors
    /// As [`Statics::stability`].
    pub fn stability(&self) -> Result<Option<Stability>, ElasticityError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        match &self.solver.equations {
            Equations::Dynamic(_) => Ok(None),
            Equations::Static(statics) => statics.stability(&self.state.d),
        }
    }

    /// The `count` natural modes about the equilibrium reached, see [`Statics::natural_modes`]; None with inertia.
    ///
    /// # Errors
    /// As [`Statics::natural_modes`].
    pub fn natural_modes(&self, count: usize) -> Result<Option<Vec<NaturalMode>>, ElasticityError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        match &self.solver.equations {
            Equations::Dynamic(_) => Ok(None),
            Equations::Static(statics) => statics.natural_modes(&self.state.d, count),
        }
    }

    /// Kinetic and strain energy at the time reached; without inertia the former is zero.
    pub fn energies(&self) -> [f64; 2] {
        self.solver.energies(&self.state)
    }
}

impl<const D: usize> SlabSolver for StructureAlone<D> {
    /// The report, and the velocities.
    type Solved = (DynamicsReport, Vec<f64>);
    type Report = StructureReport;

    fn solve(&mut self, state: &State, interval: Interval) -> Result<Self::Solved, SlabError> {
        let _timed = tracing::trace_span!(target: "cost", "elasticity").entered();
        let (start, dt) = (interval.start, interval.length());
        let mut v = match &self.equations {
            Equations::Dynamic(_) => self.guess(state, start, dt),
            Equations::Static(_) => self.prescribed(start, dt, &state.d),
        };
        let velocity = self.velocity(state).to_vec();
        let report = match &mut self.equations {
            Equations::Dynamic(dynamics) => {
                let at_bottom = SlabBottom { time: start, displacement: &state.d, velocity: &velocity };
                dynamics.solve(at_bottom, dt, &mut v)
            }
            Equations::Static(statics) => statics.solve(start, dt, &state.d, &mut v),
        };
        Ok((report.map_err(SlabError::Structure)?, v))
    }

    fn finish(&mut self, state: &mut State, interval: Interval, solved: Self::Solved) -> StructureReport {
        let ((dynamics, v), bottom) = (solved, state.d.clone());
        let dt = interval.length();
        match &self.equations {
            Equations::Dynamic(dynamics) => dynamics.motion().displacement(dt, &bottom, &v, 1.0, &mut state.d),
            // The last node is the top.
            Equations::Static(statics) => {
                let last = statics.motion().time().order() - 1;
                statics.motion().displacement_at_node(dt, &bottom, &v, last, &mut state.d);
            }
        }
        state.past = Some(Past { interval, dt, bottom, u: Arc::default(), v: Arc::new(v), bodies: Vec::new() });
        let [kinetic_energy, strain_energy] = self.energies(state);
        let (slab, rejected) = (state.slab + 1, state.rejected);
        let reactions = self.supports.reactions.forces(&dynamics.reaction);
        StructureReport { slab, interval, rejected, dynamics, kinetic_energy, strain_energy, reactions }
    }
}

impl<const D: usize> StructureAlone<D> {
    fn velocity<'a>(&'a self, state: &'a State) -> &'a [f64] {
        match &state.past {
            Some(past) => &past.v[past.v.len() - state.d.len()..],
            None => &self.velocity_at_start,
        }
    }

    fn energies(&self, state: &State) -> [f64; 2] {
        let structure = self.equations.structure();
        let strain = structure.strain_energy(&state.d);
        match &self.equations {
            Equations::Dynamic(_) => [structure.kinetic_energy(self.velocity(state)), strain],
            Equations::Static(_) => [0.0, strain],
        }
    }

    /// The displacement at the bottom at free entries, that of the supports at the time nodes at fixed ones.
    fn prescribed(&self, start: f64, dt: f64, bottom: &[f64]) -> Vec<f64> {
        let time = self.equations.motion().time();
        let mut d = bottom.repeat(time.order());
        for (s, d) in time.nodes().iter().zip(d.chunks_exact_mut(bottom.len())) {
            self.set_supports(d, |field, x| field.value(x, start + s * dt));
        }
        d
    }

    /// The velocities of the slab before, extended, at free entries; those of the supports at fixed ones.
    fn guess(&self, state: &State, start: f64, dt: f64) -> Vec<f64> {
        let (time, length) = (self.equations.motion().time(), state.d.len());
        let mut v = match state.past {
            Some(_) => state.extrapolated_velocities(time, length, dt),
            None => self.velocity_at_start.repeat(time.order()),
        };
        let (structure, slab) = (self.equations.structure(), (Clock::running(start, dt), dt));
        self.supports.set_velocities(structure, self.equations.motion(), slab, &state.d, &mut v);
        v
    }

    fn set_supports(&self, vector: &mut [f64], value: impl Fn(&dyn VectorField<D>, &[f64; D]) -> [f64; D]) {
        self.supports.set(self.equations.structure(), vector, value);
    }
}
