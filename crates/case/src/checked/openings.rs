//! The boundary conditions at which gas enters or leaves.

use super::boundary_data::{BoundaryData, Data};
use super::controls::Control;
use super::given_values;
use super::mesh_crate::{BoundaryFacet, CellMap, Mesh, face_nodes, outward_area};
use super::slide;
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
use basis::{gauss, gauss_lobatto};
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

/// The outflow `data` with the velocity outside that `raw.relaxation` asks for: along the normal of the boundary its mean follows the mean velocity
/// there. A profile keeps its shape.
pub(super) fn relaxed<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Outflow,
    data: BoundaryData<D>,
    (mesh, boundary): (&Mesh<D>, usize),
    time: &Time,
) -> Checked<BoundaryData<D>> {
    let Some(memory) = raw.relaxation else { return Ok(data) };
    let (key_of_velocity, key) = (key.child("velocity"), key.child("relaxation"));
    let memory = checker.positive(&key, "the time", memory)?;
    let (Some(_), Some(Data::Values(values))) = (&raw.velocity, &data.data) else {
        return Err(checker.combination(
            &key,
            "the velocity at the start is missing",
            "this key together with `velocity`",
        ));
    };
    if let Some(axis) = values.vector.changes_in_time() {
        let problem = "with `relaxation` the gas changes the velocity outside, and the formula gives its start alone";
        let accepted = "a formula without `t` and without controls, or no `relaxation`";
        return Err(checker.combination(&key_of_velocity.entry(axis), problem, accepted));
    }
    let normal = normal_of_plane(checker, &key, &nodes_with_normals(mesh, boundary))?;
    let initial = mean(mesh, boundary, |x| dot(&values.vector.evaluate(x, time.start), &normal));
    let name = &mesh.boundary_names()[boundary];
    let control = Control::with_memory(format!("{name}_stream"), format!("{name}_velocity"), initial, memory);
    let vector = match values.vector.as_constant() {
        Some(stream) if is_along(&stream, &normal) => Vector::new(normal.map(|n| Program::multiple(n, &control.value))),
        _ => values.vector.clone().plus_change(&normal, &control.value, initial),
    };
    let data = BoundaryData::by_formulas(data.condition, PointData { vector, ..(**values).clone() });
    Ok(BoundaryData { control: Some(control), ..data })
}

/// Whether `vector` has the direction of the unit vector `normal`, or the opposite one, up to round-off.
fn is_along<const D: usize>(vector: &[f64; D], normal: &[f64; D]) -> bool {
    let along = dot(vector, normal);
    (norm(vector) - along.abs()).abs() <= 1e-12 * along.abs()
}

/// The outward unit normal of a plane boundary.
fn normal_of_plane<const D: usize>(checker: &Checker<'_>, key: &Key, nodes: &[NodeAndNormal<D>]) -> Checked<[f64; D]> {
    let normal = nodes.first().map_or([0.0; D], |(_, normal)| *normal);
    let is_plane = nodes.iter().all(|(_, other)| is_parallel(&normal, other));
    checker.require(key, "the boundary", is_plane, "a plane boundary, the same normal everywhere")?;
    Ok(normal)
}

/// Whether two unit normals are the same up to round-off.
pub(super) fn is_parallel<const D: usize>(a: &[f64; D], b: &[f64; D]) -> bool {
    (dot(a, b) - 1.0).abs() < LITTLE
}

/// The mean of `value` over the area of a boundary of the mesh at rest, as `NAME_velocity` is one.
fn mean<const D: usize>(mesh: &Mesh<D>, boundary: usize, value: impl Fn(&[f64; D]) -> f64) -> f64 {
    let rule = gauss(mesh.order() + 3);
    let weights = rule.tensor_weights(D - 1);
    let (mut integral, mut whole) = (0.0, 0.0);
    for BoundaryFacet { side, .. } in mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary) {
        let map = CellMap::<D>::on_face(mesh.order(), side.face, &rule.points);
        let nodes = mesh.cell_coordinates(side.cell);
        for ((x, jacobian), weight) in map.positions(nodes).iter().zip(map.jacobians(nodes)).zip(&weights) {
            let area = weight * norm(&outward_area(&jacobian, side.face));
            (integral, whole) = (integral + area * value(x), whole + area);
        }
    }
    integral / whole
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

/// Round-off of normals.
const LITTLE: f64 = 1e-9;

/// Position and outward unit normal of a node on a boundary.
pub(super) type NodeAndNormal<const D: usize> = ([f64; D], [f64; D]);

/// Whether a boundary lies along an axis everywhere: its normals have no component there.
pub fn is_along_axis<const D: usize>(mesh: &Mesh<D>, boundary: usize, axis: usize) -> bool {
    nodes_with_normals(mesh, boundary).iter().all(|(_, normal)| normal[axis].abs() < LITTLE)
}

