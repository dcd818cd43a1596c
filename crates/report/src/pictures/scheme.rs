//! The data that all steps of the pictures of a run share.

use super::average::Average;
use super::medium::PictureMedium;
use super::quantity::PictureQuantity;
use super::snapshot::Snapshot;
use fem::Sampler;
use output::{OutputError, ResultReader};

/// Numbers of parts into which the reference cell may be cut along each axis.
pub const PARTS: [usize; 6] = [2, 4, 8, 16, 32, 64];

/// Data that do not change from step to step.
pub struct Scheme<const D: usize> {
    pub(super) mesh_nodes: usize,
    /// Nodes per cell of the flow, and coefficients of a cell in a slab; absent without a flow.
    pub(super) flow: Option<(usize, usize)>,
    pub(super) medium: PictureMedium,
    /// Positions at rest, as in [`output::RestMesh`].
    pub(super) rest: Vec<f64>,
    /// One for each of [`PARTS`].
    pub(super) samplers: Vec<Sampler<D>>,
    /// The sampler at the nodes of the flow.
    pub(super) at_nodes: Sampler<D>,
    /// The displayed quantities.
    pub(super) quantities: Vec<PictureQuantity>,
}

impl<const D: usize> Scheme<D> {
    /// The scheme of a result file; `None` if the file does not hold the mesh at rest.
    pub fn new(reader: &ResultReader, medium: PictureMedium) -> Option<Self> {
        let axes = |name: &str| reader.layout.exact.iter().find(|array| array.name == name).map(|array| &array.axes);
        let last = |name: &str| axes(name).and_then(|axes| axes.last()).map(|axis| axis.length);
        let mesh_nodes = last("position")?;
        let cells = axes("position")?.first()?.length;
        let flow = last("flow")
            .map(|nodes| (nodes, axes("flow").iter().flat_map(|a| a.iter()).map(|a| a.length).skip(1).product()));
        let rest = reader.metadata.mesh.position.clone();
        let order = |nodes: usize| (nodes as f64).powf(1.0 / D as f64).round() as usize;
        let (mesh_order, flow_order) = (order(mesh_nodes), flow.map_or(order(mesh_nodes), |(nodes, _)| order(nodes)));
        let sampler = |points: &[f64]| Sampler::new(flow_order, mesh_order, points);
        let samplers = PARTS.map(|parts| sampler(&basis::equidistant_points(parts + 1))).into();
        let at_nodes = sampler(basis::Lagrange::gauss_lobatto(flow_order).nodes());
        let complete = rest.len() == cells * mesh_nodes * D;
        let arrays: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
        let fields: Vec<&str> = reader.layout.fields.iter().map(|field| &field.name[..]).collect();
        let quantities = PictureQuantity::of_page(flow.is_some(), &arrays, &fields);
        complete.then_some(Scheme { mesh_nodes, flow, medium, rest, samplers, at_nodes, quantities })
    }

    /// The solution at a step.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn at(&self, reader: &ResultReader, step: usize) -> Result<Snapshot<'_, D>, OutputError> {
        let mut position = reader.exact("position", step)?.unwrap_or_default();
        position.extend(reader.exact("structure_position", step)?.unwrap_or_default());
        let flow = reader.exact("flow", step)?.unwrap_or_default();
        let averages = self.quantities.iter().filter_map(|quantity| match quantity {
            PictureQuantity::Average(average) => Some(*average),
            _ => None,
        });
        let arrays = |average: Average| -> Result<_, OutputError> {
            let found = average.arrays.iter().filter_map(|name| reader.exact(name, step).transpose());
            Ok((average, found.collect::<Result<_, _>>()?))
        };
        let averages = averages.map(arrays).collect::<Result<_, _>>()?;
        Ok(Snapshot { scheme: self, time: reader.times[step], position, flow, averages })
    }

    /// The displayed quantities.
    pub fn quantities(&self) -> &[PictureQuantity] {
        &self.quantities
    }

    /// The same scheme with other quantities.
    pub fn showing(self, quantities: Vec<PictureQuantity>) -> Self {
        Scheme { quantities, ..self }
    }

    /// Whether `cell` is one of the flow.
    pub(super) fn has_flow(&self, cell: usize) -> bool {
        self.flow.is_some() && (cell + 1) * D * self.mesh_nodes <= self.rest.len()
    }

    /// The nodes of a cell, `[component][node]`, among the `positions` of all.
    pub(super) fn nodes<'b>(&self, positions: &'b [f64], cell: usize) -> &'b [f64] {
        &positions[cell * D * self.mesh_nodes..][..D * self.mesh_nodes]
    }
}
