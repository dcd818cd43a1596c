//! `stsolve info`

mod mesh_facts;
mod mesh_file;

use super::print;
use super::table::Table;
use crate::cli::quoted;
use case::input_file;
use output::{RESULT_FILE, ResultInfo};
use simulation::Failure;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The beginning of an HDF5 file.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Describes the file at `path`: a mesh file of Gmsh, SU2 or CGNS, by its contents or its ending .msh, .su2 or .cgns, or a result
/// file. For a directory, it describes the result file in it. A verbose description of a result holds checksums and the checkpoint.
///
/// # Errors
/// If the file cannot be read, is damaged or neither.
pub fn info(path: &Path, json: bool, verbose: bool) -> Result<(), Failure> {
    let path = &if path.is_dir() { path.join(RESULT_FILE) } else { path.to_owned() };
    if let Err(error) = input_file::require_regular(path) {
        return Err(Failure::bad_input(anyhow::anyhow!("`{}` cannot be read: {error}", path.display())));
    }
    if mesh_file::is_one(path) {
        return mesh_file::info(path, json);
    }
    if let Some(problem) = other_kind(path) {
        return Err(Failure::bad_input(anyhow::anyhow!("`{}` {problem}", path.display())));
    }
    let info = output::inspect(path)?;
    if json {
        return print(&serde_json::to_string_pretty(&info).map_err(Failure::bad_input)?);
    }
    print(&describe(path, &info, verbose))
}

/// The kind of a file that is no result, not even a damaged one.
fn other_kind(path: &Path) -> Option<String> {
    let named = |extension: &str| path.extension().is_some_and(|found| found == extension);
    let mut beginning = Vec::new();
    match File::open(path).and_then(|file| file.take(SIGNATURE.len() as u64).read_to_end(&mut beginning)) {
        Err(error) => Some(format!("cannot be read: {error}")),
        Ok(_) if beginning == SIGNATURE || named("vtkhdf") => None,
        Ok(_) if named("toml") => {
            Some(format!("is a case; `stsolve check {}` explains it", quoted(&path.to_string_lossy())))
        }
        Ok(_) => Some(format!("is neither the result of a run, `{RESULT_FILE}`, nor a mesh file of Gmsh, SU2 or CGNS")),
    }
}

fn describe(path: &Path, info: &ResultInfo, verbose: bool) -> String {
    let mut file = Table::new(&path.display().to_string());
    file.row("case", info.case_name.clone(), "")
        .row("written by", info.creator.clone(), "")
        .row("format version", info.format_version, "")
        .row("size", info.bytes as f64 / 1e6, "MB");
    if verbose {
        file.row("case fingerprint", info.case_fingerprint.clone(), "").row(
            "mesh fingerprint",
            info.mesh_id.clone(),
            "",
        );
    }
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
    let mut fields: Vec<_> = info.layout.fields.iter().map(|field| field.name.as_str()).collect();
    let mut exact: Vec<_> = info.layout.exact.iter().map(|array| array.name.as_str()).collect();
    // The file lists them in no order.
    fields.sort_unstable();
    exact.sort_unstable();
    steps.row("fields", fields, "").row("coefficients", exact, "");
    let tables = [file, mesh, steps].into_iter().chain(verbose.then(|| checkpoint(info)));
    tables.map(|table| table.text()).collect::<Vec<_>>().join("\n")
}

/// The arrays and counters from which a run goes on.
fn checkpoint(info: &ResultInfo) -> Table {
    let mut checkpoint = Table::new("checkpoint");
    for (name, length) in &info.checkpoint.arrays {
        checkpoint.row(name, *length, "values");
    }
    for (name, value) in &info.checkpoint.integers {
        checkpoint.row(name, *value, "");
    }
    checkpoint
}
