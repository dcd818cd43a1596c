//! The files of a wall: `surface_NAME.csv` with a row for every point at every time, and `surface_NAME.vtkhdf` for viewers.

use super::columns::{Column, columns};
use basis::{Lagrange, Matrix, Rule, equidistant_points};
use output::{FieldSpec, FileLayout, Grid, OutputError, Series, Step, ViewerFile, write_atomically};
use std::fmt::Write;
use std::path::Path;

/// Writes both files of the `series` of a wall in `dimension` dimensions. Its points are those of `rule`, a viewer gets `lattice` points
/// per direction.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    directory: &Path,
    dimension: usize,
    series: &Series,
    rule: &Rule,
    lattice: usize,
) -> Result<(), OutputError> {
    let path = |extension: &str| directory.join(format!("{}.{extension}", series.array.name));
    write_atomically(&path("csv"), table(dimension, series).as_bytes())?;
    let facets = series.array.axes[0].length;
    let at_lattice = Lagrange::new(rule.points.clone()).value_matrix(&equidistant_points(lattice));
    let grid = Grid { dimension: dimension - 1, points_per_direction: lattice, cells: facets };
    let shown: Vec<Column> = columns(dimension).into_iter().filter(|column| column.is_field).collect();
    let file = ViewerFile::create(
        &path("vtkhdf"),
        FileLayout { grid, fields: shown.iter().map(spec).collect(), exact: Vec::new() },
    )?;
    for (time, values) in series.times.iter().zip(series.values.chunks_exact(series.array.len())) {
        let field = |name: &str| on_lattice(&quantity(dimension, values, name), dimension - 1, &at_lattice);
        let points = field("");
        let drawn: Vec<Vec<f64>> = shown.iter().map(|column| field(column.name)).collect();
        let fields: Vec<(&str, &[f64])> =
            shown.iter().map(|column| column.name).zip(drawn.iter().map(Vec::as_slice)).collect();
        file.append(&Step { time: *time, points: &points, fields: &fields, exact: &[] })?;
    }
    file.publish()
}

fn spec(column: &Column) -> FieldSpec {
    if column.components == 1 { FieldSpec::scalar(column.name) } else { FieldSpec::vector(column.name) }
}

/// All rows, with the time in the first column.
fn table(dimension: usize, series: &Series) -> String {
    let names: Vec<String> = columns(dimension).iter().flat_map(Column::names).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for (time, values) in series.times.iter().zip(series.values.chunks_exact(series.array.len())) {
        for row in values.chunks_exact(names.len()) {
            let row = row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{time},{row}");
        }
    }
    text
}

/// The quantity `name` at all points, `[point][1 or 3]`.
fn quantity(dimension: usize, values: &[f64], name: &str) -> Vec<Vec<f64>> {
    let all = columns(dimension);
    let width: usize = all.iter().map(|column| column.components).sum();
    let first: usize = all.iter().take_while(|column| column.name != name).map(|column| column.components).sum();
    let components = all.iter().find(|column| column.name == name).map_or(1, |column| column.components);
    let stored = if components == 1 { 1 } else { 3 };
    let padded = |row: &[f64]| (0..stored).map(|i| if i < components { row[first + i] } else { 0.0 }).collect();
    values.chunks_exact(width).map(padded).collect()
}

/// The polynomials through the values at the points of every facet, at the points of its lattice, one after the other.
fn on_lattice(values: &[Vec<f64>], axes: usize, at_lattice: &Matrix) -> Vec<f64> {
    let (points, lattice) = (at_lattice.cols(), at_lattice.rows());
    let weight = |target: usize, point: usize| -> f64 {
        (0..axes as u32)
            .map(|axis| at_lattice[(target / lattice.pow(axis) % lattice, point / points.pow(axis) % points)])
            .product()
    };
    let of_facet = |facet: &[Vec<f64>]| -> Vec<f64> {
        let at = |target: usize, i: usize| (0..facet.len()).map(|point| weight(target, point) * facet[point][i]).sum();
        (0..lattice.pow(axes as u32))
            .flat_map(|target| (0..facet[0].len()).map(move |i| (target, i)))
            .map(|(target, i)| at(target, i))
            .collect()
    };
    values.chunks_exact(points.pow(axes as u32)).flat_map(of_facet).collect()
}
