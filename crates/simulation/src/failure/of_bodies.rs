//! Measurements of the bodies of a failed run.

use super::data::Bodies;
use super::grid::Grid;
use crate::bodies::{beside_flow, extent, has_bodies};
use case::{Case, Flow};
use coupled::State;
use std::f64::consts::PI;

/// The bodies of `case` in the `state` before a slab of the length `dt` that failed.
pub fn measure<const D: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    grid: &Grid<D>,
    state: &State,
    dt: f64,
) -> Option<Bodies> {
    has_bodies(case).then(|| Bodies {
        travel: travel(grid, state, dt),
        added_mass: added_mass(case, flow),
        unheld: None,
        inverted: None,
    })
}

/// The path of nodes at the velocity of the last time node, in thicknesses of their cells.
fn travel<const D: usize>(grid: &Grid<D>, state: &State, dt: f64) -> f64 {
    let Some(past) = &state.past else { return 0.0 };
    let velocity = &past.v[past.v.len() - state.d.len()..];
    let path: Vec<f64> = velocity.iter().map(|v| v * dt).collect();
    grid.longest_path(&path, &state.d)
}

/// The mass of a cylinder or sphere of fluid as large as a body over that of the body.
fn added_mass<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> f64 {
    let fluid = |size: f64| flow.law.reference.density() * PI / (2 * D) as f64 * size.powi(D as i32);
    let rigid = case.bodies.iter().map(|body| fluid(extent(&case.mesh, &body.walls)) / body.mass);
    let elastic = beside_flow(case).map(|(structure, part)| {
        let mass = structure.density.unwrap_or(f64::INFINITY) * part.mesh.volume();
        fluid(extent(&case.mesh, &part.walls)) / mass
    });
    rigid.chain(elastic).fold(0.0, f64::max)
}
