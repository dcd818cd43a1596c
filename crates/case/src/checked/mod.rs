//! The checked case: plain enums and numbers, compiled formulas, the mesh.

mod averages;
mod bodies;
mod boundary_data;
mod boundary_motion;
mod controls;
mod displacement;
mod flow;
mod forces;
mod given;
mod given_values;
mod held_nodes;
mod inertia;
mod initial;
mod mesh;
mod motion;
mod movers;
mod openings;
mod parallel;
mod parts;
mod probes;
mod quadrature;
mod resolved;
mod shared_nodes;
mod slide;
mod sliding_mesh;
mod solver;
mod source;
mod states;
mod structure;
mod surfaces;
mod tables;
mod time;
mod walls;

pub use super::raw::{
    AllowedChange, Analysis, Average, Damping, Field, Integral, Jacobian, Plane, Preconditioner, Predictor, PseudoTime,
    Solver, Steady, StructureLaw,
};
pub use averages::{Averages, Phases};
pub use bodies::{FollowingMesh, Freedom, RigidBody};
pub use boundary_data::{BoundaryData, Data};
pub use controls::Control;
pub use flow::Flow;
pub use forces::Wall;
pub use motion::{Motion, Stiffness};
pub use parts::SolidPart;
pub use probes::{Line, Observed, Probe, Slice};
pub use resolved::{gas_of, motion_of, ratio_of_specific_heats_of, reference_pressure_of, title_of, walls_of};
pub use sliding_mesh::{Held, constrained};
pub use source::Source;
pub use structure::{Largest, Structure, Support};
pub use time::{Output, Time};

use super::checker::{Checked, Checker};
use super::continuation::{as_toml, lasting};
use super::document::Document;
use super::error::{CaseError, Errors, collected};
use super::key::Key;
use super::raw;
use super::reading::{self, Read};
use crate::any_mesh::AnyMesh;
// The crate, besides a module of the same name.
use ::mesh as mesh_crate;
use std::path::{Path, PathBuf};

/// A case in two or three dimensions.
#[derive(Debug)]
pub enum AnyCase {
    /// Two dimensions.
    Plane(Box<Case<2>>),
    /// Three dimensions.
    Space(Box<Case<3>>),
}

/// A case that has been checked.
#[derive(Clone, Debug)]
pub struct Case<const D: usize> {
    /// Name and texts.
    pub about: About,
    /// The mesh at rest: without the part of a structure beside a flow.
    pub mesh: mesh_crate::Mesh<D>,
    /// Whether triangles, tetrahedra and prisms of the file of the mesh were split.
    pub splits_simplices: bool,
    /// The motion of the mesh; None: it rests.
    pub motion: Option<Motion<D>>,
    /// The flow; None: only the mesh moves.
    pub flow: Option<Flow<D>>,
    /// The rigid bodies that the flow moves.
    pub bodies: Vec<RigidBody<D>>,
    /// The structure. Without a part of its own it fills the mesh, and there is neither motion nor flow.
    pub structure: Option<Structure<D>>,
    /// Numbers in formulas that the run changes after every slab.
    pub controls: Vec<Control>,
    /// The time to cover.
    pub time: Time,
    /// The result, or its directory, from which the run starts instead of the initial state.
    pub restart: Option<PathBuf>,
    /// Differences that are allowed between this case and the case of that run.
    pub allowed_changes: Vec<AllowedChange>,
    /// The solver settings.
    pub solver: Solver,
    /// Blocks into which the cells of the flow are cut.
    pub blocks: usize,
    /// Groups of cells that the preconditioner eliminates one after the other, in all blocks at the same time; `usize::MAX` for as many as keep
    /// the order of one block.
    pub stages: usize,
    /// Directory and contents of the output.
    pub output: Output,
    /// Where the flow is observed.
    pub observed: Observed<D>,
    /// The averages over time.
    pub averages: Option<Averages>,
}

/// The description of a case, without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// The name of the file without its extension.
    pub name: String,
    /// A title in one line.
    pub title: String,
    /// The resolved case with all defaults and the contents of its tables, which can be run again.
    pub resolved: String,
    /// The part of `resolved` that the states of a run depend on: equal for cases that may continue each other.
    pub lasting: String,
    /// Every key that was left to its default, and the value taken.
    pub defaults: Vec<(String, String)>,
}

/// From this order of the flow in three dimensions the low-order preconditioner takes less memory than blocks and no more time
/// (docs/src/speed.md). At order 2 it takes 1.2 times as much time.
const LOW_ORDER_FROM: usize = 3;

