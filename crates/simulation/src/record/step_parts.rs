//! The parts of a step of the result file: cells of the mesh, range by range, and the structure beside the flow.

use super::layout::{drawn_specs, flow_layout, flow_order};
use super::mesh_view::{MeshView, exact_mesh};
use super::{Snapshot, average_fields, averages};
use crate::averages::{AverageSums, Averaged};
use crate::bodies::beside_flow;
use crate::build::solid;
use crate::cells;
use case::{Case, SolidPart};
use elasticity::{Solid, just_inside};
use fem::Sampler;
use mesh::NodeNumbering;
use output::{OutputError, SharedFile, Step, StepInParts};
use report::fields;
use std::ops::Range;
use std::sync::Arc;

/// What makes the parts.
pub struct StepParts<'a, const D: usize, const M: usize> {
    pub(super) case: &'a Case<D>,
    pub(super) mesh: Arc<MeshView<D>>,
    /// The mesh of a structure beside the flow.
    pub(super) beside: Option<MeshView<D>>,
    /// The material of the structure, if there is one.
    pub(super) solid: Option<Solid<D>>,
    pub(super) sampler: Sampler<D>,
    /// For fields of the order of the mesh.
    pub(super) mesh_sampler: Sampler<D>,
    /// The same points, moved just inside of their cell, where that has its own material.
    pub(super) material_sampler: Sampler<D>,
}

/// Names and values.
pub(super) type Named = Vec<(String, Vec<f64>)>;

/// A part of a step.
pub(super) struct StepPart {
    time: f64,
    /// `[cell][point][3]`
    points: Vec<f64>,
    /// For every field `[cell][point][component]`.
    fields: Named,
    exact: Named,
}

impl StepPart {
    /// Writes it.
    ///
    /// # Errors
    /// As [`StepInParts::add`].
    pub(super) fn add_to(&self, step: &mut StepInParts) -> Result<(), OutputError> {
        self.pass_to(|part| step.add(part))
    }

    /// Writes it to a `file` of all ranks, from the cell `first` on.
    ///
    /// # Errors
    /// As [`SharedFile::write_cells`].
    pub(super) fn write_to(&self, file: &SharedFile, first: usize) -> Result<(), OutputError> {
        self.pass_to(|part| file.write_cells(first, part))
    }

    fn pass_to(&self, write: impl FnOnce(&Step) -> Result<(), OutputError>) -> Result<(), OutputError> {
        let fields: Vec<(&str, &[f64])> = self.fields.iter().map(|(name, values)| (&name[..], &values[..])).collect();
        let exact: Vec<(&str, &[f64])> = self.exact.iter().map(|(name, values)| (&name[..], &values[..])).collect();
        write(&Step { time: self.time, points: &self.points, fields: &fields, exact: &exact })
    }
}

impl<'a, const D: usize, const M: usize> StepParts<'a, D, M> {
    /// Of the steps of a run of `case` on `mesh`.
    pub fn new(case: &'a Case<D>, mesh: Arc<MeshView<D>>) -> Self {
        let (sampler, n) = fields::equidistant::<D>(flow_order(case), case.mesh.order());
        let (order, points) = (case.mesh.order(), basis::equidistant_points(n));
        let mesh_sampler = Sampler::new(order, order, &points);
        let material_sampler = Sampler::new(order, order, &just_inside(&points));
        let beside =
            |part: &SolidPart<D>| MeshView::new(&part.mesh, &NodeNumbering::new(&part.mesh, part.mesh.order()));
        let beside = beside_flow(case).map(|(_, part)| beside(part));
        let solid = case.structure.as_ref().map(solid);
        StepParts { case, mesh, beside, solid, sampler, mesh_sampler, material_sampler }
    }

    /// The ranges of cells that make a part each.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> + use<D, M> {
        cells::ranges(self.mesh.cells.len(), self.cell_len())
    }

    /// The same in rounds of so many `ranks`.
    pub(super) fn rounds(&self, ranks: usize) -> impl Iterator<Item = Vec<Range<usize>>> + use<D, M> {
        cells::rounds(self.mesh.cells.len(), self.cell_len(), ranks)
    }

    /// As many numbers a cell has at most in one array.
    fn cell_len(&self) -> usize {
        let nodes = flow_order(self.case).pow(D as u32);
        let of_averages = self.case.averages.as_ref().map_or(0, |wanted| AverageSums::cell_len::<D>(wanted, nodes));
        flow_layout::<D, M>(self.case).cell_len().max(of_averages)
    }

    /// The part of some `cells` of the mesh.
    pub(super) fn of_cells(&self, snapshot: &Snapshot, cells: Range<usize>) -> StepPart {
        let flow = (snapshot.flow)(cells.clone());
        let (points, mut fields) = self.draw(snapshot, cells.clone(), &flow);
        let [position, velocity] = exact_mesh(&self.mesh, cells.clone(), snapshot.displacement, snapshot.velocities);
        let mut exact = vec![("position".to_owned(), position), ("mesh_velocity".to_owned(), velocity)];
        if self.case.flow.is_some() {
            exact.push(("flow".to_owned(), flow.into_owned()));
        }
        self.add_averages(snapshot, cells, (&mut fields, &mut exact));
        StepPart { time: snapshot.time, points, fields, exact }
    }

    /// The averages up to now in some `cells`, if the case asks for averages.
    fn add_averages(&self, snapshot: &Snapshot, cells: Range<usize>, (fields, exact): (&mut Named, &mut Named)) {
        if self.case.averages.is_none() {
            return;
        }
        let (count, sums) = (cells.len(), (snapshot.averages)(cells));
        let Some(of_mesh) = average_fields(self.case, &sums) else { return };
        let nodes = flow_order(self.case).pow(D as u32);
        for average in of_mesh.averages() {
            let coefficients = of_mesh.coefficients(average, None, 0..count);
            let drawn = averages::drawn::<D>(average, &coefficients, nodes, &self.sampler);
            fields.push((average.name.clone(), drawn));
            exact.push((average.name.clone(), coefficients));
        }
    }

    /// The part of the structure beside the flow, if there is one. It has no averages.
    pub(super) fn of_structure(&self, snapshot: &Snapshot) -> Option<StepPart> {
        let (mesh, structure) = self.beside.as_ref().zip(snapshot.structure.as_ref())?;
        let (points, mut fields) = self.draw_structure(mesh, snapshot.time, structure);
        if let Some(of_mesh) = average_fields(self.case, &AverageSums::default()) {
            let none = |average: &Averaged| {
                let numbers = points.len() / 3 * averages::spec(average).components;
                (average.name.clone(), vec![f64::NAN; numbers])
            };
            fields.extend(of_mesh.averages().iter().map(none));
        }
        let [position, velocity] =
            exact_mesh(mesh, 0..mesh.cells.len(), &structure.displacement, &structure.velocities);
        let exact = vec![("structure_position".to_owned(), position), ("structure_velocity".to_owned(), velocity)];
        Some(StepPart { time: snapshot.time, points, fields, exact })
    }

    /// The names of the fields that are drawn.
    pub(super) fn names(&self) -> impl Iterator<Item = String> + use<'_, D, M> {
        drawn_specs(self.case).map(|spec| spec.name)
    }
}
