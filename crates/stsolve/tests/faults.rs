//! Seeded faults: for any failure the true cause must be among the three named, and the folder `failure` must be complete.

#![allow(clippy::unwrap_used)]

mod common;

use common::{checkpoint, number, on_case};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// A case with one fault.
struct Fault {
    /// The fault.
    what: &'static str,
    /// The case.
    case: &'static str,
    /// Changes that make it small.
    small: &'static [&'static str],
    /// Changes that make it fail.
    spoil: &'static [&'static str],
    /// The cause to be named.
    cause: &'static str,
}

const BOX: &[&str] = &["mesh.generate.box.cells=[3,3]", "mesh.order=3", "flow.order=3", "solver.slab_halvings=2"];
const CYLINDER: &[&str] = &[
    "mesh.generate.annulus.outer_radius=3",
    "mesh.generate.annulus.cells=[8,3]",
    "mesh.order=3",
    "flow.order=3",
    "solver.slab_halvings=0",
];
const AIRFOIL: &[&str] = &["mesh.order=4", "flow.order=4"];
const DISC: &[&str] =
    &["mesh.order=3", "flow.order=3", "mesh.generate.disc.radial_cells=1", "time.slabs=10", "solver.slab_halvings=2"];

const FAULTS: [Fault; 17] = [
    Fault {
        what: "one Newton step allowed",
        case: "vortex",
        small: BOX,
        spoil: &["solver.newton_steps=1"],
        cause: "newton_steps",
    },
    Fault {
        what: "one Krylov iteration allowed",
        case: "cylinder_steady",
        small: CYLINDER,
        spoil: &["time.order=2", "time.end=10", "solver={slab_halvings=0,krylov_iterations=1,krylov_restart=1}"],
        cause: "linear_solver",
    },
    Fault {
        what: "slabs of a hundred times too long",
        case: "cylinder_steady",
        small: CYLINDER,
        spoil: &[
            "time.order=2",
            "time.end=1000",
            "solver={slab_halvings=0,newton_steps=20,fallback=\"none\"}",
            "flow.gas.viscosity.constant=0.0005",
        ],
        cause: "time_step",
    },
    Fault {
        what: "steady flow in three steps",
        case: "cylinder_steady",
        small: CYLINDER,
        spoil: &["solver.steady.steps=3"],
        cause: "newton_steps",
    },
    Fault {
        what: "transonic flow without shock capturing",
        case: "naca0012_heave",
        small: AIRFOIL,
        spoil: &[
            "flow.gas={viscosity=\"inviscid\"}",
            "flow.initial={uniform={velocity=[1,0],mach=0.85}}",
            "flow.boundary={airfoil=\"slip_wall\",far={far_field={velocity=[1,0],mach=0.85}}}",
            "solver={steady={steps=12}}",
        ],
        cause: "shock",
    },
    Fault {
        what: "far field against the flow",
        case: "vortex",
        small: BOX,
        spoil: &[
            "flow.boundary.others={far_field={density=1,velocity=[-6,0],pressure=1}}",
            "flow.initial={uniform={density=1,velocity=[6,0],pressure=1}}",
        ],
        cause: "boundary_condition",
    },
    Fault {
        what: "far field at another Mach number",
        case: "vortex",
        small: BOX,
        spoil: &["flow.boundary.others={far_field={density=1,velocity=[1,0],mach=0.01}}"],
        cause: "boundary_condition",
    },
    Fault {
        what: "wall that slides at once",
        case: "couette",
        small: BOX,
        spoil: &["flow.boundary.top={isothermal_wall={temperature=0.85,slide=[50,0]}}"],
        cause: "boundary_condition",
    },
    Fault {
        what: "outflow to a vacuum",
        case: "cylinder_steady",
        small: CYLINDER,
        spoil: &["flow.boundary.far={outflow={pressure=1e-4}}", "solver.steady.steps=15"],
        cause: "boundary_condition",
    },
    Fault {
        what: "initial state near vacuum",
        case: "vortex",
        small: BOX,
        spoil: &["flow.initial.expression={density=1,velocity=[0,0],pressure=\"1e-3+100*sin(0.7*x)^2\"}"],
        cause: "near_vacuum",
    },
    Fault {
        what: "initial state with a jump",
        case: "vortex",
        small: BOX,
        spoil: &[
            "flow.initial.expression={density=\"if(x<5,1,0.1)\",velocity=[0,0],pressure=\"if(x<5,1,0.1)\"}",
            "flow.boundary.others=\"slip_wall\"",
            "motion.boundary.others=\"fixed\"",
            "solver.fallback=\"none\"",
        ],
        cause: "steep_initial_state",
    },
    Fault {
        what: "wall that starts at once",
        case: "cylinder_m1",
        small: DISC,
        spoil: &["motion.boundary.wall.displacement=[\"20*t\",0]", "time.end=0.05"],
        cause: "impulsive_motion",
    },
    Fault {
        what: "body that starts at once",
        case: "cylinder_viv",
        small: &["mesh.generate.annulus.cells=[8,5]", "mesh.order=3", "flow.order=3", "solver.slab_halvings=2"],
        spoil: &[
            "bodies.cylinder={walls=[\"wall\"],mass=2,mesh={between={inner=1,outer=15}},y={motion=\"30*t\"}}",
            "time.end=0.4",
        ],
        cause: "impulsive_motion",
    },
    Fault {
        what: "boundary that squeezes the mesh",
        case: "vortex",
        small: BOX,
        spoil: &["constants.stretch=1.5", "time.step=0.4"],
        cause: "deformation",
    },
    Fault {
        what: "displacement that folds",
        case: "couette",
        small: BOX,
        spoil: &["motion.displacement=[\"0.6*sin(pi*x)*sin(pi*y)*sin(2*pi*t)\",0]"],
        cause: "folding_formula",
    },
    Fault {
        what: "displacement that is no number for a while",
        case: "couette",
        small: BOX,
        spoil: &["time.end=1", "motion.displacement=[\"if(abs(t-0.4)<0.1, log(-t), 0)*sin(pi*x)\",0]"],
        cause: "undefined_motion",
    },
    Fault {
        what: "motion too far for one slab",
        case: "vortex",
        small: BOX,
        spoil: &[
            "motion.elasticity.law=\"neo_hookean\"",
            "constants.stretch=1.5",
            "time.step=0.4",
            "solver.slab_halvings=0",
        ],
        cause: "far_in_one_slab",
    },
];

