//! The exact solution at the end of a slab, evaluated as finely as a picture needs.

use super::average::Average;
use super::patch::of_flow;
use super::quantity::PictureQuantity;
use super::scheme::{PARTS, Scheme};
use crate::fields::CellSample;
use case::Field;
use fem::Sampler;
use navier_stokes::Primitive;

/// The approximate length of a part in pixels; the curvature between its ends is invisible.
const PIXELS_PER_PART: f64 = 4.0;

/// The coefficients at one time. Cells of a structure beside the flow come after those of the flow.
pub struct Snapshot<'a, const D: usize> {
    pub(super) scheme: &'a Scheme<D>,
    pub(super) time: f64,
    /// `[cell][component][node]`
    pub(super) position: Vec<f64>,
    /// `[cell][time node][component][node]`; empty without a flow.
    pub(super) flow: Vec<f64>,
    /// The arrays of every displayed average, `[cell][component][node]`.
    pub(super) averages: Vec<(Average, Vec<Vec<f64>>)>,
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
        let gas = &self.scheme.medium.medium.gas;
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
        self.q_at::<M>(cell, &self.scheme.samplers[fineness])
    }

    /// The same at the nodes of the flow.
    pub fn q_at_nodes<const M: usize>(&self, cell: usize) -> Option<Vec<f64>> {
        self.q_at::<M>(cell, &self.scheme.at_nodes)
    }

    fn q_at<const M: usize>(&self, cell: usize, sampler: &Sampler<D>) -> Option<Vec<f64>> {
        let scheme = self.scheme;
        let u = self.state(cell).filter(|_| scheme.has_flow(cell))?;
        let gradients = sampler.gradients(u, scheme.nodes(&self.position, cell));
        let state = &sampler.state(u)[..];
        let sample = CellSample { state, gradients: &gradients, ..CellSample::of_points(sampler.points()) };
        Some(of_flow::<D, M>(PictureQuantity::Flow(Field::QCriterion), &scheme.medium.medium, &sample))
    }

    /// Numbers at the nodes of the flow as a polynomial at the points of a cell.
    pub fn interpolated(&self, nodal: &[f64], fineness: usize) -> Vec<f64> {
        self.scheme.samplers[fineness].state(nodal)
    }

    /// det J at the points of a cell.
    pub fn determinants(&self, cell: usize, fineness: usize) -> Vec<f64> {
        self.scheme.samplers[fineness].determinants(self.scheme.nodes(&self.position, cell))
    }

    /// The positions of a cell, cut into `PARTS[fineness]` parts along each axis.
    pub fn points(&self, cell: usize, fineness: usize) -> Vec<[f64; D]> {
        self.points_of(cell, &self.scheme.samplers[fineness])
    }

    /// The positions of the nodes of the flow.
    pub fn flow_nodes(&self, cell: usize) -> Vec<[f64; D]> {
        self.points_of(cell, &self.scheme.at_nodes)
    }

    fn points_of(&self, cell: usize, sampler: &Sampler<D>) -> Vec<[f64; D]> {
        let (x, n) = (sampler.positions(self.scheme.nodes(&self.position, cell)), sampler.points());
        (0..n).map(|p| std::array::from_fn(|d| x[d * n + p])).collect()
    }

    /// The flow of a cell at the end of the slab, which is the last time node.
    pub(super) fn state(&self, cell: usize) -> Option<&[f64]> {
        let (nodes, per_cell) = self.scheme.flow?;
        let last = (D + 2) * nodes;
        self.flow.get((cell + 1) * per_cell - last..)?.get(..last)
    }
}
