//! A flow that the mesh does not resolve goes on in a split form when a slab cannot be solved.

#![allow(clippy::unwrap_used)]

mod common;

use case::AnyCase;
use common::{assert_conserves, assert_same_bits, column, number, shipped, stsolve, summary};
use ranks::Threads;
use serde_json::Value;
use simulation::{Destination, Existing, Failure, Observer, SlabDone, WarningSink};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use tempfile::TempDir;

/// A shear layer on 64 cells with the default quadrature: a slab fails at t = 1.5. Parts of it could be solved.
const LAYER: [&str; 9] = [
    "mesh.generate.box.cells=[8,8]",
    "flow.order=3",
    "flow.quadrature=conserving",
    "flow.volume_flux=central",
    "time.step=0.05",
    "time.end=2",
    "output.every=10",
    "output.checkpoint_every=4",
    "output.fields=[\"density\"]",
];

/// A layer of order 2, at which the highest modes tell nothing: a slab fails at t = 2.7, and parts of it are solved.
const LAYER_IN_PARTS: [&str; 3] = ["mesh.generate.box.cells=[6,6]", "flow.order=2", "time.end=3"];

/// Keeps the messages of a run, and asks it to stop after the first slab that ends later than a time.
struct Watch {
    stop_after: f64,
    is_due: AtomicBool,
    messages: Arc<Mutex<String>>,
}

impl Watch {
    fn new(stop_after: f64) -> Self {
        Watch { stop_after, is_due: AtomicBool::new(false), messages: Arc::default() }
    }
}

impl Observer for Watch {
    fn slab(&self, slab: &SlabDone) {
        self.is_due.fetch_or(slab.time > self.stop_after, Ordering::Relaxed);
    }
    fn warnings(&self) -> Option<WarningSink> {
        let messages = self.messages.clone();
        Some(Box::new(move |message| *messages.lock().unwrap() += message))
    }
    fn is_stop_requested(&self) -> bool {
        self.is_due.load(Ordering::Relaxed)
    }
}

fn layer(more: &[&str]) -> AnyCase {
    let changes: Vec<String> = LAYER.iter().chain(more).map(|&change| change.to_owned()).collect();
    AnyCase::read(Path::new(&shipped("kelvin_helmholtz.toml")), &changes).unwrap()
}

fn run(directory: &Path, more: &[&str], existing: Existing, observer: &dyn Observer) -> Result<(), Failure> {
    let destination = Destination { directory: directory.to_owned(), existing };
    simulation::run(&layer(more), &destination, observer).map(drop)
}

#[test]
fn a_run_goes_back_and_on_in_a_split_form_and_says_so() {
    let (directory, watch) = (TempDir::new().unwrap(), Watch::new(f64::INFINITY));
    let at = directory.path();
    run(at, &[], Existing::Keep, &watch).unwrap();
    let messages = watch.messages.lock().unwrap().clone();
    for part in ["slab ", "does not resolve the flow", "goes on from t = 1.5 in a split form"] {
        assert!(messages.contains(part), "{messages}");
    }
    let page = std::fs::read_to_string(report::write(at).unwrap().path).unwrap();
    assert!(page.contains("does not resolve the flow: in a split form from t = 1.5"));
    let summary = summary(at);
    assert_eq!((number(&summary, "split_form_since"), number(&summary, "slabs")), (1.5, 40.0));
    assert_conserves(&summary);
    // The mesh does not resolve the flow, so nothing else was tried.
    assert_eq!((number(&summary, "rejected_slabs"), column(at, "rejected").iter().sum()), (1.0, 1.0));
    assert!(number(&summary, "cost.jacobian_products") > number(&summary, "krylov.total"));
}

