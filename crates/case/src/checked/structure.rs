//! A structure.

mod material;
mod start;
mod supports;

use super::Time;
use super::mesh_crate::{Mesh, NodeNumbering};
use super::parts::SolidPart;
use super::probes::check_name;
use super::shared_nodes::SharedNodes;
use crate::checker::{Checked, Checker};
use crate::error::{Errors, collected};
use crate::expression::Program;
use crate::key::Key;
use crate::raw::{self, Analysis, Damping, Plane, StructureLaw};
use crate::vector::Vector;
use material::Material;
use start::Start;

/// An elastic body.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure<const D: usize> {
    /// Its part of the mesh; None: it fills the mesh, and there is no flow.
    pub part: Option<SolidPart<D>>,
    /// E, in the position at rest.
    pub young_modulus: Program,
    /// nu, in the position at rest.
    pub poisson_ratio: Program,
    /// The law of the material, stress by strain.
    pub law: StructureLaw,
    /// Rayleigh damping.
    pub damping: Damping,
    /// Mass per volume; None: a static analysis needs none.
    pub density: Option<f64>,
    /// Whether it has inertia.
    pub analysis: Analysis,
    /// Plane strain or plane stress in two dimensions.
    pub plane: Plane,
    /// The largest shear modulus mu = E / (2 (1 + nu)), and the largest nu, at the nodes.
    pub largest: Largest,
    /// Force per volume, in the position at rest and time.
    pub body_force: Option<Vector<D>>,
    /// Each boundary of its mesh, in the order of `Mesh::boundary_names`.
    pub boundary: Vec<Support<D>>,
    /// The displacement at the start; None: zero.
    pub displacement: Option<Vector<D>>,
    /// The velocity at the start; None: zero.
    pub velocity: Option<Vector<D>>,
    /// The number of natural modes.
    pub natural_modes: usize,
    /// Observed points, with their names.
    pub points: Vec<(String, [f64; D])>,
}

impl<const D: usize> Structure<D> {
    /// Its mesh, in a case whose flow or structure has the mesh `other`.
    pub fn mesh<'a>(&'a self, other: &'a Mesh<D>) -> &'a Mesh<D> {
        self.part.as_ref().map_or(other, |part| &part.mesh)
    }

    /// The largest speed of shear waves, (mu / rho)^1/2; zero without a density.
    pub fn shear_speed(&self) -> f64 {
        self.density.map_or(0.0, |density| (self.largest.shear_modulus / density).sqrt())
    }
}

/// Extremes of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// mu
    pub shear_modulus: f64,
    /// nu
    pub poisson_ratio: f64,
}

/// The support or load of a boundary.
#[derive(Clone, Debug, PartialEq)]
pub enum Support<const D: usize> {
    /// No load or support.
    Free,
    /// These components of the displacement are zero.
    Held([bool; D]),
    /// Its displacement.
    Moved(Vector<D>),
    /// The force per area.
    Traction(Vector<D>),
    /// The force per area against the outward normal at rest.
    Pressure(Program),
    /// The same against that of the body as it moves.
    FollowerPressure(Program),
}

impl<const D: usize> Support<D> {
    /// The components of the displacement that it prescribes.
    pub fn fixes(&self) -> [bool; D] {
        match self {
            Support::Held(components) => *components,
            Support::Moved(_) => [true; D],
            Support::Free | Support::Traction(_) | Support::Pressure(_) | Support::FollowerPressure(_) => [false; D],
        }
    }

    /// The displacement that it prescribes at `x` and `t`.
    pub(super) fn prescribed(&self, x: &[f64; D], t: f64) -> [Option<f64>; D] {
        let g = if let Support::Moved(g) = self { g.evaluate(x, t) } else { [0.0; D] };
        std::array::from_fn(|i| self.fixes()[i].then_some(g[i]))
    }
}

/// Checks `[structure]` of a run that covers `time`, on its `part` beside a flow or on the whole `mesh`. A run that `starts` does so from its
/// initial displacement, a restart from that of another run.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Structure,
    mesh: &Mesh<D>,
    part: Option<SolidPart<D>>,
    (time, starts): (&Time, bool),
) -> Checked<Structure<D>> {
    let key = Key::new("structure");
    let mut errors = Errors::default();
    if part.is_some() {
        errors.note(check_beside_flow(checker, &key, raw));
    }
    let mesh = part.as_ref().map_or(mesh, |part| &part.mesh);
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let shared = SharedNodes { checker, mesh, numbering: &numbering, time: *time };
    let boundary = errors.note(supports::check(&shared, &key, raw, part.as_ref()));
    let start = errors.note(Start::check(checker, &key, raw, mesh, time.start));
    // A static analysis starts in equilibrium with its supports.
    if let (Some(boundary), Some(start), Analysis::Dynamic, true) = (&boundary, &start, raw.analysis, starts) {
        errors.note(start.check_walls(&shared, part.as_ref(), boundary));
    }
    let material = errors.note(Material::check(checker, &key, raw, mesh));
    let body_force = raw.body_force.as_ref();
    let body_force = errors.note(body_force.map(|f| checker.formulas(&key.child("body_force"), f)).transpose());
    let points = errors.note(points(checker, &key.child("points"), raw, mesh));
    errors.all()?;
    let (Some(boundary), Some(start), Some(material)) = (boundary, start, material) else {
        unreachable!("what is missing has left an error")
    };
    Ok(Structure {
        part,
        young_modulus: material.young_modulus,
        poisson_ratio: material.poisson_ratio,
        law: raw.law,
        damping: material.damping,
        density: material.density,
        analysis: raw.analysis,
        plane: material.plane,
        largest: material.largest,
        body_force: body_force.flatten(),
        boundary,
        displacement: start.displacement,
        velocity: start.velocity,
        natural_modes: raw.natural_modes,
        points: points.unwrap_or_default(),
    })
}

/// Beside a flow a structure has inertia, and moves in other modes than by itself.
fn check_beside_flow(checker: &Checker<'_>, key: &Key, raw: &raw::Structure) -> Checked<()> {
    if raw.analysis == Analysis::Static {
        let problem = "a flow moves the structure in time";
        let accepted = "\"dynamic\"; with `time.order = 1` and long slabs flow and structure settle";
        return Err(checker.combination(&key.child("analysis"), problem, accepted));
    }
    if raw.natural_modes > 0 {
        let problem = "natural modes are those of a structure by itself";
        let accepted = "no such key here; a case without [flow] and [motion] finds them";
        return Err(checker.combination(&key.child("natural_modes"), problem, accepted));
    }
    Ok(())
}

fn points<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Structure,
    mesh: &Mesh<D>,
) -> Checked<Vec<(String, [f64; D])>> {
    let point = |(name, x): (&String, &Vec<f64>)| {
        let key = key.child(name);
        check_name(checker, &key, name)?;
        let x = checker.finite_vector(&key, "the coordinate", x)?;
        checker.require(
            &key,
            "the point",
            mesh.locate(&x).is_some(),
            "a point inside the structure, or on its boundary",
        )?;
        Ok((name.clone(), x))
    };
    collected(raw.points.iter().map(point))
}
