//! The sections of a case in the order in which they can be checked, and whether they belong together.

use super::{
    Averages, Flow, Motion, Observed, Output, RigidBody, Structure, Time, Wall, averages, bodies, controls,
    equilibrium, flow, held_nodes, motion, movers, over_run, parallel, parts, probes, sliding_mesh, solver, structure,
    surfaces, time,
};
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::raw;
use ::mesh as mesh_crate;
use std::cell::OnceCell;

/// The sections of a case that depend on the mesh and the time, and not on each other. None stands for a section with an error.
pub(super) struct Independent<const D: usize> {
    pub(super) time: Option<Time>,
    pub(super) mesh: Option<mesh_crate::Mesh<D>>,
    pub(super) flow: Option<Option<Flow<D>>>,
    pub(super) structure: Option<Option<Structure<D>>>,
    pub(super) output: Option<Output>,
}

impl<const D: usize> Independent<D> {
    pub(super) fn check(
        checker: &Checker<'_>,
        raw: &raw::Case,
        mesh: mesh_crate::Mesh<D>,
        errors: &mut Errors,
    ) -> Self {
        let time = errors.note(time::check(checker, &raw.time, raw.flow.is_some() && raw.solver.steady.is_some()));
        let time = time.filter(|_| !checker.damage().has("time"));
        errors.note(solver::check(checker, &raw.solver));
        let output = errors.note(time::check_output(checker, &raw.output));
        let split = errors.note(parts::split(checker, raw.structure.as_ref(), raw.flow.is_some(), mesh));
        let Some((mesh, part)) = split else {
            return Independent { time, mesh: None, flow: None, structure: None, output };
        };
        let flow = raw.flow.as_ref().map(|flow| flow::check(checker, flow, &mesh, time.as_ref()));
        let flow = errors.note(flow.transpose());
        let structure = match (&raw.structure, &time) {
            (None, _) => Some(None),
            (Some(structure), Some(time)) => {
                let starts = raw.restart.is_none();
                errors.note(structure::check(checker, structure, &mesh, part, (time, starts))).map(Some)
            }
            (Some(_), None) => None,
        };
        Independent { time, mesh: Some(mesh), flow, structure, output }
    }

    /// All sections, if all are correct.
    pub(super) fn whole(self) -> Option<Whole<D>> {
        let Independent { time, mesh, flow, structure, output } = self;
        Some(Whole { time: time?, mesh: mesh?, flow: flow?, structure: structure?, output: output? })
    }
}

/// The correct sections of [`Independent`].
pub(super) struct Whole<const D: usize> {
    pub(super) time: Time,
    pub(super) mesh: mesh_crate::Mesh<D>,
    pub(super) flow: Option<Flow<D>>,
    pub(super) structure: Option<Structure<D>>,
    pub(super) output: Output,
}

/// The sections of a case that depend on those of [`Independent`]. None stands for a section with an error.
pub(super) struct Dependent<const D: usize> {
    pub(super) observed: Option<Observed<D>>,
    pub(super) averages: Option<Option<Averages>>,
    pub(super) bodies: Option<Vec<RigidBody<D>>>,
    movers: Option<movers::Movers>,
    pub(super) motion: Option<Option<Motion<D>>>,
}

impl<const D: usize> Dependent<D> {
    pub(super) fn check(
        checker: &Checker<'_>,
        raw: &raw::Case,
        independent: &Independent<D>,
        errors: &mut Errors,
    ) -> Self {
        let mut found = Dependent { observed: None, averages: None, bodies: None, movers: None, motion: None };
        let Some(mesh) = &independent.mesh else { return found };
        let flow = raw.flow.as_ref();
        errors.note(surfaces::check(checker, &raw.output, flow, mesh.boundary_names()));
        found.observed = errors.note(probes::check(checker, &raw.output, mesh, flow.map(|flow| flow.order)));
        if let Some(time) = &independent.time {
            let averages = averages::check(checker, raw.output.averages.as_ref(), mesh, time, flow.is_some());
            found.averages = errors.note(averages);
            found.bodies = Self::bodies(checker, raw, mesh, independent, time, errors);
        }
        found.movers = found.movers(checker, independent, errors);
        found.motion = match (&found.movers, &independent.time) {
            (Some(movers), Some(time)) => errors.note(motion::check(checker, raw.motion.as_ref(), mesh, movers, time)),
            _ => {
                errors.note(motion::check_alone(checker, raw.motion.as_ref(), mesh));
                None
            }
        };
        found
    }

