//! Distributions along walls.

use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::key::Key;
use crate::raw;

/// Checks `[output.surfaces]` on a mesh with these `boundaries`: the surfaces are walls of the flow, each listed once.
pub(super) fn check(
    checker: &Checker<'_>,
    raw: Option<&raw::Surfaces>,
    flow: Option<&raw::Flow>,
    boundaries: &[String],
) -> Checked<()> {
    let Some(raw) = raw else { return Ok(()) };
    // A boundary without a condition, and one with an unknown name, are other errors.
    let conditions = flow.map(|flow| checker.entries_of_boundaries(&Key::new("flow"), &flow.boundary, boundaries));
    let is_whole = flow.is_none_or(|flow| {
        checker.by_boundary(&Key::new("flow.boundary"), "flow condition", &flow.boundary, boundaries).is_ok()
    });
    let key = Key::new("output").child("surfaces").child("walls");
    if !is_whole || checker.damage().hides_conditions() {
        return check_names(checker, &key, &raw.walls, boundaries);
    }
    let walls = conditions.iter().flatten().filter(|(.., condition)| condition.is_wall());
    let walls: Vec<String> = walls.map(|(index, ..)| boundaries[*index].clone()).collect();
    if walls.is_empty() {
        let problem = "there are no distributions: the case has no wall in a flow";
        let accepted = "no section [output.surfaces], or a condition such as `adiabatic_wall` in [flow.boundary]";
        return Err(checker.combination(&key, problem, accepted));
    }
    if raw.walls.is_empty() {
        let accepted = format!("some of {}, or no section [output.surfaces]", walls.join(", "));
        return Err(checker.combination(&key, "the list of walls is empty", &accepted));
    }
    check_names(checker, &key, &raw.walls, &walls)
}

/// Checks that the `names` are different names of `walls`.
fn check_names(checker: &Checker<'_>, key: &Key, names: &[String], walls: &[String]) -> Checked<()> {
    let names = checker.distinct(key, "wall", names)?.iter().enumerate();
    let unknown = names.filter(|(_, name)| !walls.contains(name)).map(|(index, name)| {
        let cause = Cause::Unknown { kind: "wall", name: name.clone(), accepted: walls.to_vec(), belongs: None };
        Err(checker.error(&key.entry(index), cause))
    });
    collected::<()>(unknown).map(drop)
}
