//! What is doubtful about the rigid bodies of a case, known before a run.

use super::bodies::{beside_flow, bounds, extent, in_space, is_of_body, middle_and_area, mode, rate, wall_facets};
use super::build::{StructureAtStart, structure_at_start};
use super::error::Failure;
use case::{Analysis, Case, Flow, Freedom, RigidBody, SteadyBodies, Structure, StructureLaw};
use coupled::block::BodyState;
use coupled::blocks::rigid_body::{Freedom as Direction, Vec3};
use coupled::rounded_time;
use navier_stokes::Viscosity;
use tensor::{AXES, dot, norm};

/// A wall that follows a body by more than this part of its motion changes its shape, if it moves across itself, or drags gas along.
const FOLLOWS: f64 = 1e-3;

/// The difference of displacements, in diameters of a structure, up to which a linear law holds to about a per cent.
const SMALL_DISPLACEMENT: f64 = 0.1;

/// The largest speed at the start of the walls of bodies, by their prescribed motion or the rate that they are given.
pub fn speed_of_bodies_at_start<const D: usize>(case: &Case<D>) -> f64 {
    let of_body = |body: &RigidBody<D>| {
        let motions: Vec<(Direction, f64)> = rates_at_start(body, case.time.start).collect();
        let speed_at = |x: &[f64; D]| {
            let sum = |velocity: Vec3, (direction, rate): &(Direction, f64)| {
                let mode = mode(direction, &body.pivot, &in_space(x));
                std::array::from_fn(|i| velocity[i] + rate * mode[i])
            };
            norm(&motions.iter().fold([0.0; 3], sum))
        };
        wall_facets(&case.mesh, &body.walls).flatten().map(|x| speed_at(&x)).fold(0.0, f64::max)
    };
    case.bodies.iter().map(of_body).fold(0.0, f64::max)
}

/// The directions in which `body` may move, and their rates at the start, the time `t`.
fn rates_at_start<const D: usize>(body: &RigidBody<D>, t: f64) -> impl Iterator<Item = (Direction, f64)> {
    let of = move |freedom: &Freedom| freedom.motion.as_ref().map_or(freedom.rate, |motion| rate(motion, t));
    body.freedoms.iter().map(move |freedom| (freedom.direction, of(freedom)))
}

/// The first body that turns and whose pivot or centre of mass lies farther outside of its walls than these are large. Returns the body, the key of
/// the point, and its distance in sizes of the body.
pub fn point_far_from_body<const D: usize>(case: &Case<D>) -> Option<(&RigidBody<D>, &'static str, f64)> {
    let far = |body: &RigidBody<D>, point: &[f64; D]| {
        let [low, high] = bounds(&case.mesh, &body.walls);
        let outside =
            norm(&in_space::<D>(&std::array::from_fn(|d| (low[d] - point[d]).max(point[d] - high[d]).max(0.0))));
        let size = extent(&case.mesh, &body.walls);
        (outside > size).then(|| outside / size)
    };
    let of_body = |body| {
        let points = [("pivot", far(body, &body.pivot)), ("centre_of_mass", far(body, &body.centre_of_mass))];
        points.into_iter().find_map(|(key, sizes)| Some((body, key, sizes?)))
    };
    let turns = |body: &&RigidBody<D>| body.freedoms.iter().any(|freedom| freedom.direction.rotates());
    case.bodies.iter().filter(turns).find_map(of_body)
}

/// The first wall that is of no body and that the mesh of a body moves across itself, or along itself with gas that sticks to it: the body, and the
/// number of the boundary.
pub fn wall_that_follows<'a, const D: usize>(case: &'a Case<D>, flow: &Flow<D>) -> Option<(&'a RigidBody<D>, usize)> {
    let others: Vec<usize> =
        flow.walls.iter().map(|wall| wall.boundary).filter(|&boundary| !is_of_body(case, boundary)).collect();
    let pairs = case.bodies.iter().flat_map(|body| others.iter().map(move |&boundary| (body, boundary)));
    let follows = |body: &RigidBody<D>, boundary: usize| {
        let is_viscous = flow.law.gas.viscosity() != Viscosity::Inviscid;
        let sticks = is_viscous && flow.boundary[boundary].condition.is_no_slip();
        wall_facets(&case.mesh, &[boundary]).any(|nodes| is_moved(body, &nodes, sticks))
    };
    pairs.into_iter().find(|(body, boundary)| follows(body, *boundary))
}

/// Whether the mesh of `body` moves the facet with these `nodes` across itself; any way, if gas `sticks` to it.
fn is_moved<const D: usize>(body: &RigidBody<D>, nodes: &[[f64; D]], sticks: bool) -> bool {
    let weight = nodes.iter().filter_map(|x| body.weight(x)).fold(0.0, |most: f64, w| most.max(w.abs()));
    let (centre, area) = middle_and_area(nodes);
    let moves = |direction: &Direction| {
        let mode = mode(direction, &body.pivot, &centre);
        let way = if sticks { norm(&mode) * norm(&area) } else { dot(&mode, &area).abs() };
        weight * way > FOLLOWS * norm(&mode) * norm(&area)
    };
    weight > 0.0 && body.freedoms.iter().any(|freedom| moves(&freedom.direction))
}