    fn bodies(
        checker: &Checker<'_>,
        raw: &raw::Case,
        mesh: &mesh_crate::Mesh<D>,
        independent: &Independent<D>,
        time: &Time,
        errors: &mut Errors,
    ) -> Option<Vec<RigidBody<D>>> {
        let flow = independent.flow.as_ref().and_then(Option::as_ref);
        errors.note(bodies::check(checker, &raw.bodies, mesh, (raw.flow.is_some(), flow), time))
    }

    /// What moves walls; None if one of the sections that tell it has an error.
    fn movers(
        &self,
        checker: &Checker<'_>,
        independent: &Independent<D>,
        errors: &mut Errors,
    ) -> Option<movers::Movers> {
        let Independent { mesh, flow, structure, .. } = independent;
        let (bodies, structure) = (self.bodies.as_ref()?, structure.as_ref()?);
        // Only a structure needs the flow.
        let flow = if structure.is_some() { flow.as_ref()?.as_ref() } else { None };
        let movers = movers::Movers::new(checker, bodies, structure.as_ref(), flow, mesh.as_ref()?);
        errors.note(movers)
    }

    /// All sections, if all are correct.
    pub(super) fn whole(self) -> Option<WholeDependent<D>> {
        let Dependent { observed, averages, bodies, movers, motion } = self;
        let (observed, averages) = (observed?, averages?);
        Some(WholeDependent { observed, averages, bodies: bodies?, movers: movers?, motion: motion? })
    }
}

/// The correct sections of [`Dependent`].
pub(super) struct WholeDependent<const D: usize> {
    pub(super) observed: Observed<D>,
    pub(super) averages: Option<Averages>,
    pub(super) bodies: Vec<RigidBody<D>>,
    movers: movers::Movers,
    pub(super) motion: Option<Motion<D>>,
}

/// Checks that the sections that are present belong together. Without a flow this is left until there are no other errors, which may say the same.
pub(super) fn check_presence<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Case,
    independent: &Independent<D>,
    errors: &mut Errors,
) {
    let has_flow = raw.flow.is_some();
    let Some(mesh) = independent.mesh.as_ref().filter(|_| has_flow || errors.is_empty()) else { return };
    errors.note(parallel::check(checker, &raw.parallel, has_flow.then(|| mesh.n_cells())));
    errors.note(parallel::check_solver_of_mesh(checker, raw));
    errors.note(check_sections_of(checker, raw));
}

fn check_sections_of(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    let moves = raw.motion.is_some() || raw.bodies.values().any(|body| body.mesh.is_some());
    check_sections(checker, [moves, raw.flow.is_some(), raw.structure.is_some()])?;
    solver::check_bodies(checker, raw)?;
    frame_is_at_rest(checker, raw)?;
    controls::need_a_flow(checker, &raw.controls, raw.flow.is_some())?;
    time::check_fields(checker, &raw.output.fields, raw.flow.is_some(), raw.structure.is_some())?;
    restart_needs_a_flow(checker, raw.restart.as_ref(), raw.flow.is_some())?;
    check_without_flow(checker, raw)
}

