//! Starts from a uniform state: at no-slip walls the velocity jumps.

#![allow(clippy::unwrap_used)]

mod common;

use case::AnyCase;
use common::{assert_conserves, assert_same_bits, column, finished, number, on_case, shipped, summary};
use serde_json::Value;
use simulation::{Destination, Existing, Failure, Observer};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::TempDir;

/// A cylinder at Re = 1e4 and M = 0.4 that stands in a uniform flow at once: with long slabs and coarse cells Newton's method does not solve
/// the first slab.
const SUDDEN: [&str; 10] = [
    "mesh.generate.annulus={ inner_radius = 0.5, outer_radius = 50, first_cell = 0.02, cells = [24, 16] }",
    "mesh.order=4",
    "flow.order=4",
    "flow.gas={ gamma = 1.4, prandtl = 0.72, mach = 0.4, viscosity = { constant = 1e-4 } }",
    "flow.reference={ density = 1, speed = 1, pressure = 4.464285714285714 }",
    "flow.initial={ uniform = { velocity = [1, 0], mach = 0.4 } }",
    "flow.boundary.far={ far_field = { velocity = [1, 0], mach = 0.4 } }",
    "time.order=2",
    "time.step=0.05",
    "time.end=0.2",
];

fn sudden(directory: &Path, more: &[&str]) -> Value {
    finished(directory, "cylinder_street", &[&SUDDEN[..], more].concat())
}

/// One attempt fails, at little cost, and the next one begins with a layer. The layer is not the whole flow: mass and energy balance from it on.
#[test]
fn a_sudden_start_is_made_easier_by_a_layer_at_the_wall() {
    let directory = TempDir::new().unwrap();
    let summary = sudden(directory.path(), &[]);
    assert_eq!((&summary["rejected_slabs"], &summary["slabs"]), (&1.into(), &4.into()));
    assert!((number(&summary, "start_layer") - 0.3).abs() < 1e-12);
    let (products, krylov) = (number(&summary, "cost.jacobian_products"), number(&summary, "krylov.total"));
    assert!(krylov > 0.7 * products, "{krylov} Krylov iterations of {products} products were of use");
    assert_conserves(&summary);
}

/// The program uses the layer that a case sets.
#[test]
fn the_layer_may_be_given() {
    let directory = TempDir::new().unwrap();
    let last_force = |more: &[&str]| {
        sudden(directory.path(), more);
        *column(&directory.path().join("cylinder_street"), "wall_force_x").last().unwrap()
    };
    let (found, given) = (last_force(&[]), last_force(&["solver.start_layer=0.3"]));
    assert!((found / given - 1.0).abs() < 1e-3, "{found} and {given}");
    let thin = last_force(&["solver.start_layer=0.2"]);
    assert!((thin / given - 1.0).abs() > 1e-2, "{thin} and {given}");
}

/// Without a layer the slab is halved.
#[test]
fn no_layer_where_the_case_forbids_it() {
    let directory = TempDir::new().unwrap();
    let set = [&SUDDEN[..], &["solver.start_layer=0", "time.end=0.05"]].concat();
    on_case(directory.path(), "run", "cylinder_street", &set, "run", &[]);
    let summary = summary(&directory.path().join("run"));
    assert!(summary.get("start_layer").is_none() && number(&summary, "rejected_slabs") >= 1.0, "{summary}");
}

/// The layer destroyed initial states that have the velocity of the walls, as soon as their first slab was not solved.
#[test]
fn a_state_that_fits_the_walls_keeps_its_velocity() {
    let directory = TempDir::new().unwrap();
    let set = ["solver.newton_steps=1", "solver.newton_tolerance=1e-13", "solver.slab_halvings=0"];
    let outcome = on_case(directory.path(), "run", "couette", &set, "run", &[]);
    outcome.expect(1, &["too few Newton steps are allowed"]);
    assert!(!outcome.stderr.contains("boundary layer"), "{}", outcome.stderr);
}

/// Asks for a stop when it is asked for the second time: after the first attempt at the first slab.
#[derive(Default)]
struct AfterOneAttempt(AtomicUsize);

impl Observer for AfterOneAttempt {
    fn is_stop_requested(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) > 0
    }
}

/// A resumed run took the layer for the initial state: it had other bits, and the energy of the layer was missing from its balance.
#[test]
fn a_run_that_is_stopped_before_its_first_slab_resumes_with_the_same_bits() {
    let (directory, changes) = (TempDir::new().unwrap(), SUDDEN.map(str::to_owned));
    let case = AnyCase::read(Path::new(&shipped("cylinder_street.toml")), &changes).unwrap();
    let at = |name: &str| directory.path().join(name);
    let run = |name: &str, existing, observer: &dyn Observer| {
        simulation::run(&case, &Destination { directory: at(name), existing }, observer).map(drop)
    };
    run("whole", Existing::Keep, &()).unwrap();
    assert!(matches!(run("stopped", Existing::Keep, &AfterOneAttempt::default()), Err(Failure::Stopped)));
    assert_eq!(number(&summary(&at("stopped")), "slabs"), 0.0);
    run("stopped", Existing::Resume, &()).unwrap();
    assert_same_bits(&at("whole"), &at("stopped"), "resumed within the first slab");
    let layers = ["whole", "stopped"].map(|name| number(&summary(&at(name)), "start_layer"));
    assert_eq!(layers[0], layers[1]);
    assert_conserves(&summary(&at("stopped")));
}