impl AnyCase {
    /// Reads and checks the case file at `path`, with `options`, each `key.path=value`, written over it.
    ///
    /// # Errors
    /// The errors of the case: the first one in the text, with the others in `also`.
    pub fn read(path: &Path, options: &[String]) -> Result<Self, Box<CaseError>> {
        Self::check(&Document::read(path, options)?)
    }

    /// Checks a case.
    ///
    /// # Errors
    /// As [`AnyCase::read`].
    pub fn check(document: &Document) -> Result<Self, Box<CaseError>> {
        let Read { case, mut errors } = reading::read(document)?;
        let case = case.and_then(|raw| errors.note(Self::check_values(document, &raw)));
        errors.all()?;
        Ok(case.expect("a case without errors can be read"))
    }

    fn check_values(document: &Document, raw: &raw::Case) -> Checked<Self> {
        let checker = checker_of(document, raw)?;
        match mesh::build(&checker, &raw.mesh) {
            Ok(AnyMesh::Plane(mesh)) => Ok(AnyCase::Plane(Box::new(Case::check(&checker, document, raw, mesh)?))),
            Ok(AnyMesh::Space(mesh)) => Ok(AnyCase::Space(Box::new(Case::check(&checker, document, raw, mesh)?))),
            Err(error) => Err(check_without_mesh(&checker, raw, error)),
        }
    }

    /// The output directory given in the case, if any.
    pub fn output_directory(&self) -> Option<&Path> {
        match self {
            AnyCase::Plane(case) => case.output.directory.as_deref(),
            AnyCase::Space(case) => case.output.directory.as_deref(),
        }
    }

    /// The result, or its directory, from which the run starts instead of the initial state.
    pub fn restart(&self) -> Option<&Path> {
        match self {
            AnyCase::Plane(case) => case.restart.as_deref(),
            AnyCase::Space(case) => case.restart.as_deref(),
        }
    }

    /// The description of the case, without its numbers.
    pub fn about(&self) -> &About {
        match self {
            AnyCase::Plane(case) => &case.about,
            AnyCase::Space(case) => &case.about,
        }
    }
}

/// The error of the mesh, and those of the sections that need none.
fn check_without_mesh(checker: &Checker<'_>, raw: &raw::Case, error: Box<CaseError>) -> Box<CaseError> {
    let mut errors = Errors::default();
    errors.add(error);
    errors.note(time::check(checker, &raw.time, raw.flow.is_some() && raw.solver.steady.is_some()));
    errors.note(solver::check(checker, &raw.solver));
    errors.note(time::check_output(checker, &raw.output));
    errors.all().expect_err("there is one")
}

impl<const D: usize> Case<D> {
    fn check(checker: &Checker<'_>, document: &Document, raw: &raw::Case, mesh: mesh_crate::Mesh<D>) -> Checked<Self> {
        let independent = Independent::check(checker, raw, mesh)?;
        let dependent = Dependent::check(checker, raw, &independent)?;
        check_together(checker, raw, &independent, &dependent)?;
        let Independent { time, mesh, flow, structure, output } = independent;
        let Dependent { observed, averages, bodies, motion } = dependent;
        let of_boundaries = flow.iter().flat_map(Flow::controls);
        let controls = checker.controls().iter().chain(of_boundaries).cloned().collect();
        Ok(Case {
            about: About::new(checker, document, raw),
            mesh,
            splits_simplices: raw.mesh.split_simplices == Some(true),
            motion,
            flow,
            bodies,
            structure,
            controls,
            time,
            restart: raw.restart.as_ref().map(|restart| checker.beside_case(&restart.from)),
            allowed_changes: raw.restart.as_ref().map_or_else(Vec::new, |restart| restart.allow.clone()),
            solver: raw.solver.clone(),
            blocks: raw.parallel.blocks,
            stages: parallel::stages(checker, &raw.parallel)?,
            output,
            observed,
            averages,
        })
    }
}

/// The sections of a case that depend on the mesh and the time, and not on each other. All their errors are reported at once.
struct Independent<const D: usize> {
    time: Time,
    mesh: mesh_crate::Mesh<D>,
    flow: Option<Flow<D>>,
    structure: Option<Structure<D>>,
    output: Output,
}

