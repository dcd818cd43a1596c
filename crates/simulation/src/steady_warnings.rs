//! What a search for a steady flow cannot determine, or holds at its start.

use case::{BoundaryData, Case, Control, Flow};
use navier_stokes::{Boundary, Source};

/// Warnings about the steady flow that a case searches for.
pub fn undetermined<const D: usize>(case: &Case<D>) -> Vec<String> {
    let Some(flow) = case.flow.as_ref().filter(|_| case.solver.steady.is_some()) else { return Vec::new() };
    [undetermined_energy(flow), held_controls(case, flow)].into_iter().flatten().collect()
}

/// Whether a wall moves in its own plane.
pub(crate) fn slides<const D: usize>(data: &BoundaryData<D>) -> bool {
    match &data.condition {
        Boundary::AdiabaticWall(wall) => wall.slide() != Some([0.0; D]),
        Boundary::IsothermalWall(wall) => wall.slide() != Some([0.0; D]),
        _ => false,
    }
}

/// Gas that is enclosed or periodic keeps the heat of friction, unless a wall or a sponge takes it. A force and a wall that slides do work on
/// it.
fn undetermined_energy<const D: usize>(flow: &Flow<D>) -> Option<String> {
    let is_enclosed = flow.boundary.iter().all(|data| data.condition.is_solid()) && flow.conserves_mass();
    let has_heat_flow = flow.boundary.iter().any(|data| matches!(data.condition, Boundary::IsothermalWall(_)));
    let is_forced = flow.source.is_some() && !flow.is_manufactured() && flow.law.source != Source::Given;
    let works = is_forced || flow.boundary.iter().any(slides);
    (is_enclosed && !has_heat_flow && works).then(|| {
        "no wall takes heat, and a force or a wall that slides does work: friction heats moving gas for ever, so there may be no steady flow, and \
         the temperature of gas at rest depends on `solver.steady.first_step`: an `isothermal_wall`, or a march in time without `[solver.steady]`"
            .to_owned()
    })
}

/// Controls begin with the march in time.
fn held_controls<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<String> {
    let of_boundary = |control: &Control| flow.boundary.iter().any(|data| data.control.as_ref() == Some(control));
    let control = case.controls.iter().find(|control| control.is_used && !of_boundary(control))?;
    Some(format!(
        "the steady flow is that of `controls.{0}.initial` = {1}: controls change in time only; give `initial` the value that is expected, or search \
         for no steady flow",
        control.name, control.initial
    ))
}
