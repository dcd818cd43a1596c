//! Existing output directories: a run is replaced only with `--force`, and the source of a restart never.

#![cfg(unix)]
#![allow(clippy::unwrap_used)]

mod common;

use common::{Outcome, contents, on_case, summary};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use tempfile::TempDir;

/// A vortex on 4 cells, 2 slabs.
const SMALL: [&str; 5] =
    ["mesh.order=2", "mesh.generate.box.cells=[2,2]", "flow.order=2", "time.step=0.1", "time.end=0.2"];

/// Parts of the message about a run that is not replaced.
const REMEDIES: [&str; 4] = ["it is not replaced unasked", "--force", "`--output`", "stsolve report run"];

/// Calls `command` on the small vortex with `changes`, into `output`.
fn call(directory: &TempDir, command: &str, changes: &[&str], output: &str, extra: &[&str]) -> Outcome {
    on_case(directory.path(), command, "vortex", &[&SMALL[..], changes].concat(), output, extra)
}

/// A finished run in the folder `run`.
fn finished() -> TempDir {
    let directory = TempDir::new().unwrap();
    call(&directory, "run", &[], "run", &[]).expect(0, &[]);
    directory
}

/// The outcome is code 2 with `parts` in the message, and no file in `run` has changed.
fn assert_refused(run: &Path, outcome: impl FnOnce() -> Outcome, parts: &[&str]) {
    let before = contents(run);
    outcome().expect(2, parts);
    assert!(contents(run) == before, "a file has changed");
}

#[test]
fn a_finished_run_was_replaced_without_a_word() {
    let directory = finished();
    let run = directory.path().join("run");
    for command in ["run", "motion"] {
        let parts = [&REMEDIES[..], &["`run` holds a finished run, t = 0.2;"]].concat();
        assert_refused(&run, || call(&directory, command, &[], "run", &[]), &parts);
        // The mesh alone does not go on where the flow stands.
        let advised = call(&directory, command, &[], "run", &[]).stderr;
        assert_eq!(advised.contains("go on to a later `time.end`: stsolve run"), command == "run", "{advised}");
        assert_eq!(advised.contains("--resume"), command == "run", "{advised}");
    }
    let both = || call(&directory, "run", &[], "run", &["--force", "--resume"]);
    assert_refused(&run, both, &["cannot be used with"]);
    call(&directory, "run", &["time.end=0.3"], "run", &["--force"]).expect(0, &[]);
    assert_eq!((&summary(&run)["slabs"], &summary(&run)["completed"]), (&3.into(), &true.into()));
    call(&directory, "run", &["time.end=0.3"], "run", &["--resume"]).expect(0, &[]);
    assert_eq!(summary(&run)["slabs"], 3, "a finished run that is resumed stays as it is");
}

/// A failed run is likely to be repeated with a better case.
#[test]
fn an_unfinished_run_was_replaced_without_a_word() {
    let directory = TempDir::new().unwrap();
    let run = directory.path().join("run");
    let fails = ["solver.newton_steps=1", "solver.slab_halvings=0"];
    call(&directory, "run", &fails, "run", &[]).expect(1, &[]);
    let parts = ["holds an unfinished run, t = 0 (", "go on from its last checkpoint: stsolve run"];
    assert_refused(&run, || call(&directory, "run", &[], "run", &[]), &[&REMEDIES[..], &parts].concat());
    call(&directory, "run", &[], "run", &["--force"]).expect(0, &[]);
    assert!(!run.join("failure").exists(), "that of the run before");
}

/// A run killed before its first checkpoint leaves its history only.
#[test]
fn the_history_of_a_killed_run_was_replaced_without_a_word() {
    let directory = TempDir::new().unwrap();
    let run = directory.path().join("run");
    fs::create_dir_all(&run).unwrap();
    fs::write(run.join("history.csv"), "t,dt,newton_steps\n0.1,0.1,3\n").unwrap();
    let parts = ["holds an unfinished run, t = 0.1, without a checkpoint;"];
    assert_refused(&run, || call(&directory, "run", &[], "run", &[]), &[&REMEDIES[..], &parts].concat());
    call(&directory, "run", &[], "run", &["--force"]).expect(0, &[]);
}

#[test]
fn a_run_of_the_mesh_alone_is_not_replaced_either() {
    let directory = TempDir::new().unwrap();
    call(&directory, "motion", &[], "run", &[]).expect(0, &[]);
    let run = directory.path().join("run");
    let again = || call(&directory, "run", &[], "run", &[]);
    assert_refused(&run, again, &["holds a finished run of the mesh alone, t = 0.2;"]);
    // Killed runs have no summary.
    fs::remove_file(run.join("summary.json")).unwrap();
    assert_refused(&run, again, &["holds an unfinished run of the mesh alone, t = 0.2;"]);
    for (command, resumes) in [("run", false), ("motion", true)] {
        let advised = call(&directory, command, &[], "run", &[]).stderr;
        assert_eq!(advised.contains("--resume"), resumes, "{command}: {advised}");
    }
}

#[test]
fn a_restart_destroyed_the_run_from_which_it_started() {
    let directory = finished();
    let run = directory.path().join("run");
    symlink("run", directory.path().join("link")).unwrap();
    symlink(run.join("result.vtkhdf"), directory.path().join("linked.vtkhdf")).unwrap();
    for source in ["run", "run/result.vtkhdf", "link", "linked.vtkhdf", "run/../run"] {
        let from = format!("restart.from={}", directory.path().join(source).display());
        for (output, extra) in
            [("run", &[][..]), ("run", &["--force"]), ("link", &["--force"]), ("./run/.", &["--force"])]
        {
            let restart = || call(&directory, "run", &["time.end=0.3", &from], output, extra);
            assert_refused(&run, restart, &["would destroy its own source", "`--output`"]);
        }
        let resumed = || call(&directory, "run", &["time.end=0.3", &from], "run", &["--resume"]);
        assert_refused(&run, resumed, &["the checkpoint of another case"]);
    }
    let from = format!("restart.from={}", run.display());
    let elsewhere = || call(&directory, "run", &["time.end=0.3", &from], "other", &[]);
    elsewhere().expect(0, &[]);
    assert_eq!(summary(&directory.path().join("other"))["slabs"], 3);
}

#[test]
fn files_of_others_stay() {
    let directory = TempDir::new().unwrap();
    let run = directory.path().join("run");
    fs::create_dir_all(run.join("failure")).unwrap();
    fs::write(run.join("failure/mine.txt"), "mine").unwrap();
    fs::write(run.join("notes.txt"), "mine").unwrap();
    fs::write(run.join("history.csv"), "date,price\n1,2\n").unwrap();
    fs::write(run.join("summary.json"), r#"{"total": 3}"#).unwrap();
    for name in ["history.csv", "summary.json"] {
        let foreign = || call(&directory, "run", &[], "run", &[]);
        assert_refused(&run, foreign, &[&format!("`run/{name}` was not written by stsolve")]);
        fs::remove_file(run.join(name)).unwrap();
    }
    call(&directory, "run", &[], "run", &[]).expect(0, &[]);
    call(&directory, "run", &[], "run", &["--force"]).expect(0, &[]);
    for name in ["failure/mine.txt", "notes.txt"] {
        assert_eq!(fs::read_to_string(run.join(name)).unwrap(), "mine");
    }
}
