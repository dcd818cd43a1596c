//! The flow.

use super::boundary_data::{BoundaryData, Data};
use super::controls::Control;
use super::forces::{self, Wall};
use super::given::{self, Given};
use super::initial;
use super::mesh_crate::Mesh;
use super::openings;
use super::quadrature;
use super::source::{self, Source};
use super::states::{self, Typical};
use super::time::Time;
use super::time_length;
use super::walls;
use crate::checker::{Checked, Checker, OTHERS};
use crate::error::Errors;
use crate::key::Key;
use crate::raw;
use crate::state::State;
use navier_stokes::{
    Boundary, FarField, NavierStokes, PrescribedState, Riemann, ShockCapturing, SlipWall, VolumeFlux, WallFlux,
};

/// The compressible flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow<const D: usize> {
    /// N_s, nodes per direction and cell.
    pub order: usize,
    /// The gas, the numerical flux, the reference state.
    pub law: NavierStokes<D>,
    /// `flow.gas.mach`, if the case gives it in place of a gas constant.
    pub gas_mach: Option<f64>,
    /// A typical speed, that of the reference state.
    pub reference_speed: f64,
    /// A typical length, for coefficients and the Reynolds number.
    pub reference_length: f64,
    /// The length that the flow passes in a unit of time: the reference length if it is given, or else that of bodies or of the mesh.
    pub time_length: f64,
    /// The quadrature points.
    pub quadrature: fem::Quadrature,
    /// The state at the start.
    pub initial: State<D>,
    /// The velocity at the start, if it is uniform.
    pub uniform_velocity: Option<[f64; D]>,
    /// The solution, if it is known.
    pub exact: Option<State<D>>,
    /// The source. For the meaning of its data see `law.source`.
    pub source: Option<Source<D>>,
    /// The condition on each boundary, in the order of `Mesh::boundary_names`.
    pub boundary: Vec<BoundaryData<D>>,
    /// The boundaries that are walls.
    pub walls: Vec<Wall<D>>,
}

impl<const D: usize> Flow<D> {
    /// Whether the source is the one that makes `exact` the solution.
    pub fn is_manufactured(&self) -> bool {
        self.source == Some(Source::Manufactured)
    }
    /// The exact state if it is uniform and solves the equations: a source or a rotating frame changes it.
    pub fn free_stream(&self) -> Option<&State<D>> {
        let is_uniform = |exact: &&State<D>| matches!(exact, State::Uniform(_));
        self.exact.as_ref().filter(is_uniform).filter(|_| self.source.is_none() || self.is_manufactured())
    }
    /// Whether no source adds mass.
    pub fn conserves_mass(&self) -> bool {
        let adds_none = |source: &Source<D>| match source {
            Source::Given(formulas) => formulas.first.as_constant() == Some(0.0),
            Source::Manufactured | Source::Forcing(_) => self.law.source.is_force(),
        };
        self.source.as_ref().is_none_or(adds_none)
    }
    /// This flow in a split form, which stays alive where `mesh` does not resolve it. None if it has a split form, or `mesh` does not
    /// allow one.
    pub fn in_split_form(&self, mesh: &Mesh<D>) -> Option<Self> {
        if self.law.volume_flux.is_split() {
            return None;
        }
        let (quadrature, volume_flux) = quadrature::split_form(mesh, self.order)?;
        Some(Flow { quadrature, law: NavierStokes { volume_flux, ..self.law }, ..self.clone() })
    }
    /// The controls of its boundary conditions.
    pub(super) fn controls(&self) -> impl Iterator<Item = &Control> {
        self.boundary.iter().filter_map(|data| data.control.as_ref())
    }
    /// The time in which the flow passes `time_length`.
    pub fn time_unit(&self) -> f64 {
        self.time_length / self.reference_speed
    }
    /// The length of bodies in `mesh`, or that of `mesh` without a body; and the largest that may be meant.
    pub fn lengths_in(&self, mesh: &Mesh<D>) -> [f64; 2] {
        time_length::of_mesh(mesh, &self.boundary)
    }
    /// The pressure of the reference state.
    pub fn reference_pressure(&self) -> f64 {
        self.law.reference.pressure(&self.law.gas)
    }
}

