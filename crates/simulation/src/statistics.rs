//! Sums over a run, for summary.json; they go into checkpoints.

mod arrays;

use super::body_record::BodyRecord;
use super::openings::Record;
use super::walls::{WallLoads, numbers_per_wall, to_numbers};
use coupled::block::BodyState;
use coupled::{Counts, EasedStart, MeshQuality, Reliability, SlabReport, SteadyFlow, StructureReport};
use navier_stokes::Conserved;
use std::array::from_fn;

/// The numbers of all [`BodyRecord`]s among the arrays of a checkpoint.
pub const BODIES: &str = "statistics.bodies";

/// The statistics of a run so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunStatistics {
    /// Attempts at slabs that were rejected.
    pub rejected: u64,
    /// Newton steps.
    pub newton: u64,
    /// The largest number of Newton steps in a slab.
    pub newton_max: u64,
    /// Krylov iterations.
    pub krylov: u64,
    /// The largest number of Krylov iterations in a Newton step.
    pub krylov_max: u64,
    /// CG iterations of the mesh.
    pub elasticity: u64,
    /// Evaluations of the residual.
    pub residuals: u64,
    /// Jacobian products.
    pub products: u64,
    /// The worst quality of the mesh.
    pub quality: Option<MeshQuality>,
    /// The first place where the mesh was invalid.
    pub first_invalid: Option<FirstInvalid>,
    /// The first time at which a sampled det J was not positive.
    pub first_invalid_sampled: Option<f64>,
    /// Integrals of all components at the start.
    pub totals_at_start: Vec<f64>,
    /// The thickness of the layer at walls that was added to the initial state, if there is one.
    pub start_layer: Option<f64>,
    /// The time from which the flow is solved in a split form, because a slab could not be solved without.
    pub split_form_since: Option<f64>,
    /// The amount that has left through all boundaries, per component.
    pub left: Vec<f64>,
    /// Impulses, work and heat of every wall, as numbers.
    pub impulses: Vec<Vec<f64>>,
    /// The loads of every wall at the time reached, as numbers.
    pub forces: Vec<Vec<f64>>,
    /// The search for the steady flow, if the run starts from one.
    pub steady: Option<Steady>,
    /// The largest of the mass errors, relative to the mass at the start.
    pub mass_error: f64,
    /// The largest of the energy errors, relative to the energy at the start.
    pub energy_error: f64,
    /// The energy of a structure.
    pub structure: EnergyBalance,
    /// The mass flow out through every boundary at the time reached.
    pub mass_flows: Vec<f64>,
    /// The values of the controls at the time reached, and those for which the preconditioner was made.
    pub controls: Vec<f64>,
    /// See `controls`.
    pub controls_of_preconditioner: Vec<f64>,
    /// The observations at inflows and outflows.
    pub openings: Vec<Record>,
    /// What bodies have done.
    pub bodies: Vec<BodyRecord>,
    /// The largest error of the energy of gas and bodies together, relative to that of the gas at the start.
    pub coupled_energy_error: f64,
}

/// The energy balance of a structure since the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// The energy at the start.
    pub energy_at_start: f64,
    /// The work of the loads.
    pub load_work: f64,
    /// The work of the supports.
    pub support_work: f64,
    /// The energy dissipated by damping and by the jumps between slabs.
    pub dissipation: f64,
    /// The part of damping.
    pub damped: f64,
}

impl EnergyBalance {
    /// The excess of `energy` over its balance: round-off.
    pub fn error(&self, energy: f64) -> f64 {
        energy - (self.energy_at_start + self.load_work + self.support_work - self.dissipation)
    }
}

/// The steady flow at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Steady {
    /// Newton steps.
    pub newton: u64,
    /// Krylov iterations.
    pub krylov: u64,
    /// The residual, relative to the residual of the initial state.
    pub residual: f64,
    /// The loads of every wall, as numbers.
    pub forces: Vec<Vec<f64>>,
    /// What speaks for and against it.
    pub reliability: Reliability,
}