/// The warning about a structure that deforms more in `state` than a linear law describes.
pub fn beyond_linear<const D: usize>(case: &Case<D>, state: &coupled::State) -> Option<String> {
    let structure = case.structure.as_ref().filter(|structure| structure.law == StructureLaw::Linear)?;
    let displacement = match beside_flow(case) {
        Some(_) => state.bodies.last().map(|stored| &stored[..BodyState::coordinates(stored)])?,
        None => &state.d[..],
    };
    let along = |axis: usize| displacement.iter().skip(axis).step_by(D);
    let spread = |axis: usize| {
        let [low, high] =
            along(axis).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &d| [low.min(d), high.max(d)]);
        high - low
    };
    let part = (0..D).map(spread).fold(0.0, f64::max) / structure.mesh(&case.mesh).diameter();
    (part > SMALL_DISPLACEMENT).then(|| {
        let part = if part < 1e3 { format!("{part:.2}") } else { format!("{part:.1e}") };
        format!(
            "points of the structure move apart by {part} of its size at t = {}, but `structure.law = \"linear\"` is for small displacements, up to about \
             {SMALL_DISPLACEMENT}; \"neo_hookean\" and \"st_venant_kirchhoff\" are for large ones",
            rounded_time(state.time)
        )
    })
}

/// Checks what only the mesh tells of the structure of a case, if it has one: enough supports for an equilibrium, enough natural modes, and
/// loads with a value at the start.
///
/// # Errors
/// What a run would refuse at its start.
pub fn check_structure<const D: usize>(case: &Case<D>) -> Result<(), Failure> {
    let Some(structure) = &case.structure else { return Ok(()) };
    let check = || {
        let StructureAtStart { body, loads, .. } = structure_at_start(case, structure)?;
        if structure.analysis == Analysis::Static {
            body.require_held()?;
        }
        body.require_modes(structure.natural_modes)?;
        body.load(&loads, case.time.start, &mut vec![0.0; body.length()])
    };
    check().map_err(Failure::bad_input)
}

/// A warning if the case asks for the equilibrium of a structure or body that nothing holds.
pub fn unheld_in_equilibrium<const D: usize>(case: &Case<D>) -> Option<String> {
    unheld(case).map(|[what, remedy]| format!("{what}; {remedy}"))
}

/// What is to find its equilibrium though nothing holds it, and the remedy: an axis of the structure without a support, or the first
/// coordinate of a body without a spring or stop.
pub fn unheld<const D: usize>(case: &Case<D>) -> Option<[String; 2]> {
    case.solver.steady.as_ref().filter(|steady| steady.bodies == SteadyBodies::Equilibrium)?;
    if let Some(axis) = case.structure.as_ref().and_then(unheld_axis) {
        return Some([
            format!(
                "no support holds the structure along {axis}: the flow carries it away, and there is no equilibrium"
            ),
            format!(
                "\"fixed\" or `{{ held = [\"{axis}\"] }}` for one of its boundaries in `structure.boundary`, or \
                 `solver.steady.bodies = \"held\"`"
            ),
        ]);
    }
    let of_body = |body: &RigidBody<D>| {
        let is_unheld = |freedom: &&Freedom| !is_held(body, freedom);
        Some((body.name.clone(), body.freedoms.iter().find(is_unheld)?.name))
    };
    let (body, freedom) = case.bodies.iter().find_map(of_body)?;
    Some([
        format!(
            "no spring holds `bodies.{body}.{freedom}`: unless the flow does, there is no equilibrium, and the body leaves its mesh"
        ),
        "give it a `spring`, or take `solver.steady.bodies = \"held\"`".into(),
    ])
}

/// Whether a drive, a spring or a stop holds a coordinate of `body`, or its weight, as that of a pendulum.
fn is_held<const D: usize>(body: &RigidBody<D>, freedom: &Freedom) -> bool {
    let has_spring = freedom.spring != 0.0 || freedom.cubic_spring != 0.0 || freedom.stops.is_some();
    let hangs = freedom.direction.rotates() && body.force.is_some() && body.centre_of_mass != body.pivot;
    freedom.motion.is_some() || has_spring || hangs
}

/// The first axis along which no boundary of `structure` is held.
fn unheld_axis<const D: usize>(structure: &Structure<D>) -> Option<&'static str> {
    let is_held = |axis: usize| structure.boundary.iter().any(|support| support.fixes()[axis]);
    AXES.into_iter().take(D).enumerate().find(|(axis, _)| !is_held(*axis)).map(|(_, name)| name)
}
