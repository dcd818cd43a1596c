//! The command as a user meets it: exit codes, messages, files.

#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;

mod bench;
mod check;
mod refusals;
mod warnings;

use common::{shipped, stsolve};
use std::path::Path;
use tempfile::TempDir;

/// Calls the program in `directory`; exit code, stdout, stderr.
fn outcome(directory: &Path, arguments: &[&str]) -> (i32, String, String) {
    let common::Outcome { code, stdout, stderr } = stsolve(directory, arguments);
    (code, stdout, stderr)
}

fn is_empty(directory: &TempDir) -> bool {
    std::fs::read_dir(directory.path()).unwrap().next().is_none()
}

#[test]
fn the_schema_is_valid_json_and_lists_the_sections() {
    let (code, stdout, _) = outcome(Path::new("."), &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(code, 0);
    for section in ["title", "constants", "mesh", "motion", "flow", "time", "solver", "output"] {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

#[test]
fn completions_know_every_command_and_option() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let (code, stdout, stderr) = outcome(Path::new("."), &["completions", shell]);
        assert_eq!((code, stderr.as_str()), (0, ""), "{shell}");
        for word in ["run", "motion", "check", "info", "schema", "completions", "output", "threads", "resume"] {
            assert!(stdout.contains(word), "{shell}: no {word}");
        }
    }
    assert_eq!(outcome(Path::new("."), &["completions", "csh"]).0, 2);
}

#[test]
fn what_goes_into_a_pipe_is_plain_text() {
    let directory = TempDir::new().unwrap();
    let case = shipped("free_stream.toml");
    let short = ["--set", "time.end=0.1", "--set", "time.slabs=1"];
    let run = [&["run", &case, "--output", "run"][..], &short].concat();
    let motion = [&["motion", &case, "--output", "motion"][..], &short].concat();
    for arguments in [&run[..], &motion, &["check", &case], &["schema"], &["info", "run/result.vtkhdf"], &["--help"]] {
        let (code, stdout, stderr) = outcome(directory.path(), arguments);
        assert_eq!(code, 0, "{arguments:?}: {stderr}");
        assert!(!stdout.is_empty() || !stderr.is_empty(), "{arguments:?}");
        for text in [stdout, stderr] {
            assert!(!text.contains(['\x1b', '\r', '\x08']), "{arguments:?}: {text:?}");
        }
    }
    assert!(outcome(directory.path(), &run).1.is_empty(), "results are for files, progress is for stderr");
}
