//! The files about averages and walls that a run leaves at its end.

use super::FlowRun;
use crate::averages::{AlongFiles, AverageSums, PhaseFile};
use crate::drive::Run;
use crate::surfaces::{self, MeansOf, Section};
use case::{Averages, Wall, rounded_time};
use navier_stokes::{Boundary, Compiled, NavierStokes};
use output::{RESULT_FILE, ResultReader, Series};
use std::borrow::Cow;
use std::path::Path;

impl<const D: usize, const M: usize> FlowRun<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    /// The sums of averages over all cells, if something of them is written at the end.
    pub(super) fn whole_averages(&self) -> Cow<'_, AverageSums> {
        if self.march.solver.system.flow.operator.share.is_whole() {
            return Cow::Borrowed(&self.averages);
        }
        Cow::Owned(self.averages(0..self.layout().cells))
    }

    /// Writes the averages over phases and along axes, if the case asks for them.
    pub(super) fn write_averages(&self, directory: &Path) -> anyhow::Result<()> {
        let asked = |wanted: &&Averages| wanted.phases.is_some() || !wanted.along.is_empty();
        let Some(wanted) = self.case.averages.as_ref().filter(asked) else { return Ok(()) };
        let sums = &*self.whole_averages();
        let (mover, order) = (&self.march.solver.system.mesh.mover, self.flow.order);
        // A file without a step is an error for its readers.
        let has_begun = sums.durations.iter().any(|duration| *duration > 0.0);
        if let Some(phases) = wanted.phases.filter(|_| has_begun) {
            PhaseFile { wanted, sums, mover, order }.write(directory, phases)?;
        }
        if let Some(files) = AlongFiles::new(wanted, sums, &mover.reference, order) {
            files.write(directory)?;
        }
        Ok(())
    }

    /// Writes the distributions along walls: those of the series in the result, and last that of the present state. `has_averages` if a part of
    /// the run is averaged.
    pub(super) fn write_surfaces(&self, directory: &Path, has_averages: bool) -> anyhow::Result<()> {
        let (present, time) = (self.surfaces(), self.state().time);
        if present.is_empty() {
            return Ok(());
        }
        let reader = ResultReader::open(&directory.join(RESULT_FILE))?;
        let (order, rule) = (self.flow.order, &self.surface_rule);
        for (wall, (array, values)) in self.listed_walls().zip(present) {
            let stored = reader.series(&array.name)?.filter(|series| series.array == array);
            let mut series = stored.unwrap_or_else(|| Series { array, times: Vec::new(), values: Vec::new() });
            if series.times.last() != Some(&time) {
                series.times.push(time);
                series.values.extend(values);
            }
            surfaces::write(directory, D, &series, rule, order.max(self.case.mesh.order()))?;
            if has_averages {
                self.write_means(directory, wall, &series)?;
            }
        }
        Ok(())
    }

    /// Writes the means along a wall, if the case averages over time and has distributions at several times: one alone has no mean.
    pub(super) fn write_means(&self, directory: &Path, wall: &Wall<D>, series: &Series) -> anyhow::Result<()> {
        let (Some(averages), Some(_)) = (&self.case.averages, self.case.output.surfaces_every) else { return Ok(()) };
        let interval = [averages.from, averages.to.unwrap_or(f64::INFINITY)];
        let mover = &self.march.solver.system.mesh.mover;
        let Some(section) = Section::new(&mover.reference, &mover.numbering, wall.boundary, &self.surface_rule) else {
            tracing::warn!(
                "the wall `{}` has no means and no separation: it is not extruded along z, so that it has no curve in the plane x, y; its \
                 distributions are in {}.csv",
                wall.name,
                series.array.name
            );
            return Ok(());
        };
        let slips = matches!(self.flow.boundary[wall.boundary].condition, Boundary::SlipWall(_));
        let means = MeansOf { series, section: &section, slips };
        if !surfaces::write_means(directory, D, &means, interval)? {
            let (first, last) = (series.times.first(), series.times.last());
            tracing::warn!(
                "the wall `{}` has no means: the time of its distributions, from t = {} to {}, and that of `output.averages` do not overlap; a smaller \
                 `output.surfaces.every`",
                wall.name,
                first.copied().map(rounded_time).unwrap_or_default(),
                last.copied().map(rounded_time).unwrap_or_default()
            );
        }
        Ok(())
    }

    /// The walls with distributions.
    pub(super) fn listed_walls(&self) -> impl Iterator<Item = &Wall<D>> {
        self.flow.walls.iter().filter(|wall| self.case.output.surfaces.contains(&wall.name))
    }
}
