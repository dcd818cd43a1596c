//! Bodies and structures that start in equilibrium with the flow.

use super::bodies::{RigidBody, key_of};
use super::structure::Structure;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, SteadyBodies};

/// Whether the case `raw` asks for an equilibrium.
pub(super) fn is_asked(raw: &raw::Case) -> bool {
    raw.solver.steady.is_some_and(|steady| steady.bodies == SteadyBodies::Equilibrium)
}

/// Checks that `bodies` and `structure` start at rest, if the case `raw` asks for an equilibrium. A restart has another start.
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
            let key = key_of(&body.name).child(freedom.name).child("rate");
            check_no_rate(checker, &key, freedom.rate != 0.0)?;
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