/// Names of the causes in `failure/failure.json`, after a check that the folder is complete and agrees with the message.
fn causes(run: &Path, message: &str) -> Vec<String> {
    let folder = run.join("failure");
    let text = std::fs::read_to_string(folder.join("failure.md")).unwrap();
    let numbers: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("failure.json")).unwrap()).unwrap();
    let causes = numbers["causes"].as_array().unwrap();
    assert!((1..=3).contains(&causes.len()), "{text}");
    let likelihoods: Vec<f64> = causes.iter().map(|cause| number(cause, "likelihood")).collect();
    assert!(likelihoods.is_sorted_by(|a, b| a >= b) && likelihoods.iter().all(|l| (0.0..=1.0).contains(l)));
    assert!(
        message.contains(causes[0]["what"].as_str().unwrap()) && message.contains("failure/failure.md"),
        "{message}"
    );
    for part in ["Remedy: ", "## Last good state", "--resume"] {
        assert!(text.contains(part), "{text}");
    }
    let time = f64::from_bits(checkpoint(run).0["time"][0]);
    assert!((number(&numbers, "last_good_state.time") - time).abs() < 1e-9, "{time}");
    if numbers["worst_cell"].is_object() {
        let svg = std::fs::read_to_string(folder.join("cell.svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("<polygon") && !svg.contains("NaN"), "{svg}");
    }
    causes.iter().map(|cause| cause["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
#[allow(clippy::print_stdout)]
fn the_cause_of_a_seeded_fault_is_named() {
    let directory = TempDir::new().unwrap();
    let (mut named, mut first) = (0, 0);
    for (number, Fault { what, case, small, spoil, cause }) in FAULTS.iter().enumerate() {
        let (set, output) = ([*small, *spoil].concat(), number.to_string());
        let outcome = on_case(directory.path(), "run", case, &set, &output, &[]);
        outcome.expect(1, &["the run stopped at t = ", "likely cause: "]);
        assert!(!outcome.stderr.contains("(not a number)"), "{}", outcome.stderr);
        let causes = causes(&directory.path().join(&output), &outcome.stderr);
        let place = causes.iter().position(|name| name == cause);
        println!(
            "{what:35} {cause:20} {:9} of {}",
            place.map_or("not".into(), |p| format!("number {}", p + 1)),
            causes.join(", ")
        );
        named += usize::from(place.is_some());
        first += usize::from(place == Some(0));
    }
    println!("named: {named} of {}, first: {first}", FAULTS.len());
    assert!(named >= 12 && first >= 9, "{named} named, {first} of them first");
}

/// The numbers in the folder `failure` of a run, after a check that text and picture exist.
fn numbers_of(run: &Path) -> Value {
    let folder = run.join("failure");
    let text = std::fs::read_to_string(folder.join("failure.md")).unwrap();
    assert!(text.contains("## Worst cell") && text.contains("cell.svg"), "{text}");
    assert!(std::fs::read_to_string(folder.join("cell.svg")).unwrap().contains("<polygon"));
    serde_json::from_str(&std::fs::read_to_string(folder.join("failure.json")).unwrap()).unwrap()
}

/// A mesh alone continues when a cell is inverted; the report of the first such slab is kept.
#[test]
fn a_motion_that_inverts_a_cell_says_why() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[3,3]", "constants.stretch=1.5", "time.step=0.4", "time.end=2"];
    let outcome = on_case(directory.path(), "motion", "vortex", &set, "run", &[]);
    outcome
        .expect(1, &["the mesh is not valid: cell ", "likely cause: the boundary moves further than the mesh follows"]);
    let numbers = numbers_of(&directory.path().join("run"));
    // det J falls below zero at t = 0.929, in the third slab.
    assert_eq!((number(&numbers, "last_good_state.time"), number(&numbers, "last_good_state.slabs")), (0.8, 2.0));
    assert!(number(&numbers, "failure_data.mesh.smallest_det_j") < 0.0);
    assert!(numbers["worst_cell"]["because"].as_str().unwrap().starts_with("det J / det J_0 is -"));
}

/// The load has no value beyond t = 0.0005, which is in the third slab. Of a follower pressure this was told as round-off of thin cells, or as a
/// flow that is not resolved.
#[test]
fn a_structure_whose_load_is_no_number_says_so() {
    for load in ["traction=[0,\"sqrt(0.0005-t)\"]", "follower_pressure=\"sqrt(0.0005-t)\""] {
        let directory = TempDir::new().unwrap();
        let load = format!("structure.boundary.top={{{load}}}");
        let set = [&load, "time.end=0.002", "structure.natural_modes=0", "solver.slab_halvings=0"];
        let outcome = on_case(directory.path(), "run", "cantilever", &set, "run", &[]);
        let told = ["the run stopped at t = 0.0004", "likely cause: the formula of a load has no finite value"];
        outcome.expect(1, &told);
        let numbers = numbers_of(&directory.path().join("run"));
        assert_eq!(numbers["causes"][0]["name"], "bad_load");
        assert_eq!(number(&numbers, "last_good_state.slabs"), 2.0);
        assert!(number(&numbers, "failure_data.structure.waves_per_slab") > 1.0);
    }
}

/// The folder belongs to the run that wrote it.
#[test]
fn a_run_that_succeeds_removes_what_the_last_one_has_left() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[2,2]", "time.end=0.1"];
    let fails = [&set[..], &["solver.newton_steps=1", "solver.slab_halvings=0"]].concat();
    on_case(directory.path(), "run", "vortex", &fails, "run", &[]).expect(1, &["likely cause: too few Newton steps"]);
    let folder = directory.path().join("run/failure");
    assert!(folder.join("failure.md").exists());
    on_case(directory.path(), "run", "vortex", &set, "run", &["--force"]).expect(0, &[]);
    assert!(!folder.exists());
}
