//! An initial state with a boundary layer at its walls.
//!
//! A uniform state contradicts no-slip walls: the velocity jumps at the first node, and Newton's method may fail in the first slab. In the
//! layer the velocity falls to that of the wall,
//!
//! ```text
//! w(x) = w_b + (w_0(x) - w_b) (1 - exp(-(d_w(x) / delta)^2))                                                   (start layer)
//! ```
//!
//! with the distance d_w to the walls and their mean velocity w_b. Density and pressure stay as they are.

use crate::mesh_mover::MeshMover;
use basis::gauss_lobatto;
use fem::SlabOperator;
use mesh::{BoundaryDistance, CellMap};
use navier_stokes::Conserved;
use newton_krylov::inner_product::{largest, smallest, sum};
use std::array::from_fn;

/// The first thickness tried, relative to the size of the flow around the walls. With thinner layers a later slab was seen to fail.
const FIRST: f64 = 0.3;

/// How many thicknesses are tried, each twice the one before.
const ATTEMPTS: usize = 2;

/// An initial state that was made easier.
#[derive(Clone, Debug, PartialEq)]
pub struct EasedStart {
    /// How many layers were tried.
    pub attempts: usize,
    /// delta of (start layer).
    pub thickness: f64,
    /// The integral of every component of the initial state with the layer.
    pub totals: Vec<f64>,
}

/// The layer at the walls of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartLayer {
    /// The no-slip boundaries.
    pub walls: Vec<usize>,
    /// The state without a layer, once there is one.
    pub given: Vec<f64>,
}

impl StartLayer {
    /// The layer at these boundaries.
    pub fn new(walls: Vec<usize>) -> Self {
        StartLayer { walls, ..StartLayer::default() }
    }

    /// Gives `u` the next thicker layer after so many that were `tried`; returns its thickness. `None` if there are no walls, or all thicknesses
    /// were tried.
    pub(crate) fn thicken<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        (mover, time): (&MeshMover<D>, f64),
        tried: usize,
        u: &mut [f64],
    ) -> Option<f64> {
        if self.walls.is_empty() || tried >= ATTEMPTS {
            return None;
        }
        if tried == 0 {
            self.given = u.to_vec();
        }
        let thickness = FIRST * size(mover, &self.walls) * 2.0_f64.powi(tried as i32);
        if !(thickness > 0.0 && thickness.is_finite()) {
            return None;
        }
        u.copy_from_slice(&self.given);
        self.apply(flow, (mover, time), thickness, u);
        Some(thickness)
    }

    /// Applies (start layer) to the state `u` at one time.
    pub fn apply<const D: usize, const M: usize>(
        &self,
        flow: &SlabOperator<D, M>,
        (mover, time): (&MeshMover<D>, f64),
        thickness: f64,
        u: &mut [f64],
    ) {
        let distance = BoundaryDistance::new(&mover.reference, &self.walls);
        let (map, one) = (nodes_of_flow(flow), flow.layout.at_one_time());
        let wall_velocity = self.mean_velocity(mover, time);
        for (cell, of_mesh) in flow.share.own.iter().enumerate() {
            let positions = map.positions(mover.reference.cell_coordinates(*of_mesh));
            for (i, x) in positions.iter().enumerate() {
                let factor = -(-(distance.at(x) / thickness).powi(2)).exp_m1();
                let entry = |m: usize| one.index(cell, 0, m, i);
                let slowed = slowed::<D, M>(&from_fn(|m| u[entry(m)]), &wall_velocity, factor);
                (0..M).for_each(|m| u[entry(m)] = slowed[m]);
            }
        }
    }

    /// w_b, the mean velocity of the nodes of the walls.
    fn mean_velocity<const D: usize>(&self, mover: &MeshMover<D>, time: f64) -> [f64; D] {
        let mut velocity = vec![0.0; mover.field_len()];
        mover.prescribe_velocity(time, &mut velocity);
        let nodes = nodes_on(mover, &self.walls);
        let along = |axis: usize| nodes.iter().map(|node| velocity[node * D + axis]).collect::<Vec<f64>>();
        from_fn(|axis| sum(&along(axis)) / nodes.len().max(1) as f64)
    }
}

