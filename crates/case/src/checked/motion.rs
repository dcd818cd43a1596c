//! The motion of the mesh.

mod material;

use self::material::Elasticity;
use super::Time;
use super::boundary_motion::{Boundaries, check_formulas};
use super::displacement::{check_displacement, undefined};
use super::mesh_crate::{Mesh, NodeNumbering};
use super::movers::Movers;
use super::shared_nodes::{nodes_on, not_periodic, periodic_copies_apart};
use super::sliding_mesh::{Held, check_held};
use crate::boundary_motion::BoundaryMotion;
use crate::cause::Cause;
use crate::checker::{Checked, Checker, OTHERS};
use crate::error::Errors;
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::is_round_off;
use crate::raw;
use crate::vector::Vector;
use coupled::BoundaryField;
use elasticity::{Law, Solver};
use std::collections::{BTreeMap, BTreeSet};

/// The motion of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<const D: usize> {
    /// A prescribed displacement of every point, as a function of the position at rest and time.
    Prescribed(Vector<D>),
    /// Every point with rigid bodies, by weights.
    Followed,
    /// A prescribed motion of the boundary with an elastic interior.
    Elastic {
        /// Poisson's ratio.
        poisson_ratio: f64,
        /// Young's modulus over the mesh.
        stiffness: Stiffness,
        /// The law.
        law: Law,
        /// The tolerance of Newton's method, a root mean square error of position relative to the node spacing.
        tolerance: f64,
        /// The solver of the mesh equations.
        solver: Solver,
        /// The displacement of each boundary, in the order of `Mesh::boundary_names`; None: it rests or slides.
        boundary: Vec<Option<BoundaryMotion<D>>>,
        /// In the same order, for boundaries that slide, what they hold.
        slides: Vec<Option<Held<D>>>,
    },
}

impl<const D: usize> Motion<D> {
    /// The number of operations of its longest formula, at a node and a time.
    pub fn operations(&self) -> usize {
        match self {
            Motion::Prescribed(displacement) => displacement.operations(),
            Motion::Followed => 0,
            Motion::Elastic { boundary, .. } => {
                boundary.iter().flatten().map(BoundaryMotion::operations).max().unwrap_or(0)
            }
        }
    }
}

/// Young's modulus over the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Stiffness {
    /// Constant.
    Constant,
    /// (det J)^-power.
    InverseJacobian {
        /// The power.
        power: f64,
    },
    /// A formula in the position at rest.
    Expression(Program),
    /// By the distance to boundaries, see [`elasticity::WallDistance`].
    WallDistance {
        /// A.
        amplitude: f64,
        /// d_0.
        distance: f64,
        /// Boundaries that move, by index.
        inner: Vec<usize>,
        /// Boundaries that rest.
        outer: Vec<usize>,
    },
}

/// Checks `[motion]` of a run that covers `time`, in which `movers` move parts of the mesh. None: the mesh rests.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: Option<&raw::Motion>,
    mesh: &Mesh<D>,
    movers: &Movers,
    time: &Time,
) -> Checked<Option<Motion<D>>> {
    match raw {
        Some(_) if movers.by_weights => {
            let problem = "`bodies` move the whole mesh by weights";
            Err(checker.combination(
                &Key::new("motion"),
                problem,
                "this section, or the key `mesh` of the bodies: remove one",
            ))
        }
        None if movers.by_weights => Ok(Some(Motion::Followed)),
        Some(raw) => Ok(Some(check_given(checker, raw, mesh, movers, time)?)),
        None if !movers.walls.is_empty() => {
            let still = raw::Motion { displacement: None, elasticity: None, boundary: others_fixed() };
            Ok(Some(check_given(checker, &still, mesh, movers, time)?))
        }
        None => Ok(None),
    }
}

fn others_fixed() -> BTreeMap<String, raw::BoundaryMotion> {
    BTreeMap::from([("others".to_owned(), raw::BoundaryMotion::Fixed)])
}

