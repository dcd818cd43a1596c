//! The mesh of a case: one file for each generator.

mod airfoil;
mod airfoil_points;
mod annulus;
mod box_mesh;
mod box_regions;
mod camber;
mod channel;
mod channel_cylinder;
mod channel_flag;
mod closed_body;
mod disc;
mod ellipsoid;
mod family;
mod gmsh;
mod point_file;
mod rotating_box;
mod turbine_blade;

use super::order;
use crate::any_mesh::AnyMesh;
use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::raw::{AirfoilGenerator, ChannelFlagGenerator, Extrude, Generate, Mesh as Raw, TurbineBladeGenerator};
use ::mesh::generate::Extrusion;
use ::mesh::{MeshError, ORDERS};
use family::Family;

/// Builds the mesh.
pub(super) fn build(checker: &Checker<'_>, raw: &Raw) -> Checked<AnyMesh> {
    let key = Key::new("mesh");
    let one_of = "one of `generate` and `file`";
    let mesh = match (&raw.generate, &raw.file) {
        (Some(generate), None) => generated(checker, raw, generate)?,
        (None, Some(file)) => raised(checker, raw, gmsh::read(checker, raw, file)?)?,
        (None, None) => return Err(checker.combination(&key, "there is no mesh", one_of)),
        (Some(_), Some(_)) => return Err(checker.combination(&key, "the mesh is given twice", one_of)),
    };
    let mesh = match &raw.extrude {
        Some(extrude) => extruded(checker, extrude, mesh)?,
        None => mesh,
    };
    Ok(match raw.scramble {
        Some(seed) => mesh.scrambled(seed),
        None => mesh,
    })
}

/// Whether the shape of the cells is given: by a file, or by a formula for a box.
pub(super) fn are_cells_given(raw: &Raw) -> bool {
    raw.file.is_some() || matches!(&raw.generate, Some(Generate::Box(given)) if given.map.is_some())
}

/// A mesh with the same boundaries as the one of `raw`, which has an error: of order 2, and of other sizes if need be.
pub(super) fn stand_in(checker: &Checker<'_>, raw: &Raw) -> Option<AnyMesh> {
    let of_order = |order: Option<usize>, generate: &Option<Generate>| {
        build(checker, &Raw { order, generate: generate.clone(), ..raw.clone() }).ok()
    };
    let Some(generate) = &raw.generate else { return of_order(None, &None) };
    let of_defaults = match generate {
        Generate::ChannelFlag(_) => Some(Generate::ChannelFlag(ChannelFlagGenerator::default())),
        Generate::Airfoil(_) => Some(Generate::Airfoil(AirfoilGenerator::default())),
        Generate::TurbineBlade(_) => Some(Generate::TurbineBlade(TurbineBladeGenerator::default())),
        _ => None,
    };
    of_order(Some(*ORDERS.start()), &raw.generate).or_else(|| of_order(Some(*ORDERS.start()), &of_defaults))
}

/// The given order, or the lowest one beside an error.
fn order_or_lowest(checker: &Checker<'_>, raw: &Raw) -> (usize, Errors) {
    let key = Key::new("mesh.order");
    let missing =
        || checker.combination(&key, "the order of the mesh is missing", "`order`, 2 to 16 nodes per direction");
    let mut errors = Errors::default();
    let given = raw.order.ok_or_else(missing).and_then(|given| order(checker, &key, "the order of the mesh", given));
    (errors.note(given).unwrap_or(*ORDERS.start()), errors)
}

/// Checks the generator also if the order has an error, except for errors that a higher order may mend.
fn generated(checker: &Checker<'_>, raw: &Raw, generate: &Generate) -> Checked<AnyMesh> {
    let (order, mut errors) = order_or_lowest(checker, raw);
    errors.note(refuse_keys_of_files(checker, raw));
    let has_order = errors.is_empty();
    let mesh = errors.note(of_generator(checker, generate, order).map_err(|error| match error.cause {
        Cause::Mesh(MeshError::Parameter { .. }) | Cause::OutOfRange { .. } | Cause::NotPositive { .. } => error,
        _ if has_order => error,
        _ => checker.follows(&Key::new("mesh")),
    }));
    errors.all()?;
    mesh.ok_or_else(|| checker.follows(&Key::new("mesh")))
}

fn of_generator(checker: &Checker<'_>, generate: &Generate, order: usize) -> Checked<AnyMesh> {
    match generate {
        Generate::Box(raw) => box_mesh::build(checker, raw, order),
        Generate::Channel(raw) => channel::build(checker, raw, order),
        Generate::ChannelCylinder(raw) => channel_cylinder::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::ChannelFlag(raw) => channel_flag::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::RotatingBox(raw) => rotating_box::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::Annulus(raw) => annulus::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::ClosedBody(raw) => closed_body::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::Ellipsoid(raw) => ellipsoid::build(checker, raw, order).map(AnyMesh::Space),
        Generate::Disc(raw) => disc::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::Airfoil(raw) => airfoil::build(checker, raw, order).map(AnyMesh::Plane),
        Generate::TurbineBlade(raw) => turbine_blade::build(checker, raw, order).map(AnyMesh::Plane),
    }
}

/// The keys that only a file can have.
fn refuse_keys_of_files(checker: &Checker<'_>, raw: &Raw) -> Checked<()> {
    if !raw.periodic.is_empty() {
        let accepted = "the key `periodic` of the generator, if it has one";
        let problem = "only boundaries of a file are joined by name";
        return Err(checker.combination(&Key::new("mesh.periodic"), problem, accepted));
    }
    if raw.split_simplices.is_some() {
        let accepted = "a mesh without this key: generated cells are quadrilaterals or hexahedra";
        return Err(checker.combination(&Key::new("mesh.split_simplices"), "only cells of a file are split", accepted));
    }
    Ok(())
}

/// The mesh of a file, in the requested order.
fn raised(checker: &Checker<'_>, raw: &Raw, mesh: AnyMesh) -> Checked<AnyMesh> {
    let (key, of_file) = (Key::new("mesh.order"), mesh.order());
    let Some(wanted) = raw.order else {
        checker.note_default(&key, &format!("{of_file}, that of the file"));
        return Ok(mesh);
    };
    let wanted = order(checker, &key, "the order of the mesh", wanted)?;
    let accepted = format!("{of_file}, the order of the file, or more: with less the shape of the cells would change");
    checker.require(&key, "the order of the mesh", wanted >= of_file, &accepted)?;
    match &mesh {
        AnyMesh::Plane(mesh) => family::check_size::<2>(checker, &key, mesh.n_cells(), wanted)?,
        AnyMesh::Space(mesh) => family::check_size::<3>(checker, &key, mesh.n_cells(), wanted)?,
    }
    Ok(mesh.with_order(wanted))
}

fn extruded(checker: &Checker<'_>, raw: &Extrude, mesh: AnyMesh) -> Checked<AnyMesh> {
    let parameters = &[("the depth", "depth"), ("the number of layers", "layers"), ("z of the front", "lower")];
    let family = Family { checker, key: Key::new("mesh.extrude"), parameters };
    let AnyMesh::Plane(plane) = mesh else {
        let accepted = "a mesh of two dimensions, or no `extrude`";
        return Err(checker.combination(&family.key, "the mesh has three dimensions already", accepted));
    };
    family.check_size::<3>("layers", &[plane.n_cells(), raw.layers], plane.order())?;
    let Extrude { lower, depth, layers, periodic } = *raw;
    let extrusion = Extrusion { lower, depth, layers, periodic };
    plane.extruded(&extrusion).map(AnyMesh::Space).map_err(|error| family.refused(error))
}
