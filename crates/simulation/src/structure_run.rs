//! A structure.

use super::bodies::STRUCTURE;
use super::body_record::BodyRecord;
use super::context::{RunContext, Stop};
use super::drive::{Call, Run, drive};
use super::failure::{Finding, examine_structure};
use super::record::{MeshView, Stored};
use super::{build, checkpoint, history, summary};
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::Observer;
use crate::session::Session;
use case::{Analysis, Case, Structure};
use coupled::block::{BodyState, Ledger};
use coupled::{Interval, Observation, SlabError, StructureMarch, StructureReport, rounded_time};
use elasticity::{ElasticityError, NaturalMode, Stability, natural_modes};
use newton_krylov::inner_product::{Euclidean, InnerProduct, largest};
use output::{Checkpoint, Summary};
use std::sync::Arc;
use std::time::Instant;

/// Runs a structure.
///
/// # Errors
/// Bad input before anything is written; a slab that cannot be solved after the last good state is written.
pub fn run_structure<const D: usize, const M: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
    destination: &Destination,
    observer: &dyn Observer,
) -> Result<Summary, Failure> {
    history::require_distinct_columns(case)?;
    let call = Call { destination, observer, begun: Instant::now(), origin: None };
    let march = build::structure_march(case, structure).map_err(without_march)?;
    let mesh = Arc::new(MeshView::new(&case.mesh, march.structure().numbering()));
    let observed = Observed::new(structure, &march).map_err(Failure::bad_input)?;
    let mut run = StructureRun { case, structure, march, report: None, observed, stability: None, failed: None };
    drive::<D, M>(case, &mut run, &mesh, call)
}

/// The failure of a structure that has no march: an equilibrium at the start that was not found, or a bad input.
fn without_march(error: ElasticityError) -> Failure {
    let advice = match error {
        ElasticityError::LargeDisplacement { .. } => {
            "loads that grow from zero, for instance times t, find it in steps; a soft material or another unit of its modulus may have none"
        }
        ElasticityError::Solver(_) => "a Poisson's ratio above 0.49 or too few supports may be the cause",
        _ => return Failure::bad_input(error),
    };
    let words = format!("the equilibrium with the loads at the start was not found: {advice}");
    Failure::solve(anyhow::Error::new(error).context(words))
}

/// A body that its loads displace by more of its size has no buckling load that follows from its stiffness.
const LITTLE: f64 = 0.05;

/// The warning about an unstable equilibrium, with the buckling `factor` if it has one.
fn unstable(factor: Option<f64>, time: f64) -> String {
    let at = factor
        .map_or_else(String::new, |factor| format!("the structure buckles at about {factor:.3} of these loads, and "));
    format!(
        "the equilibrium at t = {} is unstable: {at}the least disturbance moves it away. A small load across it, or a shape that is not perfect, leads \
         to the equilibrium that is stable",
        rounded_time(time)
    )
}

struct StructureRun<'a, const D: usize> {
    case: &'a Case<D>,
    structure: &'a Structure<D>,
    march: StructureMarch<D>,
    /// That of the last slab, until it is entered.
    report: Option<StructureReport>,
    observed: Observed,
    /// That of the equilibrium at the end.
    stability: Option<Stability>,
    /// The slab that could not be solved, if the last one could not.
    failed: Option<Interval>,
}

/// The quantities of the displacement in history.csv.
struct Observed {
    points: Vec<Observation>,
    modes: Vec<NaturalMode>,
    /// M phi of every mode.
    momenta: Vec<Vec<f64>>,
}

impl Observed {
    fn new<const D: usize>(structure: &Structure<D>, march: &StructureMarch<D>) -> Result<Self, ElasticityError> {
        let body = march.structure();
        let modes =
            if structure.natural_modes > 0 { natural_modes(body, structure.natural_modes)? } else { Vec::new() };
        let momentum = |mode: &NaturalMode| {
            let mut momentum = vec![0.0; body.length()];
            body.apply_mass(&mode.shape, &mut momentum);
            momentum
        };
        let momenta = modes.iter().map(momentum).collect();
        // The case has been checked, so every point is in the mesh.
        let observation = |(_, x): &(String, [f64; D])| Observation::new(body.mesh(), body.numbering(), x);
        Ok(Observed { points: structure.points.iter().filter_map(observation).collect(), modes, momenta })
    }

    /// The displacements of the points, and the coordinates phi . M d of the modes.
    fn values<const D: usize>(&self, d: &[f64]) -> Vec<f64> {
        let points = self.points.iter().flat_map(|point| point.value::<D>(d));
        points.chain(self.momenta.iter().map(|momentum| Euclidean.dot(momentum, d))).collect()
    }
}

