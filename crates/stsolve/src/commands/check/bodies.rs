//! Warnings about bodies that the flow moves.

use super::Facts;
use super::resolution::NODES_PER_PERIOD;
use super::warnings::{Warning, warning};
use case::{Flow, Freedom, RigidBody};
use coupled::blocks::rigid_body::Freedom as Direction;
use simulation::{point_far_from_body, wall_that_follows};
use std::f64::consts::{PI, TAU};
use tensor::dot;

/// A spring with fewer nodes in a period hardly swings.
const FEW_NODES: f64 = 4.0;

/// A contact with a stop that lasts fewer slabs changes the energy of the body by more than a few per cent.
const FEW_SLABS: f64 = 6.0;

/// All of them.
pub(super) fn warnings<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> [Option<Warning>; 7] {
    [
        wall_beside_body(facts, flow),
        weightless(facts, flow),
        stiff_spring(facts),
        stiff_stops(facts),
        negative(facts),
        beyond_stops(facts),
        far_point(facts),
    ]
}

/// A wall beside a body that follows it by weights changes its shape, or drags gas along.
fn wall_beside_body<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (body, boundary) = wall_that_follows(facts.case, flow)?;
    let (name, wall) = (&body.name, &facts.case.mesh.boundary_names()[boundary]);
    let text = format!(
        "`bodies.{name}.mesh` moves the wall `{wall}`, which is of no body, across itself, or along itself with the gas that sticks to it: a smaller \
         `outer`, a `weight` that is 0 there, or an elastic mesh (no `bodies.{name}.mesh`)"
    );
    warning("wall beside a body", text)
}

/// A force on the gas, gravity perhaps, that bodies and structures do not feel.
fn weightless<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    if !flow.law.source.is_force() {
        return None;
    }
    let of_body = || {
        let is_free = |body: &&RigidBody<D>| body.freedoms.iter().any(|freedom| freedom.motion.is_none());
        let body = facts.case.bodies.iter().filter(is_free).find(|body| body.force.is_none())?;
        Some(format!("`bodies.{}.force` gives the body its weight", body.name))
    };
    let of_structure = || {
        let structure = facts.case.structure.as_ref().filter(|structure| structure.body_force.is_none());
        structure.map(|_| "`structure.body_force` gives the structure its weight".to_owned())
    };
    let remedy = of_body().or_else(of_structure)?;
    warning("body force", format!("`flow.source.acceleration` acts on the gas alone: if it is gravity, {remedy}"))
}

/// A body on a spring that swings faster than slabs resolve: they damp it within a few periods.
fn stiff_spring<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let time = &facts.case.time;
    // Slabs that adapt see it, and an equilibrium needs no motion.
    if time.control.is_some() || time.end == time.start {
        return None;
    }
    let swings = |(body, freedom): &(&RigidBody<D>, &Freedom)| {
        let critical = 2.0 * (inertia(body, &freedom.direction) * freedom.spring).sqrt();
        freedom.motion.is_none() && freedom.spring > 0.0 && freedom.damping < critical
    };
    let periods = coordinates(facts).filter(swings).map(|(body, freedom)| {
        (TAU * (inertia(body, &freedom.direction) / freedom.spring).sqrt(), &body.name, freedom.name)
    });
    let (period, body, coordinate) = periods.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let nodes = period / time.step * time.order as f64;
    if nodes >= FEW_NODES {
        return None;
    }
    let text = format!(
        "without the fluid `bodies.{body}.{coordinate}` swings with the period {period:.2e}, which has {nodes:.1} nodes in time: such slabs damp it \
         away; to see it, `time.step` of {:.2e} or less",
        period * time.order as f64 / NODES_PER_PERIOD
    );
    warning("spring", text)
}

/// Stops that turn a body back within a few slabs: a bounce may then multiply its energy.
fn stiff_stops<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let time = &facts.case.time;
    // Slabs that adapt resolve the contact, and an equilibrium needs no motion.
    if time.control.is_some() || time.end == time.start {
        return None;
    }
    let contacts = coordinates(facts).filter(|(_, freedom)| freedom.motion.is_none()).filter_map(|(body, freedom)| {
        let contact = PI * (inertia(body, &freedom.direction) / freedom.stops?.stiffness).sqrt();
        Some((contact, &body.name, freedom.name))
    });
    let (contact, body, coordinate) = contacts.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let slabs = contact / time.step;
    if slabs >= FEW_SLABS {
        return None;
    }
    let text = format!(
        "a contact of `bodies.{body}.{coordinate}` with its stops lasts {contact:.2e}, which is {slabs:.2} slabs: the energy of the body is wrong \
         after it; `time.step` of {:.2e} or less, softer stops, or `time.adaptive`",
        contact / FEW_SLABS
    );
    warning("stops", text)
}

/// A spring or a damper that drives the body.
fn negative<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (body, freedom) = coordinates(facts).find(|(_, freedom)| freedom.spring < 0.0 || freedom.damping < 0.0)?;
    let (key, value) = if freedom.spring < 0.0 { ("spring", freedom.spring) } else { ("damping", freedom.damping) };
    let text = format!(
        "`bodies.{}.{}.{key}` is {value}: it drives the body away; a positive number, if that is not meant",
        body.name, freedom.name
    );
    warning("spring", text)
}

/// Stops between which the body does not start.
fn beyond_stops<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let start =
        |freedom: &Freedom| freedom.motion.as_ref().map_or(0.0, |motion| motion.evaluate(&[], facts.case.time.start));
    let is_beyond =
        |freedom: &Freedom| freedom.stops.is_some_and(|stops| !(stops.lower..=stops.upper).contains(&start(freedom)));
    let (body, freedom) = coordinates(facts).find(|(_, freedom)| is_beyond(freedom))?;
    let text = format!(
        "`bodies.{}.{}` starts at {}, beyond its stops, which push at once: `stops` around the start",
        body.name,
        freedom.name,
        start(freedom)
    );
    warning("stops", text)
}

/// A pivot or a centre of mass far from its body, perhaps because the origin was taken.
fn far_point<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (body, key, sizes) = point_far_from_body(facts.case)?;
    let point = if key == "pivot" { &body.pivot } else { &body.centre_of_mass };
    let text = format!(
        "`bodies.{}.{key}` is {point:?}, {sizes:.1} sizes of the body away from its walls: a hinge there is possible; `{key} = [...]` if it is not meant",
        body.name
    );
    warning(key, text)
}

/// The coordinates of all bodies.
fn coordinates<'a, const D: usize>(facts: &'a Facts<'_, D>) -> impl Iterator<Item = (&'a RigidBody<D>, &'a Freedom)> {
    facts.case.bodies.iter().flat_map(|body| body.freedoms.iter().map(move |freedom| (body, freedom)))
}

/// The mass, or the moment of inertia about the axis through the pivot.
fn inertia<const D: usize>(body: &RigidBody<D>, direction: &Direction) -> f64 {
    let Direction::Rotation(axis) = direction else { return body.mass };
    let arm: [f64; 3] = std::array::from_fn(|i| if i < D { body.centre_of_mass[i] - body.pivot[i] } else { 0.0 });
    let about_centre = dot(axis, &body.inertia.map(|row| dot(&row, axis)));
    about_centre + body.mass * (dot(&arm, &arm) - dot(&arm, axis).powi(2))
}