#[test]
fn a_run_that_has_tried_parts_of_a_slab_forgets_them_but_for_their_cost() {
    let (directory, watch) = (TempDir::new().unwrap(), Watch::new(f64::INFINITY));
    let at = directory.path();
    run(at, &LAYER_IN_PARTS, Existing::Keep, &watch).unwrap();
    let messages = watch.messages.lock().unwrap().clone();
    assert!(messages.contains("goes on from t = 2.7 in a split form"), "{messages}");
    let times = column(at, "t");
    assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - 0.05).abs() < 1e-9), "the parts of the slab are gone");
    let (summary, rejected) = (summary(at), column(at, "rejected"));
    assert_eq!((number(&summary, "split_form_since"), number(&summary, "slabs")), (2.7, 60.0));
    // With the parts of the slab that were tried.
    assert!(rejected.iter().sum::<f64>() > 5.0 && number(&summary, "rejected_slabs") == rejected.iter().sum::<f64>());
    assert_conserves(&summary);
    // So do their products count, as in a run that ends there.
    let (ended, alone) = (TempDir::new().unwrap(), [&LAYER_IN_PARTS[..], &["solver.fallback=none"]].concat());
    run(ended.path(), &alone, Existing::Keep, &Watch::new(f64::INFINITY)).unwrap_err();
    let wasted = |summary: &Value| number(summary, "cost.jacobian_products") - number(summary, "krylov.total");
    let [with, without] = [&summary, &common::summary(ended.path())].map(wasted);
    assert!(with >= without && without > 50.0, "{with} and {without} products for attempts that were rejected");
}

/// The warning blamed the mesh, also if too few Newton steps were allowed.
#[test]
fn too_few_newton_steps_are_named() {
    let (directory, watch) = (TempDir::new().unwrap(), Watch::new(f64::INFINITY));
    let few = ["solver.newton_steps=2", "solver.slab_halvings=0", "time.end=0.05"];
    // Whether two steps are enough in the split form does not matter.
    drop(run(directory.path(), &few, Existing::Keep, &watch));
    let messages = watch.messages.lock().unwrap().clone();
    assert!(messages.contains("too few Newton steps are allowed"), "{messages}");
    assert!(
        messages.contains("raise `solver.newton_steps`, now 2") && !messages.contains("does not resolve"),
        "{messages}"
    );
}

/// The balances hold on a curved mesh that moves too, where the two quadratures measure other masses.
#[test]
fn the_balances_hold_on_a_curved_mesh_that_moves() {
    let directory = TempDir::new().unwrap();
    let motion = "motion.displacement=[\"0.05*sin(pi*y)*sin(t)\",\"0.05*sin(pi*x)*sin(2*t)\"]";
    let curved = ["mesh.generate.box.curving={wavy={amplitude=0.03}}", "mesh.order=3", motion];
    run(directory.path(), &curved, Existing::Keep, &()).unwrap();
    let summary = summary(directory.path());
    assert!(summary.get("split_form_since").is_some());
    assert!(number(&summary, "conservation.mass_error") < 1e-12, "{summary}");
}

#[test]
fn a_case_may_forbid_it() {
    let directory = TempDir::new().unwrap();
    let failed = run(directory.path(), &["solver.fallback=none"], Existing::Keep, &());
    assert!(matches!(failed, Err(Failure::Solve(_))), "{failed:?}");
    assert!(summary(directory.path()).get("split_form_since").is_none());
    let reached = *column(directory.path(), "t").last().unwrap();
    assert!(reached > 1.5, "the parts of the slab that could be solved stay");
}

/// Before the slab that fails, among its parts, just after them, and later.
#[test]
fn a_run_that_is_interrupted_has_the_same_bits() {
    let directory = TempDir::new().unwrap();
    let at = |name: &str| directory.path().join(name);
    for (layer, times) in [(&[][..], &[1.4, 1.51, 1.7][..]), (&LAYER_IN_PARTS, &[2.6, 2.71, 2.73, 2.8])] {
        let through = format!("through {}", times[0]);
        run(&at(&through), layer, Existing::Keep, &()).unwrap();
        for time in times {
            let name = time.to_string();
            let stopped = run(&at(&name), layer, Existing::Keep, &Watch::new(*time));
            assert!(matches!(stopped, Err(Failure::Stopped)), "{time}: {stopped:?}");
            run(&at(&name), layer, Existing::Resume, &()).unwrap();
            assert_same_bits(&at(&through), &at(&name), &format!("interrupted after {time}"));
        }
    }
}

