//! `stsolve info`

mod mesh_file;

use super::print;
use super::table::Table;
use crate::failure::Failure;
use output::ResultInfo;
use std::path::Path;

/// Tells what the file at `path` holds: a mesh file, which begins with `$MeshFormat` or ends in .msh, or a result file.
///
/// # Errors
/// If the file cannot be read, is damaged or neither.
pub fn info(path: &Path, json: bool) -> Result<(), Failure> {
    if mesh_file::is_one(path) {
        return mesh_file::info(path, json);
    }
    let info = output::inspect(path)?;
    if json {
        return print(&serde_json::to_string_pretty(&info).map_err(Failure::bad_input)?);
    }
    print(&describe(path, &info))
}

fn describe(path: &Path, info: &ResultInfo) -> String {
    let mut file = Table::new(&path.display().to_string());
    file.row("case", info.case_name.clone(), "")
        .row("written by", info.creator.clone(), "")
        .row("format version", info.format_version, "")
        .row("size", info.bytes as f64 / 1e6, "MB")
        .row("case fingerprint", info.case_fingerprint.clone(), "")
        .row("mesh fingerprint", info.mesh_id.clone(), "");
    let grid = &info.layout.grid;
    let mut mesh = Table::new("grid");
    mesh.row("dimension", grid.dimension, "")
        .row("cells", grid.cells, "")
        .row("nodes in space per direction", info.space_nodes, "")
        .row("nodes in time per slab", info.time_nodes, "");
    let mut steps = Table::new("steps");
    steps.row("number", info.times.len(), "");
    for (key, time) in [("first time", info.times.first()), ("last time", info.times.last())] {
        steps.row(key, time.copied(), "");
    }
    let fields: Vec<_> = info.layout.fields.iter().map(|field| field.name.as_str()).collect();
    let exact: Vec<_> = info.layout.exact.iter().map(|array| array.name.as_str()).collect();
    steps.row("fields", fields, "").row("coefficients", exact, "");
    let mut checkpoint = Table::new("checkpoint");
    for (name, length) in &info.checkpoint.arrays {
        checkpoint.row(name, *length, "values");
    }
    for (name, value) in &info.checkpoint.integers {
        checkpoint.row(name, *value, "");
    }
    [file, mesh, steps, checkpoint].iter().map(Table::text).collect::<Vec<_>>().join("\n")
}
