//! The boundary conditions at which gas enters or leaves.

use super::flow::BoundaryData;
use super::mesh_crate::{CellMap, Mesh, face_nodes, outward_area};
use super::states::{self, Typical};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::magnitude::{is_bounded, is_computable};
use crate::raw;
use crate::state::{Entering, State};
use basis::gauss_lobatto;
use navier_stokes::{Boundary, Gas, Inflow, Outflow, Primitive, Reference, SupersonicInflow, VelocityInflow};
use tensor::{dot, norm};

/// Checks an inflow from a reservoir.
pub(super) fn inflow<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Inflow) -> Checked<Boundary<D>> {
    let direction = checker.finite_vector(&key.child("direction"), "the direction", &raw.direction)?;
    let pressure = checker.positive(&key.child("total_pressure"), "the pressure", raw.total_pressure)?;
    let temperature = checker.positive(&key.child("total_temperature"), "the temperature", raw.total_temperature)?;
    let inflow = Inflow::new(pressure, temperature, direction);
    Ok(Boundary::Inflow(checker.physics(&key.child("direction"), inflow)?))
}

/// Checks an outflow. Gas that comes back has by default the temperature of the reference state.
pub(super) fn outflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Outflow,
    gas: &Gas,
    reference: &Reference,
) -> Checked<Boundary<D>> {
    let key_of_temperature = key.child("total_temperature");
    let temperature = match raw.total_temperature {
        Some(given) => checker.positive(&key_of_temperature, "the temperature", given)?,
        None => {
            let temperature = reference.total_temperature(gas);
            checker.note_default(&key_of_temperature, &format!("{temperature}, of `flow.reference`"));
            temperature
        }
    };
    let outflow = Outflow::new(raw.pressure, temperature);
    Ok(Boundary::Outflow(checker.physics(&key.child("pressure"), outflow)?))
}

/// Checks an inflow of given velocity or mass flux.
pub(super) fn velocity_inflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::VelocityInflow,
    gas: Gas,
) -> Checked<BoundaryData<D>> {
    let (condition, vector) = match (&raw.velocity, &raw.mass_flux) {
        (Some(velocity), None) => (VelocityInflow::OfVelocity, checker.formulas(&key.child("velocity"), velocity)?),
        (None, Some(mass_flux)) => (VelocityInflow::OfMassFlux, checker.formulas(&key.child("mass_flux"), mass_flux)?),
        (given, _) => {
            let problem = if given.is_some() { "the velocity is given twice" } else { "the velocity is missing" };
            return Err(checker.combination(key, problem, "one of `velocity` and `mass_flux`"));
        }
    };
    let temperature = checker.formula::<D>(&key.child("temperature"), &raw.temperature)?;
    let state = State::Entering(Box::new(Entering { gas, vector, temperature }));
    Ok(BoundaryData { condition: Boundary::VelocityInflow(condition), state: Some(state) })
}

/// Checks a supersonic inflow.
pub(super) fn supersonic_inflow<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::State,
    gas: Gas,
) -> Checked<BoundaryData<D>> {
    let Typical { state, .. } = states::check(checker, key, raw, gas)?;
    Ok(BoundaryData { condition: Boundary::SupersonicInflow(SupersonicInflow), state: Some(state) })
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
    start: f64,
) -> Checked<()> {
    let nodes = || nodes_with_normals(mesh, boundary);
    match (&data.condition, &data.state) {
        (Boundary::Inflow(inflow), _) => points_into_domain(checker, &key.child("inflow"), inflow, &nodes()),
        (_, Some(State::Entering(entering))) => {
            let (key, vector) = (key.child("velocity_inflow"), &data.condition);
            let vector =
                if *vector == Boundary::VelocityInflow(VelocityInflow::OfMassFlux) { "mass_flux" } else { "velocity" };
            nodes().iter().try_for_each(|(x, _)| {
                let state = entering.primitive(x, start);
                let t = state.pressure / gas.gas_constant();
                let quantity = format!("the temperature at {x:?}, {t},");
                let positive = t > 0.0 && is_computable(t);
                checker.require(
                    &key.child("temperature"),
                    &quantity,
                    positive,
                    "a formula that is positive everywhere",
                )?;
                let finite = state.velocity.iter().all(|w| is_bounded(*w));
                checker.require(
                    &key.child(vector),
                    &format!("the vector at {x:?}"),
                    finite,
                    "formulas that are finite everywhere",
                )
            })
        }
        (Boundary::SupersonicInflow(_), Some(state)) => {
            enters_faster_than_sound(checker, &key.child("supersonic_inflow"), state, &nodes(), gas, start)
        }
        _ => Ok(()),
    }
}

/// An inflow must not point out of the domain everywhere.
fn points_into_domain<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    inflow: &Inflow<D>,
    nodes: &[([f64; D], [f64; D])],
) -> Checked<()> {
    /// The least component of the direction that points into the domain.
    const LEAST: f64 = 1e-6;
    let into = |(_, normal): &([f64; D], [f64; D])| dot(&inflow.direction(), normal) < -LEAST;
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
