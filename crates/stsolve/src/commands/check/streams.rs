//! Warnings about streams that do not fit the walls, the frame or each other.

use super::Facts;
use super::warnings::{Warning, warning};
use case::{Flow, State};
use navier_stokes::{Boundary, Gas, Primitive, Source};
use tensor::norm;

/// The initial state differs from the far field by more than this, in parts of the density, the speed or the pressure outside.
const UNLIKE: f64 = 1e-2;

/// The reference state differs from the far field by more than this, in parts of the density, the speed or the pressure there.
const OTHER_SCALE: f64 = 0.05;

/// The sine of the least angle between drag and the far field that causes a warning: 0.06 degrees.
const TURNED: f64 = 1e-3;

/// A uniform flow and a vortex do not satisfy the conditions of walls without slip, nor of most others.
pub(super) fn exact<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let knows_no_walls = matches!(&flow.exact, Some(State::Uniform(_) | State::Vortex(_)));
    let sticks = flow.walls.iter().any(|wall| flow.boundary[wall.boundary].condition.is_no_slip());
    let may_go_along_walls = !sticks && matches!(&flow.exact, Some(State::Uniform(_)));
    if flow.walls.is_empty() || !knows_no_walls || may_go_along_walls || flow.is_manufactured() {
        return None;
    }
    let text = "`flow.exact` is no solution of a flow with walls, and errors against it mean nothing: `flow.initial` in its place, for instance \
                `initial = { uniform = { velocity = [1, 0], mach = 0.2 } }`, and `far_field` where boundaries are \"exact\"";
    warning("exact solution", text.to_owned())
}

/// A uniform stream does not satisfy the equations of a rotating frame.
pub(super) fn rotating_frame<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    if !matches!(flow.law.source, Source::Rotating(_)) {
        return None;
    }
    let (key, remedy) = match (&flow.exact, far_fields(facts, flow).next()) {
        (Some(State::Uniform(_)), _) => ("flow.exact".to_owned(), "exact"),
        (_, Some((name, _))) => (format!("flow.boundary.{name}.far_field"), "prescribed_state"),
        _ => return None,
    };
    let text = format!(
        "`{key}` is uniform, and no solution in a rotating frame, where centrifugal and Coriolis forces accelerate it: formulas, \
         `{remedy} = {{ expression = ... }}`; gas at rest outside has the velocity [\"rate*y\", \"-rate*x\"] about the z axis"
    );
    warning("rotating frame", text)
}

/// A uniform initial state that the far field changes at once: often one of the two was forgotten.
pub(super) fn unlike<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let State::Uniform(state) = &flow.initial else { return None };
    let (start, gas) = (state.primitive(), &flow.law.gas);
    // Gas at rest that a far field sets into motion is a choice.
    let (name, outside) =
        far_fields(facts, flow).find(|(_, outside)| norm(&start.velocity) > 0.0 && differ(&start, outside))?;
    let text = format!(
        "the flow starts with {}, and the far field `{name}` has {}, to which the flow turns: one state for both if that is not meant",
        described(&start, gas),
        described(&outside, gas)
    );
    warning("free stream", text)
}

/// A reference state that is not that of the stream: coefficients and numbers of the flow then refer to another one.
pub(super) fn unlike_reference<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (law, (name, outside)) = (&flow.law, far_fields(facts, flow).next()?);
    let speed = norm(&outside.velocity);
    let reference = [law.reference.density(), flow.reference_speed, law.reference.pressure(&law.gas)];
    let outside = [outside.density, speed, outside.pressure];
    let differs = |(a, b): (&f64, &f64)| (a - b).abs() > OTHER_SCALE * b;
    // Where the gas rests far away, walls give the scale of speed.
    if speed == 0.0 || !reference.iter().zip(&outside).any(differs) {
        return None;
    }
    let list =
        |[density, speed, pressure]: [f64; 3]| format!("density {density}, speed {speed}, pressure {pressure:.5}");
    let text = format!(
        "`flow.reference` has {}, and the far field `{name}` {}: force coefficients, the Reynolds number and the Mach number refer to the first; one \
         state for both if that is not meant",
        list(reference),
        list(outside)
    );
    warning("reference state", text)
}

/// `flow.gas.mach` is a unit of the temperature: changed alone it changes no flow.
pub(super) fn other_mach<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let (of_gas, of_stream) = (flow.gas_mach?, flow.law.reference.mach());
    ((of_gas - of_stream).abs() > OTHER_SCALE * of_stream).then(|| {
        let text = format!(
            "`flow.gas.mach` = {of_gas} sets the gas constant alone, so that the temperature is 1 in a flow of that Mach number; the reference state has \
             {of_stream:.4}: change the `mach` or the pressure of `flow.initial`, of far fields and inflows too"
        );
        Warning { subject: "Mach number of the gas", text }
    })
}

fn far_fields<'a, const D: usize>(
    facts: &'a Facts<'_, D>,
    flow: &'a Flow<D>,
) -> impl Iterator<Item = (&'a String, Primitive<f64, D>)> {
    flow.boundary.iter().zip(facts.case.mesh.boundary_names()).filter_map(|(data, name)| match &data.condition {
        Boundary::FarField(far) => Some((name, far.free_stream())),
        _ => None,
    })
}

fn differ<const D: usize>(start: &Primitive<f64, D>, outside: &Primitive<f64, D>) -> bool {
    let change: [f64; D] = std::array::from_fn(|i| start.velocity[i] - outside.velocity[i]);
    norm(&change) > UNLIKE * norm(&outside.velocity)
        || (start.density - outside.density).abs() > UNLIKE * outside.density
        || (start.pressure - outside.pressure).abs() > UNLIKE * outside.pressure
}

fn described<const D: usize>(stream: &Primitive<f64, D>, gas: &Gas) -> String {
    let Primitive { density, velocity, pressure } = stream;
    let mach = gas.mach(stream);
    format!("density {density}, velocity {velocity:?}, pressure {pressure:.5}, Mach {mach:.3}")
}

/// Drag is along x unless told otherwise, also at an angle of attack.
pub(super) fn drag_direction<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (_, outside) = far_fields(facts, flow).next()?;
    let speed = norm(&outside.velocity);
    let is_along_x = |direction: &[f64; D]| direction[0] == 1.0;
    let wall = flow.walls.iter().find(|wall| is_along_x(&wall.scales.drag_direction))?;
    let across = norm(&std::array::from_fn::<f64, D, _>(|i| if i == 0 { 0.0 } else { outside.velocity[i] }));
    if across <= TURNED * speed {
        return None;
    }
    let (name, velocity) = (&wall.name, &outside.velocity);
    let text = format!(
        "the far field has the velocity {velocity:?}, and drag of `{name}` is the force along x: `flow.forces.{name}.drag_direction = {velocity:?}` for \
         drag and lift of the stream"
    );
    warning("drag", text)
}
