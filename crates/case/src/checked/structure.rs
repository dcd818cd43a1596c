//! A structure.

use super::Time;
use super::mesh_crate::{Mesh, NodeNumbering};
use super::motion::check_start as check_at_rest;
use super::parts::SolidPart;
use super::probes::check_name;
use super::shared_nodes::{SharedNodes, nodes_on};
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::is_bounded;
use crate::raw::{self, Analysis, Damping, Plane, StructureBoundary, StructureLaw};
use crate::vector::Vector;
use std::collections::BTreeMap;

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

/// Checks `[structure]` of a run that covers `time`, on its `part` beside a flow or on the whole `mesh`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Structure,
    mesh: &Mesh<D>,
    part: Option<SolidPart<D>>,
    time: &Time,
) -> Checked<Structure<D>> {
    let key = Key::new("structure");
    if part.is_some() {
        check_beside_flow(checker, &key, raw)?;
    }
    let mesh = part.as_ref().map_or(mesh, |part| &part.mesh);
    let given = with_free_walls(raw, part.as_ref());
    let vector = |name: &str, formulas: &Option<Vec<_>>| {
        formulas.as_ref().map(|formulas| checker.formulas(&child(&key, name), formulas)).transpose()
    };
    let named = checker.by_boundary(&key.child("boundary"), "support or load", &given, mesh.boundary_names())?;
    let boundary: Vec<Support<D>> =
        named.iter().map(|(key, boundary)| support(checker, key, boundary)).collect::<Checked<_>>()?;
    let keys: Vec<Key> = named.into_iter().map(|(key, _)| key).collect();
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let shared = SharedNodes { checker, mesh, numbering: &numbering, time: *time };
    shared.check(&keys, &|index, _, x, t| boundary[index].prescribed(x, t))?;
    check_walls(checker, part.as_ref(), &keys, &boundary)?;
    let displacement = vector("initial.displacement", &raw.initial.displacement)?;
    let velocity = vector("initial.velocity", &raw.initial.velocity)?;
    for (name, given) in [("displacement", &displacement), ("velocity", &velocity)] {
        check_finite(checker, &child(&key, "initial").child(name), name, given.as_ref(), mesh, time.start)?;
    }
    check_start_of_walls(checker, part.as_ref(), displacement.as_ref(), &shared)?;
    match raw.analysis {
        Analysis::Dynamic => check_start(checker, &boundary, displacement.as_ref(), &shared)?,
        Analysis::Static => check_static(checker, &key, raw)?,
    }
    let (young_modulus, poisson_ratio, largest) = material(checker, &key, raw, mesh)?;
    let points = points(checker, &key.child("points"), raw, mesh)?;
    Ok(Structure {
        part,
        young_modulus,
        poisson_ratio,
        law: raw.law,
        damping: damping(checker, &key.child("damping"), raw)?,
        density: density(checker, &key, raw)?,
        analysis: raw.analysis,
        plane: plane::<D>(checker, &key, raw)?,
        largest,
        body_force: vector("body_force", &raw.body_force)?,
        boundary,
        displacement,
        velocity,
        natural_modes: raw.natural_modes,
        points,
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

/// E and nu, which must be in range at all nodes of the mesh, and their extremes there.
fn material<const D: usize>(
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

/// A static analysis has no initial motion.
fn check_static(checker: &Checker<'_>, key: &Key, raw: &raw::Structure) -> Checked<()> {
    for (name, given) in [("displacement", &raw.initial.displacement), ("velocity", &raw.initial.velocity)] {
        if given.is_some() {
            let problem = format!("`structure.initial.{name}` has no effect on a static analysis");
            let accepted = "remove it: the body starts in equilibrium with its loads and supports";
            return Err(checker.combination(&key.child("initial").child(name), &problem, accepted));
        }
    }
    Ok(())
}

/// The key `a.b` below `key`.
fn child(key: &Key, path: &str) -> Key {
    path.split('.').fold(key.clone(), |key, name| key.child(name))
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

/// The motion at the `start` must have a value at every node.
fn check_finite<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    name: &str,
    given: Option<&Vector<D>>,
    mesh: &Mesh<D>,
    start: f64,
) -> Checked<()> {
    let Some(vector) = given else { return Ok(()) };
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
            let apart = |i: &usize| g[*i].is_some_and(|g| (d[*i] - g).abs() > 1e-12 * mesh.diameter());
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
    let key = Key::new("structure.initial.displacement");
    for (_, x) in part.wet.iter().flat_map(|wall| nodes_on(mesh, numbering, *wall)) {
        let d = displacement.evaluate(&x, time.start);
        check_at_rest(checker, |axis| key.entry(axis), &x, &d, time.start, mesh.diameter())?;
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
        checker.require(&key, "the point", mesh.locate(&x).is_some(), "a point inside the mesh, or on its boundary")?;
        Ok((name.clone(), x))
    };
    raw.points.iter().map(point).collect()
}