/// Checks `[flow]` of a run that covers `time`; None: the time has an error.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    time: Option<&Time>,
) -> Checked<Flow<D>> {
    let key = Key::new("flow");
    let mut errors = Errors::default();
    let order = errors.note(super::order(checker, &key.child("order"), "the order of the flow", raw.order));
    let numerics = errors.note(Numerics::check(checker, &key, raw, mesh));
    let given = errors.note(given::check(checker, &key, raw));
    let of_gas = errors.note(OfGas::check(checker, &key, raw, given.as_ref(), mesh, time));
    if let (Some(order), Some(Given { initial, .. }), Some(time)) = (order, &given, time) {
        let of_start = key.child(if raw.initial.is_some() { "initial" } else { "exact" });
        errors.note(initial::check(checker, &of_start, initial, mesh, order, time.start));
    }
    errors.all()?;
    let (Some(order), Some(numerics), Some(given), Some(of_gas)) = (order, numerics, given, of_gas) else {
        unreachable!("what is missing has left an error")
    };
    let time_length = time_length(checker, &key, given.length, mesh, &of_gas.boundary);
    Ok(assembled(raw, order, time_length, numerics, given, of_gas))
}

/// The length from which scales of time follow: the `given` one, or that of the mesh.
fn time_length<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    given: Option<f64>,
    mesh: &Mesh<D>,
    conditions: &[BoundaryData<D>],
) -> f64 {
    given.unwrap_or_else(|| {
        let [length, _] = time_length::of_mesh(mesh, conditions);
        let of_time = format!("{length}, from the mesh, for scales of time");
        let taken = format!("{} for coefficients and the Reynolds number; {of_time}", given::DEFAULT_LENGTH);
        checker.note_default(&key.child("reference").child("length"), &taken);
        length
    })
}

/// Settings of the discretisation that do not depend on the gas.
struct Numerics {
    quadrature: fem::Quadrature,
    volume_flux: VolumeFlux,
    shock_capturing: Option<ShockCapturing>,
}

impl Numerics {
    fn check<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Flow, mesh: &Mesh<D>) -> Checked<Self> {
        let mut errors = Errors::default();
        let key_of = |name: &str| key.child(name);
        let quadrature = quadrature::check(checker, &key_of("quadrature"), raw.quadrature, mesh, raw.order);
        let quadrature = errors.note(quadrature);
        let volume_flux = errors.note(quadrature::volume_flux(checker, key, raw));
        let shock_capturing = errors.note(given::shock_capturing(checker, &key_of("shock_capturing"), raw));
        errors.all()?;
        let (Some(quadrature), Some(volume_flux), Some(shock_capturing)) = (quadrature, volume_flux, shock_capturing)
        else {
            unreachable!("what is missing has left an error")
        };
        Ok(Numerics { quadrature, volume_flux, shock_capturing })
    }
}

/// The parts of a flow that depend on the gas and its reference state.
struct OfGas<const D: usize> {
    source: Option<Source<D>>,
    /// The meaning of the data of the source.
    meaning: navier_stokes::Source<D>,
    boundary: Vec<BoundaryData<D>>,
    walls: Vec<Wall<D>>,
}

impl<const D: usize> OfGas<D> {
    fn check(
        checker: &Checker<'_>,
        key: &Key,
        raw: &raw::Flow,
        given: Option<&Given<D>>,
        mesh: &Mesh<D>,
        time: Option<&Time>,
    ) -> Checked<Self> {
        let mut errors = Errors::default();
        let boundary = errors.note(boundary(checker, &key.child("boundary"), raw, mesh, given, time));
        let (Some(given), Some(time)) = (given, time) else {
            errors.note(checker.by_boundary_or_default(&key.child("forces"), &raw.forces, mesh.boundary_names()));
            errors.all()?;
            return Err(checker.follows(key));
        };
        let source = errors.note(source::check(checker, key, raw, given.gas, (mesh, time)));
        let walls = boundary.as_ref().and_then(|boundary| {
            let length = given.length.unwrap_or(given::DEFAULT_LENGTH);
            let given = forces::Given { forces: &raw.forces, reference: given.reference, length, time };
            errors.note(forces::check(checker, &key.child("forces"), &given, mesh, boundary))
        });
        errors.all()?;
        let (Some((source, meaning)), Some(boundary), Some(walls)) = (source, boundary, walls) else {
            unreachable!("what is missing has left an error")
        };
        Ok(OfGas { source, meaning, boundary, walls })
    }
}

fn assembled<const D: usize>(
    raw: &raw::Flow,
    order: usize,
    time_length: f64,
    numerics: Numerics,
    given: Given<D>,
    of_gas: OfGas<D>,
) -> Flow<D> {
    let Numerics { quadrature, volume_flux, shock_capturing } = numerics;
    let Given { exact, initial, uniform_velocity, gas, reference, speed, length } = given;
    let OfGas { source, meaning, boundary, walls } = of_gas;
    Flow {
        order,
        law: NavierStokes {
            gas,
            riemann: riemann(raw.riemann, speed),
            reference,
            source: meaning,
            volume_flux,
            shock_capturing,
            wall_flux: wall_flux(raw.wall_flux),
        },
        gas_mach: raw.gas.mach,
        reference_speed: speed,
        reference_length: length.unwrap_or(given::DEFAULT_LENGTH),
        time_length,
        quadrature,
        initial,
        uniform_velocity,
        exact,
        source,
        boundary,
        walls,
    }
}

