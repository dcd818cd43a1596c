//! Distributions along walls.

use super::flow::Flow;
use crate::checker::{Checked, Checker};
use crate::error::Cause;
use crate::key::Key;
use crate::raw;

/// Checks `[output.surfaces]`: the surfaces are walls of the flow, each listed once.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: Option<&raw::Surfaces>,
    flow: Option<&Flow<D>>,
) -> Checked<()> {
    let Some(raw) = raw else { return Ok(()) };
    let key = Key::new("output").child("surfaces").child("walls");
    let walls: Vec<String> = flow.iter().flat_map(|flow| &flow.walls).map(|wall| wall.name.clone()).collect();
    if walls.is_empty() {
        let problem = "there are no distributions: the case has no wall in a flow";
        let accepted = "no section [output.surfaces], or a condition such as `adiabatic_wall` in [flow.boundary]";
        return Err(checker.combination(&key, problem, accepted));
    }
    for (index, name) in checker.distinct(&key, "wall", &raw.walls)?.iter().enumerate() {
        if !walls.contains(name) {
            let unknown = Cause::Unknown { kind: "wall", name: name.clone(), accepted: walls };
            return Err(checker.error(&key.entry(index), unknown));
        }
    }
    Ok(())
}
