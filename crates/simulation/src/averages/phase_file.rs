//! Averages over phases of a period, as a file for a viewer: a step for each phase, on the mean mesh of the phase.

use super::fields::{AverageFields, drawn, spec};
use super::{AverageSums, Averaged};
use case::{Averages, Phases};
use coupled::MeshMover;
use fem::Sampler;
use output::{FileLayout, Grid, OutputError, Step, ViewerFile};
use report::fields::equidistant;
use std::path::Path;

/// Name of the file.
pub(super) const PHASE_FILE: &str = "phases.vtkhdf";

/// The averages over phases at the end of a run.
pub struct PhaseFile<'a, const D: usize> {
    /// What is averaged.
    pub wanted: &'a Averages,
    /// The sums of the run.
    pub sums: &'a AverageSums,
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// Nodes per direction of the flow.
    pub order: usize,
}

impl<const D: usize> PhaseFile<'_, D> {
    /// Writes the file into `directory`. A phase that the run has not reached has no step.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &Path, phases: Phases) -> Result<(), OutputError> {
        let (mesh, nodes) = (&self.mover.reference, self.order.pow(D as u32));
        let (sampler, n) = equidistant::<D>(self.order, mesh.order());
        let of_mesh = AverageFields::new::<D>(self.wanted, self.sums, mesh.n_cells(), nodes);
        let grid = Grid { dimension: D, points_per_direction: n, cells: mesh.n_cells() };
        let fields = of_mesh.averages().iter().map(spec).collect();
        let file = ViewerFile::create(&directory.join(PHASE_FILE), FileLayout { grid, fields, exact: Vec::new() })?;
        for phase in (0..phases.count).filter(|&phase| self.sums.durations.get(phase).is_some_and(|t| *t > 0.0)) {
            let values = |average: &Averaged| {
                drawn::<D>(average, &of_mesh.coefficients(average, Some(phase), 0..mesh.n_cells()), nodes, &sampler)
            };
            let drawn: Vec<Vec<f64>> = of_mesh.averages().iter().map(values).collect();
            let names = of_mesh.averages().iter().map(|average| &average.name[..]);
            let fields: Vec<(&str, &[f64])> = names.zip(drawn.iter().map(Vec::as_slice)).collect();
            let (time, points) = (middle(phases, phase), self.points(phase, &sampler));
            file.append(&Step { time, points: &points, fields: &fields, exact: &[] })?;
        }
        file.publish()
    }

    /// The mean positions in a phase, `[cell][point][3]`.
    fn points(&self, phase: usize, sampler: &Sampler<D>) -> Vec<f64> {
        let (displacement, n) = (self.sums.mean_displacement(phase), sampler.points());
        let of_cell = |cell: usize| {
            let x = sampler.positions(&self.mover.cell_positions(cell, &displacement));
            (0..3 * n).map(move |i| x.get(i % 3 * n + i / 3).copied().unwrap_or(0.0))
        };
        (0..self.mover.reference.n_cells()).flat_map(of_cell).collect()
    }
}

/// The time since the start of the period in the middle of a phase.
fn middle(Phases { period, count }: Phases, phase: usize) -> f64 {
    (phase as f64 + 0.5) * period / count as f64
}
