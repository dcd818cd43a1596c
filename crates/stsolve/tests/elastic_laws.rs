//! The laws of the elastic mesh, through the case file.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_same_bits, column, number, on_case, shipped, stsolve, summary};
use tempfile::TempDir;

/// The vortex in a square whose sides bend, so that the laws differ.
const BENT: [&str; 4] = [
    "mesh.generate.box.cells=[3,3]",
    "time.step=0.2",
    "motion.elasticity.stiffness=\"constant\"",
    "motion.boundary={others={displacement=[\"0.2*t*sin(0.3*y)\",\"0.3*t*sin(0.4*x)\"]}}",
];

const NEO_HOOKEAN: &str = "motion.elasticity.law=\"neo_hookean\"";
const UPDATED: &str = "motion.elasticity.reference=\"updated\"";

#[test]
fn a_flow_is_solved_on_a_mesh_of_every_law() {
    let directory = TempDir::new().unwrap();
    let joint = "solver.predictor=\"extrapolate\"";
    let mut displacements = Vec::new();
    for (name, set) in [("neo", &[NEO_HOOKEAN][..]), ("joint", &[NEO_HOOKEAN, joint]), ("updated", &[UPDATED])] {
        let set = [&BENT[..], set, &["time.end=1"]].concat();
        on_case(directory.path(), "run", "vortex", &set, name, &[]).expect(0, &[]);
        let summary = summary(&directory.path().join(name));
        assert_eq!(summary["completed"], true);
        assert!(number(&summary, "conservation.mass_error") < 1e-12, "{name}: {summary}");
        displacements.push(number(&summary, "mesh_quality.det_j_sampled_min"));
    }
    // The mesh solved before the flow or together with it: the same equilibrium.
    assert!((displacements[0] - displacements[1]).abs() < 1e-6, "{displacements:?}");
    assert!((displacements[0] - displacements[2]).abs() > 1e-4, "{displacements:?}");
}

/// The guess of the mesh is in equilibrium to 1e-11. What is left of its residual must not keep a flow from a smaller tolerance.
#[test]
fn a_mesh_that_is_not_linear_does_not_limit_the_tolerance() {
    let directory = TempDir::new().unwrap();
    for tolerance in ["1e-10", "1e-11"] {
        let newton = format!("solver.newton_tolerance={tolerance}");
        let set = [&BENT[..], &[NEO_HOOKEAN, "time.end=0.4", &newton]].concat();
        on_case(directory.path(), "run", "vortex", &set, tolerance, &[]).expect(0, &[]);
        assert_eq!(number(&summary(&directory.path().join(tolerance)), "rejected_slabs"), 0.0, "{tolerance}");
    }
}

#[test]
fn meshes_that_are_not_linear_resume() {
    let directory = TempDir::new().unwrap();
    for (command, law) in [("motion", NEO_HOOKEAN), ("motion", UPDATED), ("run", NEO_HOOKEAN), ("run", UPDATED)] {
        let go = |end: &str, output: &str, extra: &[&str]| {
            let set = [&BENT[..], &[law, end]].concat();
            on_case(directory.path(), command, "vortex", &set, output, extra).expect(0, &[]);
        };
        let [through, resumed] = ["through", "resumed"].map(|part| format!("{command}_{part}_{}", law.len()));
        go("time.end=0.8", &through, &["--threads", "1"]);
        go("time.end=0.4", &resumed, &["--threads", "2"]);
        go("time.end=0.8", &resumed, &["--threads", "2", "--resume"]);
        assert_same_bits(&directory.path().join(through), &directory.path().join(resumed), law);
    }
}

#[test]
fn check_names_the_law() {
    let directory = TempDir::new().unwrap();
    for (set, name) in [
        (NEO_HOOKEAN, "neo-Hookean elasticity about the initial mesh"),
        (UPDATED, "linear elasticity about the mesh at the start of each slab"),
    ] {
        let outcome = stsolve(directory.path(), &["check", &shipped("vortex.toml"), "--set", set]);
        outcome.expect(0, &[]);
        assert!(outcome.stdout.contains(name), "{}", outcome.stdout);
    }
}

/// With the tolerance 1e-2 the run would fail at 30 degrees, and det J would be wrong by 40 % before that.
#[test]
fn a_neo_hookean_mesh_is_converged_where_it_is_accepted() {
    let directory = TempDir::new().unwrap();
    let smallest = |tolerance: &str, output: &str| {
        let constant = "motion.elasticity.stiffness=\"constant\"";
        let set = [&[NEO_HOOKEAN, constant][..], &[tolerance][..usize::from(!tolerance.is_empty())]].concat();
        on_case(directory.path(), "motion", "rotating_box", &set, output, &[]).expect(0, &[]);
        column(&directory.path().join(output), "det_j_sampled_min")
    };
    let (default, converged) = (smallest("", "default"), smallest("motion.elasticity.tolerance=1e-9", "converged"));
    assert_eq!(default.len(), 13, "65 degrees in slabs of 5");
    for (slab, (default, converged)) in default.iter().zip(&converged).enumerate() {
        assert!((default / converged - 1.0).abs() < 2e-3, "slab {slab}: det J {default}, converged {converged}");
    }
}

/// Newton's method cannot follow a sudden turn of a box by 150 degrees, but it can follow one by 75.
#[test]
fn a_slab_of_the_mesh_alone_that_cannot_be_solved_is_halved() {
    let directory = TempDir::new().unwrap();
    let turn = |halvings: &str, output: &str| {
        let set = [
            NEO_HOOKEAN,
            "mesh.order=3",
            "mesh.generate.rotating_box.cells_per_side=10",
            "time={order=2,end=180,step=150}",
            halvings,
        ];
        on_case(directory.path(), "motion", "rotating_box", &set, output, &[])
    };
    let given_up = turn("solver.slab_halvings=0", "given_up");
    given_up.expect(1, &["slab 1, t = 0 to 150", "could not be solved", "not found to the tolerance 1e-6"]);
    let told = std::fs::read_to_string(directory.path().join("given_up/failure/failure.md")).unwrap();
    assert!(told.contains("`motion.elasticity.tolerance`"), "{told}");
    assert!(!told.contains("take `motion.elasticity.law"), "the law is on already: {told}");
    turn("solver.slab_halvings=1", "halved").expect(0, &[]);
    let run = directory.path().join("halved");
    assert_eq!(column(&run, "t"), [75.0, 150.0, 180.0]);
    assert_eq!(summary(&run)["rejected_slabs"], 1);
    assert!(number(&summary(&run), "mesh_quality.det_j_lower_bound") > 0.0);
}
