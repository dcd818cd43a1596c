//! The flow.

use super::forces::{self, Wall};
use super::given::{self, Given};
use super::initial;
use super::mesh_crate::Mesh;
use super::openings;
use super::quadrature;
use super::slide;
use super::states::{self, Typical};
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::error::{Errors, collected};
use crate::key::Key;
use crate::magnitude::is_bounded;
use crate::raw;
use crate::state::State;
use crate::vector::Vector;
use navier_stokes::{
    AdiabaticWall, Boundary, FarField, IsothermalWall, NavierStokes, PrescribedState, Riemann, SlipWall, Source,
    WallFlux,
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
    /// The velocity at the start, if it is uniform.
    pub uniform_velocity: Option<[f64; D]>,
    /// The solution, if it is known.
    pub exact: Option<State<D>>,
    /// Whether there is the source that makes `exact` the solution.
    pub manufactured: bool,
    /// The acceleration of a body force.
    pub acceleration: Option<Vector<D>>,
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

/// The condition on a boundary, and its prescribed state.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryData<const D: usize> {
    /// The condition.
    pub condition: Boundary<D>,
    /// The prescribed state, if the condition takes one.
    pub state: Option<State<D>>,
}

/// Checks `[flow]` of a run that covers `time`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    time: &Time,
) -> Checked<Flow<D>> {
    let key = Key::new("flow");
    let mut errors = Errors::default();
    let order = errors.note(super::order(checker, &key.child("order"), "the order of the flow", raw.order));
    let quadrature = errors.note(quadrature::check(checker, &key.child("quadrature"), raw.quadrature, mesh, raw.order));
    let volume_flux = errors.note(quadrature::volume_flux(checker, &key, raw));
    let shock_capturing = errors.note(given::shock_capturing(checker, &key.child("shock_capturing"), raw));
    let acceleration = errors.note(acceleration(checker, &key.child("source"), raw.source.as_ref(), mesh, time));
    let given = errors.note(given::check(checker, &key, raw));
    let boundary = given.as_ref().and_then(|given| {
        let boundary = boundary(checker, &key.child("boundary"), raw, mesh, given, time);
        errors.note(boundary)
    });
    if let (Some(order), Some(Given { initial, .. })) = (order, &given) {
        let of_start = key.child(if raw.initial.is_some() { "initial" } else { "exact" });
        errors.note(initial::check(checker, &of_start, initial, mesh, order, time.start));
    }
    let walls = boundary.as_ref().zip(given.as_ref()).and_then(|(boundary, given)| {
        let given = forces::Given { forces: &raw.forces, reference: given.reference, length: given.length, time };
        errors.note(forces::check(checker, &key.child("forces"), &given, mesh, boundary))
    });
    errors.all()?;
    let (
        Some(order),
        Some(quadrature),
        Some(volume_flux),
        Some(shock_capturing),
        Some(acceleration),
        Some(given),
        Some(boundary),
        Some(walls),
    ) = (order, quadrature, volume_flux, shock_capturing, acceleration, given, boundary, walls)
    else {
        unreachable!("what is missing has left an error")
    };
    let Given { exact, initial, uniform_velocity, gas, reference, speed, length } = given;
    let source = if acceleration.is_some() { Source::Acceleration } else { Source::Given };
    let law = NavierStokes {
        gas,
        riemann: riemann(raw.riemann),
        reference,
        source,
        volume_flux,
        shock_capturing,
        wall_flux: wall_flux(raw.wall_flux),
    };
    let manufactured = raw.source == Some(raw::Source::Manufactured);
    Ok(Flow {
        order,
        law,
        reference_speed: speed,
        reference_length: length,
        quadrature,
        initial,
        uniform_velocity,
        exact,
        manufactured,
        acceleration,
        boundary,
        walls,
    })
}

/// The acceleration of a body force, which has a value everywhere at the start and the end.
fn acceleration<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: Option<&raw::Source>,
    mesh: &Mesh<D>,
    time: &Time,
) -> Checked<Option<Vector<D>>> {
    let Some(raw::Source::Acceleration(formulas)) = raw else { return Ok(None) };
    let key = key.child("acceleration");
    let acceleration: Vector<D> = checker.formulas(&key, formulas)?;
    for (x, t) in mesh.coordinates().chunks_exact(D).flat_map(|x| [(x, time.start), (x, time.end)]) {
        let a = acceleration.evaluate(&std::array::from_fn(|axis| x[axis]), t);
        let quantity = format!("the acceleration at {x:?} and t = {t}, {a:?},");
        let bounded = a.iter().all(|a| is_bounded(*a));
        checker.require(&key, &quantity, bounded, "formulas that are finite everywhere, and at most 1e60")?;
    }
    Ok(Some(acceleration))
}

fn riemann(raw: raw::Riemann) -> Riemann {
    match raw {
        raw::Riemann::Roe => Riemann::Roe,
        raw::Riemann::Hllc => Riemann::Hllc,
        raw::Riemann::LaxFriedrichs => Riemann::LaxFriedrichs,
    }
}

fn wall_flux(raw: raw::WallFlux) -> WallFlux {
    match raw {
        raw::WallFlux::Inside => WallFlux::Inside,
        raw::WallFlux::Mirrored => WallFlux::Mirrored,
    }
}

fn boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    given: &Given<D>,
    time: &Time,
) -> Checked<Vec<BoundaryData<D>>> {
    let named = checker.by_boundary(key, "flow condition", &raw.boundary, mesh.boundary_names())?;
    let check = |(index, (key, raw)): (usize, &(Key, &raw::Condition))| {
        let data = self::condition(checker, key, raw, given)?;
        slide::check(checker, key, raw, mesh, index)?;
        openings::check_on_boundary(checker, key, &data, (mesh, index), &given.gas, time.start)?;
        if let (raw::Condition::PrescribedState(_), Some(state)) = (raw, &data.state) {
            initial::check_on_boundary(checker, &key.child("prescribed_state"), state, mesh, index, time)?;
        }
        Ok(data)
    };
    collected(named.iter().enumerate().map(check))
}

fn condition<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    given: &Given<D>,
) -> Checked<BoundaryData<D>> {
    let Given { exact, gas, reference, .. } = given;
    let gas = *gas;
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
            return exact.clone().map(prescribed).ok_or_else(missing);
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
        raw::Condition::Inflow(inflow) => openings::inflow(checker, &key.child("inflow"), inflow)?,
        raw::Condition::VelocityInflow(inflow) => {
            return openings::velocity_inflow(checker, &key.child("velocity_inflow"), inflow, gas);
        }
        raw::Condition::SupersonicInflow(state) => {
            return openings::supersonic_inflow(checker, &key.child("supersonic_inflow"), state, gas);
        }
        raw::Condition::Outflow(outflow) => {
            openings::outflow(checker, &key.child("outflow"), outflow, &gas, reference)?
        }
    };
    Ok(BoundaryData { condition, state: None })
}
