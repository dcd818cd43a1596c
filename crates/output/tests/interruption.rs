//! A run killed at any moment leaves a complete result; a run directory belongs to one process at a time.
//!
//! The killed process is this test program itself, started again with the name of one ignored test.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use common::{append, contents, layout, metadata, run, state};
use output::{OutputError, RESULT_FILE, ResultFile, RunDirectory, inspect, read_checkpoint};

const DIRECTORY: &str = "STSOLVE_TEST_DIRECTORY";
const INTERVAL: u64 = 3;

/// Runs until it is killed and prints each slab on its standard output.
#[test]
#[ignore = "the process that the other tests kill"]
#[allow(clippy::print_stdout)]
fn victim() {
    let Ok(path) = std::env::var(DIRECTORY) else {
        return;
    };
    let directory = RunDirectory::open(Path::new(&path)).unwrap();
    let mut result = ResultFile::create(&directory, layout(), &metadata()).unwrap();
    for slab in 1.. {
        append(&mut result, slab);
        if slab % INTERVAL == 0 {
            result.checkpoint(&state(slab)).unwrap();
        }
        println!("slab {slab} done");
    }
}

/// Starts the victim and waits until it has done `slabs` slabs.
fn start(path: &Path, slabs: u64) -> Child {
    let mut victim = Command::new(std::env::current_exe().unwrap())
        .args(["victim", "--exact", "--ignored", "--nocapture"])
        .env(DIRECTORY, path)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let wanted = format!("slab {slabs} done");
    let mut lines = BufReader::new(victim.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.is_ok_and(|line| line.ends_with(&wanted))), "the victim ended early");
    // Its output must not fill the pipe and stop it.
    thread::spawn(move || lines.for_each(drop));
    victim
}

fn kill(mut victim: Child) {
    victim.kill().unwrap();
    victim.wait().unwrap();
}

#[test]
fn a_killed_run_loses_at_most_one_interval() {
    for trial in 0..16 {
        let directory = tempfile::tempdir().unwrap();
        let seen = 4 + trial % 3;
        let victim = start(directory.path(), seen);
        thread::sleep(Duration::from_micros(1700 * trial));
        kill(victim);

        let path = directory.path().join(RESULT_FILE);
        let (_, found) = read_checkpoint(&path).unwrap();
        let slab = found.integers["slab"] as u64;
        assert!(slab + INTERVAL > seen, "slab {slab} is more than one interval behind slab {seen}");
        assert_eq!(inspect(&path).unwrap().times.len() as u64, slab, "as many steps as the state says");

        run(directory.path(), slab, slab + INTERVAL, INTERVAL);
        let through = tempfile::tempdir().unwrap();
        run(through.path(), 0, slab + INTERVAL, slab + INTERVAL);
        assert_eq!(contents(&path), contents(&through.path().join(RESULT_FILE)), "trial {trial}");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1, "nothing else is left");
    }
}

#[test]
fn a_second_run_is_refused_and_told_by_whom() {
    let directory = tempfile::tempdir().unwrap();
    let victim = start(directory.path(), 1);
    let error = RunDirectory::open(directory.path()).unwrap_err();
    assert!(matches!(&error, OutputError::Busy { owner: Some(owner), .. } if owner.pid == victim.id()), "{error:?}");
    assert!(error.to_string().contains(&format!("process {}", victim.id())), "{error}");
    kill(victim);
    // The lock file is still there, the lock is not.
    assert!(directory.path().join("run.lock").exists());
    drop(RunDirectory::open(directory.path()).unwrap());
    assert!(!directory.path().join("run.lock").exists());
}

#[test]
fn a_directory_is_free_again_after_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let first = RunDirectory::open(directory.path()).unwrap();
    assert!(matches!(RunDirectory::open(directory.path()), Err(OutputError::Busy { .. })));
    drop(first);
    RunDirectory::open(directory.path()).unwrap();
}

#[test]
fn a_directory_that_cannot_be_written_is_refused_and_nothing_is_left() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("file");
    fs::write(&file, "").unwrap();
    for path in [file.join("a/b"), "/proc/stsolve/run".into()] {
        let error = RunDirectory::open(&path).unwrap_err();
        assert!(matches!(error, OutputError::Directory { .. }), "{error:?}");
        assert!(error.to_string().contains(&*path.to_string_lossy()), "{error}");
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
}

#[test]
fn directories_made_for_a_run_that_writes_nothing_are_removed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("runs/box");
    let run = RunDirectory::open(&path).unwrap();
    assert!(matches!(ResultFile::resume(&run, &metadata(), &[], |_, _| Ok(())), Err(OutputError::NoCheckpoint { .. })));
    drop(run);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}
