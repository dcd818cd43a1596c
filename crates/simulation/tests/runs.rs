//! A run that is called from a program: no command line, no terminal. As a program of its own it takes the solver that is compiled already.
#![allow(clippy::unwrap_used)]

use case::{AnyCase, Document};
use simulation::{Destination, Existing, Failure, Observer, SlabDone, run};
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

/// A steady flow along a wall, and a bar beside gas that finds its equilibrium.
const SEARCHES: [&str; 2] = [
    r#"
mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [3, 3] } }
time = { order = 1, end = 0.1, slabs = 1 }
solver.steady.stability_time = 1
[flow]
order = 2
gas = { gamma = 1.4, prandtl = 0.72, viscosity.constant = 0.025 }
initial.uniform = { velocity = [0.5, 0], pressure = 1 }
boundary = { bottom.adiabatic_wall = {}, others.far_field = { velocity = [0.5, 0], pressure = 1 } }
"#,
    r#"
mesh = { order = 2, generate.box = { lower = [-1, 0], upper = [1, 0.1], cells = [4, 1], regions = { bar = { lower = [-1, 0], upper = [0, 0.1] } } } }
motion.boundary = { bottom = "slide", top = "slide", others = "fixed" }
time = { order = 1, end = 0.1, slabs = 1 }
solver.steady.bodies = "equilibrium"
flow = { order = 2, initial.uniform = { velocity = [0, 0], pressure = 1 }, reference = { density = 1, speed = 1, pressure = 1 }, boundary.others = "slip_wall" }
[structure]
regions = ["bar"]
density = 10
young_modulus = 100
poisson_ratio = 0
boundary = { left = "fixed", bottom = { held = ["y"] }, top = { held = ["y"] } }
"#,
];

/// Asks to stop, but not before it was asked so often.
struct Patience(AtomicUsize);

impl Observer for Patience {
    fn is_stop_requested(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

/// A signal was heard when the search had ended, after hours perhaps.
#[test]
fn a_search_that_is_stopped_begins_again_with_the_same_bits() {
    for text in SEARCHES {
        let case = AnyCase::check(&Document::parse(Path::new("search.toml"), text.to_owned(), &[]).unwrap()).unwrap();
        let runs = tempfile::tempdir().unwrap();
        let run_in = |name: &str, existing, observer: &dyn Observer| {
            let directory = runs.path().join(name);
            let summary = run(&case, &Destination { directory: directory.clone(), existing }, observer);
            (summary.map(|summary| summary.slabs), std::fs::read_to_string(directory.join("history.csv")).unwrap())
        };
        let (slabs, history) = run_in("through", Existing::Keep, &());
        assert_eq!((slabs.unwrap(), history.lines().count()), (1, 3), "{history}");
        let mut stops = 0;
        for patience in [0, 1, 2, 5, 8, 13, 21, 1000] {
            let existing = if patience == 0 { Existing::Keep } else { Existing::Resume };
            match run_in("stopped", existing, &Patience(AtomicUsize::new(patience))) {
                (Err(Failure::Stopped), stopped) => stops += usize::from(stopped.lines().count() == 1),
                (Err(other), _) => panic!("{other}"),
                (Ok(_), completed) => assert_eq!(completed, history),
            }
        }
        assert!(stops >= 4, "{stops} stops in the search");
    }
}

#[test]
fn a_case_that_names_no_directory_writes_into_one_of_its_name() {
    let destination = Destination::of(&case());
    assert_eq!((destination.directory.as_path(), destination.is_resumed()), (Path::new("runs/stream"), false));
}
