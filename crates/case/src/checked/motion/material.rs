//! The elastic material of a mesh.

use super::{Stiffness, position};
use crate::checked::mesh_crate::Mesh;
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::raw;
use elasticity::{Law, Solver};

/// The default of [`Motion::Elastic::tolerance`]. det J, and the start of the next slab, are then correct to four digits. The tolerance
/// is a mean over all nodes, and a few nodes at a corner may have a hundred times the error: with 1e-2, det J was wrong by 40 %. Newton's
/// method converges quadratically, so the tight tolerance costs only a fifth more time.
const TOLERANCE: f64 = 1e-6;

/// The largest tolerance that a case may ask for.
const LARGEST_TOLERANCE: f64 = 1e-3;

/// The largest absolute power of det J. With larger ones the stiffness overflows or the matrix becomes singular.
const LARGEST_POWER: f64 = 10.0;

/// The elastic material of the mesh.
pub(super) struct Elasticity {
    pub(super) poisson_ratio: f64,
    pub(super) stiffness: Stiffness,
    pub(super) law: Law,
    pub(super) solver: Solver,
    pub(super) tolerance: f64,
}

impl Elasticity {
    pub(super) fn check<const D: usize>(
        checker: &Checker<'_>,
        key: &Key,
        raw: &raw::Motion,
        mesh: &Mesh<D>,
    ) -> Checked<Self> {
        let (raw, key) = (raw.elasticity.clone().unwrap_or_default(), key.child("elasticity"));
        let mut errors = Errors::default();
        let nu = errors.note(checker.poisson_ratio(&key.child("poisson_ratio"), raw.poisson_ratio));
        let stiffness = errors.note(stiffness(checker, &key.child("stiffness"), &raw.stiffness, mesh));
        let law = errors.note(law(checker, &key, &raw));
        errors.all()?;
        let (Some(poisson_ratio), Some(stiffness), Some(law)) = (nu, stiffness, law) else {
            unreachable!("what is missing has left an error")
        };
        let tolerance = raw.tolerance.unwrap_or(TOLERANCE);
        Ok(Elasticity { poisson_ratio, stiffness, law, solver: solver(raw.solver), tolerance })
    }
}

/// The law; keys of other laws are refused.
fn law(checker: &Checker<'_>, key: &Key, raw: &raw::Elasticity) -> Checked<Law> {
    let without_effect = |name: &str, law: &str, remedy: &str| {
        let problem = format!("`motion.elasticity.{name}` has no effect with the {law} law");
        checker.combination(&key.child(name), &problem, remedy)
    };
    if let Some(tolerance) = raw.tolerance {
        let accepted = format!(
            "a positive number of at most {LARGEST_TOLERANCE:e}, for instance {TOLERANCE:e}: a mesh further from equilibrium is \
             no start for the next slab"
        );
        let fine = tolerance > 0.0 && tolerance <= LARGEST_TOLERANCE;
        checker.require(&key.child("tolerance"), "the tolerance", fine, &accepted)?;
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

fn solver(raw: raw::ElasticitySolver) -> Solver {
    match raw {
        raw::ElasticitySolver::Automatic => Solver::Automatic,
        raw::ElasticitySolver::Direct => Solver::Direct,
        raw::ElasticitySolver::Cg => Solver::ConjugateGradients,
        raw::ElasticitySolver::Multigrid => Solver::Multigrid,
        raw::ElasticitySolver::Bddc => Solver::Bddc,
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
            checker.require(&key, "the power", power.abs() <= LARGEST_POWER, "a number from -10 to 10")?;
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
            checker.require_of_formula(
                &key,
                "the stiffness",
                everywhere,
                "a formula that is positive everywhere in the mesh",
            )?;
            Ok(Stiffness::Expression(modulus))
        }
        raw::Stiffness::WallDistance(raw) => wall_distance(checker, &key.child("wall_distance"), raw, mesh),
    }
}

fn wall_distance<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::WallDistance,
    mesh: &Mesh<D>,
) -> Checked<Stiffness> {
    let boundaries = |name: &str, names| checker.boundaries(&key.child(name), names, mesh.boundary_names());
    let (inner, outer) = (boundaries("inner", &raw.inner)?, boundaries("outer", &raw.outer)?);
    checker.require(&key.child("inner"), "the list", !inner.is_empty(), "the name of a boundary, or several")?;
    if let Some(entry) = outer.iter().position(|boundary| inner.contains(boundary)) {
        let problem = format!("boundary `{}` is in `inner` too: it moves or rests", raw.outer[entry]);
        return Err(checker.combination(
            &key.child("outer").entry(entry),
            &problem,
            "each boundary in one of the lists",
        ));
    }
    Ok(Stiffness::WallDistance {
        amplitude: checker.positive(&key.child("amplitude"), "the amplitude", raw.amplitude)?,
        distance: checker.positive(&key.child("distance"), "the distance", raw.distance)?,
        inner,
        outer,
    })
}