/// The map to the nodes of the flow in a cell.
fn nodes_of_flow<const D: usize, const M: usize>(flow: &SlabOperator<D, M>) -> CellMap<D> {
    let orders = flow.tables.orders;
    CellMap::on_grid(orders.mesh, &gauss_lobatto(orders.flow).points)
}

/// The C0 nodes on these boundaries. A node on two of them is listed twice.
fn nodes_on<const D: usize>(mover: &MeshMover<D>, walls: &[usize]) -> Vec<usize> {
    walls.iter().flat_map(|&wall| mover.numbering.on_boundary(&mover.reference, wall)).collect()
}

/// The size of the flow around the walls: the largest extent of the walls along an axis, or the largest distance from them if that is less.
fn size<const D: usize>(mover: &MeshMover<D>, walls: &[usize]) -> f64 {
    let distance = BoundaryDistance::new(&mover.reference, walls);
    // Between two walls one cell apart no node of the mesh may lie inside.
    let centre = CellMap::on_grid(mover.reference.order(), &[0.0]);
    let centres =
        (0..mover.reference.n_cells()).map(|cell| centre.positions(mover.reference.cell_coordinates(cell))[0]);
    let farthest = largest(mover.positions().iter().copied().chain(centres).map(|x| distance.at(&x)));
    let on_walls = nodes_on(mover, walls);
    let extent = |axis: usize| {
        let along = || on_walls.iter().map(|node| mover.positions()[*node][axis]);
        largest(along()) - smallest(along())
    };
    largest((0..D).map(extent)).min(farthest)
}

/// The state `u` with its velocity relative to `wall` multiplied by `factor`, at the same density and pressure.
fn slowed<const D: usize, const M: usize>(u: &[f64; M], wall: &[f64; D], factor: f64) -> [f64; M] {
    let state = Conserved::<f64, D>::unpack(u);
    let before = state.velocity();
    let velocity: [f64; D] = from_fn(|i| wall[i] + (before[i] - wall[i]) * factor);
    let gain = 0.5 * state.density * (tensor::dot(&velocity, &velocity) - tensor::dot(&before, &before));
    Conserved { momentum: velocity.map(|w| state.density * w), energy: state.energy + gain, ..state }.pack()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::MeshMotion;
    use mesh::NodeNumbering;
    use mesh::generate::AnnulusMesh;
    use navier_stokes::{Gas, Primitive, Viscosity};

    #[test]
    fn density_and_pressure_stay_and_the_velocity_is_that_of_the_wall() -> Result<(), Box<dyn std::error::Error>> {
        let gas = Gas::new(1.4, 1.0, 0.7, Viscosity::Inviscid)?;
        let given = Primitive { density: 1.3, velocity: [0.4, -0.2], pressure: 0.9 };
        for (factor, expected) in [(0.0, [0.1, 0.2]), (1.0, given.velocity), (0.5, [0.25, 0.0])] {
            let u = slowed::<2, 4>(&given.pack(&gas), &[0.1, 0.2], factor);
            let state = Primitive::<f64, 2>::unpack(&gas, &u);
            assert!((state.density - 1.3).abs() < 1e-15 && (state.pressure - 0.9).abs() < 1e-15);
            assert!((0..2).all(|i| (state.velocity[i] - expected[i]).abs() < 1e-15), "{factor}: {state:?}");
        }
        Ok(())
    }

    #[test]
    fn the_size_is_that_of_the_body_or_of_the_room() -> Result<(), Box<dyn std::error::Error>> {
        for (outer_radius, expected) in [(20.0, 1.0), (0.9, 0.4)] {
            let annulus = AnnulusMesh { inner_radius: 0.5, outer_radius, first_cell: 0.03, cells: [12, 9], order: 5 };
            let mesh = annulus.build()?;
            let wall = mesh.boundary_names().iter().position(|name| name == "wall").ok_or("no wall")?;
            let numbering = NodeNumbering::new(&mesh, mesh.order());
            let found = size(&MeshMover::new(MeshMotion::Still, mesh, numbering, 1), &[wall]);
            assert!((found - expected).abs() < 1e-3, "{found}, expected {expected}");
        }
        Ok(())
    }
}
