//! Writes a result by all processes of MPI, and once more by one of them, and compares the two:
//!
//!     HDF5_DIR=... cargo build --release -p output --features parallel-hdf5 --example shared_result
//!     mpirun -n 3 target/release/examples/shared_result DIRECTORY
#![allow(clippy::print_stdout)]

use anyhow::{Result, ensure};
use output::{
    ArrayInParts, ArraySpec, FieldSpec, FileLayout, Grid, Metadata, OutputError, Parts, RESULT_FILE, ResultFile,
    ResultReader, RunDirectory, SharedFile, SolverState, Step, read_checkpoint,
};
use ranks::Communicator;
use std::ops::Range;
use std::path::{Path, PathBuf};

const CELLS: usize = 3000;
const STEPS: usize = 3;
/// The name of the array of coefficients, and of that of the state.
const FLOW: &str = "flow";

fn main() -> Result<()> {
    let ranks = message_passing::world()?;
    let directory = std::env::args().nth(1).map_or_else(|| "shared_result".into(), PathBuf::from);
    let (alone, together) = (directory.join("alone"), directory.join("together"));
    if ranks.rank() > 0 {
        for step in 0..STEPS {
            write(&*ranks, &together, |file, cells| write_step(file, step, cells))?;
            write(&*ranks, &together, |file, cells| write_state(file, step, cells))?;
        }
        return Ok(());
    }
    let opened = [&alone, &together].map(|place| RunDirectory::open(place));
    let [of_alone, of_together] = opened;
    let (of_alone, of_together) = (of_alone?, of_together?);
    let mut results = [&of_alone, &of_together].map(|place| ResultFile::create(place, layout(), &Metadata::default()));
    let [Ok(one), Ok(all)] = &mut results else { anyhow::bail!("no file") };
    for step in 0..STEPS {
        with_cells(step, 0..CELLS, |part| one.append(part))?;
        one.checkpoint(&state(flow(step, 0..CELLS)))?;
        let parts = all.append_in_parts(step as f64)?;
        parts.share(CELLS, |_| write(&*ranks, &together, |file, cells| write_step(file, step, cells)))?.finish()?;
        let long = ArrayInParts { name: FLOW.to_owned(), len: CELLS * 9, parts: Parts::OfAllRanks };
        all.checkpoint_together(&SolverState::default(), vec![long], |_| {
            write(&*ranks, &together, |file, cells| write_state(file, step, cells))
        })?;
    }
    compare(&alone.join(RESULT_FILE), &together.join(RESULT_FILE))?;
    println!("{} processes wrote {STEPS} steps of {CELLS} cells as one does", ranks.size());
    Ok(())
}

/// Has all ranks write to the working copy in `directory`, each some of the cells.
fn write(
    ranks: &dyn Communicator,
    directory: &Path,
    write: impl FnOnce(&SharedFile, Range<usize>) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    // Rank 0 has closed the file.
    ranks.all_gather(&[]);
    let sharing = ranks.file_sharing().unwrap_or(ranks::FileSharing::Threads);
    let file = SharedFile::open(&directory.join(format!("{RESULT_FILE}.partial")), layout(), sharing)?;
    let end = |rank: usize| CELLS * rank / ranks.size();
    let written = write(&file, end(ranks.rank())..end(ranks.rank() + 1)).and(file.close());
    ranks.all_gather(&[]);
    written
}

fn write_step(file: &SharedFile, step: usize, cells: Range<usize>) -> Result<(), OutputError> {
    with_cells(step, cells.clone(), |part| file.write_cells(cells.start, part))
}

fn write_state(file: &SharedFile, step: usize, cells: Range<usize>) -> Result<(), OutputError> {
    file.write_state(FLOW, 9 * cells.start, &flow(step, cells))
}

fn layout() -> FileLayout {
    FileLayout {
        grid: Grid { dimension: 2, points_per_direction: 3, cells: CELLS },
        fields: vec![FieldSpec::scalar("density")],
        exact: vec![ArraySpec::new(FLOW, &[("cell", CELLS), ("node", 9)])],
    }
}

/// Different numbers for all steps and nodes.
fn flow(step: usize, cells: Range<usize>) -> Vec<f64> {
    (9 * cells.start..9 * cells.end).map(|node| 0.1 * node as f64 + step as f64).collect()
}

fn state(flow: Vec<f64>) -> SolverState {
    SolverState { arrays: [(FLOW.to_owned(), flow.into())].into(), ..SolverState::default() }
}

/// Passes the cells of a step to `write`.
fn with_cells<E>(step: usize, cells: Range<usize>, write: impl FnOnce(&Step) -> Result<(), E>) -> Result<(), E> {
    let flow = flow(step, cells);
    let points: Vec<f64> = flow.iter().flat_map(|x| [*x, -x, 0.0]).collect();
    write(&Step { time: step as f64, points: &points, fields: &[("density", &flow)], exact: &[(FLOW, &flow)] })
}

/// The files have the same coefficients, points, fields and states.
fn compare(one: &Path, other: &Path) -> Result<()> {
    let readers = [ResultReader::open(one)?, ResultReader::open(other)?];
    for step in 0..STEPS {
        let [of_one, of_other] = [readers[0].exact(FLOW, step)?, readers[1].exact(FLOW, step)?];
        ensure!(of_one == of_other && of_one == Some(flow(step, 0..CELLS)), "the coefficients of step {step}");
    }
    ensure!(read_checkpoint(one)?.1.arrays == read_checkpoint(other)?.1.arrays, "the states");
    for name in ["VTKHDF/Points", "VTKHDF/PointData/density", "VTKHDF/Steps/Values"] {
        let [one, other] =
            [one, other].map(|path| hdf5::File::open(path).and_then(|file| file.dataset(name)?.read_raw::<f64>()));
        ensure!(one? == other?, "{name}");
    }
    Ok(())
}
