//! The stsolve command: case files, progress, reports.
//!
//! This crate is the only one that reads TOML, prints or exits; it holds no numerics.
//!
//! | module | holds |
//! |---|---|
//! | `cli` | the command line |
//! | `case` | the case file: from the text of the user to the checked case |
//! | `expression` | formulas in a case file |
//! | `any_mesh` | a mesh whose dimension is known only after it is read |
//! | `bench` | the kernels relative to the peak of the machine |
//! | `commands` | the commands |
//! | `run` | from a checked case to files |
//! | `report` | a page that shows a run |
//! | `input_file` | input files, read as a whole |
//! | `mesh_file` | a mesh file, if it fits into memory |
//! | `memory` | available memory |
//! | `progress`, `terminal`, `logging`, `signals` | progress, messages and interruption of a run |
//! | `clock` | the wall time of the parts of a run |
//! | `excerpt` | a piece of a line with carets below it |
//! | `failure` | error messages and exit codes |

mod any_mesh;
pub mod bench;
pub mod case;
pub mod cli;
pub mod clock;
pub mod commands;
mod excerpt;
pub mod expression;
pub mod failure;
mod input_file;
pub mod logging;
mod memory;
mod mesh_file;
mod nearest;
pub mod progress;
pub mod report;
pub mod run;
pub mod signals;
pub mod terminal;

use case::AnyCase;
use cli::{Arguments, CaseArguments, Command, RunArguments};
use failure::Failure;

/// A program for one instruction set, on a machine that lacks it.
const OTHER_MACHINE: &str = "this program was compiled for the instruction set of another machine alone (feature `this-machine`): compile it \
                             here, `cargo build --release`";

/// Executes the command line.
///
/// # Errors
/// Bad input, or a solve that failed.
pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    if !tensor::runs_here() {
        return Err(Failure::bad_input(anyhow::anyhow!(OTHER_MACHINE)));
    }
    match &arguments.command {
        Command::Check { case, json, probe } => {
            let case = read(case)?;
            in_pool(|| commands::check(&case, *json, *probe))
        }
        Command::Info { file, json } => commands::info(file, *json),
        Command::Report { directory } => report::report(directory),
        Command::Bench(arguments) => bench::bench(arguments),
        Command::Schema { markdown } => commands::schema(*markdown),
        Command::Completions { shell } => commands::completions(*shell),
        Command::Run(arguments) => {
            let case = read_for(arguments)?;
            in_pool(|| run::run(&case, arguments))
        }
        Command::Motion(arguments) => {
            let case = read_for(arguments)?;
            in_pool(|| run::motion(&case, arguments))
        }
    }
}

/// Does `work` on a thread of the pool. From outside the pool every parallel loop would wake one of its threads and wait to be woken by
/// it, which costs some loops as much as their work.
fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}

/// The case of a command that computes. The number of threads is set first, because they build the mesh.
fn read_for(arguments: &RunArguments) -> Result<AnyCase, Failure> {
    commands::set_threads(arguments)?;
    read(&arguments.case)
}

fn read(arguments: &CaseArguments) -> Result<AnyCase, Failure> {
    Ok(AnyCase::read(&arguments.case, &arguments.set)?)
}
