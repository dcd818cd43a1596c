//! The stsolve command: case files, progress, reports.
//!
//! This crate is the only one that reads TOML, prints or exits; it holds no numerics.
//!
//! | module | holds |
//! |---|---|
//! | `cli` | the command line |
//! | `case` | the case file: what the user writes, and what the program needs |
//! | `expression` | formulas in a case file |
//! | `commands` | what each command does |
//! | `run` | from a checked case to files |
//! | `progress`, `terminal`, `logging`, `signals` | what the user sees of a run, and how it is stopped |
//! | `failure` | error messages and exit codes |

pub mod case;
pub mod cli;
pub mod commands;
pub mod expression;
pub mod failure;
pub mod logging;
mod nearest;
pub mod progress;
pub mod run;
pub mod signals;
pub mod terminal;

use case::AnyCase;
use cli::{Arguments, CaseArguments, Command};
use failure::Failure;

/// Does what the command line asks for.
///
/// # Errors
/// Bad input, or a solve that failed.
pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Check { case, json } => commands::check(&read(case)?, *json),
        Command::Info { file, json } => commands::info(file, *json),
        Command::Schema => commands::schema(),
        Command::Run(arguments) | Command::Motion(arguments) => {
            let case = read(&arguments.case)?;
            let _session = commands::Session::start(arguments, case.about(), case.output_directory())?;
            Err(Failure::solve(anyhow::anyhow!("the solver is not connected to the command line")))
        }
    }
}

fn read(arguments: &CaseArguments) -> Result<AnyCase, Failure> {
    Ok(AnyCase::read(&arguments.case, &arguments.set)?)
}