/// Every node on a boundary of the mesh at rest.
pub(super) fn nodes_with_normals<const D: usize>(mesh: &Mesh<D>, boundary: usize) -> Vec<NodeAndNormal<D>> {
    nodes_of_boundary(mesh, boundary, |_, _, _| [0.0; D])
}

/// Every node on a boundary of the mesh, displaced as those of [`nodes_of_facets`].
pub(super) fn nodes_of_boundary<const D: usize>(
    mesh: &Mesh<D>,
    boundary: usize,
    displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
) -> Vec<NodeAndNormal<D>> {
    let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
    nodes_of_facets(mesh, facets, displacement)
}

/// The nodes of `facets`, after the displacement of (cell, node of the cell, position at rest). The normals depend on these nodes alone.
pub(super) fn nodes_of_facets<'a, const D: usize>(
    mesh: &Mesh<D>,
    facets: impl Iterator<Item = &'a BoundaryFacet>,
    displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
) -> Vec<NodeAndNormal<D>> {
    let order = mesh.order();
    let map = CellMap::on_grid(order, &gauss_lobatto(order).points);
    let of_facet = |BoundaryFacet { side, .. }: &BoundaryFacet| {
        let (mut nodes, on_face) = (mesh.cell_coordinates(side.cell).to_vec(), face_nodes(D, order, side.face));
        for &k in &on_face {
            let x = &mut nodes.as_chunks_mut::<D>().0[k];
            let d = displacement(side.cell, k, x);
            x.iter_mut().zip(d).for_each(|(x, d)| *x += d);
        }
        let (positions, jacobians) = (map.positions(&nodes), map.jacobians(&nodes));
        let node = |k: usize| {
            let area = outward_area(&jacobians[k], side.face);
            let size = norm(&area);
            (positions[k], area.map(|a| a / size))
        };
        on_face.into_iter().map(node).collect::<Vec<_>>()
    };
    facets.flat_map(of_facet).collect()
}

/// Checks the condition `raw` with its data at `key` on the nodes of a boundary, at the start. `over_run` checks it at other times.
pub(super) fn check_on_boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    data: &BoundaryData<D>,
    gas: &Gas,
    (mesh, boundary, time): (&Mesh<D>, usize, &Time),
) -> Checked<()> {
    let nodes = nodes_with_normals(mesh, boundary);
    check_at(checker, key, data, &nodes, time.start)?;
    nodes.first().map_or(Ok(()), |(x, _)| given_values::check_of_time(checker, key, data, x, time))?;
    if let (Boundary::SupersonicInflow(_), Some(Data::State(state))) = (&data.condition, &data.data) {
        enters_faster_than_sound(checker, &key.child("supersonic_inflow"), state, &nodes, gas, time.start)?;
    }
    slide::check(checker, key, raw, &nodes, time.start)
}

/// Checks the data at `key` on `nodes` of a boundary at `t`.
pub(super) fn check_at<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    data: &BoundaryData<D>,
    nodes: &[NodeAndNormal<D>],
    t: f64,
) -> Checked<()> {
    given_values::check(checker, key, data, nodes, t)?;
    let Boundary::Inflow(inflow) = &data.condition else { return Ok(()) };
    let direction = |x: &[f64; D]| match &data.data {
        Some(Data::Values(values)) => values.vector.evaluate(x, t),
        _ => inflow.direction().unwrap_or([0.0; D]),
    };
    points_into_domain(checker, &key.child("inflow"), direction, nodes, t)
}

/// An inflow must not point out of the domain: gas at rest would be sucked out there.
fn points_into_domain<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    direction: impl Fn(&[f64; D]) -> [f64; D],
    nodes: &[NodeAndNormal<D>],
    t: f64,
) -> Checked<()> {
    /// The least component of the unit direction that points into the domain.
    const LEAST: f64 = 1e-6;
    if let Some((x, _)) = nodes.iter().find(|(x, _)| norm(&direction(x)) == 0.0) {
        let quantity = format!("the direction at {x:?} and t = {t}, {:?},", direction(x));
        checker.require(&key.child("direction"), &quantity, false, "a vector that points somewhere")?;
    }
    let into = |(x, normal): &NodeAndNormal<D>| {
        let direction = direction(x);
        dot(&direction, normal) < -LEAST * norm(&direction)
    };
    let outwards = |(x, normal): &&NodeAndNormal<D>| {
        let direction = direction(x);
        dot(&direction, normal) > LEAST * norm(&direction)
    };
    let wrong = nodes.iter().find(outwards).or(nodes.first().filter(|_| !nodes.iter().any(into)));
    let Some((x, normal)) = wrong else { return Ok(()) };
    let accepted = format!("a vector into the domain: the outward normal of the boundary is {normal:.3?} there");
    checker.require(&key.child("direction"), &format!("the direction at {x:.3?} and t = {t}"), false, &accepted)
}

/// A state that is nowhere supersonic belongs to another condition.
fn enters_faster_than_sound<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    state: &State<D>,
    nodes: &[NodeAndNormal<D>],
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
