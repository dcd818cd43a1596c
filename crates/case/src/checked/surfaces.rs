//! Distributions along walls.

use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::key::Key;
use crate::raw;

/// How the names of the files of averages along a wall end.
const OF_AVERAGES: [&str; 2] = ["_mean", "_separation"];

/// File systems take names of 255 bytes; those of files of a wall have more than its name.
const LONGEST_NAME: usize = 200;

/// Checks `[output.surfaces]` on a mesh with these `boundaries`: the surfaces are walls of the flow, each listed once.
pub(super) fn check(
    checker: &Checker<'_>,
    output: &raw::Output,
    flow: Option<&raw::Flow>,
    boundaries: &[String],
) -> Checked<()> {
    let Some(raw) = output.surfaces.as_ref() else { return Ok(()) };
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
    check_names(checker, &key, &raw.walls, &walls)?;
    check_lengths(checker, &key, &raw.walls)?;
    check_files(checker, &key, &raw.walls, output.averages.is_some() && raw.every.is_some())
}

/// The name of the series and of the files of a wall. A slash in the name of the wall would be a folder.
pub fn surface_name(wall: &str) -> String {
    format!("surface_{}", wall.replace(['/', '\\'], "_"))
}

/// Whether two walls would write the same file. Averages are written beside their distributions, with [`OF_AVERAGES`] in the names.
fn clash(wall: &str, other: &str, has_averages: bool) -> bool {
    let (here, there) = (surface_name(wall), surface_name(other));
    let is_of_averages = |end: &str| here == format!("{there}{end}") || there == format!("{here}{end}");
    here == there || has_averages && OF_AVERAGES.into_iter().any(is_of_averages)
}

/// Checks that the name of a file can hold each name of a wall. A mesh file may have longer ones.
fn check_lengths(checker: &Checker<'_>, key: &Key, walls: &[String]) -> Checked<()> {
    let fits = |wall: &String| wall.len() <= LONGEST_NAME;
    let accepted = "a name of at most 200 bytes in the mesh: it becomes a part of the names of files";
    let names = walls.iter().enumerate();
    collected::<()>(names.map(|(index, wall)| checker.require(&key.entry(index), "the name", fits(wall), accepted)))
        .map(drop)
}

/// Checks that no two walls write the same file.
fn check_files(checker: &Checker<'_>, key: &Key, walls: &[String], has_averages: bool) -> Checked<()> {
    for (index, wall) in walls.iter().enumerate() {
        if let Some(other) = walls[..index].iter().find(|other| clash(wall, other, has_averages)) {
            let problem =
                format!("the distributions of \"{wall}\" and of \"{other}\" would be written to the same file");
            return Err(checker.combination(
                &key.entry(index),
                &problem,
                "names that differ in more than / and _, a `_mean` or a `_separation`",
            ));
        }
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file was written by two walls, and one distribution was lost.
    #[test]
    fn walls_with_the_same_file_clash() {
        assert_eq!(surface_name("a/b"), "surface_a_b");
        assert!(clash("a/b", "a_b", false) && clash("a\\b", "a/b", false) && !clash("a", "b", true));
        assert!(clash("a", "a_mean", true) && clash("a_mean", "a", true) && !clash("a", "a_mean", false));
        assert!(clash("step", "step_separation", true) && !clash("step", "step_separation", false));
    }
}
