//! The motions of the boundaries.

use super::Time;
use super::mesh_crate::{Mesh, NodeNumbering};
use super::motion::check_start;
use super::shared_nodes::{SharedNodes, nodes_on, same_place};
use super::sliding_mesh::Held;
use crate::boundary_motion::{BoundaryMotion, NormalMotion, RigidMotion, RigidStep};
use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::expression::{Program, Variable};
use crate::key::Key;
use crate::raw;
use crate::vector::Vector;
use coupled::BoundaryField;
use std::cell::OnceCell;
use std::sync::Arc;

/// Data shared by the checks of all boundaries.
pub(super) struct Boundaries<'a, const D: usize> {
    checker: &'a Checker<'a>,
    mesh: &'a Mesh<D>,
    /// The C0 nodes, computed at first use.
    numbering: OnceCell<NodeNumbering>,
    time: Time,
}

impl<'a, const D: usize> Boundaries<'a, D> {
    /// For the boundaries of `mesh`, in a run that covers `time`.
    pub(super) fn new(checker: &'a Checker<'a>, mesh: &'a Mesh<D>, time: &Time) -> Self {
        Boundaries { checker, mesh, numbering: OnceCell::new(), time: *time }
    }

    /// The motion of boundary number `boundary`, given at `key`; None: it rests or slides.
    pub(super) fn motion(
        &self,
        boundary: usize,
        key: &Key,
        raw: &raw::BoundaryMotion,
    ) -> Checked<Option<BoundaryMotion<D>>> {
        let (key, motion) = match raw {
            raw::BoundaryMotion::Fixed | raw::BoundaryMotion::Slide => return Ok(None),
            raw::BoundaryMotion::Displacement(formulas) => {
                let key = key.child("displacement");
                let displacement = self.checker.formulas(&key, formulas)?;
                (key, BoundaryMotion::Formulas(displacement))
            }
            raw::BoundaryMotion::Rigid(steps) => {
                let key = key.child("rigid");
                if steps.is_empty() {
                    let accepted = "`[{ translate = [...] }]`, `[{ rotate = { angle = ... } }]` or several of them; \"fixed\" for a boundary that rests";
                    return Err(self.checker.combination(&key, "a rigid motion without a step", accepted));
                }
                let step = |(index, step)| rigid_step(self.checker, &key.entry(index), step);
                let steps = steps.iter().enumerate().map(step).collect::<Checked<_>>()?;
                (key, BoundaryMotion::Rigid(RigidMotion { steps }))
            }
            raw::BoundaryMotion::Normal(formula) => {
                let key = key.child("normal");
                let motion = self.normal(boundary, &key, formula)?;
                (key, BoundaryMotion::Normal(motion))
            }
        };
        self.check_start(boundary, &key, &motion)?;
        Ok(Some(motion))
    }

    /// The nodes of boundary number `boundary`, and the components that it holds there, if what is given at `key` lets it slide.
    pub(super) fn slide(&self, boundary: usize, key: &Key, raw: &raw::BoundaryMotion) -> Checked<Option<Held<D>>> {
        if *raw != raw::BoundaryMotion::Slide {
            return Ok(None);
        }
        let axes = self.mesh.normal_axes(self.numbering(), boundary);
        axes.map(Some).map_err(|error| self.checker.error(key, Cause::Mesh(error)))
    }

    /// Checks that the `motions` of all boundaries, with their keys, agree at shared nodes. Boundaries that slide hold only the components
    /// in `slides`; those that something else has `moved` hold none.
    pub(super) fn check_shared(
        &self,
        keys: &[Key],
        motions: &[Option<BoundaryMotion<D>>],
        slides: &[Option<Held<D>>],
        moved: &[bool],
    ) -> Checked<()> {
        let (checker, mesh, numbering, time) = (self.checker, self.mesh, self.numbering(), self.time);
        SharedNodes { checker, mesh, numbering, time }.check(keys, &|boundary, node, x, t| {
            let held = slides[boundary].as_ref().map_or([!moved[boundary]; D], |slide| slide[&node]);
            let d = motions[boundary].as_ref().map_or([0.0; D], |motion| motion.displacement(node, x, t));
            std::array::from_fn(|i| held[i].then_some(d[i]))
        })
    }

    fn numbering(&self) -> &NodeNumbering {
        self.numbering.get_or_init(|| NodeNumbering::new(self.mesh, self.mesh.order()))
    }

