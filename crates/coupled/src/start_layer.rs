//! An initial state with a boundary layer at its walls.
//!
//! A uniform state contradicts no-slip walls: the velocity jumps at the first node, and Newton's method may fail in the first slab. In the
//! layer the velocity falls to that of the wall,
//!
//! ```text
//! w(x) = w_b + (w_0(x) - w_b) (1 - exp(-(d_w(x) / delta)^2)),   w_b = sum_k d_k^-2 w_k / sum_k d_k^-2,   d_w = min_k d_k     (start layer)
//! ```
//!
//! with the distance d_k to wall k and its mean velocity w_k. Density and pressure stay as they are.

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

/// A no-slip boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerWall {
    /// Its index.
    pub boundary: usize,
    /// w_k, its mean velocity.
    pub velocity: Vec<f64>,
}

/// The layer at the walls of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartLayer {
    /// The walls.
    pub walls: Vec<LayerWall>,
    /// The state without a layer, once there is one.
    pub given: Vec<f64>,
}

impl StartLayer {
    /// The layer at these walls.
    pub fn new(walls: Vec<LayerWall>) -> Self {
        StartLayer { walls, ..StartLayer::default() }
    }

    /// Gives `u` the next thicker layer after so many that were `tried`; returns its thickness. `None` if there are no walls, or all thicknesses
    /// were tried.
    pub(crate) fn thicken<const D: usize, const M: usize>(
        &mut self,
        flow: &SlabOperator<D, M>,
        mover: &MeshMover<D>,
        tried: usize,
        u: &mut [f64],
    ) -> Option<f64> {
        if self.walls.is_empty() || tried >= ATTEMPTS {
            return None;
        }
        if tried == 0 {
            self.given = u.to_vec();
        }
        let thickness = FIRST * size(mover, &self.boundaries()) * 2.0_f64.powi(tried as i32);
        if !(thickness > 0.0 && thickness.is_finite()) {
            return None;
        }
        u.copy_from_slice(&self.given);
        self.apply(flow, mover, thickness, u);
        Some(thickness)
    }

    fn boundaries(&self) -> Vec<usize> {
        self.walls.iter().map(|wall| wall.boundary).collect()
    }

    /// Applies (start layer) to the state `u`.
    pub fn apply<const D: usize, const M: usize>(
        &self,
        flow: &SlabOperator<D, M>,
        mover: &MeshMover<D>,
        thickness: f64,
        u: &mut [f64],
    ) {
        let of_wall = |wall: &LayerWall| BoundaryDistance::new(&mover.reference, &[wall.boundary]);
        let distances: Vec<BoundaryDistance<D>> = self.walls.iter().map(of_wall).collect();
        let (map, one) = (nodes_of_flow(flow), flow.layout.at_one_time());
        for (cell, of_mesh) in flow.share.own.iter().enumerate() {
            let positions = map.positions(mover.reference.cell_coordinates(*of_mesh));
            for (i, x) in positions.iter().enumerate() {
                let distances: Vec<f64> = distances.iter().map(|distance| distance.at(x)).collect();
                let factor = -(-(smallest(distances.iter().copied()) / thickness).powi(2)).exp_m1();
                let entry = |m: usize| one.index(cell, 0, m, i);
                let slowed = slowed::<D, M>(&from_fn(|m| u[entry(m)]), &self.velocity_of_walls(&distances), factor);
                (0..M).for_each(|m| u[entry(m)] = slowed[m]);
            }
        }
    }

    /// w_b at these `distances` from the walls.
    fn velocity_of_walls<const D: usize>(&self, distances: &[f64]) -> [f64; D] {
        // Relative to the smallest distance: on a wall its weight is one, and those of the others vanish.
        let nearest = smallest(distances.iter().copied());
        let weight = |d: f64| if d == nearest { 1.0 } else { (nearest / d).powi(2) };
        let weights: Vec<f64> = distances.iter().map(|d| weight(*d)).collect();
        let mean =
            |axis: usize| sum(&self.walls.iter().zip(&weights).map(|(k, w)| w * k.velocity[axis]).collect::<Vec<_>>());
        from_fn(|axis| mean(axis) / sum(&weights))
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

    /// One mean velocity of all walls made jumps at walls that slide: gas at rest beside the upper wall of a Couette flow.
    #[test]
    fn the_velocity_is_that_of_the_nearest_wall() {
        let wall = |boundary, velocity: [f64; 2]| LayerWall { boundary, velocity: velocity.to_vec() };
        let layer = StartLayer::new(vec![wall(0, [0.0, 0.0]), wall(1, [3.0, 1.0])]);
        for (distances, expected) in
            [([0.0, 1.0], [0.0, 0.0]), ([1.0, 0.0], [3.0, 1.0]), ([0.5, 0.5], [1.5, 0.5]), ([2.0, 1.0], [2.4, 0.8])]
        {
            let found = layer.velocity_of_walls::<2>(&distances);
            assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-15), "{distances:?}: {found:?}");
        }
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