fn check_given<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Motion,
    mesh: &Mesh<D>,
    movers: &Movers,
    time: &Time,
) -> Checked<Motion<D>> {
    let key = Key::new("motion");
    let Some(formulas) = &raw.displacement else {
        let motion = elastic(checker, &key, raw, mesh, &movers.moved(mesh), time)?;
        let motion = check_walls(checker, &key, motion, mesh, movers)?;
        check_beside_bodies(checker, &key, &motion, mesh, movers, time)?;
        return Ok(motion);
    };
    if !movers.walls.is_empty() {
        let problem = "`motion.displacement` prescribes the motion everywhere, and a body moves its walls";
        return Err(checker.combination(&key.child("displacement"), problem, "one of the two: remove the other"));
    }
    for (name, given) in [("elasticity", raw.elasticity.is_some()), ("boundary", !raw.boundary.is_empty())] {
        if given {
            let problem =
                format!("`motion.{name}` has no effect: `motion.displacement` prescribes the motion everywhere");
            return Err(checker.combination(&key.child(name), &problem, "one of the two: remove the other"));
        }
    }
    let key = key.child("displacement");
    let displacement = checker.formulas(&key, formulas)?;
    let (size, start) = (mesh.diameter(), time.start);
    mesh.coordinates().chunks_exact(D).map(position).try_for_each(|x| {
        check_start(checker, |axis| key.entry(axis), &x, &displacement.evaluate(&x, start), start, size)
    })?;
    for t in time.check_times() {
        let mut all = mesh.coordinates().chunks_exact(D).map(position);
        all.try_for_each(|x| check_displacement(checker, &key, &x, &displacement.evaluate(&x, t), t, size))?;
    }
    check_periodicity(checker, &key, &displacement, mesh, time)?;
    Ok(Motion::Prescribed(displacement))
}

/// A displacement has the period of the mesh: periodic boundaries share their nodes.
fn check_periodicity<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    displacement: &Vector<D>,
    mesh: &Mesh<D>,
    time: &Time,
) -> Checked<()> {
    let numbering = NodeNumbering::new(mesh, mesh.order());
    for t in time.check_times() {
        let at = |x: &[f64; D]| displacement.evaluate(x, t);
        let Some(x) = periodic_copies_apart(mesh, &numbering, 1e-9 * mesh.diameter(), |_, x| at(x)) else { continue };
        return Err(not_periodic(checker, key, x, x.map(|x| at(&x).map(Some)), t));
    }
    Ok(())
}

/// Walls that something moves have no other motion, and do not slide.
fn check_walls<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    motion: Motion<D>,
    mesh: &Mesh<D>,
    movers: &Movers,
) -> Checked<Motion<D>> {
    let Motion::Elastic { boundary, slides, .. } = &motion else { return Ok(motion) };
    let walls = movers.walls.iter().flat_map(|(mover, walls)| walls.iter().map(move |wall| (mover, *wall)));
    let mut moved = walls.filter(|(_, wall)| boundary[*wall].is_some() || slides[*wall].is_some());
    if let Some((mover, wall)) = moved.next() {
        let name = &mesh.boundary_names()[wall];
        let problem = format!("boundary `{name}` is moved by {mover}");
        let accepted = format!("\"fixed\", to which {mover} adds its motion");
        return Err(checker.combination(&key.child("boundary").child(name), &problem, &accepted));
    }
    Ok(motion)
}

/// Boundaries that meet the wall of a rigid body rest there: the body moves the nodes that they share. A structure replaces their motion.
fn check_beside_bodies<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    motion: &Motion<D>,
    mesh: &Mesh<D>,
    movers: &Movers,
    time: &Time,
) -> Checked<()> {
    let Motion::Elastic { boundary, .. } = motion else { return Ok(()) };
    if movers.of_bodies().next().is_none() || boundary.iter().all(Option::is_none) {
        return Ok(());
    }
    let (numbering, times) = (NodeNumbering::new(mesh, mesh.order()), time.check_times());
    for (body, walls) in movers.of_bodies() {
        let shared: BTreeSet<usize> = walls.iter().flat_map(|wall| numbering.on_boundary(mesh, *wall)).collect();
        let moving = boundary.iter().enumerate().filter_map(|(index, motion)| Some((index, motion.as_ref()?)));
        for (index, motion) in moving {
            let nodes = nodes_on(mesh, &numbering, index).filter(|(node, _)| shared.contains(node));
            let then = |(node, x)| times.iter().map(move |t| (x, *t, motion.displacement(node, &x, *t)));
            let mut moved = nodes.flat_map(then).filter(|(.., d)| tensor::norm(d) > 1e-9 * mesh.diameter());
            let Some((x, t, d)) = moved.next() else { continue };
            let name = &mesh.boundary_names()[index];
            let problem = format!("the node at {x:?} is displaced by {d:?} until t = {t}, and {body} moves it, too");
            let accepted = format!("a motion that is zero where `{name}` meets the walls of {body}");
            return Err(checker.combination(&key.child("boundary").child(name), &problem, &accepted));
        }
    }
    Ok(())
}

