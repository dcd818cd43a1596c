//! The material of a structure.

use super::super::mesh_crate::Mesh;
use super::Largest;
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::expression::Program;
use crate::key::Key;
use crate::raw::{self, Analysis, Damping, Plane, StructureLaw};

/// The material of a structure, as [`super::Structure`] holds it.
pub(super) struct Material {
    pub(super) young_modulus: Program,
    pub(super) poisson_ratio: Program,
    pub(super) largest: Largest,
    pub(super) density: Option<f64>,
    pub(super) damping: Damping,
    pub(super) plane: Plane,
}

impl Material {
    pub(super) fn check<const D: usize>(
        checker: &Checker<'_>,
        key: &Key,
        raw: &raw::Structure,
        mesh: &Mesh<D>,
    ) -> Checked<Self> {
        let mut errors = Errors::default();
        let constants = errors.note(constants(checker, key, raw, mesh));
        let density = errors.note(density(checker, key, raw));
        let damping = errors.note(damping(checker, &key.child("damping"), raw));
        let plane = errors.note(plane::<D>(checker, key, raw));
        errors.all()?;
        let (Some((young_modulus, poisson_ratio, largest)), Some(density), Some(damping), Some(plane)) =
            (constants, density, damping, plane)
        else {
            unreachable!("what is missing has left an error")
        };
        Ok(Material { young_modulus, poisson_ratio, largest, density, damping, plane })
    }
}

/// E and nu, which must be in range at all nodes of the mesh, and their extremes there.
fn constants<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Structure,
    mesh: &Mesh<D>,
) -> Checked<(Program, Program, Largest)> {
    let [key_young, key_poisson] = ["young_modulus", "poisson_ratio"].map(|name| key.child(name));
    let young = checker.formula_of_position::<D>(&key_young, &raw.young_modulus)?;
    let poisson = checker.formula_of_position::<D>(&key_poisson, &raw.poisson_ratio)?;
    let mut largest = Largest { shear_modulus: 0.0, poisson_ratio: -1.0 };
    for x in mesh.coordinates().chunks_exact(D) {
        let [e, nu] = [&young, &poisson].map(|constant| constant.evaluate(x, 0.0));
        checker.positive(&key_young, "Young's modulus", e)?;
        checker.poisson_ratio(&key_poisson, nu)?;
        largest.shear_modulus = largest.shear_modulus.max(0.5 * e / (1.0 + nu));
        largest.poisson_ratio = largest.poisson_ratio.max(nu);
    }
    Ok((young, poisson, largest))
}

/// The density, which inertia needs.
fn density(checker: &Checker<'_>, key: &Key, raw: &raw::Structure) -> Checked<Option<f64>> {
    let key = key.child("density");
    if let Some(density) = raw.density {
        return Ok(Some(checker.positive(&key, "the density", density)?));
    }
    if raw.analysis == Analysis::Static && raw.natural_modes == 0 {
        return Ok(None);
    }
    let accepted = "`density`, a mass per volume; or `analysis = \"static\"` without natural modes";
    Err(checker.combination(&key, "missing key `density`: inertia needs one", accepted))
}

/// Plane strain or plane stress; neither in three dimensions.
fn plane<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Structure) -> Checked<Plane> {
    if raw.plane.is_some() && D == 3 {
        let problem = "`structure.plane` has no effect on a three-dimensional body";
        return Err(checker.combination(&key.child("plane"), problem, "remove it"));
    }
    let plane = raw.plane.unwrap_or_default();
    if plane == Plane::Stress && raw.law != StructureLaw::Linear {
        let problem = "`structure.plane = \"stress\"` is for the linear law only";
        return Err(checker.combination(&key.child("plane"), problem, "`plane = \"strain\"`, or `law = \"linear\"`"));
    }
    Ok(plane)
}

/// The damping, of a body that moves.
fn damping(checker: &Checker<'_>, key: &Key, raw: &raw::Structure) -> Checked<Damping> {
    for (name, value) in [("mass", raw.damping.mass), ("stiffness", raw.damping.stiffness)] {
        let accepted = "a number that is not negative";
        checker.require(&key.child(name), "the damping", value >= 0.0 && value.is_finite(), accepted)?;
    }
    if raw.analysis == Analysis::Static && raw.damping != Damping::default() {
        let problem = "`structure.damping` has no effect on a static analysis";
        return Err(checker.combination(key, problem, "remove it"));
    }
    Ok(raw.damping)
}