/// Checks that sections, each of them correct, fit together.
pub(super) fn check_together<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Case,
    Whole { time, mesh, flow, structure, .. }: &Whole<D>,
    WholeDependent { bodies, movers, motion, .. }: &WholeDependent<D>,
) -> Checked<()> {
    let (flow, motion) = (flow.as_ref(), motion.as_ref());
    time::check_integrals::<D>(checker, &raw.output.integrals)?;
    equilibrium::check(checker, raw, bodies, structure.as_ref())?;
    held_nodes::check(checker, structure.as_ref(), motion, mesh, time)?;
    held_nodes::check_bodies(checker, bodies, &movers.moved(mesh), (mesh, flow))?;
    sliding_mesh::check_walls(checker, mesh, motion, flow)?;
    let (Some(of_flow), Some(flow)) = (&raw.flow, flow) else { return Ok(()) };
    start_layer_has_walls(checker, &raw.solver, flow)?;
    let (moved, numbering) = (&movers.moved(mesh), OnceCell::new());
    over_run::OverRun { checker, flow, mesh, motion, moved, time, numbering }.check(of_flow)
}

/// A start layer slows the gas at no-slip walls only.
fn start_layer_has_walls<const D: usize>(checker: &Checker<'_>, raw: &raw::Solver, flow: &Flow<D>) -> Checked<()> {
    let sticks = |wall: &Wall<D>| flow.boundary[wall.boundary].condition.is_no_slip();
    if raw.start_layer.is_none_or(|thickness| thickness == 0.0) || flow.walls.iter().any(sticks) {
        return Ok(());
    }
    let problem = "a start layer slows the gas at walls without slip, and there is none";
    let accepted =
        "no key; a formula of `flow.initial` may let the velocity across a slip wall fall to zero at the wall";
    Err(checker.combination(&Key::new("solver").child("start_layer"), problem, accepted))
}

/// Without a flow slabs are not adapted, no steady flow is searched, and there is nothing to integrate.
fn check_without_flow(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    let given = [
        ("time", "adaptive", raw.time.adaptive.is_some()),
        ("solver", "steady", raw.solver.steady.is_some()),
        ("solver", "start_layer", raw.solver.start_layer.is_some()),
        ("output", "integrals", !raw.output.integrals.is_empty()),
    ];
    let Some((section, name, _)) = given.into_iter().find(|(.., given)| *given && raw.flow.is_none()) else {
        return Ok(());
    };
    let problem = format!("`{section}.{name}` has no effect without a flow");
    Err(checker.combination(&Key::new(section).child(name), &problem, "this key together with [flow]"))
}

/// The equations of bodies and structures have no forces of a rotating frame.
fn frame_is_at_rest(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    let rotates = raw.flow.as_ref().is_some_and(|flow| flow.rotation.is_some());
    if !rotates || (raw.bodies.is_empty() && raw.structure.is_none()) {
        return Ok(());
    }
    let problem = "bodies and structures do not feel the centrifugal and Coriolis forces of a rotating frame";
    Err(checker.combination(
        &Key::new("flow").child("rotation"),
        problem,
        "a frame at rest, or a flow without [bodies] and [structure]",
    ))
}

/// Only a flow starts from the result of another run.
fn restart_needs_a_flow(checker: &Checker<'_>, raw: Option<&raw::Restart>, has_flow: bool) -> Checked<()> {
    if raw.is_none() || has_flow {
        return Ok(());
    }
    let problem = "only a flow can start where another run stands";
    Err(checker.combination(&Key::new("restart"), problem, "this section together with [flow]"))
}

/// Whether the present sections among [motion], [flow] and [structure] fit together.
fn check_sections(checker: &Checker<'_>, sections: [bool; 3]) -> Checked<()> {
    match sections {
        [false, false, false] => {
            let problem = "there is nothing to solve: neither motion nor flow nor structure";
            let accepted = "a section [motion], a section [flow], or both; or a section [structure]";
            Err(checker.combination(&Key::default(), problem, accepted))
        }
        [true, false, true] => {
            let problem = "a structure without a flow moves by itself: there is no other mesh to move";
            let accepted = "this section together with [flow], or no [motion]";
            Err(checker.combination(&Key::new("structure"), problem, accepted))
        }
        _ => Ok(()),
    }
}