    fn normal(&self, boundary: usize, key: &Key, formula: &raw::Formula) -> Checked<NormalMotion<D>> {
        let amount = self.checker.formula_on_boundary::<D>(key, formula)?;
        let numbering = self.numbering();
        let normals = self.mesh.boundary_normals(numbering, boundary);
        let normals = normals.map_err(|error| self.checker.error(key, Cause::Mesh(error)))?;
        let arc = self.mesh.arc_fractions(numbering, boundary);
        if arc.is_none() && amount.contains(Variable::Coordinate(D)) {
            let problem = "`s` is the place along a closed curve, which this boundary is not";
            let variables = if D == 2 { "a formula in x, y and t" } else { "a formula in x, y, z and t" };
            return Err(self.checker.combination(key, problem, variables));
        }
        let arc = arc.unwrap_or_default();
        let with_arc = |(node, normal)| (node, (normal, arc.get(&node).copied().unwrap_or(0.0)));
        let motion = NormalMotion { amount, nodes: Arc::new(normals.into_iter().map(with_arc).collect()) };
        self.check_ends_of_curve(boundary, key, &motion)?;
        Ok(motion)
    }

    /// Checks that a closed curve, which begins and ends at one node, is displaced alike at s = 0 and s = 1.
    fn check_ends_of_curve(&self, boundary: usize, key: &Key, motion: &NormalMotion<D>) -> Checked<()> {
        if !motion.amount.contains(Variable::Coordinate(D)) {
            return Ok(());
        }
        let begins = |node: &usize| motion.nodes.get(node).is_some_and(|(_, s)| *s == 0.0);
        let ends: Vec<_> =
            nodes_on(self.mesh, self.numbering(), boundary).filter(|(node, _)| begins(node)).map(|(_, x)| x).collect();
        let amounts = |x: &[f64; D], t: f64| [0.0, 1.0].map(|s| motion.amount_at(x, s, t));
        let tear = |t: f64| {
            let apart = |[first, last]: &[f64; 2]| (first - last).abs() > same_place(self.mesh);
            ends.iter().find_map(|x| Some((x, t, Some(amounts(x, t)).filter(apart)?)))
        };
        let Some((x, t, [first, last])) = self.time.check_times().into_iter().find_map(tear) else { return Ok(()) };
        let constants = self.checker.constants_in_words();
        let problem = format!(
            "the curve begins and ends at {x:?}, but s = 0 moves by {first:.3e} and s = 1 by {last:.3e} until t = {t}{constants}"
        );
        let accepted = "a formula with the same value at both ends, such as a whole number of waves, sin(2*pi*n*s)";
        Err(self.checker.combination(key, &problem, accepted))
    }

    /// Checks that the boundary starts at rest: its displacement at the start is zero up to round-off of the size of
    /// the mesh.
    fn check_start(&self, boundary: usize, key: &Key, motion: &BoundaryMotion<D>) -> Checked<()> {
        // Only formulas have an entry for each axis.
        let key_of = |axis| match motion {
            BoundaryMotion::Formulas(_) => key.entry(axis),
            _ => key.clone(),
        };
        let size = self.mesh.diameter();
        nodes_on(self.mesh, self.numbering(), boundary).try_for_each(|(node, x)| {
            let d = motion.displacement(node, &x, self.time.start);
            check_start(self.checker, key_of, &x, &d, self.time.start, size)
        })
    }
}

/// Checks the formulas of a motion given at `key`, on whatever boundary.
pub(super) fn check_formulas<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::BoundaryMotion,
) -> Checked<()> {
    match raw {
        raw::BoundaryMotion::Fixed | raw::BoundaryMotion::Slide => Ok(()),
        raw::BoundaryMotion::Displacement(formulas) => {
            checker.formulas::<D>(&key.child("displacement"), formulas).map(drop)
        }
        raw::BoundaryMotion::Rigid(steps) => {
            let key = key.child("rigid");
            let steps = steps.iter().enumerate().map(|(index, step)| rigid_step::<D>(checker, &key.entry(index), step));
            collected(steps).map(drop)
        }
        raw::BoundaryMotion::Normal(formula) => {
            checker.formula_on_boundary::<D>(&key.child("normal"), formula).map(drop)
        }
    }
}

fn rigid_step<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::RigidStep) -> Checked<RigidStep<D>> {
    let rotation = match raw {
        raw::RigidStep::Translate(formulas) => {
            return Ok(RigidStep::Translate(checker.formulas_of_time(&key.child("translate"), formulas)?));
        }
        raw::RigidStep::Rotate(rotation) => rotation,
    };
    let key = key.child("rotate");
    let angle = checker.formula_of_time(&key.child("angle"), &rotation.angle)?;
    let centre = match &rotation.centre {
        Some(formulas) => checker.formulas_of_time(&key.child("centre"), formulas)?,
        None => Vector::new(std::array::from_fn(|_| Program::constant(0.0))),
    };
    Ok(RigidStep::Rotate { angle, centre, axis: axis::<D>(checker, &key.child("axis"), rotation.axis)? })
}

/// The unit vector along the axis of a rotation.
fn axis<const D: usize>(checker: &Checker<'_>, key: &Key, raw: Option<[f64; 3]>) -> Checked<[f64; 3]> {
    raw.map_or(Ok([0.0, 0.0, 1.0]), |raw| super::unit_axis::<D>(checker, key, raw, "a rotation"))
}