impl<const D: usize> StructureRun<'_, D> {
    /// The multiple of the loads at which the body buckles, if they hardly deform it before.
    fn buckling_factor(&self) -> Option<f64> {
        let (body, displacement) = (self.march.structure(), &self.march.state.d);
        let moved = largest(displacement.iter().map(|d| d.abs()));
        let factor = self.stability.and_then(|stability| stability.buckling_factor());
        factor.filter(|_| moved <= LITTLE * body.mesh().diameter())
    }

    /// The natural frequencies about the equilibrium reached, if it is stable and its loads change them.
    fn loaded_frequencies(&self) -> Vec<f64> {
        let count = self.structure.natural_modes;
        if count == 0 || self.stability.is_none_or(|stability| stability.is_unstable()) {
            return Vec::new();
        }
        let modes = self.march.natural_modes(count).unwrap_or_else(|error| {
            tracing::warn!("no natural frequencies under the loads: {error}");
            None
        });
        modes.iter().flatten().map(NaturalMode::frequency).collect()
    }

    /// The structure as a body that no flow moves.
    fn as_body(&self, context: &RunContext) -> BodyState {
        let at_points = |field: &[f64]| self.observed.points.iter().flat_map(|point| point.value::<D>(field)).collect();
        let ([kinetic_energy, potential_energy], balance) = (self.march.energies(), context.statistics.structure);
        BodyState {
            position: at_points(&self.march.state.d),
            rate: at_points(self.march.velocity()),
            kinetic_energy,
            potential_energy,
            ledger: Ledger {
                drive: balance.support_work,
                force: balance.load_work,
                damped: balance.damped,
                numerical: balance.dissipation - balance.damped,
                ..Ledger::default()
            },
            reactions: Vec::new(),
        }
    }
}

impl<const D: usize> Run for StructureRun<'_, D> {
    fn state(&self) -> &coupled::State {
        &self.march.state
    }
    fn is_done(&self) -> bool {
        self.march.is_done()
    }
    fn advance(&mut self) -> anyhow::Result<bool> {
        let done = self.march.advance();
        self.failed = done.as_ref().err().map(|error| error.interval);
        let report = done.map_err(|error| match error.source {
            // The cause alone: the slab is told beside it.
            SlabError::Structure(source) => source.into(),
            _ => anyhow::Error::from(error),
        })?;
        self.report = Some(report);
        Ok(true)
    }
    fn velocities_at_start(&self) -> Vec<f64> {
        self.march.velocity().repeat(self.case.time.order)
    }

    fn open(&mut self, context: &mut RunContext) -> anyhow::Result<Option<Vec<f64>>> {
        context.statistics.structure.energy_at_start = self.march.energies().iter().sum();
        context.statistics.bodies = vec![BodyRecord::start(&self.as_body(context), self.march.state.time)];
        Ok(None)
    }

    fn enter(&mut self, context: &mut RunContext) -> Vec<f64> {
        let Some(report) = &self.report.take() else { return Vec::new() };
        context.statistics.add_structure(report);
        let (body, time) = (self.as_body(context), self.march.state.time);
        context.statistics.bodies.iter_mut().for_each(|record| record.add(&body, time));
        context.observer.structure_slab(report);
        let mut row = history::row_of_structure(report, &context.statistics.structure);
        row.extend(self.observed.values::<D>(&self.march.state.d));
        row
    }

    fn store(&self) -> Stored<'_> {
        checkpoint::store(&self.march.state, None, false).into()
    }

    fn restore(&mut self, stored: &Checkpoint) -> Result<(), Failure> {
        checkpoint::restore(&mut self.march.state, &stored.whole()?, &self.case.time).ok_or_else(checkpoint::incomplete)
    }

    fn summary(&mut self, context: &RunContext, stop: Option<&Stop>) -> Summary {
        let energy = self.march.energies().iter().sum();
        // It has numbers only, so that there is no error.
        self.stability = if stop.is_none() { self.march.stability().ok().flatten() } else { None };
        let mut summary = summary::of_structure(self.case, &self.march, energy, &self.observed.modes, context, stop);
        if let (Some(structure), Some(stability)) = (&mut summary.structure, self.stability) {
            structure.least_stiffness = Some(stability.stiffness);
            structure.buckling_factor = self.buckling_factor();
            structure.loaded_frequencies = self.loaded_frequencies();
        }
        if let Some(record) = context.statistics.bodies.first() {
            let mut body = summary::of_elastic_body(self.structure, &self.as_body(context), record);
            if self.structure.analysis == Analysis::Static {
                // The rate is a displacement per load, not a velocity.
                body.velocity.clear();
            }
            summary.bodies.insert(STRUCTURE.to_owned(), body);
        }
        summary
    }

    fn examine(&self, error: &anyhow::Error, _: &super::statistics::RunStatistics) -> Finding {
        let next =
            Interval { start: self.march.state.time, end: self.march.state.time + self.case.time.step, halvings: 0 };
        examine_structure(self.structure, &self.march, self.failed.unwrap_or(next), error)
    }

    fn judge(&self, context: &RunContext, session: &Session) -> Result<(), Failure> {
        if self.stability.is_some_and(|stability| stability.is_unstable()) {
            tracing::warn!("{}", unstable(self.buckling_factor(), self.march.state.time));
        }
        context.say_done(self.march.state.time, session);
        Ok(())
    }
}
