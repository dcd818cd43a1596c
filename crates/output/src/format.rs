//! The group `/stsolve`: program, case, layout, and the exact coefficients.

use hdf5::{Group, Result};

use crate::hdf::{
    constant, drop_last, growing, read_integer, read_labels, read_length, read_text, write_integer, write_labels,
    write_text,
};
use crate::layout::{ArraySpec, Axis, FieldSpec, FileLayout, Grid};
use crate::rest_mesh::{self, RestMesh};

/// Version of the group `/stsolve`; raised when a reader of the old one would misread the new one.
pub const FORMAT_VERSION: i64 = 2;

/// Name of the group.
pub(crate) const GROUP: &str = "stsolve";

/// Name of the text of the case.
const CASE: &str = "case";

/// Name of its checksum.
const CASE_FINGERPRINT: &str = "case_fingerprint";

/// Name of the axis along which an array of coefficients grows.
const STEP_LABEL: &str = "step";

/// The description of a result file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Metadata {
    /// Name and version of the program that wrote the file, for instance `stsolve 0.1.0`.
    pub creator: String,
    /// Name of the case.
    pub case_name: String,
    /// The resolved case, as it could be run again.
    pub case_text: String,
    /// A checksum of all parts of the case that influence the numbers; a checkpoint with another checksum is refused.
    pub case_fingerprint: String,
    /// A checksum of the mesh, so that coefficients are not combined with another mesh.
    pub mesh_id: String,
    /// Reference coordinates in [-1, 1] of the space nodes of one direction.
    pub space_nodes: Vec<f64>,
    /// Positions in [0, 1] of the time nodes of a slab.
    pub time_nodes: Vec<f64>,
    /// The mesh at rest.
    pub mesh: RestMesh,
}

/// Creates the group without a step.
pub(crate) fn create(group: &Group, layout: &FileLayout, metadata: &Metadata) -> Result<()> {
    write_integer(group, "format_version", FORMAT_VERSION)?;
    write_metadata(group, metadata)?;
    write_grid(group, &layout.grid)?;
    let exact = group.create_group("exact")?;
    for array in &layout.exact {
        let row: Vec<usize> = array.axes.iter().map(|axis| axis.length).collect();
        let labels: Vec<&str> =
            std::iter::once(STEP_LABEL).chain(array.axes.iter().map(|axis| axis.label.as_str())).collect();
        write_labels(&growing::<f64>(&exact, &array.name, 1, &row)?, &labels)?;
    }
    Ok(())
}

fn write_metadata(group: &Group, metadata: &Metadata) -> Result<()> {
    write_text(group, "creator", &metadata.creator)?;
    write_text(group, "case_name", &metadata.case_name)?;
    write_text(group, CASE, &metadata.case_text)?;
    write_text(group, CASE_FINGERPRINT, &metadata.case_fingerprint)?;
    write_text(group, "mesh_id", &metadata.mesh_id)?;
    constant(group, "space_nodes", &metadata.space_nodes)?;
    constant(group, "time_nodes", &metadata.time_nodes)?;
    rest_mesh::write(group, &metadata.mesh)
}

/// Replaces the text of the case and its checksum.
pub(crate) fn replace_case(group: &Group, now: &Metadata) -> Result<()> {
    [CASE, CASE_FINGERPRINT].iter().try_for_each(|name| group.delete_attr(name))?;
    write_text(group, CASE, &now.case_text)?;
    write_text(group, CASE_FINGERPRINT, &now.case_fingerprint)
}

/// Reads the description of the file.
pub(crate) fn read_metadata(group: &Group) -> Result<Metadata> {
    Ok(Metadata {
        creator: read_text(group, "creator")?,
        case_name: read_text(group, "case_name")?,
        case_text: read_text(group, CASE)?,
        case_fingerprint: read_text(group, CASE_FINGERPRINT)?,
        mesh_id: read_text(group, "mesh_id")?,
        space_nodes: group.dataset("space_nodes")?.read_raw()?,
        time_nodes: group.dataset("time_nodes")?.read_raw()?,
        mesh: rest_mesh::read(group)?,
    })
}

/// Reads the version of the format.
pub(crate) fn read_version(group: &Group) -> Result<i64> {
    read_integer(group, "format_version")
}

fn write_grid(group: &Group, grid: &Grid) -> Result<()> {
    write_integer(group, "dimension", grid.dimension as i64)?;
    write_integer(group, "points_per_direction", grid.points_per_direction as i64)?;
    write_integer(group, "cells", grid.cells as i64)
}

fn read_grid(group: &Group) -> Result<Grid> {
    Ok(Grid {
        dimension: read_length(group, "dimension")?,
        points_per_direction: read_length(group, "points_per_direction")?,
        cells: read_length(group, "cells")?,
    })
}

/// Reads the layout of the steps.
pub(crate) fn read_layout(group: &Group, vtkhdf: &Group) -> Result<FileLayout> {
    let (point_data, exact) = (vtkhdf.group("PointData")?, group.group("exact")?);
    let field = |name: String| {
        let components = point_data.dataset(&name)?.shape().get(1).copied().unwrap_or(1);
        Ok(FieldSpec { name, components })
    };
    Ok(FileLayout {
        grid: read_grid(group)?,
        fields: point_data.member_names()?.into_iter().map(field).collect::<Result<_>>()?,
        exact: exact.member_names()?.into_iter().map(|name| read_array(&exact, name)).collect::<Result<_>>()?,
    })
}

fn read_array(exact: &Group, name: String) -> Result<ArraySpec> {
    let dataset = exact.dataset(&name)?;
    let axes = read_labels(&dataset)?.into_iter().zip(dataset.shape());
    let axes = axes.skip(1).map(|(label, length)| Axis { label, length }).collect();
    Ok(ArraySpec { name, axes })
}

/// Drops the coefficients of the last step.
pub(crate) fn drop_array(group: &Group, name: &str) -> Result<()> {
    drop_last(&group.group("exact")?.dataset(name)?, 1)
}
