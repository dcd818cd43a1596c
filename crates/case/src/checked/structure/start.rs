//! The displacement and the velocity of a structure at the start.

use super::super::mesh_crate::Mesh;
use super::super::parts::SolidPart;
use super::super::shared_nodes::{SharedNodes, nodes_on};
use super::Support;
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::magnitude::{is_bounded, is_round_off};
use crate::raw::{self, Analysis};
use crate::vector::Vector;

/// The displacement and the velocity at the start, if they are given.
pub(super) struct Start<const D: usize> {
    pub(super) displacement: Option<Vector<D>>,
    pub(super) velocity: Option<Vector<D>>,
}

impl<const D: usize> Start<D> {
    pub(super) fn check(
        checker: &Checker<'_>,
        key: &Key,
        raw: &raw::Structure,
        mesh: &Mesh<D>,
        start: f64,
    ) -> Checked<Self> {
        let (mut errors, key) = (Errors::default(), key.child("initial"));
        if raw.analysis == Analysis::Static {
            check_static(checker, &key, &raw.initial)?;
        }
        let [displacement, velocity] =
            [("displacement", &raw.initial.displacement), ("velocity", &raw.initial.velocity)].map(|(name, given)| {
                let (key, formulas) = (key.child(name), given.as_ref()?);
                let vector = errors.note(checker.formulas(&key, formulas))?;
                errors.note(check_finite(checker, &key, name, &vector, mesh, start))?;
                Some(vector)
            });
        errors.all().map(|()| Start { displacement, velocity })
    }

    /// At the start the structure must be at its supports, and the walls to the flow must be at rest.
    pub(super) fn check_walls(
        &self,
        shared: &SharedNodes<'_, D>,
        part: Option<&SolidPart<D>>,
        boundary: &[Support<D>],
    ) -> Checked<()> {
        check_start_of_walls(shared.checker, part, self.displacement.as_ref(), shared)?;
        check_start(shared.checker, boundary, self.displacement.as_ref(), shared)
    }
}

/// A static analysis has no initial motion.
fn check_static(checker: &Checker<'_>, key: &Key, initial: &raw::InitialMotion) -> Checked<()> {
    for (name, given) in [("displacement", &initial.displacement), ("velocity", &initial.velocity)] {
        if given.is_some() {
            let problem = format!("`structure.initial.{name}` has no effect on a static analysis");
            let accepted = "remove it: the body starts in equilibrium with its loads and supports";
            return Err(checker.combination(&key.child(name), &problem, accepted));
        }
    }
    Ok(())
}

/// The motion at the `start` must have a value at every node.
fn check_finite<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    name: &str,
    vector: &Vector<D>,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<()> {
    for (k, x) in mesh.coordinates().chunks_exact(D).enumerate() {
        let x: [f64; D] = std::array::from_fn(|axis| x[axis]);
        for (axis, value) in vector.evaluate(&x, start).into_iter().enumerate() {
            let quantity = format!("the {name} in cell {} at {x:?}, {value},", k / mesh.nodes_per_cell());
            checker.require_of_formula(
                &key.entry(axis),
                &quantity,
                is_bounded(value),
                "a formula that is finite everywhere, and at most 1e60",
            )?;
        }
    }
    Ok(())
}

/// At the start the body must be at its supports, up to round-off of the size of the mesh.
fn check_start<const D: usize>(
    checker: &Checker<'_>,
    boundary: &[Support<D>],
    displacement: Option<&Vector<D>>,
    SharedNodes { mesh, numbering, time, .. }: &SharedNodes<'_, D>,
) -> Checked<()> {
    for (index, support) in boundary.iter().enumerate() {
        for (_, x) in nodes_on(mesh, numbering, index) {
            let d = displacement.map_or([0.0; D], |displacement| displacement.evaluate(&x, time.start));
            let g = support.prescribed(&x, time.start);
            let apart = |i: &usize| g[*i].is_some_and(|g| !is_round_off(d[*i] - g, mesh.diameter()));
            if let Some(i) = (0..D).find(apart) {
                let (name, d, g) = (&mesh.boundary_names()[index], d[i], g[i].unwrap_or(0.0));
                let problem =
                    format!("the displacement at the start, {d:e} at {x:?}, is not that of boundary `{name}`, {g:e}");
                let accepted = "an initial displacement that is that of the supports";
                return Err(checker.combination(&Key::new("structure.initial.displacement"), &problem, accepted));
            }
        }
    }
    Ok(())
}

/// The mesh of the flow starts at rest, and so do the walls that it shares with the structure.
fn check_start_of_walls<const D: usize>(
    checker: &Checker<'_>,
    part: Option<&SolidPart<D>>,
    displacement: Option<&Vector<D>>,
    SharedNodes { mesh, numbering, time, .. }: &SharedNodes<'_, D>,
) -> Checked<()> {
    let (Some(part), Some(displacement)) = (part, displacement) else { return Ok(()) };
    let d = |x: &[f64; D]| displacement.evaluate(x, time.start);
    let moves = |x: &[f64; D]| d(x).iter().any(|d| !is_round_off(*d, mesh.diameter()));
    let Some((_, x)) = part.wet.iter().flat_map(|wall| nodes_on(mesh, numbering, *wall)).find(|(_, x)| moves(x)) else {
        return Ok(());
    };
    let problem = format!("the displacement at the start moves a wall of the flow, at {x:?} by {:?}", d(&x));
    let accepted = "a displacement that is zero on walls of the flow, where the mesh starts at rest; `solver.steady.bodies = \"equilibrium\"` \
                    starts with a structure bent by its loads";
    Err(checker.combination(&Key::new("structure.initial.displacement"), &problem, accepted))
}
