//! The flow.

use super::forces::{self, Wall};
use super::mesh_crate::Mesh;
use super::states::{self, Typical};
use crate::case::checker::{Checked, Checker};
use crate::case::key::Key;
use crate::case::raw;
use crate::case::state::State;
use navier_stokes::{
    AdiabaticWall, Boundary, FarField, Gas, Inflow, IsothermalWall, NavierStokes, Outflow, PrescribedState, Reference,
    Riemann, SlipWall, Viscosity,
};

/// The compressible flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow<const D: usize> {
    /// N_s, nodes per direction and cell.
    pub order: usize,
    /// The gas, the numerical flux, the reference state.
    pub law: NavierStokes<D>,
    /// A typical speed, that of the reference state.
    pub reference_speed: f64,
    /// A typical length, for the Reynolds number.
    pub reference_length: f64,
    /// The quadrature points.
    pub quadrature: fem::Quadrature,
    /// The state at the start.
    pub initial: State<D>,
    /// The velocity at the start, if that is the same everywhere.
    pub uniform_velocity: Option<[f64; D]>,
    /// The solution, if it is known.
    pub exact: Option<State<D>>,
    /// Whether there is the source that makes `exact` the solution.
    pub manufactured: bool,
    /// The condition on each boundary, in the order of `Mesh::boundary_names`.
    pub boundary: Vec<BoundaryData<D>>,
    /// The boundaries that are walls.
    pub walls: Vec<Wall<D>>,
}

impl<const D: usize> Flow<D> {
    /// The pressure of the reference state.
    pub fn reference_pressure(&self) -> f64 {
        self.law.reference.pressure(&self.law.gas)
    }
}

/// The condition on a boundary, and the state that it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryData<const D: usize> {
    /// The condition.
    pub condition: Boundary<D>,
    /// The prescribed state, for those conditions that take one.
    pub state: Option<State<D>>,
}

/// Checks `[flow]` of a run that starts at time `start`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<Flow<D>> {
    let key = Key::new("flow");
    let order = super::order(checker, &key.child("order"), "the order of the flow", raw.order)?;
    let gas = gas(checker, &key.child("gas"), &raw.gas)?;
    let state = |name: &str, state: &Option<raw::State>| {
        state.as_ref().map(|state| states::check::<D>(checker, &key.child(name), state, gas)).transpose()
    };
    let (exact, initial) = (state("exact", &raw.exact)?, state("initial", &raw.initial)?);
    let Some(start_state) = initial.as_ref().or(exact.as_ref()).map(|typical| typical.state.clone()) else {
        let accepted = "a key `initial`, or `exact` from which it is taken";
        return Err(checker.combination(&key, "there is no initial state", accepted));
    };
    let stream = exact.as_ref().or(initial.as_ref()).and_then(|typical| typical.stream);
    let (reference, reference_speed, reference_length) = reference(checker, &key, raw.reference.as_ref(), stream, gas)?;
    let uniform = initial.as_ref().filter(|typical| matches!(typical.state, State::Uniform(_)));
    let uniform_velocity = uniform.and_then(|typical| typical.stream).map(|stream| stream.velocity);
    let exact = exact.map(|typical| typical.state);
    if initial.is_none() && exact.is_some() {
        checker.note_default(&key.child("initial"), "flow.exact");
    }
    check_initial(checker, &key, &start_state, mesh, start)?;
    if raw.source.is_some() && exact.is_none() {
        let problem = "a manufactured source needs a solution to be made for";
        return Err(checker.combination(&key.child("source"), problem, "this key together with `exact`"));
    }
    let boundary = boundary(checker, &key.child("boundary"), raw, mesh, exact.as_ref(), gas)?;
    let walls =
        forces::check(checker, &key.child("forces"), &raw.forces, mesh, &boundary, reference, reference_length)?;
    let law = NavierStokes { gas, riemann: riemann(raw.riemann), reference };
    let quadrature = quadrature(checker, &key.child("quadrature"), raw.quadrature, order)?;
    let manufactured = raw.source.is_some();
    Ok(Flow {
        order,
        law,
        reference_speed,
        reference_length,
        quadrature,
        initial: start_state,
        uniform_velocity,
        exact,
        manufactured,
        boundary,
        walls,
    })
}

