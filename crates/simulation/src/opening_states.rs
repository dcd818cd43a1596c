//! The mean state of the gas that crosses inflows and outflows: columns of history.csv.
//!
//! ```text
//! <q> = int q rho (w - v) . n dA / int rho (w - v) . n dA,     q = p (1 + (gamma - 1)/2 M^2)^(gamma/(gamma - 1)), T (1 + (gamma - 1)/2 M^2), p
//! <w_n> = int w . n dA / int dA
//! loss = ( <p_0> of the inflow - <p_0> of the outflow ) / ( <p_0> - <p> of the outflow )
//! ```
//!
//! for an observer at rest, with the velocities w of the gas and v of the boundary: total pressure, total temperature, static pressure, normal
//! velocity. A case with one inflow and one outflow has a loss. The weight is the signed mass flow: gas that flows back counts negatively. With
//! backflow `<q>` may therefore lie outside of the values on the boundary, and it has no limit where the mass flow vanishes.

use super::cells::StateInCells;
use super::history::openings;
use super::nodal::{by_node, dot_of};
use case::{Case, Flow};
use coupled::MeshMover;
use fem::functions_at;
use mesh::{BoundaryFacet, CellMap, axis_and_side, outward_area, outward_sign};
use navier_stokes::{Boundary, Gas, Primitive};
use report::fields::total_state;
use tensor::{dot, norm};

const NAMES: [&str; 4] = ["total_pressure", "total_temperature", "pressure", "velocity"];

/// The names of the columns.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    let Some(flow) = &case.flow else { return Vec::new() };
    let name = |boundary: usize| &case.mesh.boundary_names()[boundary];
    let of_openings = openings(flow).flat_map(|boundary| NAMES.map(|column| format!("{}_{column}", name(boundary))));
    of_openings.chain(passage(flow).map(|_| "loss_coefficient".to_owned())).collect()
}

/// The places of the inflow and of the outflow among the openings, if there is one of each.
fn passage<const D: usize>(flow: &Flow<D>) -> Option<[usize; 2]> {
    let is_outflow = |boundary: usize| matches!(flow.boundary[boundary].condition, Boundary::Outflow(_));
    match openings(flow).map(is_outflow).collect::<Vec<bool>>()[..] {
        [false, true] => Some([0, 1]),
        [true, false] => Some([1, 0]),
        _ => None,
    }
}

/// Integrals over a boundary.
#[derive(Default)]
struct Sums {
    area: f64,
    /// w . n
    volume: f64,
    /// rho (w - v) . n, and that times each quantity.
    mass: f64,
    carried: [f64; 3],
}

impl Sums {
    /// The means, in the order of [`NAMES`]. Their weights are signed, so that with backflow they may lie outside of the values that they average.
    fn means(&self) -> [f64; NAMES.len()] {
        let [total_pressure, total_temperature, pressure] = self.carried.map(|sum| sum / self.mass);
        [total_pressure, total_temperature, pressure, self.volume / self.area]
    }
}

/// The points of one face of the reference cell.
pub struct FacePoints<const D: usize> {
    /// The map of the mesh there.
    pub map: CellMap<D>,
    /// The functions of the flow and of the mesh at each point.
    pub functions: Vec<[Vec<f64>; 2]>,
    /// The derivatives of those of the flow along each reference direction.
    pub slopes: Vec<[Vec<f64>; D]>,
    /// Weights on the reference face.
    pub weights: Vec<f64>,
}

impl<const D: usize> FacePoints<D> {
    /// The Gauss points of `face`, one more per direction than the higher order has nodes.
    pub fn new(face: usize, flow_order: usize, mesh_order: usize) -> Self {
        Self::with_rule(face, [flow_order, mesh_order], &basis::gauss(flow_order.max(mesh_order) + 1))
    }

    /// The points of `rule` on `face`, for a flow and a mesh of the given orders.
    pub fn with_rule(face: usize, [flow_order, mesh_order]: [usize; 2], rule: &basis::Rule) -> Self {
        let ((axis, _), n) = (axis_and_side(face), rule.points.len());
        let point = |index: usize| -> [f64; D] {
            let along = |d: usize| rule.points[index / n.pow(d as u32) % n];
            std::array::from_fn(
                |d| if d == axis { outward_sign(face) } else { along(if d > axis { d - 1 } else { d }) },
            )
        };
        let points: Vec<[f64; D]> = (0..n.pow(D as u32 - 1)).map(point).collect();
        FacePoints {
            map: CellMap::on_face(mesh_order, face, &rule.points),
            functions: points.iter().map(|xi| [flow_order, mesh_order].map(|order| functions_at(order, xi))).collect(),
            slopes: points.iter().map(|xi| slopes_at(flow_order, xi)).collect(),
            weights: rule.tensor_weights(D - 1),
        }
    }
}

