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
    AllowedChange, Analysis, Average, Damping, Fallback, Field, Integral, Jacobian, Plane, Preconditioner, Predictor,
    PseudoTime, Solver, Steady, SteadyBodies, StructureLaw,
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

use super::checker::{Checked, Checker, Sound};
use super::consequences::Damage;
use super::continuation::{as_toml, lasting};
use super::document::Document;
use super::error::{CaseError, Errors};
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
    /// Whether the mesh comes from a file.
    pub is_mesh_from_file: bool,
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

/// With bodies that the flow moves, the low-order preconditioner takes four times the iterations of blocks, and twice the time. Blocks serve as
/// long as they take fewer bytes than this.
const MOST_BYTES_OF_BLOCKS: usize = 2_000_000_000;

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
        let Read { case, mut errors, damage } = reading::read(document)?;
        let case = case.and_then(|raw| errors.note(Self::check_values(document, &raw, &damage)));
        errors.all()?;
        Ok(case.expect("a case without errors can be read"))
    }

    /// Checks the values of a case that could be read with `damage`.
    fn check_values(document: &Document, raw: &raw::Case, damage: &Damage) -> Checked<Self> {
        let Sound { checker, mut errors } = checker_of(document, raw, damage.clone());
        let (mut of_mesh, mut damage) = (Errors::default(), damage.clone());
        let mesh = of_mesh.note(mesh::build(&checker, &raw.mesh));
        errors.extend(of_mesh.without_consequences_of(&damage));
        damage.of_geometry = mesh.is_none();
        let mesh = mesh.or_else(|| mesh::stand_in(&checker, &raw.mesh)).filter(|_| !damage.hides_boundaries());
        let mut of_sections = Errors::default();
        let case = match mesh {
            Some(AnyMesh::Plane(mesh)) => {
                of_sections.note(Case::check(&checker, document, raw, mesh)).map(|case| AnyCase::Plane(Box::new(case)))
            }
            Some(AnyMesh::Space(mesh)) => {
                of_sections.note(Case::check(&checker, document, raw, mesh)).map(|case| AnyCase::Space(Box::new(case)))
            }
            None => {
                of_sections.note(check_without_mesh(&checker, raw));
                None
            }
        };
        errors.extend(of_sections.without_consequences_of(&damage));
        errors.all()?;
        case.ok_or_else(|| checker.follows(&Key::default()))
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

/// Checks the sections that need no mesh.
fn check_without_mesh(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    let mut errors = Errors::default();
    errors.note(time::check(checker, &raw.time, raw.flow.is_some() && raw.solver.steady.is_some()));
    errors.note(solver::check(checker, &raw.solver));
    errors.note(time::check_output(checker, &raw.output));
    errors.all()
}

impl<const D: usize> Case<D> {
    fn check(checker: &Checker<'_>, document: &Document, raw: &raw::Case, mesh: mesh_crate::Mesh<D>) -> Checked<Self> {
        let mut errors = Errors::default();
        let independent = Independent::check(checker, raw, mesh, &mut errors);
        let dependent = Dependent::check(checker, raw, &independent, &mut errors);
        let cells = independent.mesh.as_ref().map_or(0, mesh_crate::Mesh::n_cells);
        let stages = errors.note(parallel::stages(checker, &raw.parallel, cells));
        check_presence(checker, raw, &independent, &mut errors);
        errors.all()?;
        let (Some(independent), Some(dependent), Some(stages)) = (independent.whole(), dependent.whole(), stages)
        else {
            return Err(checker.follows(&Key::default()));
        };
        check_together(checker, &independent, &dependent)?;
        Ok(Self::assembled(checker, document, raw, independent, dependent, stages))
    }

    fn assembled(
        checker: &Checker<'_>,
        document: &Document,
        raw: &raw::Case,
        Whole { time, mesh, flow, structure, output }: Whole<D>,
        WholeDependent { observed, averages, bodies, motion }: WholeDependent<D>,
        stages: usize,
    ) -> Self {
        let of_boundaries = flow.iter().flat_map(Flow::controls);
        let controls = checker.controls().iter().chain(of_boundaries).cloned().collect();
        Case {
            about: About::new(checker, document, raw),
            mesh,
            splits_simplices: raw.mesh.split_simplices == Some(true),
            is_mesh_from_file: raw.mesh.file.is_some(),
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
            stages,
            output,
            observed,
            averages,
        }
    }
}

/// The sections of a case that depend on the mesh and the time, and not on each other. None stands for a section with an error.
struct Independent<const D: usize> {
    time: Option<Time>,
    mesh: Option<mesh_crate::Mesh<D>>,
    flow: Option<Option<Flow<D>>>,
    structure: Option<Option<Structure<D>>>,
    output: Option<Output>,
}

impl<const D: usize> Independent<D> {
    fn check(checker: &Checker<'_>, raw: &raw::Case, mesh: mesh_crate::Mesh<D>, errors: &mut Errors) -> Self {
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
            (Some(raw), Some(time)) => errors.note(structure::check(checker, raw, &mesh, part, time)).map(Some),
            (Some(_), None) => None,
        };
        Independent { time, mesh: Some(mesh), flow, structure, output }
    }

    /// All sections, if all are correct.
    fn whole(self) -> Option<Whole<D>> {
        let Independent { time, mesh, flow, structure, output } = self;
        Some(Whole { time: time?, mesh: mesh?, flow: flow?, structure: structure?, output: output? })
    }
}

/// The correct sections of [`Independent`].
struct Whole<const D: usize> {
    time: Time,
    mesh: mesh_crate::Mesh<D>,
    flow: Option<Flow<D>>,
    structure: Option<Structure<D>>,
    output: Output,
}

