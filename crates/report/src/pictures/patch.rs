//! A cell on a lattice of points, with the displayed quantities.

use super::average::Average;
use super::quantity::PictureQuantity;
use super::scheme::PARTS;
use super::snapshot::Snapshot;
use crate::fields::{self, CellSample, Medium};
use case::Field;
use fem::Sampler;

/// The value of all quantities in a structure beside the flow, which has a colour of its own.
pub const OF_STRUCTURE: f64 = f64::INFINITY;

/// A cell on a lattice of points with `parts` parts along each axis, axis 0 fastest.
pub struct Patch<const D: usize> {
    /// Parts along each axis.
    pub parts: usize,
    /// Positions.
    pub points: Vec<[f64; D]>,
    /// Values, `[point][quantity]`.
    pub values: Vec<f64>,
}

impl<const D: usize> Snapshot<'_, D> {
    /// The cell on a lattice, with all quantities. M = D + 2.
    pub fn patch<const M: usize>(&self, cell: usize, fineness: usize) -> Patch<D> {
        let (scheme, sampler) = (self.scheme, &self.scheme.samplers[fineness]);
        let quantities = scheme.quantities();
        let nodal = scheme.nodes(&self.position, cell);
        if (cell + 1) * D * scheme.mesh_nodes > scheme.rest.len() {
            let values = vec![OF_STRUCTURE; quantities.len() * sampler.points()];
            return Patch { parts: PARTS[fineness], points: self.points(cell, fineness), values };
        }
        let jacobian = ratio(&sampler.determinants(nodal), &sampler.determinants(scheme.nodes(&scheme.rest, cell)));
        let columns: Vec<Vec<f64>> = match self.state(cell) {
            None => {
                let column = |quantity: &PictureQuantity| match quantity {
                    PictureQuantity::Displacement => self.displacement(cell, sampler),
                    _ => of_mesh(*quantity, &jacobian),
                };
                quantities.iter().map(column).collect()
            }
            Some(u) => {
                let (state, gradients) = (&sampler.state(u)[..], &sampler.gradients(u, nodal)[..]);
                let sample =
                    CellSample { state, jacobian: &jacobian, gradients, ..CellSample::of_points(sampler.points()) };
                let column = |quantity: &PictureQuantity| match quantity {
                    PictureQuantity::Average(average) => self.average(*average, cell, sampler),
                    PictureQuantity::Formula(number) => {
                        let (formula, medium) = (&scheme.medium.formulas[*number..=*number], &scheme.medium.medium);
                        let x = sampler.positions(nodal);
                        fields::of_formulas::<D, M>(formula, Some(medium), &sample, &x, self.time).concat()
                    }
                    _ => of_flow::<D, M>(*quantity, &scheme.medium.medium, &sample),
                };
                quantities.iter().map(column).collect()
            }
        };
        let values = (0..sampler.points()).flat_map(|p| columns.iter().map(move |column| column[p])).collect();
        Patch { parts: PARTS[fineness], points: self.points(cell, fineness), values }
    }

    /// The magnitude of the displacement at the points of a cell.
    fn displacement(&self, cell: usize, sampler: &Sampler<D>) -> Vec<f64> {
        let [now, rest] =
            [&self.position, &self.scheme.rest].map(|all| sampler.positions(self.scheme.nodes(all, cell)));
        let n = sampler.points();
        let magnitude = |p: usize| (0..D).map(|d| (now[d * n + p] - rest[d * n + p]).powi(2)).sum::<f64>().sqrt();
        (0..n).map(magnitude).collect()
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
}

fn ratio(j: &[f64], j0: &[f64]) -> Vec<f64> {
    j.iter().zip(j0).map(|(j, j0)| j / j0).collect()
}

/// A quantity of the flow or the mesh at the points of a sample.
pub fn of_flow<const D: usize, const M: usize>(
    quantity: PictureQuantity,
    medium: &Medium,
    sample: &CellSample,
) -> Vec<f64> {
    let PictureQuantity::Flow(field) = quantity else { return of_mesh(quantity, sample.jacobian) };
    let mut values = Vec::new();
    fields::values::<D, M>(field, Some(medium), sample, &mut values);
    match (field, D) {
        // The third component of the vector.
        (Field::Vorticity, 3) => values.into_iter().skip(2).step_by(3).collect(),
        (Field::Velocity, _) => values.chunks_exact(3).map(magnitude).collect(),
        _ => values,
    }
}

/// The magnitude of a vector.
fn magnitude(vector: &[f64]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn of_mesh(quantity: PictureQuantity, jacobian: &[f64]) -> Vec<f64> {
    match quantity {
        PictureQuantity::ScaledJacobian => {
            let [least, most] = [f64::min, f64::max].map(|pick| jacobian.iter().copied().fold(jacobian[0], pick));
            vec![least / most; jacobian.len()]
        }
        _ => jacobian.to_vec(),
    }
}