impl<const D: usize> Independent<D> {
    fn check(checker: &Checker<'_>, raw: &raw::Case, mesh: mesh_crate::Mesh<D>) -> Checked<Self> {
        let mut errors = Errors::default();
        let time = errors.note(time::check(checker, &raw.time, raw.flow.is_some() && raw.solver.steady.is_some()));
        let parts = errors.note(parts::split(checker, raw.structure.as_ref(), raw.flow.is_some(), mesh));
        let sections = match (&time, parts) {
            (Some(time), Some((mesh, part))) => {
                let flow = raw.flow.as_ref().map(|flow| flow::check(checker, flow, &mesh, time));
                let structure = raw.structure.as_ref();
                let structure = structure.map(|raw| structure::check(checker, raw, &mesh, part, time));
                Some((errors.note(flow.transpose()), errors.note(structure.transpose()), mesh))
            }
            (None, Some((mesh, _))) => {
                errors.note(raw.flow.as_ref().map_or(Ok(()), |flow| flow::check_without_time(checker, flow, &mesh)));
                None
            }
            _ => None,
        };
        errors.note(solver::check(checker, &raw.solver));
        let output = errors.note(time::check_output(checker, &raw.output));
        errors.all()?;
        match (time, sections, output) {
            (Some(time), Some((Some(flow), Some(structure), mesh)), Some(output)) => {
                Ok(Independent { time, mesh, flow, structure, output })
            }
            _ => unreachable!("what is missing has left an error"),
        }
    }
}

/// The sections of a case that depend on those of [`Independent`]. All their errors are reported at once.
struct Dependent<const D: usize> {
    observed: Observed<D>,
    averages: Option<Averages>,
    bodies: Vec<RigidBody<D>>,
    motion: Option<Motion<D>>,
}

impl<const D: usize> Dependent<D> {
    fn check(checker: &Checker<'_>, raw: &raw::Case, independent: &Independent<D>) -> Checked<Self> {
        let Independent { time, mesh, flow, structure, .. } = independent;
        let (flow, structure) = (flow.as_ref(), structure.as_ref());
        let mut errors = Errors::default();
        errors.note(surfaces::check(checker, raw.output.surfaces.as_ref(), flow));
        let averages = errors.note(averages::check(checker, raw.output.averages.as_ref(), time, flow.is_some()));
        let observed = errors.note(probes::check(checker, &raw.output, mesh, flow.map(|flow| flow.order)));
        let bodies = errors.note(bodies::check(checker, &raw.bodies, mesh, flow, time));
        let movers =
            bodies.as_ref().and_then(|bodies| errors.note(movers::Movers::new(checker, bodies, structure, flow, mesh)));
        let motion =
            movers.and_then(|movers| errors.note(motion::check(checker, raw.motion.as_ref(), mesh, &movers, time)));
        errors.all()?;
        match (observed, averages, bodies, motion) {
            (Some(observed), Some(averages), Some(bodies), Some(motion)) => {
                Ok(Dependent { observed, averages, bodies, motion })
            }
            _ => unreachable!("what is missing has left an error"),
        }
    }
}

/// Checks that sections, each of them correct, fit together.
fn check_together<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Case,
    Independent { time, mesh, flow, structure, .. }: &Independent<D>,
    Dependent { motion, .. }: &Dependent<D>,
) -> Checked<()> {
    held_nodes::check(checker, structure.as_ref(), motion.as_ref(), mesh, time)?;
    sliding_mesh::check_walls(checker, mesh, motion.as_ref(), flow.as_ref())?;
    check_sections(checker, [motion.is_some(), flow.is_some(), structure.is_some()])?;
    parallel::check(checker, &raw.parallel, flow.as_ref().map(|_| mesh.n_cells()))?;
    controls::need_a_flow(checker, &raw.controls, flow.is_some())?;
    time::check_fields_of_structure(checker, &raw.output.fields, structure.is_some())?;
    restart_needs_a_flow(checker, raw.restart.as_ref(), flow.is_some())
}

/// Only a flow starts from the result of another run.
fn restart_needs_a_flow(checker: &Checker<'_>, raw: Option<&raw::Restart>, has_flow: bool) -> Checked<()> {
    if raw.is_none() || has_flow {
        return Ok(());
    }
    let problem = "only a flow can start where another run stands";
    Err(checker.combination(&Key::new("restart"), problem, "this section together with [flow]"))
}

impl<const D: usize> Case<D> {
    /// Whether this difference to the case of the earlier run is allowed.
    pub fn allows(&self, change: AllowedChange) -> bool {
        self.allowed_changes.contains(&change)
    }

