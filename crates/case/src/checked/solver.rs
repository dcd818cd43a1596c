//! The solver settings of a case.

use super::equilibrium;
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::raw::{self, Solver, Steady};

/// The largest number of Krylov iterations between restarts.
const MOST_VECTORS: usize = 10_000;

/// The longest march that tells whether a steady flow is stable, in time units.
const LONGEST_MARCH: f64 = 1e4;

/// The largest number of halvings of a slab: after more of them its length is below the round-off of the time.
const MOST_HALVINGS: usize = 40;
/// The largest tolerance of Newton's method: a residual reduced by less than ten times is no solution.
const LOOSEST: f64 = 0.1;

/// The same in words.
const LOOSEST_RELATIVE: &str =
    "a number above 0, at most 0.1; with more a residual counts as solved that has hardly been reduced";

/// Checks `[solver]`.
pub(super) fn check(checker: &Checker<'_>, raw: &Solver) -> Checked<()> {
    let mut errors = Errors::default();
    let key = Key::new("solver");
    let (relative, absolute) = (raw.newton_tolerance, raw.newton_absolute_tolerance);
    for (name, fine, accepted) in [
        ("newton_tolerance", 0.0 < relative && relative <= LOOSEST, LOOSEST_RELATIVE),
        (
            "newton_absolute_tolerance",
            (0.0..=LOOSEST).contains(&absolute),
            "a number from 0 to 0.1; a slab with more is not solved",
        ),
        ("krylov_tolerance", 0.0 < raw.krylov_tolerance && raw.krylov_tolerance < 1.0, "a number above 0 and below 1"),
    ] {
        errors.note(checker.require(&key.child(name), "the tolerance", fine, accepted));
    }
    for (name, value) in [
        ("newton_steps", raw.newton_steps),
        ("krylov_iterations", raw.krylov_iterations),
        ("krylov_restart", raw.krylov_restart),
    ] {
        errors.note(checker.at_least_one(&key.child(name), "the number", value));
    }
    errors.note(checker.require(
        &key.child("krylov_restart"),
        "the number",
        raw.krylov_restart <= MOST_VECTORS,
        "1 or more, at most 10000: each keeps two vectors",
    ));
    let accepted = format!("0 to {MOST_HALVINGS}: half as long each time");
    let halvings = raw.slab_halvings <= MOST_HALVINGS;
    errors.note(checker.require(&key.child("slab_halvings"), "the number of halvings", halvings, &accepted));
    let layer = raw.start_layer.is_none_or(|thickness| thickness >= 0.0 && thickness.is_finite());
    errors.note(checker.require(&key.child("start_layer"), "the thickness", layer, "0 or more"));
    if let Some(steady) = &raw.steady {
        errors.note(check_steady(checker, &key.child("steady"), steady));
    }
    let key = key.child("pseudo_time");
    let pseudo_time = &raw.pseudo_time;
    for (name, value) in [
        ("initial_inverse", pseudo_time.initial_inverse),
        ("restart_inverse", pseudo_time.restart_inverse),
        ("power", pseudo_time.power),
    ] {
        errors.note(checker.require(&key.child(name), "the number", value >= 0.0 && value.is_finite(), "0 or more"));
    }
    errors.all()
}

/// Checks that there is something that the steady flow of the case `raw` can move, if it is to be in equilibrium with it.
pub(super) fn check_bodies(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    if !equilibrium::is_asked(raw) || !raw.bodies.is_empty() || raw.structure.is_some() {
        return Ok(());
    }
    let key = Key::new("solver").child("steady").child("bodies");
    let problem = "the case has nothing that the flow moves";
    Err(checker.combination(&key, problem, "[bodies] or [structure] in this case, or `held`"))
}

fn check_steady(checker: &Checker<'_>, key: &Key, raw: &Steady) -> Checked<()> {
    let mut errors = Errors::default();
    let (newton, krylov) = (raw.tolerance, raw.krylov_tolerance);
    for (name, fine, accepted) in [
        ("tolerance", 0.0 < newton && newton <= LOOSEST, LOOSEST_RELATIVE),
        ("krylov_tolerance", 0.0 < krylov && krylov < 1.0, "a number above 0 and below 1"),
    ] {
        errors.note(checker.require(&key.child(name), "the tolerance", fine, accepted));
    }
    errors.note(checker.positive(&key.child("first_step"), "the first step", raw.first_step));
    errors.note(checker.require(
        &key.child("power"),
        "the power",
        raw.power >= 0.0 && raw.power.is_finite(),
        "0 or more",
    ));
    let time = raw.stability_time.is_none_or(|time| (0.0..=LONGEST_MARCH).contains(&time));
    errors.note(checker.require(
        &key.child("stability_time"),
        "the time",
        time,
        "0 to 10000, in time units of six slabs each",
    ));
    let grows = raw.growth > 1.0 && raw.growth.is_finite();
    errors.note(checker.require(&key.child("growth"), "the factor", grows, "a number above 1"));
    for (name, value) in [("steps", raw.steps), ("krylov_iterations", raw.krylov_iterations)] {
        errors.note(checker.at_least_one(&key.child(name), "the number", value));
    }
    errors.all()
}