/// The sections of a case that depend on those of [`Independent`]. None stands for a section with an error.
struct Dependent<const D: usize> {
    observed: Option<Observed<D>>,
    averages: Option<Option<Averages>>,
    bodies: Option<Vec<RigidBody<D>>>,
    motion: Option<Option<Motion<D>>>,
}

impl<const D: usize> Dependent<D> {
    fn check(checker: &Checker<'_>, raw: &raw::Case, independent: &Independent<D>, errors: &mut Errors) -> Self {
        let mut found = Dependent { observed: None, averages: None, bodies: None, motion: None };
        let Some(mesh) = &independent.mesh else { return found };
        let flow = raw.flow.as_ref();
        errors.note(surfaces::check(checker, raw.output.surfaces.as_ref(), flow, mesh.boundary_names()));
        found.observed = errors.note(probes::check(checker, &raw.output, mesh, flow.map(|flow| flow.order)));
        if let Some(time) = &independent.time {
            let averages = averages::check(checker, raw.output.averages.as_ref(), mesh, time, flow.is_some());
            found.averages = errors.note(averages);
            found.bodies = Self::bodies(checker, raw, mesh, independent, time, errors);
        }
        found.motion = match found.movers(checker, independent, errors) {
            Some((movers, time)) => errors.note(motion::check(checker, raw.motion.as_ref(), mesh, &movers, time)),
            None => {
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

    /// What moves walls, and the time; None if one of the sections that tell it has an error.
    fn movers<'a>(
        &self,
        checker: &Checker<'_>,
        independent: &'a Independent<D>,
        errors: &mut Errors,
    ) -> Option<(movers::Movers, &'a Time)> {
        let Independent { time, mesh, flow, structure, .. } = independent;
        let (time, bodies, structure) = (time.as_ref()?, self.bodies.as_ref()?, structure.as_ref()?);
        // Only a structure needs the flow.
        let flow = if structure.is_some() { flow.as_ref()?.as_ref() } else { None };
        let movers = movers::Movers::new(checker, bodies, structure.as_ref(), flow, mesh.as_ref()?);
        Some((errors.note(movers)?, time))
    }

    /// All sections, if all are correct.
    fn whole(self) -> Option<WholeDependent<D>> {
        let Dependent { observed, averages, bodies, motion } = self;
        Some(WholeDependent { observed: observed?, averages: averages?, bodies: bodies?, motion: motion? })
    }
}

/// The correct sections of [`Dependent`].
struct WholeDependent<const D: usize> {
    observed: Observed<D>,
    averages: Option<Averages>,
    bodies: Vec<RigidBody<D>>,
    motion: Option<Motion<D>>,
}

/// Checks that the sections that are present belong together. Without a flow this is left until there are no other errors, which may say the same.
fn check_presence<const D: usize>(
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
    controls::need_a_flow(checker, &raw.controls, raw.flow.is_some())?;
    time::check_fields_of_structure(checker, &raw.output.fields, raw.structure.is_some())?;
    restart_needs_a_flow(checker, raw.restart.as_ref(), raw.flow.is_some())
}

/// Checks that sections, each of them correct, fit together.
fn check_together<const D: usize>(
    checker: &Checker<'_>,
    Whole { time, mesh, flow, structure, .. }: &Whole<D>,
    WholeDependent { motion, .. }: &WholeDependent<D>,
) -> Checked<()> {
    held_nodes::check(checker, structure.as_ref(), motion.as_ref(), mesh, time)?;
    sliding_mesh::check_walls(checker, mesh, motion.as_ref(), flow.as_ref())
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
        let needs_blocks = self.has_moved_bodies() && self.bytes_of_blocks() <= MOST_BYTES_OF_BLOCKS;
        let cheapest = match D == 3 && order >= LOW_ORDER_FROM && !needs_blocks {
            true => Preconditioner::LowOrder,
            false => Preconditioner::Blocks,
        };
        self.solver.preconditioner.unwrap_or(cheapest)
    }

    /// Whether there are bodies or structures that the flow moves.
    pub fn has_moved_bodies(&self) -> bool {
        self.flow.is_some() && (!self.bodies.is_empty() || self.structure.is_some())
    }

    /// About the bytes of the preconditioner by blocks: the square of the unknowns of each cell, in single precision for the Jacobian and in
    /// half precision for every factor.
    fn bytes_of_blocks(&self) -> usize {
        let block = self.flow.as_ref().map_or(0, |flow| flow.order.pow(D as u32) * (D + 2));
        self.mesh.n_cells() * block * block * (4 + 2 * self.time.order)
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

/// A checker of `raw`, with its constants, tables and controls that have no error, and the errors of the others.
fn checker_of<'a>(document: &'a Document, raw: &raw::Case, damage: Damage) -> Sound<'a> {
    let Sound { mut checker, mut errors } = Checker::of_constants(document, &raw.constants, damage);
    let key = Key::new("tables");
    for (name, raw) in &raw.tables {
        let key = key.child(name);
        let table = tables::check(&checker, &key, raw);
        let defined = table.and_then(|table| checker.define_table(&key, name, table));
        if errors.note(defined).is_none() {
            checker.lose(key);
        }
    }
    for (name, raw) in &raw.controls {
        let control = controls::check(&checker, name, raw);
        if errors.note(control.and_then(|control| checker.define_control(control))).is_none() {
            checker.lose(Key::new("controls").child(name));
        }
    }
    Sound { checker, errors }
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
        return Err(checker.dimension(key, &problem, "no `axis`"));
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
