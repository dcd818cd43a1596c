//! The group `/VTKHDF`: a transient unstructured grid of Lagrange cells whose points move.
//!
//! The grid has one part and its topology is written once. Each step appends its points and fields and the offsets at
//! which they start. VTK 9.3 (ParaView 5.12) and later read it. Older readers require three things: `Type` is an ASCII
//! string of exactly its 16 bytes, all index arrays are 64 bits wide, and points and vectors have three components.

use hdf5::types::FixedAscii;
use hdf5::{Error, Group, Result};

use crate::hdf::{append, constant, drop_last, growing, indices, make_room, write_at, write_integer};
use crate::lagrange::in_vtk_order;
use crate::layout::{FieldSpec, FileLayout, Grid};

const LAGRANGE_CURVE: u8 = 68;
const LAGRANGE_QUADRILATERAL: u8 = 70;
const LAGRANGE_HEXAHEDRON: u8 = 72;

/// Index arrays of `Steps` with one entry per step: name and length of an entry (absent: a plain number).
const STEP_OFFSETS: [(&str, Option<usize>); 5] = [
    ("PartOffsets", None),
    ("NumberOfParts", None),
    ("PointOffsets", None),
    ("CellOffsets", Some(1)),
    ("ConnectivityIdOffsets", Some(1)),
];

/// Creates the group without a step.
pub(crate) fn create(root: &Group, layout: &FileLayout) -> Result<()> {
    let points = layout.grid.points();
    write_type(root)?;
    write_topology(root, &layout.grid)?;
    growing::<f64>(root, "Points", points, &[3])?;
    create_steps(root, &layout.fields)?;
    let point_data = root.create_group("PointData")?;
    for field in &layout.fields {
        growing::<f64>(&point_data, &field.name, points, &components(field))?;
    }
    Ok(())
}

/// A scalar field is an array with one axis; any other field has a second axis for its components.
fn components(field: &FieldSpec) -> Vec<usize> {
    if field.components == 1 { vec![] } else { vec![field.components] }
}

fn write_type(root: &Group) -> Result<()> {
    root.new_attr_builder().with_data(&[2_i64, 2]).create("Version")?;
    let name = FixedAscii::<16>::from_ascii("UnstructuredGrid").map_err(|error| Error::from(error.to_string()))?;
    root.new_attr::<FixedAscii<16>>().create("Type")?.write_scalar(&name)
}

/// Each cell owns its points, numbered one cell after the other, because the solution jumps between neighbours.
fn write_topology(root: &Group, grid: &Grid) -> Result<()> {
    let connectivity: Vec<i64> = (0..grid.points() as i64).collect();
    let offsets: Vec<i64> = (0..=grid.cells).map(|cell| (cell * grid.points_per_cell()) as i64).collect();
    let kind = match grid.dimension {
        1 => LAGRANGE_CURVE,
        2 => LAGRANGE_QUADRILATERAL,
        _ => LAGRANGE_HEXAHEDRON,
    };
    constant(root, "NumberOfPoints", &[grid.points() as i64])?;
    constant(root, "NumberOfCells", &[grid.cells as i64])?;
    constant(root, "NumberOfConnectivityIds", &[grid.points() as i64])?;
    indices(root, "Connectivity", &connectivity)?;
    indices(root, "Offsets", &offsets)?;
    constant(root, "Types", &vec![kind; grid.cells])
}

fn create_steps(root: &Group, fields: &[FieldSpec]) -> Result<()> {
    let steps = root.create_group("Steps")?;
    write_integer(&steps, "NSteps", 0)?;
    growing::<f64>(&steps, "Values", 1, &[])?;
    for (name, entry) in STEP_OFFSETS {
        growing::<i64>(&steps, name, 1, entry.as_slice())?;
    }
    let offsets = steps.create_group("PointDataOffsets")?;
    fields.iter().try_for_each(|field| growing::<i64>(&offsets, &field.name, 1, &[]).map(drop))
}

/// Times of the steps.
pub(crate) fn times(root: &Group) -> Result<Vec<f64>> {
    root.dataset("Steps/Values")?.read_raw()
}

/// Writes points and `fields` of cells, in the order of the layout, from the point `first` of all steps on. `order` comes from
/// [`crate::vtk_order`].
pub(crate) fn write_cells(
    root: &Group,
    layout: &FileLayout,
    order: &[usize],
    first: usize,
    (points, fields): (&[f64], &[&[f64]]),
) -> Result<()> {
    let rows = points.len() / 3;
    write_at(&root.dataset("Points")?, first, rows, &in_vtk_order(order, points, 3))?;
    let point_data = root.group("PointData")?;
    for (field, values) in layout.fields.iter().zip(fields) {
        let values = in_vtk_order(order, values, field.components);
        write_at(&point_data.dataset(&field.name)?, first, rows, &values)?;
    }
    Ok(())
}

/// Gives all steps together at least so many points.
pub(crate) fn make_room_for(root: &Group, layout: &FileLayout, points: usize) -> Result<()> {
    make_room(&root.dataset("Points")?, points)?;
    let point_data = root.group("PointData")?;
    layout.fields.iter().try_for_each(|field| make_room(&point_data.dataset(&field.name)?, points))
}

/// Makes the appended points and fields a step: they become valid when its number is raised here.
pub(crate) fn close_step(root: &Group, time: f64, layout: &FileLayout) -> Result<()> {
    let steps = root.group("Steps")?;
    let values = steps.dataset("Values")?;
    let step = values.size();
    let first_point = (step * layout.grid.points()) as i64;
    append(&values, 1, &[time])?;
    for (name, _) in STEP_OFFSETS {
        let entry = match name {
            "NumberOfParts" => 1,
            "PointOffsets" => first_point,
            _ => 0,
        };
        append(&steps.dataset(name)?, 1, &[entry])?;
    }
    let offsets = steps.group("PointDataOffsets")?;
    for field in &layout.fields {
        append(&offsets.dataset(&field.name)?, 1, &[first_point])?;
    }
    steps.attr("NSteps")?.write_scalar(&(step as i64 + 1))
}

/// Drops the last step. It ceases to be valid when the number of steps is lowered here.
pub(crate) fn drop_step(root: &Group, layout: &FileLayout) -> Result<()> {
    let steps = root.group("Steps")?;
    let values = steps.dataset("Values")?;
    steps.attr("NSteps")?.write_scalar(&(values.size() as i64 - 1))?;
    drop_last(&values, 1)?;
    STEP_OFFSETS.iter().try_for_each(|(name, _)| drop_last(&steps.dataset(name)?, 1))?;
    let (offsets, point_data) = (steps.group("PointDataOffsets")?, root.group("PointData")?);
    for field in &layout.fields {
        drop_last(&offsets.dataset(&field.name)?, 1)?;
        drop_last(&point_data.dataset(&field.name)?, layout.grid.points())?;
    }
    drop_last(&root.dataset("Points")?, layout.grid.points())
}
