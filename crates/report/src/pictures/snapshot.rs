//! The exact solution at the end of a slab, evaluated as finely as a picture needs.

use super::average::Average;
use super::quantity::Quantity;
use crate::fields::{self, CellSample, Medium};
use case::Field;
use fem::Sampler;
use navier_stokes::{Gas, Primitive};
use output::{OutputError, ResultReader};

/// Numbers of parts into which the reference cell may be cut along each axis.
pub const PARTS: [usize; 6] = [2, 4, 8, 16, 32, 64];

/// The approximate length of a part in pixels; the curvature between its ends is invisible.
const PIXELS_PER_PART: f64 = 4.0;

/// Data that do not change from step to step.
pub struct Scheme<const D: usize> {
    mesh_nodes: usize,
    /// Nodes per cell of the flow, and coefficients of a cell in a slab; absent without a flow.
    flow: Option<(usize, usize)>,
    gas: Gas,
    /// Positions at rest, as in [`output::RestMesh`].
    rest: Vec<f64>,
    /// One for each of [`PARTS`].
    samplers: Vec<Sampler<D>>,
    /// The displayed quantities.
    quantities: Vec<Quantity>,
}

/// The coefficients at one time. Cells of a structure beside the flow come after those of the flow.
pub struct Snapshot<'a, const D: usize> {
    scheme: &'a Scheme<D>,
    /// `[cell][component][node]`
    position: Vec<f64>,
    /// `[cell][time node][component][node]`; empty without a flow.
    flow: Vec<f64>,
    /// The arrays of every displayed average, `[cell][component][node]`.
    averages: Vec<(Average, Vec<Vec<f64>>)>,
}

/// A cell on a lattice of points with `parts` parts along each axis, axis 0 fastest.
pub struct Patch<const D: usize> {
    /// Parts along each axis.
    pub parts: usize,
    /// Positions.
    pub points: Vec<[f64; D]>,
    /// Values, `[point][quantity]`.
    pub values: Vec<f64>,
}

impl<const D: usize> Scheme<D> {
    /// The scheme of a result file; `None` if the file does not hold the mesh at rest.
    pub fn new(reader: &ResultReader, gas: Gas) -> Option<Self> {
        let axes = |name: &str| reader.layout.exact.iter().find(|array| array.name == name).map(|array| &array.axes);
        let last = |name: &str| axes(name).and_then(|axes| axes.last()).map(|axis| axis.length);
        let mesh_nodes = last("position")?;
        let cells = axes("position")?.first()?.length;
        let flow = last("flow")
            .map(|nodes| (nodes, axes("flow").iter().flat_map(|a| a.iter()).map(|a| a.length).skip(1).product()));
        let rest = reader.metadata.mesh.position.clone();
        let order = |nodes: usize| (nodes as f64).powf(1.0 / D as f64).round() as usize;
        let (mesh_order, flow_order) = (order(mesh_nodes), flow.map_or(order(mesh_nodes), |(nodes, _)| order(nodes)));
        let sampler = |parts: usize| Sampler::new(flow_order, mesh_order, &basis::equidistant_points(parts + 1));
        let complete = rest.len() == cells * mesh_nodes * D;
        let arrays: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
        let quantities = Quantity::of(flow.is_some(), &arrays);
        complete.then(|| Scheme { mesh_nodes, flow, gas, rest, samplers: PARTS.map(sampler).into(), quantities })
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
            Quantity::Average(average) => Some(*average),
            _ => None,
        });
        let arrays = |average: Average| -> Result<_, OutputError> {
            let found = average.arrays.iter().filter_map(|name| reader.exact(name, step).transpose());
            Ok((average, found.collect::<Result<_, _>>()?))
        };
        Ok(Snapshot { scheme: self, position, flow, averages: averages.map(arrays).collect::<Result<_, _>>()? })
    }

    /// The displayed quantities.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// The same scheme with other quantities.
    pub fn showing(self, quantities: Vec<Quantity>) -> Self {
        Scheme { quantities, ..self }
    }

    /// Whether `cell` is one of the flow.
    fn has_flow(&self, cell: usize) -> bool {
        self.flow.is_some() && (cell + 1) * D * self.mesh_nodes <= self.rest.len()
    }

    fn nodes<'b>(&self, positions: &'b [f64], cell: usize) -> &'b [f64] {
        &positions[cell * D * self.mesh_nodes..][..D * self.mesh_nodes]
    }
}

