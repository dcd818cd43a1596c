//! Checkpoints that cannot be continued: exit code 2, the file and the remedy named, nothing overwritten.

#![allow(clippy::unwrap_used)]

mod common;

use common::{contents, on_case};
use std::fs;
use tempfile::TempDir;

const SHORT: [&str; 3] = ["mesh.generate.box.cells=[3,3]", "time.step=0.1", "time.end=0.2"];

/// The files of a finished run, in the folder `run`.
fn finished() -> TempDir {
    let directory = TempDir::new().unwrap();
    on_case(directory.path(), "run", "vortex", &SHORT, "run", &[]).expect(0, &[]);
    directory
}

/// `command` with `changes` refuses to continue `directory`, with all `parts` in the message; no file changes.
fn assert_refused(directory: &TempDir, command: &str, changes: &[&str], parts: &[&str]) {
    let run = directory.path().join("run");
    let before = contents(&run);
    let set = [&SHORT[..], &["time.end=0.4"], changes].concat();
    let outcome = on_case(directory.path(), command, "vortex", &set, "run", &["--resume"]);
    outcome.expect(2, &["`run/result.vtkhdf`"]);
    outcome.expect(2, parts);
    assert!(contents(&run) == before, "a file has changed");
}

#[test]
fn a_torn_checkpoint_is_refused() {
    let directory = finished();
    let path = directory.path().join("run/result.vtkhdf");
    let whole = fs::read(&path).unwrap();
    let todo = "restore it from a copy, or run the case anew";
    for length in [0, 10, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        assert_refused(&directory, "run", &[], &["is damaged: its end is missing", todo]);
    }
    for position in [0, whole.len() / 3, whole.len() / 2, whole.len() - 100] {
        let mut flipped = whole.clone();
        flipped[position] ^= 0x10;
        fs::write(&path, &flipped).unwrap();
        assert_refused(&directory, "run", &[], &["is damaged: its contents do not match its checksum", todo]);
    }
    fs::write(&path, &whole).unwrap();
    let set = [&SHORT[..], &["time.end=0.4"]].concat();
    on_case(directory.path(), "run", "vortex", &set, "run", &["--resume"]).expect(0, &[]);
}

#[test]
fn the_checkpoint_of_another_case_is_refused() {
    let directory = finished();
    let todo = "resume with the case that started the run, or choose another output directory";
    for (change, difference) in [
        ("flow.order=5", "`flow.order` was 4 and is 5"),
        ("time.step=0.05", "`time.step` was 0.1 and is 0.05"),
        ("constants.stretch=0.2", "`constants.stretch` was"),
        ("output.fields=[\"pressure\"]", "`output.fields` was"),
    ] {
        let parts = ["is the checkpoint of another case: ", difference, "`[solver]`", todo];
        assert_refused(&directory, "run", &[change], &parts);
    }
}

#[test]
fn a_run_of_the_mesh_alone_does_not_continue_one_with_a_flow() {
    assert_refused(&finished(), "motion", &[], &["is the checkpoint of another case", "moved alone"]);
}

/// The end, the solver and the intervals of output may change; the result then holds the new case.
#[test]
fn a_run_goes_on_with_another_solver() {
    let directory = finished();
    let changes = ["time.end=0.4", "solver.newton_tolerance=1e-10", "solver.krylov_restart=7", "output.every=2"];
    let set = [&SHORT[..], &changes].concat();
    on_case(directory.path(), "run", "vortex", &set, "run", &["--resume"]).expect(0, &[]);
    let result = directory.path().join("run/result.vtkhdf");
    let case = output::read_checkpoint(&result).unwrap().0.case_text;
    assert!(case.contains("newton_tolerance = 0.0000000001") && case.contains("end = 0.4"), "{case}");
    assert_eq!(output::inspect(&result).unwrap().times.len(), 4, "the start, two slabs, the last of two more");
    let log = fs::read_to_string(directory.path().join("run/log.jsonl")).unwrap();
    assert!(log.contains("`solver.krylov_restart` was") && log.contains("and is 7"), "{log}");
}

#[test]
fn without_a_checkpoint_there_is_nothing_to_resume() {
    let directory = TempDir::new().unwrap();
    fs::create_dir(directory.path().join("run")).unwrap();
    assert_refused(&directory, "run", &[], &["does not exist", "start without resuming"]);
}