fn riemann(raw: raw::Riemann, speed: f64) -> Riemann {
    match raw {
        raw::Riemann::Roe => Riemann::Roe,
        raw::Riemann::LowMachRoe => Riemann::LowMachRoe { speed },
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

/// The conditions on all boundaries. Without the gas or the time, what does not need them is checked.
fn boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    mesh: &Mesh<D>,
    given: Option<&Given<D>>,
    time: Option<&Time>,
) -> Checked<Vec<BoundaryData<D>>> {
    let (mut errors, names) = (Errors::default(), mesh.boundary_names());
    errors.note(checker.by_boundary(key, "flow condition", &raw.boundary, names));
    let unknown = checker.entries_of_none(key, &raw.boundary, names);
    let mut conditions = Vec::new();
    for (index, key_of, raw) in checker.entries_of_boundaries(key, &raw.boundary, names) {
        // `others` may stand for a boundary whose name is misspelt.
        let is_doubtful = !unknown.is_empty() && key_of == key.child(OTHERS);
        let over = time.filter(|_| !is_doubtful).map(|time| (mesh, index, time));
        conditions.extend(errors.note(condition_over(checker, &key_of, raw, given, over)));
    }
    unknown.iter().for_each(|(key, raw)| drop(errors.note(condition_over(checker, key, raw, given, None))));
    errors.all().map(|()| conditions)
}

/// The condition on a boundary of a mesh over a time; without these the values of the condition alone are checked.
fn condition_over<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    given: Option<&Given<D>>,
    over: Option<(&Mesh<D>, usize, &Time)>,
) -> Checked<BoundaryData<D>> {
    let mut data = self::condition(checker, key, raw, given)?;
    let (Some(given), Some((mesh, index, time))) = (given, over) else { return Err(checker.follows(key)) };
    if let raw::Condition::Outflow(outflow) = raw {
        data = openings::relaxed(checker, &key.child("outflow"), outflow, data, (mesh, index), time)?;
    }
    openings::check_on_boundary(checker, key, raw, &data, &given.gas, (mesh, index, time))?;
    if let (raw::Condition::PrescribedState(_), Some(Data::State(state))) = (raw, &data.data) {
        initial::check_on_boundary(checker, &key.child("prescribed_state"), state, mesh, index, time)?;
    }
    Ok(data)
}

/// The condition with its values; None stands for a gas with an error, which some conditions do not need.
fn condition<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    given: Option<&Given<D>>,
) -> Checked<BoundaryData<D>> {
    let given = || given.ok_or_else(|| checker.follows(key));
    let prescribed = |state| BoundaryData::by_state(Boundary::PrescribedState(PrescribedState), state);
    match raw {
        raw::Condition::Exact => {
            let accepted =
                "this condition together with `flow.exact`, or another one, for instance `{ far_field = { ... } }`";
            let missing = || checker.combination(key, "there is no exact solution to take", accepted);
            given()?.exact.clone().map(prescribed).ok_or_else(missing)
        }
        raw::Condition::PrescribedState(state) => {
            let Typical { state, .. } = states::check(checker, &key.child("prescribed_state"), state, given()?.gas)?;
            Ok(prescribed(state))
        }
        raw::Condition::SlipWall => Ok(BoundaryData::uniform(Boundary::SlipWall(SlipWall))),
        raw::Condition::Symmetry => Ok(BoundaryData::uniform(Boundary::Symmetry(SlipWall))),
        raw::Condition::FarField(stream) => {
            let key = key.child("far_field");
            let stream = states::free_stream(checker, &key, stream, given()?.gas)?;
            Ok(BoundaryData::uniform(Boundary::FarField(checker.physics(&key, FarField::new(stream))?)))
        }
        raw::Condition::AdiabaticWall(wall) => walls::adiabatic(checker, &key.child("adiabatic_wall"), wall),
        raw::Condition::IsothermalWall(wall) => walls::isothermal(checker, &key.child("isothermal_wall"), wall),
        raw::Condition::Inflow(inflow) => openings::inflow(checker, &key.child("inflow"), inflow),
        raw::Condition::VelocityInflow(inflow) => {
            openings::velocity_inflow(checker, &key.child("velocity_inflow"), inflow)
        }
        raw::Condition::SupersonicInflow(state) => {
            openings::supersonic_inflow(checker, &key.child("supersonic_inflow"), state, given()?.gas)
        }
        raw::Condition::Outflow(outflow) => {
            let Given { gas, reference, .. } = given()?;
            openings::outflow(checker, &key.child("outflow"), outflow, gas, reference)
        }
    }
}