/// The derivatives of the nodal functions of order `order` at `xi` along each axis, axis 0 fastest.
pub fn slopes_at<const D: usize>(order: usize, xi: &[f64; D]) -> [Vec<f64>; D] {
    let basis = basis::Lagrange::gauss_lobatto(order);
    let along = |axis: usize, of: usize| if axis == of { basis.derivatives(xi[of]) } else { basis.values(xi[of]) };
    std::array::from_fn(|axis| {
        (0..D).fold(vec![1.0], |product: Vec<f64>, of| {
            along(axis, of).iter().flat_map(|phi| product.iter().map(move |p| p * phi)).collect()
        })
    })
}

/// The flow at one time.
pub struct OpeningStates<'a, const D: usize> {
    /// The flow of the case.
    pub flow: &'a Flow<D>,
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// Its displacement, and its velocity; empty if the velocity is not known.
    pub motion: [&'a [f64]; 2],
    /// The state in the cells at openings.
    pub state: &'a StateInCells<'a>,
}

impl<const D: usize> OpeningStates<'_, D> {
    /// The values of the columns; NaN where nothing crosses a boundary.
    pub fn row<const M: usize>(&self) -> Vec<f64> {
        let (order, mesh) = (self.flow.order, &self.mover.reference);
        if openings(self.flow).next().is_none() {
            return Vec::new();
        }
        let faces: Vec<FacePoints<D>> = (0..2 * D).map(|face| FacePoints::new(face, order, mesh.order())).collect();
        let means = |boundary: usize| {
            let mut sums = Sums::default();
            for facet in mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary) {
                self.add::<M>(facet, &faces[facet.side.face], &mut sums);
            }
            sums.means()
        };
        let states: Vec<_> = openings(self.flow).map(means).collect();
        let loss = passage(self.flow).map(|[inflow, outflow]| {
            let ([before, ..], [after, _, pressure, _]) = (states[inflow], states[outflow]);
            (before - after) / (after - pressure)
        });
        states.iter().flatten().copied().chain(loss).collect()
    }

    /// Adds a facet.
    fn add<const M: usize>(&self, facet: &BoundaryFacet, points: &FacePoints<D>, sums: &mut Sums) {
        let (cell, face) = (facet.side.cell, facet.side.face);
        let nodal = by_node::<D>(&self.mover.cell_positions(cell, self.motion[0]));
        let state = self.state.of(cell);
        let at_points = points.functions.iter().zip(points.map.jacobians(&nodal)).zip(&points.weights);
        for (([functions, of_mesh], jacobian), weight) in at_points {
            let u: [f64; M] = std::array::from_fn(|m| dot_of(&state[m * functions.len()..], functions));
            let gas = Primitive::<f64, D>::unpack(&self.flow.law.gas, &u);
            let (normal, velocity) = (outward_area(&jacobian, face), self.velocity(cell, of_mesh));
            let relative: [f64; D] = std::array::from_fn(|i| gas.velocity[i] - velocity[i]);
            let mass = weight * gas.density * dot(&relative, &normal);
            sums.mass += mass;
            sums.carried.iter_mut().zip(quantities(&self.flow.law.gas, &gas)).for_each(|(sum, q)| *sum += mass * q);
            sums.area += weight * norm(&normal);
            sums.volume += weight * dot(&gas.velocity, &normal);
        }
    }

    /// The velocity of the mesh in a cell.
    fn velocity(&self, cell: usize, functions: &[f64]) -> [f64; D] {
        let at = |node: usize, i: usize| self.motion[1].get(node * D + i).copied().unwrap_or(0.0);
        let nodes = || self.mover.numbering.cell(cell).iter().zip(functions);
        std::array::from_fn(|i| nodes().map(|(&node, phi)| phi * at(node, i)).sum())
    }
}

/// Total pressure, total temperature, pressure.
fn quantities<const D: usize>(gas: &Gas, at: &Primitive<f64, D>) -> [f64; 3] {
    let [pressure, temperature] = total_state(gas, at);
    [pressure, temperature, at.pressure]
}
