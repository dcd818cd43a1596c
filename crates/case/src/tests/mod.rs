//! Cases given as texts: what becomes of them, and their errors.

#![allow(clippy::unwrap_used)]

use super::*;
use coupled::BoundaryField;
use fem::VectorField;
use navier_stokes::{Boundary, Riemann};
use std::path::{Path, PathBuf};

mod all_errors;
mod bad_input;
mod bodies;
mod continuation;
mod controls;
mod formulas;
mod in_flow;
mod meshes;
mod motions;
mod options;
mod outflows;
mod over_run;
mod parallel;
mod reference;
mod rotation;
mod schemas;
mod settings;
mod structures;
mod tables;

/// The smallest case with all parts that errors refer to.
const BASE: &str = r#"
[constants]
a = 0.1
b = "2*a"
[mesh]
order = 3
generate.box = { lower = [0, 0], upper = [2, 1], cells = [4, 2] }
[motion]
elasticity = { poisson_ratio = 0.3 }
[motion.boundary]
left = { displacement = ["4*a*t*y*(1 - y)", 0] }
others = "fixed"
[flow]
order = 4
[flow.initial.uniform]
velocity = [0.5, 0]
pressure = 1
[flow.boundary]
left = "slip_wall"
others = { far_field = { velocity = [0.5, 0], pressure = 1 } }
[time]
order = 2
end = 1
step = 0.3
"#;

/// The same case with a boundary that rests in the place of the one that moves.
fn at_rest() -> String {
    BASE.replace("left = { displacement = [\"4*a*t*y*(1 - y)\", 0] }", "left = \"fixed\"")
}

fn check_text(text: &str, options: &[&str]) -> Result<AnyCase, Box<CaseError>> {
    let options: Vec<String> = options.iter().map(|option| (*option).to_owned()).collect();
    AnyCase::check(&Document::parse(Path::new("dir/base.toml"), text.to_owned(), &options)?)
}

fn plane(text: &str, options: &[&str]) -> Case<2> {
    match check_text(text, options) {
        Ok(AnyCase::Plane(case)) => *case,
        Ok(AnyCase::Space(_)) => panic!("three dimensions"),
        Err(error) => panic!("{error}"),
    }
}

/// The message for BASE with the line that starts with `key` replaced.
fn message_with(line: &str, replacement: &str) -> String {
    let number = BASE.lines().position(|l| l.starts_with(line)).unwrap_or_else(|| panic!("no line {line}"));
    let text: Vec<&str> = BASE.lines().enumerate().map(|(i, l)| if i == number { replacement } else { l }).collect();
    check_text(&text.join("\n"), &[]).unwrap_err().to_string()
}

fn case_files() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let mut files: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    assert!(files.len() >= 6, "{files:?}");
    files
}