    /// The unknown displacements of a slab: the components at the nodes of an elastic mesh that no boundary prescribes.
    pub fn mesh_unknowns(&self) -> Option<usize> {
        let Some(Motion::Elastic { slides, .. }) = &self.motion else { return None };
        let numbering = mesh_crate::NodeNumbering::new(&self.mesh, self.mesh.order());
        let constrained = constrained(&self.mesh, &numbering, slides);
        Some(constrained.as_flattened().iter().filter(|constrained| !**constrained).count() * self.time.order)
    }

    /// The preconditioner of the flow in slabs: the given one, or the cheapest in time and memory.
    pub fn preconditioner(&self) -> Preconditioner {
        let order = self.flow.as_ref().map_or(0, |flow| flow.order);
        let cheapest =
            if D == 3 && order >= LOW_ORDER_FROM { Preconditioner::LowOrder } else { Preconditioner::Blocks };
        self.solver.preconditioner.unwrap_or(cheapest)
    }

    /// Unknowns of the flow in a slab, 0 without a flow.
    pub fn flow_unknowns(&self) -> usize {
        let per_cell = self.flow.as_ref().map_or(0, |flow| flow.order.pow(D as u32) * (D + 2));
        self.mesh.n_cells() * per_cell * self.time.order
    }
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

impl About {
    fn new(checker: &Checker<'_>, document: &Document, raw: &raw::Case) -> Self {
        let name = document.path().file_stem().map_or_else(|| "case".into(), |stem| stem.to_string_lossy());
        let whole = raw::Case { tables: tables::written_out(checker, &raw.tables), ..raw.clone() };
        About {
            name: name.into_owned(),
            title: raw.title.clone(),
            resolved: as_toml(&whole),
            lasting: as_toml(&lasting(&whole)),
            defaults: defaults_taken(document, raw).into_iter().chain(checker.noted_defaults()).collect(),
        }
    }
}

/// A checker of `raw`, with its constants and tables.
fn checker_of<'a>(document: &'a Document, raw: &raw::Case) -> Checked<Checker<'a>> {
    let mut checker = Checker::new(document, &raw.constants)?;
    let key = Key::new("tables");
    let table = |(name, table): (&String, &raw::Table)| tables::check(&checker, &key.child(name), table);
    let tables = collected(raw.tables.iter().map(table))?;
    for (name, table) in raw.tables.keys().zip(tables) {
        checker.define_table(&key.child(name), name, table)?;
    }
    for (name, raw) in &raw.controls {
        let control = controls::check(&checker, name, raw)?;
        checker.define_control(control)?;
    }
    Ok(checker)
}

/// The keys of the resolved case that are not in the document.
fn defaults_taken(document: &Document, raw: &raw::Case) -> Vec<(String, String)> {
    let full =
        toml::Value::try_from(raw).expect("a case consists of tables, arrays, texts and numbers, which TOML can write");
    let mut defaults = Vec::new();
    collect_defaults(document, &Key::default(), &full, &mut defaults);
    defaults
}

fn collect_defaults(document: &Document, key: &Key, value: &toml::Value, defaults: &mut Vec<(String, String)>) {
    match value {
        toml::Value::Table(table) => {
            table.iter().for_each(|(name, value)| collect_defaults(document, &key.child(name), value, defaults));
        }
        toml::Value::String(text) if text.is_empty() => {}
        _ if document.position(key).is_none() => {
            // Rust writes small numbers shorter than TOML does.
            let text = value.as_float().map_or_else(|| value.to_string(), |number| format!("{number:?}"));
            defaults.push((key.to_string(), text));
        }
        _ => {}
    }
}

/// The unit vector along the axis of `what`, which exists only in three dimensions.
fn unit_axis<const D: usize>(checker: &Checker<'_>, key: &Key, axis: [f64; 3], what: &str) -> Checked<[f64; 3]> {
    if D == 2 {
        let problem = format!("in two dimensions {what} has no axis but that along z");
        return Err(checker.combination(key, &problem, "no `axis`"));
    }
    let length = tensor::norm(&axis);
    checker.require(key, "the axis", length > 0.0 && length.is_finite(), "three numbers that are not all zero")?;
    Ok(axis.map(|x| x / length))
}

/// The accepted orders of mesh and flow, as the sentence of an error.
fn order(checker: &Checker<'_>, key: &Key, quantity: &str, order: usize) -> Checked<usize> {
    let accepted = format!("{} to {} nodes per direction", mesh_crate::ORDERS.start(), mesh_crate::ORDERS.end());
    checker.require(key, quantity, mesh_crate::ORDERS.contains(&order), &accepted)?;
    Ok(order)
}