/// The first invalidity of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstInvalid {
    /// The first time at which a cell is not proved to be valid.
    pub time: f64,
    /// The worst cell of that slab.
    pub cell: usize,
}

/// The mass flow out through every boundary at the top of a slab.
fn mass_flows<const M: usize>(report: &SlabReport<M>) -> Vec<f64> {
    report.fluxes.last().map_or_else(Vec::new, |top| top.boundaries.iter().map(|flux| flux.total()[0]).collect())
}

/// The larger of two errors; NaN if one of them is.
fn worse(error: f64, other: f64) -> f64 {
    if other.is_nan() || other > error { other } else { error }
}

impl RunStatistics {
    /// What the run has cost since `before`, with the `attempts` at the next slab.
    pub fn counts_since(&self, before: &Self, attempts: Counts) -> Counts {
        let since = |now: u64, then: u64| now.saturating_sub(then) as usize;
        Counts {
            residuals: attempts.residuals + since(self.residuals, before.residuals),
            products: attempts.products + since(self.products, before.products),
            elasticity_iterations: attempts.elasticity_iterations + since(self.elasticity, before.elasticity),
            ..attempts
        }
    }

    /// Adds a slab, with the loads of the walls.
    pub fn add<const D: usize, const M: usize>(&mut self, report: &SlabReport<M>, loads: &[WallLoads<D>]) {
        self.rejected += report.rejected as u64;
        let steps = report.newton.steps.len() as u64;
        self.newton += steps;
        self.newton_max = self.newton_max.max(steps);
        self.krylov += report.newton.krylov_iterations as u64;
        let most = report.newton.steps.iter().map(|step| step.krylov_iterations as u64).max().unwrap_or(0);
        self.krylov_max = self.krylov_max.max(most);
        self.elasticity += report.counts.elasticity_iterations as u64;
        self.residuals += report.counts.residuals as u64;
        self.products += (report.counts.products + report.counts.mesh_products) as u64;
        self.add_quality(report.quality);
        if let Some(EasedStart { thickness, totals, .. }) = &report.eased {
            (self.start_layer, self.totals_at_start) = (Some(*thickness), totals.clone());
        }
        self.left.resize(M, 0.0);
        self.left.iter_mut().zip(fem::left_during_slab(&report.fluxes)).for_each(|(sum, left)| *sum += left);
        self.forces = loads.iter().map(|loads| to_numbers(&loads.at_top)).collect();
        self.mass_flows = mass_flows(report);
        self.impulses.resize(loads.len(), vec![0.0; numbers_per_wall(D)]);
        for (sums, loads) in self.impulses.iter_mut().zip(loads) {
            sums.iter_mut().zip(to_numbers(&loads.during)).for_each(|(sum, number)| *sum += number);
        }
        let created = self.balances::<D, M>(&report.totals);
        self.mass_error = worse(self.mass_error, created.density.abs());
        self.energy_error = worse(self.energy_error, created.energy.abs());
    }

    /// Adds the `states` of bodies at the end of a slab, the time `t`, in which the gas has the integrals `totals`. `walls` are the walls
    /// of all bodies, by their number in the list of walls.
    pub fn add_bodies<const D: usize, const M: usize>(
        &mut self,
        states: &[BodyState],
        t: f64,
        totals: &[f64],
        walls: &[usize],
    ) {
        self.bodies.iter_mut().zip(states).for_each(|(record, state)| record.add(state, t));
        let Ok(start) = <[f64; M]>::try_from(&self.totals_at_start[..]) else { return };
        let start = Conserved::<f64, D>::unpack(&start).energy;
        let gained: f64 = self.bodies.iter().zip(states).map(|(record, state)| record.gained(state)).sum();
        let error = self.balances::<D, M>(totals).energy + (gained - self.work_of_flow(walls)) / start;
        self.coupled_energy_error = worse(self.coupled_energy_error, error.abs());
    }

