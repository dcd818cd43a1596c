//! The checked case: plain enums and numbers, compiled formulas, the mesh.

mod about;
mod averages;
mod bodies;
mod boundary_data;
mod boundary_field;
mod boundary_motion;
mod controls;
mod displacement;
mod equilibrium;
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
mod no_value;
mod openings;
mod over_run;
mod parallel;
mod parts;
mod probes;
mod quadrature;
mod resolved;
mod sections;
mod shared_nodes;
mod sizes;
mod slide;
mod sliding_mesh;
mod solver;
mod source;
mod states;
mod structure;
mod surfaces;
mod tables;
mod time;
mod time_length;
mod vector_of_time;
mod walls;

pub use super::raw::{
    AllowedChange, Analysis, Average, Damping, Fallback, Field, Integral, Jacobian, Plane, Preconditioner, Predictor,
    PseudoTime, Solver, Steady, SteadyBodies, StructureLaw,
};
pub use about::About;
pub use averages::{Averages, Phases};
pub use bodies::{FollowingMesh, Freedom, RigidBody};
pub use boundary_data::{BoundaryData, Data};
pub use controls::Control;
pub use flow::Flow;
pub use forces::Wall;
pub use given_values::NotPositive;
pub use motion::{Motion, Stiffness};
pub use no_value::NoValue;
pub use openings::is_along_axis;
pub use parts::SolidPart;
pub use probes::{Line, Observed, Probe, Slice, is_name_of_average};
pub use resolved::{
    bodies_of, freedoms_of, gas_of, motion_of, quadrature_of, ratio_of_specific_heats_of, reference_of,
    searches_steady_flow, start_of, structure_points_of, title_of, walls_of, walls_with_series_of,
};
pub use sliding_mesh::{Held, constrained};
pub use source::Source;
pub use structure::{Largest, Structure, Support};
pub use surfaces::surface_name;
pub(crate) use time::length_of_slabs;
pub use time::{Output, Time};

use super::checker::{Checked, Checker, Sound};
use super::consequences::Damage;
use super::document::Document;
use super::error::{CaseError, Errors};
use super::key::Key;
use super::names_in_use;
use super::raw;
use super::reading::{self, Read};
use crate::any_mesh::AnyMesh;
// The crate, besides a module of the same name.
use ::mesh as mesh_crate;
use sections::{Dependent, Independent, Whole, WholeDependent, check_presence, check_together};
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
    /// Whether the shape of the cells is given: by a file, or by a formula for a box.
    pub are_cells_given: bool,
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
        errors.note(names_in_use::check_options(&checker, document));
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

    /// Whether formulas of the case contain numbers that its run changes.
    pub fn has_controls(&self) -> bool {
        match self {
            AnyCase::Plane(case) => !case.controls.is_empty(),
            AnyCase::Space(case) => !case.controls.is_empty(),
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
        check_together(checker, raw, &independent, &dependent)?;
        Ok(Self::assembled(checker, document, raw, independent, dependent, stages))
    }

    fn assembled(
        checker: &Checker<'_>,
        document: &Document,
        raw: &raw::Case,
        Whole { time, mesh, flow, structure, output }: Whole<D>,
        WholeDependent { observed, averages, bodies, motion, .. }: WholeDependent<D>,
        stages: usize,
    ) -> Self {
        let of_boundaries = flow.iter().flat_map(Flow::controls);
        let named = checker.controls().iter().map(|control| control.with_use(checker.uses(control)));
        let controls = named.chain(of_boundaries.cloned()).collect();
        Case {
            about: About::new(checker, document, raw),
            mesh,
            splits_simplices: raw.mesh.split_simplices == Some(true),
            are_cells_given: mesh::are_cells_given(&raw.mesh),
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
    for (name, control) in &raw.controls {
        let control = controls::check(&checker, name, control, &raw.output.integrals);
        if errors.note(control.and_then(|control| checker.define_control(control))).is_none() {
            checker.lose(Key::new("controls").child(name));
        }
    }
    Sound { checker, errors }
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
