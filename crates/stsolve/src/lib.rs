//! The stsolve command: check, info, bench, progress, logging, signals.
//!
//! This crate is the only one that prints, exits, handles signals or has a command line; it holds no numerics.
//!
//! ```
//! let command = |words: &str| stsolve::run_command(words.split(' ').map(String::from));
//! assert_eq!(command("stsolve schema --markdown"), 0);
//! assert_eq!(command("stsolve check no_such_case.toml"), 2, "bad input has the exit code 2");
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `cli` | the command line |
//! | `commands` | the commands |
//! | `bench` | the kernels relative to the peak of the machine |
//! | `processes` | this process as one of several that run a case |
//! | `observer` | progress and interruption of a run for the user |
//! | `progress`, `terminal`, `logging`, `signals` | its parts |
//! | `failure` | error messages and exit codes |

pub mod bench;
pub mod cli;
pub mod commands;
pub mod failure;
pub mod logging;
pub mod observer;
pub mod processes;
pub mod progress;
pub mod signals;
pub mod terminal;

use case::AnyCase;
use cli::{Arguments, Command};
use simulation::Failure;

/// Executes the command line `arguments`, the name of the program first; prints errors and returns the exit code.
pub fn run_command(arguments: impl IntoIterator<Item = String>) -> i32 {
    let arguments = match <Arguments as clap::Parser>::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // If the terminal is closed, the message cannot be shown.
            let _ = error.print();
            return error.exit_code();
        }
    };
    match execute(&arguments) {
        Ok(()) => 0,
        Err(failure) => i32::from(failure::report(&failure)),
    }
}

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
        Command::Check { case, json, probe, threads } => {
            threads.set(None)?;
            commands::check(&AnyCase::read(&case.case, &case.set)?, *json, *probe)
        }
        Command::Info { file, json, verbose } => commands::info(file, *json, *verbose),
        Command::Compare { first, second, json } => commands::compare(first, second, *json),
        Command::Report { directories, drawing, q_level } => match drawing.scenario(*q_level) {
            Some((scenario, last_step)) => commands::movies(directories, &scenario, last_step),
            None => commands::report(directories, *q_level),
        },
        Command::Bench(arguments) => bench::bench(arguments),
        Command::Schema { markdown } => commands::schema(*markdown),
        Command::Completions { shell } => commands::completions(*shell),
        Command::Run(arguments) => commands::run(arguments),
        Command::Motion(arguments) => commands::motion(arguments),
    }
}