fn elastic<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Motion,
    mesh: &Mesh<D>,
    moved: &[bool],
    time: &Time,
) -> Checked<Motion<D>> {
    let mut errors = Errors::default();
    let elasticity = errors.note(Elasticity::check(checker, key, raw, mesh));
    let boundaries = errors.note(of_boundaries(checker, &key.child("boundary"), &raw.boundary, mesh, moved, time));
    errors.all()?;
    let (Some(elasticity), Some((boundary, slides))) = (elasticity, boundaries) else {
        unreachable!("what is missing has left an error")
    };
    let Elasticity { poisson_ratio, stiffness, law, solver, tolerance } = elasticity;
    Ok(Motion::Elastic { poisson_ratio, stiffness, law, solver, tolerance, boundary, slides })
}

/// Checks what can be checked of `[motion]` if the time, or what moves walls, has an error.
pub(super) fn check_alone<const D: usize>(
    checker: &Checker<'_>,
    raw: Option<&raw::Motion>,
    mesh: &Mesh<D>,
) -> Checked<()> {
    let Some(raw) = raw else { return Ok(()) };
    let (mut errors, key) = (Errors::default(), Key::new("motion"));
    if let Some(formulas) = &raw.displacement {
        return checker.formulas::<D>(&key.child("displacement"), formulas).map(drop);
    }
    errors.note(Elasticity::check(checker, &key, raw, mesh));
    let key = key.child("boundary");
    // What moves walls is not known here: a boundary without an entry is no error yet.
    errors.note(checker.known_boundaries(&key, &raw.boundary, mesh.boundary_names()));
    for (name, motion) in &raw.boundary {
        errors.note(check_formulas::<D>(checker, &key.child(name), motion));
    }
    errors.all()
}

/// The displacement of each boundary, and what each of them holds if it slides.
type OfBoundaries<const D: usize> = (Vec<Option<BoundaryMotion<D>>>, Vec<Option<Held<D>>>);

/// The motions that are `given`. Boundaries that something else has `moved` need none of their own, and `others` does not mean them.
fn with_fixed(
    given: &BTreeMap<String, raw::BoundaryMotion>,
    names: &[String],
    moved: &[bool],
) -> BTreeMap<String, raw::BoundaryMotion> {
    let moved = names.iter().zip(moved).filter(|(_, moved)| **moved);
    let fixed = moved.map(|(name, _)| (name.clone(), raw::BoundaryMotion::Fixed));
    fixed.chain(given.iter().map(|(name, motion)| (name.clone(), motion.clone()))).collect()
}

/// The motions of all boundaries, `given` at `key`.
fn of_boundaries<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    given: &BTreeMap<String, raw::BoundaryMotion>,
    mesh: &Mesh<D>,
    moved: &[bool],
    time: &Time,
) -> Checked<OfBoundaries<D>> {
    let (mut errors, names) = (Errors::default(), mesh.boundary_names());
    let given = &with_fixed(given, names, moved);
    errors.note(checker.by_boundary(key, "motion", given, names));
    let unknown = checker.entries_of_none(key, given, names);
    for (key, motion) in &unknown {
        errors.note(check_formulas::<D>(checker, key, motion));
    }
    let (boundaries, mut motions, mut keys) = (Boundaries::new(checker, mesh, time), Vec::new(), Vec::new());
    let mut slides = Vec::new();
    for (index, key_of, raw) in checker.entries_of_boundaries(key, given, names) {
        // `others` may stand for a boundary whose name is misspelt.
        if !unknown.is_empty() && key_of == key.child(OTHERS) {
            errors.note(check_formulas::<D>(checker, &key_of, raw));
            continue;
        }
        motions.extend(errors.note(boundaries.motion(index, &key_of, raw)));
        slides.extend(errors.note(boundaries.slide(index, &key_of, raw)));
        keys.push(key_of);
    }
    errors.all()?;
    boundaries.check_shared(&keys, &motions, &slides, moved)?;
    check_held(checker, key, &slides)?;
    Ok((motions, slides))
}

/// Checks that the mesh starts at rest: the displacement `d` of the point `x` at `start` must be zero up to round-off of the `size`
/// of the mesh. `key` is the key of its component along an axis.
pub(super) fn check_start<const D: usize>(
    checker: &Checker<'_>,
    key: impl Fn(usize) -> Key,
    x: &[f64; D],
    d: &[f64; D],
    start: f64,
    size: f64,
) -> Checked<()> {
    if let Some(axis) = d.iter().position(|d| d.is_nan()) {
        return Err(undefined(checker, &key(axis), x, start));
    }
    match d.iter().position(|d| !is_round_off(*d, size)) {
        Some(axis) => {
            let cause = Cause::MovedAtStart { time: start, position: x.to_vec(), value: d[axis] };
            Err(checker.error(&key(axis), cause))
        }
        None => Ok(()),
    }
}

fn position<const D: usize>(coordinates: &[f64]) -> [f64; D] {
    std::array::from_fn(|axis| coordinates[axis])
}