fn gas(checker: &Checker<'_>, key: &Key, raw: &raw::Gas) -> Checked<Gas> {
    let accepted = "a number above 1 (air: 1.4)";
    checker.require(
        &key.child("gamma"),
        "the ratio of specific heats",
        raw.gamma > 1.0 && raw.gamma.is_finite(),
        accepted,
    )?;
    checker.positive(&key.child("prandtl"), "the Prandtl number", raw.prandtl)?;
    let gas_constant = match (raw.gas_constant, raw.mach) {
        (Some(given), None) => checker.positive(&key.child("gas_constant"), "the gas constant", given)?,
        (None, None) => {
            checker.note_default(&key.child("gas_constant"), "1.0");
            1.0
        }
        (None, Some(mach)) => {
            let mach = checker.positive(&key.child("mach"), "the Mach number", mach)?;
            1.0 / (raw.gamma * mach * mach)
        }
        _ => return Err(checker.combination(key, "the gas constant is given twice", "`gas_constant` or `mach`")),
    };
    let viscosity = viscosity(checker, &key.child("viscosity"), &raw.viscosity)?;
    checker.physics(key, Gas::new(raw.gamma, gas_constant, raw.prandtl, viscosity))
}

fn viscosity(checker: &Checker<'_>, key: &Key, raw: &raw::Viscosity) -> Checked<Viscosity> {
    match *raw {
        raw::Viscosity::Inviscid => Ok(Viscosity::Inviscid),
        raw::Viscosity::Constant(viscosity) => {
            Ok(Viscosity::Constant(checker.positive(&key.child("constant"), "the viscosity", viscosity)?))
        }
        raw::Viscosity::Sutherland { viscosity, temperature, constant } => {
            let key = key.child("sutherland");
            for (name, value) in [("viscosity", viscosity), ("temperature", temperature), ("constant", constant)] {
                checker.positive(&key.child(name), "the number", value)?;
            }
            Ok(Viscosity::Sutherland { viscosity, temperature, constant })
        }
    }
}

/// The reference state that is given, or the `stream`; with its speed and a length.
fn reference<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: Option<&raw::Reference>,
    stream: Option<navier_stokes::Primitive<f64, D>>,
    gas: Gas,
) -> Checked<(Reference, f64, f64)> {
    let key_reference = key.child("reference");
    if let Some(raw) = raw {
        let numbers =
            [("density", raw.density), ("speed", raw.speed), ("pressure", raw.pressure), ("length", raw.length)];
        for (name, value) in numbers {
            checker.positive(&key_reference.child(name), &format!("the {name}"), value)?;
        }
        let reference = Reference::new(&gas, raw.density, raw.speed, raw.pressure);
        return Ok((checker.physics(&key_reference, reference)?, raw.speed, raw.length));
    }
    let accepted = "a table `reference = { density, speed, pressure }` with sizes that are typical of the flow";
    let speed = stream.map_or(0.0, |stream| tensor::norm(&stream.velocity));
    let Some(stream) = stream.filter(|_| speed > 0.0) else {
        let problem = "the size of the velocity cannot be told from the exact or the initial state";
        return Err(checker.combination(&key_reference, problem, accepted));
    };
    let (density, pressure) = (stream.density, stream.pressure);
    let taken =
        format!("{{ density = {density}, speed = {speed}, pressure = {pressure}, length = 1 }}, of the free stream");
    checker.note_default(&key_reference, &taken);
    let reference = Reference::new(&gas, density, speed, pressure);
    Ok((checker.physics(&key_reference, reference)?, speed, 1.0))
}

/// Formulas may give anything: the initial state must be one.
fn check_initial<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    initial: &State<D>,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<()> {
    let State::Expression(formulas) = initial else { return Ok(()) };
    for x in mesh.coordinates().chunks_exact(D) {
        let state = formulas.primitive(&std::array::from_fn(|axis| x[axis]), start);
        let key = key.child("initial").child("expression");
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (name, value) in [("density", state.density), ("pressure", state.pressure)] {
            let quantity = format!("the {name} at {x:?}, {value},");
            checker.require(&key.child(name), &quantity, positive(value), "a formula that is positive everywhere")?;
        }
        let finite = state.velocity.iter().all(|w| w.is_finite());
        checker.require(
            &key.child("velocity"),
            &format!("the velocity at {x:?}"),
            finite,
            "formulas that are finite everywhere",
        )?;
    }
    Ok(())
}

