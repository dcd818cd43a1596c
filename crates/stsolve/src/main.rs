//! The `stsolve` command.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match stsolve::execute(&stsolve::cli::Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(stsolve::failure::report(&failure)),
    }
}
