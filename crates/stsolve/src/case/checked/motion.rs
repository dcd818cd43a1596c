//! The motion of the mesh.

use super::mesh_crate::{Mesh, face_nodes};
use crate::case::checker::{Checked, Checker};
use crate::case::error::Cause;
use crate::case::key::Key;
use crate::case::raw;
use crate::case::vector::Vector;
use crate::expression::Program;
use elasticity::Law;

/// How the mesh moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<const D: usize> {
    /// Every point as prescribed, a displacement in the position at rest and time.
    Prescribed(Vector<D>),
    /// The boundary as prescribed, the interior as an elastic body.
    Elastic {
        /// Poisson's ratio.
        poisson_ratio: f64,
        /// Young's modulus over the mesh.
        stiffness: Stiffness,
        /// The law.
        law: Law,
        /// Where Newton's method stops, an error of position relative to the distance of nodes.
        tolerance: f64,
        /// The displacement of each boundary, in the order of `Mesh::boundary_names`; None: it rests.
        boundary: Vec<Option<Vector<D>>>,
    },
}

/// [`Motion::Elastic::tolerance`] unless the case says otherwise: a slab that turns by 5 degrees then takes one or two steps.
const TOLERANCE: f64 = 1e-2;

/// Young's modulus over the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Stiffness {
    /// The same everywhere.
    Constant,
    /// (det J)^-power.
    InverseJacobian {
        /// The power.
        power: f64,
    },
    /// A formula in the position at rest.
    Expression(Program),
}

/// Checks `[motion]` of a run that starts at time `start`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Motion,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<Motion<D>> {
    let key = Key::new("motion");
    let Some(formulas) = &raw.displacement else {
        return elastic(checker, &key, raw, mesh, start);
    };
    for (name, given) in [("elasticity", raw.elasticity.is_some()), ("boundary", !raw.boundary.is_empty())] {
        if given {
            let problem =
                format!("`motion.{name}` has no effect: `motion.displacement` prescribes the motion everywhere");
            return Err(checker.combination(&key.child(name), &problem, "one of the two: remove the other"));
        }
    }
    let key = key.child("displacement");
    let displacement = checker.formulas(&key, formulas)?;
    let points = mesh.coordinates().chunks_exact(D).map(position);
    check_start(checker, &key, &displacement, points, start, mesh.diameter())?;
    Ok(Motion::Prescribed(displacement))
}

fn elastic<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Motion,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<Motion<D>> {
    let elasticity = raw.elasticity.clone().unwrap_or_default();
    let key_elasticity = key.child("elasticity");
    let nu = checker.poisson_ratio(&key_elasticity.child("poisson_ratio"), elasticity.poisson_ratio)?;
    let stiffness = stiffness(checker, &key_elasticity.child("stiffness"), &elasticity.stiffness, mesh)?;
    let law = law(checker, &key_elasticity, &elasticity)?;
    let named = checker.by_boundary(&key.child("boundary"), "motion", &raw.boundary, mesh.boundary_names())?;
    let displacement = |(index, (key, motion)): (usize, &(Key, &raw::BoundaryMotion))| match motion {
        raw::BoundaryMotion::Fixed => Ok(None),
        raw::BoundaryMotion::Displacement(formulas) => {
            let key = key.child("displacement");
            let displacement = checker.formulas(&key, formulas)?;
            check_start(checker, &key, &displacement, boundary_points(mesh, index), start, mesh.diameter())?;
            Ok(Some(displacement))
        }
    };
    let boundary = named.iter().enumerate().map(displacement).collect::<Checked<_>>()?;
    Ok(Motion::Elastic {
        poisson_ratio: nu,
        stiffness,
        law,
        tolerance: elasticity.tolerance.unwrap_or(TOLERANCE),
        boundary,
    })
}

/// The law, whose keys must be those of the law that is chosen.
fn law(checker: &Checker<'_>, key: &Key, raw: &raw::Elasticity) -> Checked<Law> {
    let without_effect = |name: &str, law: &str, remedy: &str| {
        let problem = format!("`motion.elasticity.{name}` has no effect with the {law} law");
        checker.combination(&key.child(name), &problem, remedy)
    };
    if let Some(tolerance) = raw.tolerance {
        let positive = tolerance > 0.0 && tolerance.is_finite();
        checker.require(&key.child("tolerance"), "the tolerance", positive, "a positive number")?;
    }
    match (raw.law, raw.reference) {
        (raw::Law::Linear, _) if raw.tolerance.is_some() => {
            Err(without_effect("tolerance", "linear", "remove it: one solve is exact"))
        }
        (raw::Law::Linear, Some(raw::ReferenceMesh::Updated)) => Ok(Law::Incremental),
        (raw::Law::Linear, _) => Ok(Law::Linear),
        (raw::Law::NeoHookean, Some(raw::ReferenceMesh::Updated)) => {
            let remedy = "\"initial\": remove it, or choose the linear law";
            Err(without_effect("reference", "neo-Hookean", remedy))
        }
        (raw::Law::NeoHookean, _) => Ok(Law::NeoHookean),
    }
}

fn stiffness<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Stiffness,
    mesh: &Mesh<D>,
) -> Checked<Stiffness> {
    match raw {
        raw::Stiffness::Constant => Ok(Stiffness::Constant),
        raw::Stiffness::InverseJacobian { power } => {
            let key = key.child("inverse_jacobian").child("power");
            checker.require(&key, "the power", power.is_finite(), "a finite number")?;
            Ok(Stiffness::InverseJacobian { power: *power })
        }
        raw::Stiffness::Expression(formula) => {
            let key = key.child("expression");
            let modulus = checker.formula_of_position::<D>(&key, formula)?;
            let positive = |x: [f64; D]| {
                let value = modulus.evaluate(&x, 0.0);
                value > 0.0 && value.is_finite()
            };
            let everywhere = mesh.coordinates().chunks_exact(D).map(position).all(positive);
            checker.require(&key, "the stiffness", everywhere, "a formula that is positive everywhere in the mesh")?;
            Ok(Stiffness::Expression(modulus))
        }
    }
}

/// The mesh starts at rest: the displacement is zero at `start`, up to round-off of the size of the mesh.
fn check_start<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    displacement: &Vector<D>,
    points: impl Iterator<Item = [f64; D]>,
    start: f64,
    size: f64,
) -> Checked<()> {
    for x in points {
        let d = displacement.evaluate(&x, start);
        if let Some(axis) = d.iter().position(|d| d.is_nan() || d.abs() > 1e-12 * size) {
            let cause = Cause::MovedAtStart { time: start, position: x.to_vec(), value: d[axis] };
            return Err(checker.error(&key.entry(axis), cause));
        }
    }
    Ok(())
}

/// The nodes on a boundary, cell by cell.
pub(super) fn boundary_points<const D: usize>(mesh: &Mesh<D>, boundary: usize) -> impl Iterator<Item = [f64; D]> {
    let facets = mesh.boundary_facets().iter().filter(move |facet| facet.boundary == boundary);
    facets.flat_map(|facet| {
        let nodes = mesh.cell_coordinates(facet.side.cell);
        face_nodes(D, mesh.order(), facet.side.face).into_iter().map(|k| position(&nodes[k * D..(k + 1) * D]))
    })
}

fn position<const D: usize>(coordinates: &[f64]) -> [f64; D] {
    std::array::from_fn(|axis| coordinates[axis])
}