    /// The work of the flow on these `walls` so far.
    fn work_of_flow(&self, walls: &[usize]) -> f64 {
        // Work is the last but one of the numbers of a wall.
        let numbers = walls.iter().filter_map(|wall| self.impulses.get(*wall));
        numbers.map(|numbers| numbers.iter().rev().nth(1).copied().unwrap_or(0.0)).sum()
    }

    /// Records the search for the steady flow from which the run starts.
    pub fn start_from_steady<const D: usize, const M: usize>(&mut self, found: &SteadyFlow<M>, loads: &[WallLoads<D>]) {
        let SteadyFlow { report, stages, reliability } = found;
        self.forces = loads.iter().map(|loads| to_numbers(&loads.at_top)).collect();
        self.mass_flows = mass_flows(report);
        self.steady = Some(Steady {
            newton: stages.iter().map(|stage| stage.steps as u64).sum(),
            krylov: stages.iter().map(|stage| stage.iterations as u64).sum(),
            residual: report.relative_residual(),
            forces: self.forces.clone(),
            reliability: *reliability,
        });
    }

    /// Adds a slab of a structure.
    pub fn add_structure(&mut self, report: &StructureReport) {
        self.rejected += report.rejected as u64;
        self.elasticity += report.dynamics.iterations as u64;
        self.structure.load_work += report.dynamics.work.load;
        self.structure.support_work += report.dynamics.work.support;
        self.structure.damped += report.dynamics.work.damped;
        self.structure.dissipation += report.dynamics.work.damped + report.dynamics.work.dissipation;
    }

    /// Adds the quality of the mesh in a slab.
    pub fn add_quality(&mut self, quality: MeshQuality) {
        self.quality = Some(self.quality.map_or(quality, |worst| worst.worst(quality)));
    }

    /// (present amount + amount that has left - amount at the start) / amount at the start, of every component.
    pub fn balances<const D: usize, const M: usize>(&self, totals: &[f64]) -> Conserved<f64, D> {
        Conserved::unpack::<M>(&from_fn(|component| self.balance(totals, component)))
    }

    fn balance(&self, totals: &[f64], component: usize) -> f64 {
        let at = |values: &[f64]| values.get(component).copied();
        let start = at(&self.totals_at_start).unwrap_or(f64::NAN);
        (totals[component] + at(&self.left).unwrap_or(0.0) - start) / start
    }

    /// Begins the balances anew with the integrals `totals`: another quadrature measures other integrals of the same flow.
    pub fn rebase(&mut self, totals: Vec<f64>) {
        // Nothing has left before the first slab.
        let left = self.left.iter().copied().chain(std::iter::repeat(0.0));
        self.totals_at_start = totals.iter().zip(left).map(|(total, left)| total + left).collect();
    }

    /// Begins the balances of bodies in these `states` anew, with their present energies: they may have other masses, springs or materials
    /// than before. `walls` are as for `add_bodies`.
    pub fn rebase_bodies(&mut self, states: &[BodyState], walls: &[usize]) {
        self.bodies.iter_mut().zip(states).for_each(|(record, state)| record.energy_at_start += record.gained(state));
        // Together they have gained the work of the flow; which of them has gained it, the balance does not ask.
        let work = self.work_of_flow(walls);
        self.bodies.iter_mut().take(1).for_each(|record| record.energy_at_start -= work);
    }
}

#[cfg(test)]
mod tests {
    use super::worse;

    /// `f64::max` ignores NaN: a run without a single number for its energy had an error of zero.
    #[test]
    fn an_error_that_is_no_number_stays() {
        assert_eq!((worse(1.0, 2.0), worse(2.0, 1.0)), (2.0, 2.0));
        assert!(worse(1.0, f64::NAN).is_nan() && worse(f64::NAN, 1.0).is_nan());
    }
}