/// On 1, 2 and 3 ranks.
#[test]
fn ranks_go_on_in_a_split_form_together() {
    let directory = TempDir::new().unwrap();
    let at = |ranks: usize| directory.path().join(ranks.to_string());
    for ranks in [1, 2, 3] {
        let results = Threads::run(ranks, |communicator| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            pool.install(|| {
                let case = layer(&["parallel.blocks=3"]);
                if communicator.rank() > 0 {
                    simulation::serve(&case, &communicator);
                    return Ok(());
                }
                let destination = Destination { directory: at(ranks), existing: Existing::Keep };
                simulation::run_on(communicator, &case, &destination, &()).map(drop)
            })
        });
        results.into_iter().next().unwrap().unwrap();
        assert_same_bits(&at(1), &at(ranks), &format!("{ranks} ranks"));
    }
    assert_eq!(number(&summary(&at(3)), "split_form_since"), 1.5);
}

/// A cylinder on springs in a flow of Mach number 0.6 that its mesh does not resolve: gas and body keep their energy together.
#[test]
fn a_body_that_the_flow_moves_goes_on_too() {
    let directory = TempDir::new().unwrap();
    let set = ["flow.gas.mach=0.6", "flow.gas.viscosity.constant=1e-5", "time.end=2.4", "output.fields=[]"]
        .map(str::to_owned);
    let case = AnyCase::read(Path::new(&shipped("cylinder_viv.toml")), &set).unwrap();
    let destination = Destination { directory: directory.path().to_owned(), existing: Existing::Keep };
    simulation::run(&case, &destination, &()).unwrap();
    let summary = summary(directory.path());
    assert!(summary.get("split_form_since").is_some(), "{summary}");
    assert!(number(&summary, "conservation.coupled_energy_error") < 1e-11, "{summary}");
}

/// A shock at M = 3 that stands between cells at the start. No slab of the default form can be solved, and the run ended at once.
const SHOCK: &str = r#"
    mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 0.1], cells = [10, 1], periodic = ["y"] } }
    time = { order = 2, end = 5e-4, slabs = 4 }
    [flow]
    order = 3
    gas = { gamma = "5/3", gas_constant = 208 }
    reference = { density = 1.6025641025641026, speed = 967.4709297958259, pressure = 1e5, length = 1 }
    shock_capturing = {}
    boundary.others = "exact"
    [flow.exact.expression]
    density = "if(x < 0.51 + 50*t, 1.6025641025641026, 4.807692307692308)"
    velocity = ["if(x < 0.51 + 50*t, 1017.4709297958259, 372.49030993194197)", 0]
    pressure = "if(x < 0.51 + 50*t, 1e5, 1.1e6)"
"#;

#[test]
fn a_first_slab_that_cannot_be_solved_is_solved_in_a_split_form() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), SHOCK).unwrap();
    let outcome = stsolve(directory.path(), &["run", "case.toml", "--output", "run"]);
    outcome.expect(0, &["goes on from t = 0 in a split form"]);
    let (run, rejected) = (directory.path().join("run"), column(&directory.path().join("run"), "rejected"));
    assert_eq!((number(&summary(&run), "split_form_since"), rejected.len()), (0.0, 4));
    // The balances began with nothing, and were no numbers.
    assert!(column(&run, "mass_error").iter().all(|error| error.abs() < 1e-10));
    // All attempts count: the halves were lost with the checkpoint.
    assert!(
        rejected[0] > 2.0 && number(&summary(&run), "rejected_slabs") == rejected.iter().sum::<f64>(),
        "{rejected:?}"
    );
}
