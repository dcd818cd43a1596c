//! Bodies and structures that start in equilibrium with the flow.

use super::bodies::{Freedom, RigidBody, key_of};
use super::structure::Structure;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, SteadyBodies};

/// Whether the case `raw` asks for an equilibrium.
pub(super) fn is_asked(raw: &raw::Case) -> bool {
    raw.solver.steady.is_some_and(|steady| steady.bodies == SteadyBodies::Equilibrium)
}

/// Checks that `bodies` and `structure` can start in equilibrium, if the case `raw` asks for it. A restart has another start.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Case,
    bodies: &[RigidBody<D>],
    structure: Option<&Structure<D>>,
) -> Checked<()> {
    if !is_asked(raw) || raw.restart.is_some() {
        return Ok(());
    }
    for body in bodies {
        for freedom in body.freedoms.iter().filter(|freedom| freedom.motion.is_none()) {
            let key = key_of(&body.name).child(freedom.name);
            check_no_rate(checker, &key.child("rate"), freedom.rate != 0.0)?;
            check_held(checker, &key, body, freedom)?;
        }
    }
    let velocity = structure.and_then(|structure| structure.velocity.as_ref());
    check_no_rate(checker, &Key::new("structure.initial.velocity"), velocity.is_some())
}

/// What starts in equilibrium starts at rest.
fn check_no_rate(checker: &Checker<'_>, key: &Key, is_given: bool) -> Checked<()> {
    if !is_given {
        return Ok(());
    }
    let problem = format!("`{key}` has no effect with `solver.steady.bodies = \"equilibrium\"`");
    Err(checker.combination(key, &problem, "remove it: the run starts at rest"))
}

/// Something must hold a free coordinate. A force beside the pivot may hold a rotation, as the weight of a pendulum does.
fn check_held<const D: usize>(checker: &Checker<'_>, key: &Key, body: &RigidBody<D>, freedom: &Freedom) -> Checked<()> {
    let has_spring = freedom.spring != 0.0 || freedom.cubic_spring != 0.0 || freedom.stops.is_some();
    let is_pendulum = body.force.is_some() && body.centre_of_mass != body.pivot;
    if has_spring || (freedom.direction.rotates() && is_pendulum) {
        return Ok(());
    }
    let problem = "nothing holds this coordinate: the body has no equilibrium with the flow";
    let accepted = "`spring`, `cubic_spring` or `stops`, a weak `spring` where the flow itself holds the body; `motion = 0`, which holds it; \
                    or `solver.steady.bodies = \"held\"`";
    Err(checker.combination(key, problem, accepted))
}
