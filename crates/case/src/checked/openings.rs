//! The boundary conditions at which gas enters or leaves.

use super::boundary_data::{BoundaryData, Data};
use super::controls::Control;
use super::given_values;
use super::mesh_crate::{CellMap, Mesh, face_nodes, outward_area};
use super::states::{self, Typical};
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::is_computable;
use crate::point_data::PointData;
use crate::raw;
use crate::state::State;
use crate::vector::Vector;
use basis::gauss_lobatto;
use navier_stokes::{Boundary, Gas, Inflow, Outflow, Primitive, Reference, SupersonicInflow, VelocityInflow};
use tensor::{dot, norm};

/// Checks an inflow from a reservoir.
pub(super) fn inflow<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Inflow) -> Checked<BoundaryData<D>> {
    let data = PointData {
        first: checker.formula::<D>(&key.child("total_pressure"), &raw.total_pressure)?,
        vector: checker.formulas(&key.child("direction"), &raw.direction)?,
        last: checker.formula::<D>(&key.child("total_temperature"), &raw.total_temperature)?,
    };
    let Some((pressure, direction, temperature)) = data.as_constants() else {
        return Ok(BoundaryData::by_formulas(Boundary::Inflow(Inflow::at_points()), data));
    };
    let direction: [f64; D] = checker.finite_vector(&key.child("direction"), "the direction", &direction)?;
    let pressure = checker.positive(&key.child("total_pressure"), "the pressure", pressure)?;
    let temperature = checker.positive(&key.child("total_temperature"), "the temperature", temperature)?;
    let inflow = Inflow::new(pressure, temperature, direction);
    Ok(BoundaryData::uniform(Boundary::Inflow(checker.physics(&key.child("direction"), inflow)?)))
}

/// Checks an outflow. Gas that comes back has by default the temperature of the reference state.
pub(super) fn outflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Outflow,
    gas: &Gas,
    reference: &Reference,
) -> Checked<BoundaryData<D>> {
    let key_of_temperature = key.child("total_temperature");
    let last = match &raw.total_temperature {
        Some(given) => checker.formula::<D>(&key_of_temperature, given)?,
        None => {
            let temperature = reference.total_temperature(gas);
            checker.note_default(&key_of_temperature, &format!("{temperature}, of `flow.reference`"));
            Program::constant(temperature)
        }
    };
    let first = checker.formula::<D>(&key.child("pressure"), &raw.pressure)?;
    if let Some(velocity) = &raw.velocity {
        let vector = checker.formulas(&key.child("velocity"), velocity)?;
        let data = PointData { first, vector, last };
        return Ok(BoundaryData::by_formulas(Boundary::Outflow(Outflow::of_velocity()), data));
    }
    let data = PointData { first, vector: Vector::zero(), last };
    let Some((pressure, _, temperature)) = data.as_constants() else {
        return Ok(BoundaryData::by_formulas(Boundary::Outflow(Outflow::at_points()), data));
    };
    let temperature = checker.positive(&key_of_temperature, "the temperature", temperature)?;
    let outflow = Outflow::new(pressure, temperature);
    Ok(BoundaryData::uniform(Boundary::Outflow(checker.physics(&key.child("pressure"), outflow)?)))
}

/// The outflow `data` with the velocity outside that `raw.relaxation` asks for: along the normal of the boundary, it follows the mean velocity there.
pub(super) fn relaxed<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Outflow,
    data: BoundaryData<D>,
    (mesh, boundary): (&Mesh<D>, usize),
    time: &Time,
) -> Checked<BoundaryData<D>> {
    let Some(memory) = raw.relaxation else { return Ok(data) };
    let key = key.child("relaxation");
    let memory = checker.positive(&key, "the time", memory)?;
    let (Some(_), Some(Data::Values(values))) = (&raw.velocity, &data.data) else {
        return Err(checker.combination(
            &key,
            "the velocity at the start is missing",
            "this key together with `velocity`",
        ));
    };
    let nodes = nodes_with_normals(mesh, boundary);
    let normal = normal_of_plane(checker, &key, &nodes)?;
    let velocities = nodes.iter().map(|(x, _)| dot(&values.vector.evaluate(x, time.start), &normal));
    let initial = velocities.sum::<f64>() / nodes.len() as f64;
    let name = &mesh.boundary_names()[boundary];
    let control = Control::with_memory(format!("{name}_stream"), format!("{name}_velocity"), initial, memory);
    let vector = Vector::new(normal.map(|n| Program::multiple(n, &control.value)));
    let data = BoundaryData::by_formulas(data.condition, PointData { vector, ..(**values).clone() });
    Ok(BoundaryData { control: Some(control), ..data })
}

/// The outward unit normal of a plane boundary.
fn normal_of_plane<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    nodes: &[([f64; D], [f64; D])],
) -> Checked<[f64; D]> {
    /// Round-off of normals.
    const LITTLE: f64 = 1e-9;
    let normal = nodes.first().map_or([0.0; D], |(_, normal)| *normal);
    let is_plane = nodes.iter().all(|(_, other)| (dot(&normal, other) - 1.0).abs() < LITTLE);
    checker.require(key, "the boundary", is_plane, "a plane boundary, the same normal everywhere")?;
    Ok(normal)
}