impl<const D: usize> Snapshot<'_, D> {
    /// The lower and upper corner of the box around the nodes of `cell`.
    pub fn cell_box(&self, cell: usize) -> [[f64; D]; 2] {
        let nodes = self.scheme.nodes(&self.position, cell);
        let of = |pick: fn(f64, f64) -> f64| {
            std::array::from_fn(|d| {
                let axis = &nodes[d * self.scheme.mesh_nodes..][..self.scheme.mesh_nodes];
                axis.iter().copied().fold(axis[0], pick)
            })
        };
        [of(f64::min), of(f64::max)]
    }

    /// The entry of [`PARTS`] for a cell of length `pixels`.
    pub fn fineness(pixels: f64) -> usize {
        PARTS.iter().position(|&parts| parts as f64 * PIXELS_PER_PART >= pixels).unwrap_or(PARTS.len() - 1)
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.position.len() / (D * self.scheme.mesh_nodes)
    }

    /// The number of displayed quantities.
    pub fn quantities(&self) -> usize {
        self.scheme.quantities.len()
    }

    /// The largest sum of velocity and speed of sound at a node of the flow.
    pub fn fastest_wave<const M: usize>(&self) -> f64 {
        let gas = &self.scheme.gas;
        let speed = |u: &[f64; M]| {
            let at = Primitive::<f64, D>::unpack(gas, u);
            tensor::norm(&at.velocity) + gas.sound_speed(at.density, at.pressure)
        };
        let nodes = self.scheme.flow.map_or(1, |(nodes, _)| nodes);
        let of_cell = |u: &[f64]| {
            let at = |node: usize| speed(&std::array::from_fn(|m| u[m * nodes + node]));
            (0..nodes).map(at).fold(0.0, f64::max)
        };
        (0..self.cells()).filter_map(|cell| self.state(cell)).map(of_cell).fold(0.0, f64::max)
    }

    /// The first entry of [`PARTS`] with as many parts as a cell has nodes per direction.
    pub fn fineness_of_order(&self) -> usize {
        Self::with_parts(self.order())
    }

    /// The finest entry of [`PARTS`] for pictures, whatever their pixels. In three dimensions a cell of 64 parts has more than a million
    /// tetrahedra, so it has at most the fewest parts that are four for each node.
    pub fn finest(&self) -> usize {
        if D == 2 { PARTS.len() - 1 } else { Self::with_parts(4 * self.order()) }
    }

    fn with_parts(least: usize) -> usize {
        PARTS.iter().position(|&parts| parts >= least).unwrap_or(PARTS.len() - 1)
    }

    /// Nodes per direction of the flow. A run without a flow has those of the mesh.
    fn order(&self) -> usize {
        let nodes = self.scheme.flow.map_or(0, |(nodes, _)| nodes).max(self.scheme.mesh_nodes);
        (nodes as f64).powf(1.0 / D as f64).round() as usize
    }

    /// The Q criterion at the points of a cell, from the coefficients of the flow; `None` for a cell without a flow. M = D + 2.
    pub fn q_criterion<const M: usize>(&self, cell: usize, fineness: usize) -> Option<Vec<f64>> {
        let (scheme, sampler) = (self.scheme, &self.scheme.samplers[fineness]);
        let u = self.state(cell).filter(|_| scheme.has_flow(cell))?;
        let gradients = sampler.gradients(u, scheme.nodes(&self.position, cell));
        let state = &sampler.state(u)[..];
        let sample = CellSample { state, gradients: &gradients, ..CellSample::of_points(sampler.points()) };
        Some(of_flow::<D, M>(Quantity::Flow(Field::QCriterion), &scheme.gas, &sample))
    }

    /// det J at the points of a cell.
    pub fn determinants(&self, cell: usize, fineness: usize) -> Vec<f64> {
        self.scheme.samplers[fineness].determinants(self.scheme.nodes(&self.position, cell))
    }

    /// The positions of a cell, cut into `PARTS[fineness]` parts along each axis.
    pub fn points(&self, cell: usize, fineness: usize) -> Vec<[f64; D]> {
        let sampler = &self.scheme.samplers[fineness];
        let (x, n) = (sampler.positions(self.scheme.nodes(&self.position, cell)), sampler.points());
        (0..n).map(|p| std::array::from_fn(|d| x[d * n + p])).collect()
    }

    /// The cell on a lattice, with all quantities. M = D + 2.
    pub fn patch<const M: usize>(&self, cell: usize, fineness: usize) -> Patch<D> {
        let (scheme, sampler) = (self.scheme, &self.scheme.samplers[fineness]);
        let quantities = scheme.quantities();
        let nodal = scheme.nodes(&self.position, cell);
        if (cell + 1) * D * scheme.mesh_nodes > scheme.rest.len() {
            let values = vec![f64::NAN; quantities.len() * sampler.points()];
            return Patch { parts: PARTS[fineness], points: self.points(cell, fineness), values };
        }
        let jacobian = ratio(&sampler.determinants(nodal), &sampler.determinants(scheme.nodes(&scheme.rest, cell)));
        let columns: Vec<Vec<f64>> = match self.state(cell) {
            None => quantities.iter().map(|quantity| of_mesh(*quantity, &jacobian)).collect(),
            Some(u) => {
                let (state, gradients) = (&sampler.state(u)[..], &sampler.gradients(u, nodal)[..]);
                let sample =
                    CellSample { state, jacobian: &jacobian, gradients, ..CellSample::of_points(sampler.points()) };
                let column = |quantity: &Quantity| match quantity {
                    Quantity::Average(average) => self.average(*average, cell, sampler),
                    _ => of_flow::<D, M>(*quantity, &scheme.gas, &sample),
                };
                quantities.iter().map(column).collect()
            }
        };
        let values = (0..sampler.points()).flat_map(|p| columns.iter().map(move |column| column[p])).collect();
        Patch { parts: PARTS[fineness], points: self.points(cell, fineness), values }
    }

    /// An average at the points of a cell.
    fn average(&self, average: Average, cell: usize, sampler: &Sampler<D>) -> Vec<f64> {
        let nodes = self.scheme.flow.map_or(0, |(nodes, _)| nodes);
        let arrays = self.averages.iter().find(|(other, _)| *other == average).map_or(&[][..], |(_, arrays)| arrays);
        let cells = self.scheme.rest.len() / (D * self.scheme.mesh_nodes);
        let of_cell = |array: &Vec<f64>| array.len() / cells * cell..array.len() / cells * (cell + 1);
        let coefficients: Vec<&[f64]> = arrays.iter().map(|array| &array[of_cell(array)]).collect();
        sampler.state(&average.at_nodes(&coefficients, nodes))
    }

    /// The flow of a cell at the end of the slab, which is the last time node.
    fn state(&self, cell: usize) -> Option<&[f64]> {
        let (nodes, per_cell) = self.scheme.flow?;
        let last = (D + 2) * nodes;
        self.flow.get((cell + 1) * per_cell - last..)?.get(..last)
    }
}

fn ratio(j: &[f64], j0: &[f64]) -> Vec<f64> {
    j.iter().zip(j0).map(|(j, j0)| j / j0).collect()
}

fn of_flow<const D: usize, const M: usize>(quantity: Quantity, gas: &Gas, sample: &CellSample) -> Vec<f64> {
    let Quantity::Flow(field) = quantity else { return of_mesh(quantity, sample.jacobian) };
    let mut values = Vec::new();
    fields::values::<D, M>(field, Some(&Medium::gas(*gas)), sample, &mut values);
    match (field, D) {
        // The third component of the vector.
        (Field::Vorticity, 3) => values.into_iter().skip(2).step_by(3).collect(),
        _ => values,
    }
}

fn of_mesh(quantity: Quantity, jacobian: &[f64]) -> Vec<f64> {
    match quantity {
        Quantity::ScaledJacobian => {
            let [least, most] = [f64::min, f64::max].map(|pick| jacobian.iter().copied().fold(jacobian[0], pick));
            vec![least / most; jacobian.len()]
        }
        _ => jacobian.to_vec(),
    }
}