fn riemann(raw: raw::Riemann) -> Riemann {
    match raw {
        raw::Riemann::Roe => Riemann::Roe,
        raw::Riemann::Hllc => Riemann::Hllc,
        raw::Riemann::LaxFriedrichs => Riemann::LaxFriedrichs,
    }
}

fn quadrature(checker: &Checker<'_>, key: &Key, raw: raw::Quadrature, order: usize) -> Checked<fem::Quadrature> {
    match raw {
        raw::Quadrature::Conserving => Ok(fem::Quadrature::Conserving),
        raw::Quadrature::Double => Ok(fem::Quadrature::Double),
        raw::Quadrature::Points(points) => {
            let accepted = format!("{order}, the order of the flow, to 64");
            checker.require(&key.child("points"), "the number of points", (order..=64).contains(&points), &accepted)?;
            Ok(fem::Quadrature::Points(points))
        }
    }
}

fn boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    exact: Option<&State<D>>,
    gas: Gas,
) -> Checked<Vec<BoundaryData<D>>> {
    let named = checker.by_boundary(key, "flow condition", &raw.boundary, mesh.boundary_names())?;
    named.iter().map(|(key, condition)| self::condition(checker, key, condition, exact, gas)).collect()
}

fn condition<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    exact: Option<&State<D>>,
    gas: Gas,
) -> Checked<BoundaryData<D>> {
    let prescribed = |state| BoundaryData { condition: Boundary::PrescribedState(PrescribedState), state: Some(state) };
    let condition = match raw {
        raw::Condition::Exact => {
            let missing = || {
                checker.combination(
                    key,
                    "there is no exact solution to take",
                    "this condition together with `flow.exact`, or another one, for instance `{ far_field = { ... } }`",
                )
            };
            return exact.cloned().map(prescribed).ok_or_else(missing);
        }
        raw::Condition::PrescribedState(state) => {
            let Typical { state, .. } = states::check(checker, &key.child("prescribed_state"), state, gas)?;
            return Ok(prescribed(state));
        }
        raw::Condition::SlipWall => Boundary::SlipWall(SlipWall),
        raw::Condition::Symmetry => Boundary::Symmetry(SlipWall),
        raw::Condition::FarField(stream) => {
            let key = key.child("far_field");
            Boundary::FarField(checker.physics(&key, FarField::new(states::free_stream(checker, &key, stream, gas)?))?)
        }
        raw::Condition::AdiabaticWall(wall) => {
            let key = key.child("adiabatic_wall");
            let slide = checker.vector_or_zero(&key.child("slide"), "the velocity", wall.slide.as_ref())?;
            Boundary::AdiabaticWall(checker.physics(&key, AdiabaticWall::new(slide))?)
        }
        raw::Condition::IsothermalWall(wall) => {
            let key = key.child("isothermal_wall");
            let slide = checker.vector_or_zero(&key.child("slide"), "the velocity", wall.slide.as_ref())?;
            let temperature = checker.positive(&key.child("temperature"), "the temperature", wall.temperature)?;
            Boundary::IsothermalWall(checker.physics(&key, IsothermalWall::new(temperature, slide))?)
        }
        raw::Condition::Inflow(inflow) => {
            let key = key.child("inflow");
            let direction = checker.vector(&key.child("direction"), &inflow.direction)?;
            let pressure = checker.positive(&key.child("total_pressure"), "the pressure", inflow.total_pressure)?;
            let temperature =
                checker.positive(&key.child("total_temperature"), "the temperature", inflow.total_temperature)?;
            let inflow = Inflow::new(pressure, temperature, direction);
            Boundary::Inflow(checker.physics(&key.child("direction"), inflow)?)
        }
        raw::Condition::Outflow(outflow) => {
            Boundary::Outflow(checker.physics(&key.child("outflow").child("pressure"), Outflow::new(outflow.pressure))?)
        }
    };
    Ok(BoundaryData { condition, state: None })
}
