//! The supports and loads of a structure.

use super::super::displacement::check_rate;
use super::super::parts::SolidPart;
use super::super::shared_nodes::{SharedNodes, nodes_on};
use super::Support;
use crate::checker::{Checked, Checker, OTHERS};
use crate::error::collected;
use crate::key::Key;
use crate::raw::{self, Analysis, StructureBoundary};
use fem::VectorField;
use std::collections::BTreeMap;

/// Each boundary of the mesh of the structure, in the order of `Mesh::boundary_names`.
pub(super) fn check<const D: usize>(
    shared: &SharedNodes<'_, D>,
    key: &Key,
    raw: &raw::Structure,
    part: Option<&SolidPart<D>>,
) -> Checked<Vec<Support<D>>> {
    let SharedNodes { checker, mesh, .. } = *shared;
    let given = with_free_walls(raw, part);
    let key = key.child("boundary");
    let named = checker.by_boundary(&key, "support or load", &given, mesh.boundary_names())?;
    check_others(checker, &key.child(OTHERS), &given, mesh.boundary_names(), part)?;
    let boundary: Vec<Support<D>> = collected(named.iter().map(|(key, boundary)| support(checker, key, boundary)))?;
    let keys: Vec<Key> = named.into_iter().map(|(key, _)| key).collect();
    shared.check(&keys, &|index, _, x, t| boundary[index].prescribed(x, t))?;
    check_walls(checker, part, &keys, &boundary)?;
    // A static analysis asks for no velocity.
    if raw.analysis == Analysis::Dynamic {
        check_rates(shared, &keys, &boundary)?;
    }
    Ok(boundary)
}

/// The given boundaries. Walls to the flow are free unless they are named.
fn with_free_walls<const D: usize>(
    raw: &raw::Structure,
    part: Option<&SolidPart<D>>,
) -> BTreeMap<String, StructureBoundary> {
    let mut given = raw.boundary.clone();
    for wall in part.iter().flat_map(|part| part.wet_names()) {
        given.entry(wall.clone()).or_insert(StructureBoundary::Free);
    }
    given
}

/// `others` stands for a boundary of the structure that has no name of its own in the table `given`, and is no wall to the flow.
fn check_others<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    given: &BTreeMap<String, StructureBoundary>,
    names: &[String],
    part: Option<&SolidPart<D>>,
) -> Checked<()> {
    if !given.contains_key(OTHERS) || names.iter().any(|name| !given.contains_key(name)) {
        return Ok(());
    }
    let walls: Vec<String> = part.iter().flat_map(|part| part.wet_names()).map(|wall| format!("`{wall}`")).collect();
    let (problem, accepted) = ("`others` stands for no boundary: all have a name of their own here", "no such key");
    if walls.is_empty() {
        return Err(checker.combination(key, problem, accepted));
    }
    let problem = format!("{problem}, or are walls to the flow, for which it does not stand");
    Err(checker.combination(
        key,
        &problem,
        &format!("{accepted}; a load on a wall to the flow by name, {}", walls.join(", ")),
    ))
}

/// Supports that move have a velocity over the whole run.
fn check_rates<const D: usize>(
    &SharedNodes { checker, mesh, numbering, time }: &SharedNodes<'_, D>,
    keys: &[Key],
    boundary: &[Support<D>],
) -> Checked<()> {
    for (index, support) in boundary.iter().enumerate() {
        let Support::Moved(displacement) = support else { continue };
        let key = keys[index].child("displacement");
        for (_, x) in nodes_on(mesh, numbering, index) {
            for t in time.check_times() {
                for (axis, rate) in displacement.rate(&x, t).into_iter().enumerate() {
                    check_rate(checker, &key.entry(axis), format_args!("the displacement at {x:?}"), t, rate)?;
                }
            }
        }
    }
    Ok(())
}

/// Walls to the flow have no support: the flow moves them.
fn check_walls<const D: usize>(
    checker: &Checker<'_>,
    part: Option<&SolidPart<D>>,
    keys: &[Key],
    boundary: &[Support<D>],
) -> Checked<()> {
    let mut supported = part.iter().flat_map(|part| &part.wet).filter(|&&wall| boundary[wall].fixes() != [false; D]);
    let Some(&wall) = supported.next() else { return Ok(()) };
    let accepted = "\"free\", a load beside that of the flow, or no such key";
    Err(checker.combination(&keys[wall], "the flow moves this wall", accepted))
}

fn support<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &StructureBoundary) -> Checked<Support<D>> {
    Ok(match raw {
        StructureBoundary::Free => Support::Free,
        StructureBoundary::Fixed => Support::Held([true; D]),
        StructureBoundary::Held(axes) => {
            let key = key.child("held");
            checker.require(
                &key,
                "the list",
                !axes.is_empty(),
                "an axis or several; \"free\" where nothing holds it",
            )?;
            Support::Held(checker.axes(&key, axes)?)
        }
        StructureBoundary::Displacement(formulas) => {
            Support::Moved(checker.formulas(&key.child("displacement"), formulas)?)
        }
        StructureBoundary::Traction(formulas) => Support::Traction(checker.formulas(&key.child("traction"), formulas)?),
        StructureBoundary::Pressure(formula) => {
            Support::Pressure(checker.formula::<D>(&key.child("pressure"), formula)?)
        }
        StructureBoundary::FollowerPressure(formula) => {
            Support::FollowerPressure(checker.formula::<D>(&key.child("follower_pressure"), formula)?)
        }
    })
}