/// Checks an inflow of given velocity or mass flux.
pub(super) fn velocity_inflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::VelocityInflow,
) -> Checked<BoundaryData<D>> {
    let (condition, vector) = match (&raw.velocity, &raw.mass_flux) {
        (Some(velocity), None) => (VelocityInflow::OfVelocity, checker.formulas(&key.child("velocity"), velocity)?),
        (None, Some(mass_flux)) => (VelocityInflow::OfMassFlux, checker.formulas(&key.child("mass_flux"), mass_flux)?),
        (given, _) => {
            let problem = if given.is_some() { "the velocity is given twice" } else { "the velocity is missing" };
            return Err(checker.combination(key, problem, "one of `velocity` and `mass_flux`"));
        }
    };
    let last = checker.formula::<D>(&key.child("temperature"), &raw.temperature)?;
    let data = PointData { first: Program::constant(0.0), vector, last };
    Ok(BoundaryData::by_formulas(Boundary::VelocityInflow(condition), data))
}

/// Checks a supersonic inflow.
pub(super) fn supersonic_inflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::State,
    gas: Gas,
) -> Checked<BoundaryData<D>> {
    let Typical { state, .. } = states::check(checker, key, raw, gas)?;
    Ok(BoundaryData::by_state(Boundary::SupersonicInflow(SupersonicInflow), state))
}

/// Position and outward unit normal of every node on a boundary of the mesh at rest.
pub(super) fn nodes_with_normals<const D: usize>(mesh: &Mesh<D>, boundary: usize) -> Vec<([f64; D], [f64; D])> {
    let order = mesh.order();
    let map = CellMap::on_grid(order, &gauss_lobatto(order).points);
    let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
    let of_facet = |facet: &super::mesh_crate::BoundaryFacet| {
        let nodes = mesh.cell_coordinates(facet.side.cell);
        let (positions, jacobians) = (map.positions(nodes), map.jacobians(nodes));
        let node = |k: usize| {
            let area = outward_area(&jacobians[k], facet.side.face);
            let size = norm(&area);
            (positions[k], area.map(|a| a / size))
        };
        face_nodes(D, order, facet.side.face).into_iter().map(node).collect::<Vec<_>>()
    };
    facets.flat_map(of_facet).collect()
}

/// Checks the data at `key` on the nodes of a boundary, at the start.
pub(super) fn check_on_boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    data: &BoundaryData<D>,
    (mesh, boundary): (&Mesh<D>, usize),
    gas: &Gas,
    time: &Time,
) -> Checked<()> {
    let nodes = || nodes_with_normals(mesh, boundary);
    given_values::check(checker, key, data, mesh, boundary, time)?;
    match (&data.condition, &data.data) {
        (Boundary::Inflow(inflow), values) => {
            let direction = |x: &[f64; D]| match values {
                Some(Data::Values(values)) => values.vector.evaluate(x, time.start),
                _ => inflow.direction().unwrap_or([0.0; D]),
            };
            points_into_domain(checker, &key.child("inflow"), direction, &nodes())
        }
        (Boundary::SupersonicInflow(_), Some(Data::State(state))) => {
            enters_faster_than_sound(checker, &key.child("supersonic_inflow"), state, &nodes(), gas, time.start)
        }
        _ => Ok(()),
    }
}

/// An inflow must not point out of the domain everywhere.
fn points_into_domain<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    direction: impl Fn(&[f64; D]) -> [f64; D],
    nodes: &[([f64; D], [f64; D])],
) -> Checked<()> {
    /// The least component of the unit direction that points into the domain.
    const LEAST: f64 = 1e-6;
    if let Some((x, _)) = nodes.iter().find(|(x, _)| norm(&direction(x)) == 0.0) {
        let quantity = format!("the direction at {x:?}, {:?},", direction(x));
        checker.require(&key.child("direction"), &quantity, false, "a vector that points somewhere")?;
    }
    let into = |(x, normal): &([f64; D], [f64; D])| {
        let direction = direction(x);
        dot(&direction, normal) < -LEAST * norm(&direction)
    };
    let normal = nodes.first().map_or([0.0; D], |(_, normal)| *normal);
    let accepted = format!("a vector into the domain: the outward normal of the boundary is {normal:.3?}");
    checker.require(&key.child("direction"), "the direction", nodes.iter().any(into), &accepted)
}

/// A state that is nowhere supersonic belongs to another condition.
fn enters_faster_than_sound<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    state: &State<D>,
    nodes: &[([f64; D], [f64; D])],
    gas: &Gas,
    start: f64,
) -> Checked<()> {
    let mut fastest = f64::NEG_INFINITY;
    for (x, normal) in nodes {
        let given: Primitive<f64, D> = match state {
            State::Uniform(stream) => stream.primitive(),
            State::Expression(formulas) => formulas.primitive(x, start),
            // For the others the run checks where gas enters.
            _ => return Ok(()),
        };
        for (name, value) in [("density", given.density), ("pressure", given.pressure)] {
            let quantity = format!("the {name} at {x:?}, {value},");
            checker.require(key, &quantity, value > 0.0 && is_computable(value), "a positive number everywhere")?;
        }
        fastest = fastest.max(-dot(&given.velocity, normal) / gas.sound_speed(given.density, given.pressure));
    }
    let quantity = format!("the Mach number across the boundary into the domain, at most {fastest:.3},");
    let accepted = "more than 1; for slower gas `inflow` (total pressure and temperature) or `velocity_inflow`";
    checker.require(key, &quantity, fastest > 1.0, accepted)
}
