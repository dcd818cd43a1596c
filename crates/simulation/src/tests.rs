//! A run that is called from a program: no command line, no terminal.
#![allow(clippy::unwrap_used)]

use super::*;
use case::{AnyCase, Document};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

const CASE: &str = r#"
mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], periodic = ["x", "y"] } }
flow = { order = 2, initial.uniform = { velocity = [0.5, 0], pressure = 1 } }
time = { order = 1, end = 0.3, slabs = 3 }
"#;

fn case() -> AnyCase {
    AnyCase::check(&Document::parse(Path::new("stream.toml"), CASE.to_owned(), &[]).unwrap()).unwrap()
}

/// Counts slabs, and asks to stop after some.
struct Counter {
    slabs: AtomicUsize,
    most: usize,
}

impl Counter {
    fn stopping_after(most: usize) -> Self {
        Counter { slabs: AtomicUsize::new(0), most }
    }
    fn slabs(&self) -> usize {
        self.slabs.load(Ordering::Relaxed)
    }
}

impl Observer for Counter {
    fn slab(&self, _slab: &SlabDone) {
        self.slabs.fetch_add(1, Ordering::Relaxed);
    }
    fn is_stop_requested(&self) -> bool {
        self.slabs() == self.most
    }
}

#[test]
fn a_program_stops_a_run_and_resumes_it() {
    let directory = tempfile::tempdir().unwrap();
    let mut destination = Destination { directory: directory.path().join("run"), existing: Existing::Keep };
    let first = Counter::stopping_after(1);
    assert!(matches!(run(&case(), &destination, &first), Err(Failure::Stopped)));

    let refused = run(&case(), &destination, &()).unwrap_err().to_string();
    assert!(refused.contains("`Existing::Resume`") && refused.contains("choose another directory"), "{refused}");

    destination.existing = Existing::Resume;
    let second = Counter::stopping_after(3);
    let summary = run(&case(), &destination, &second).unwrap();
    assert_eq!((first.slabs(), second.slabs(), summary.slabs, summary.completed), (1, 2, 3, true));
}

#[test]
fn a_case_that_names_no_directory_writes_into_one_of_its_name() {
    let destination = Destination::of(&case());
    assert_eq!((destination.directory.as_path(), destination.is_resumed()), (Path::new("runs/stream"), false));
}
