//! The supports and loads of a structure.

use super::super::parts::SolidPart;
use super::super::shared_nodes::SharedNodes;
use super::Support;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::key::Key;
use crate::raw::{self, StructureBoundary};
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
    let named = checker.by_boundary(&key.child("boundary"), "support or load", &given, mesh.boundary_names())?;
    let boundary: Vec<Support<D>> = collected(named.iter().map(|(key, boundary)| support(checker, key, boundary)))?;
    let keys: Vec<Key> = named.into_iter().map(|(key, _)| key).collect();
    shared.check(&keys, &|index, _, x, t| boundary[index].prescribed(x, t))?;
    check_walls(checker, part, &keys, &boundary)?;
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
