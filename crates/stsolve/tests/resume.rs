//! A resumed run has the same bits as an uninterrupted one, for any number of threads.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_same_bits, checkpoint, column, number, on_case, shipped, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// A vortex whose mesh moves so much that the preconditioner is rebuilt in slabs 4 and 6.
const MOVED: [&str; 4] =
    ["mesh.generate.box.cells=[3,3]", "time.step=0.4", "constants.stretch=0.8", "solver.krylov_tolerance=1e-3"];

/// Runs to `end` into `output`, with `extra` arguments.
fn run(directory: &Path, changes: &[&str], end: &str, output: &str, extra: &[&str]) {
    let end = format!("time.end={end}");
    let set = [&MOVED[..], changes, &[&end]].concat();
    on_case(directory, "run", "vortex", &set, output, extra).expect(0, &[]);
}

/// The run to `end` in one go by one thread, against runs interrupted at `stop` by one and two threads, and one by two threads.
fn assert_interruption_leaves_no_trace(changes: &[&str], stop: &str, end: &str) -> TempDir {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, changes, end, "through", &["--threads", "1"]);
    run(at, changes, end, "through_2", &["--threads", "2"]);
    assert_same_bits(&at.join("through"), &at.join("through_2"), "two threads");
    for threads in ["1", "2"] {
        run(at, changes, stop, threads, &["--threads", threads]);
        run(at, changes, end, threads, &["--threads", threads, "--resume"]);
        assert_same_bits(&at.join("through"), &at.join(threads), &format!("interrupted at {stop}, {threads} threads"));
    }
    directory
}

#[test]
fn an_elastic_predictor_resumes_after_a_rebuilt_preconditioner() {
    let directory = assert_interruption_leaves_no_trace(&[], "2", "2.8");
    let builds = column(&directory.path().join("1"), "preconditioner_builds");
    assert_eq!(builds, [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0], "a rebuild before and after the interruption");
}

/// A preconditioner by directions is also rebuilt from time to time.
#[test]
fn a_preconditioner_by_lines_resumes() {
    let changes = ["solver.preconditioner=lines"];
    let directory = assert_interruption_leaves_no_trace(&changes, "2", "2.8");
    let builds = column(&directory.path().join("1"), "preconditioner_builds");
    assert!(builds[1..].contains(&1.0) && builds.contains(&0.0), "{builds:?}");
}

/// A defect that was: a resumed run joined other cells into the functions of the coarse level.
#[test]
fn a_coarse_level_of_slabs_resumes() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let set = [
        "mesh.generate.box={lower=[0,0],upper=[10,10],cells=[34,34]}",
        "mesh.order=2",
        "flow.order=3",
        "time.step=1",
        "output.fields=[\"density\"]",
    ];
    let run = |end: &str, output: &str, extra: &[&str]| {
        let end = format!("time.end={end}");
        on_case(at, "run", "vortex", &[&set[..], &[&end]].concat(), output, extra).expect(0, &[]);
    };
    run("6", "through", &[]);
    run("3", "resumed", &[]);
    run("6", "resumed", &["--resume"]);
    assert_same_bits(&at.join("through"), &at.join("resumed"), "interrupted at 3");
    assert_eq!(checkpoint(&at.join("through")).0["frozen.coarse_level"], [1.0f64.to_bits()]);
    let builds = column(&at.join("through"), "preconditioner_builds");
    assert!(builds[3..].contains(&1.0), "{builds:?}");
}

/// The preconditioner of low order keeps its order of elimination.
#[test]
fn a_preconditioner_of_low_order_resumes() {
    let directory = assert_interruption_leaves_no_trace(&["solver.preconditioner=low_order"], "2", "2.8");
    let builds = column(&directory.path().join("1"), "preconditioner_builds");
    assert!(builds[1..].contains(&1.0) && builds.contains(&0.0), "{builds:?}");
}

/// Three Newton steps are not always enough here: slabs are halved, each time with a new preconditioner.
#[test]
fn an_extrapolating_predictor_resumes_after_halved_slabs() {
    let changes = ["constants.stretch=0.9", "solver.predictor=extrapolate", "solver.newton_steps=3"];
    let directory = assert_interruption_leaves_no_trace(&changes, "2", "2.8");
    let run = directory.path().join("1");
    let (times, rejected) = (column(&run, "t"), column(&run, "rejected"));
    let builds = column(&run, "preconditioner_builds");
    let later = times.iter().position(|&t| t > 0.5).unwrap();
    let stop = times.iter().position(|&t| t > 2.1).unwrap();
    assert!(rejected[later..stop].iter().sum::<f64>() > 0.0 && builds[later..stop].iter().sum::<f64>() > 1.0);
}

/// 3 x 0.4 is not 1.2 in binary: the end of the first run must be the number that the long run passes.
#[test]
fn a_slab_end_that_is_no_binary_number_is_met() {
    assert_ne!(3.0 * 0.4, 1.2);
    assert_interruption_leaves_no_trace(&[], "1.2", "2");
}

#[test]
fn a_mesh_that_is_prescribed_resumes() {
    let directory = TempDir::new().unwrap();
    let set = |end| ["mesh.generate.box.cells=[4,3]", "time={order=2,step=0.1,end=0}", end];
    let go = |end, output: &str, extra: &[&str]| {
        on_case(directory.path(), "run", "vortex_sinusoidal", &set(end), output, extra).expect(0, &[]);
    };
    go("time.end=0.6", "through", &["--threads", "1"]);
    go("time.end=0.3", "resumed", &["--threads", "2"]);
    go("time.end=0.6", "resumed", &["--threads", "2", "--resume"]);
    assert_same_bits(&directory.path().join("through"), &directory.path().join("resumed"), "prescribed");
}

#[test]
fn the_mesh_alone_resumes() {
    let directory = TempDir::new().unwrap();
    let go = |end: &str, output: &str, extra: &[&str]| {
        let set = ["mesh.generate.box.cells=[3,3]", "time.step=0.4", end];
        on_case(directory.path(), "motion", "vortex", &set, output, extra).expect(0, &[]);
    };
    go("time.end=2", "through", &["--threads", "1"]);
    go("time.end=1.2", "resumed", &["--threads", "2"]);
    go("time.end=2", "resumed", &["--threads", "2", "--resume"]);
    assert_same_bits(&directory.path().join("through"), &directory.path().join("resumed"), "mesh alone");
}

/// 1.0 lies within a slab: the run up to there has a short last slab, and the resumed run does its rest first.
#[test]
fn a_run_continues_within_a_slab() {
    let directory = TempDir::new().unwrap();
    run(directory.path(), &[], "1.0", "run", &[]);
    // Nothing is left to do: these runs solved slabs of no or negative length, and the checkpoint was lost.
    for end in ["1.0", "0.9", "0.7"] {
        run(directory.path(), &[], end, "run", &["--resume"]);
        assert_eq!(column(&directory.path().join("run"), "t").len(), 3, "{end}");
    }
    run(directory.path(), &[], "2.0", "run", &["--resume"]);
    let run = directory.path().join("run");
    let ends: Vec<f64> = column(&run, "t").iter().map(|t| (t * 1e9).round() / 1e9).collect();
    assert_eq!(ends, [0.4, 0.8, 1.0, 1.2, 1.6, 2.0]);
    assert_eq!(summary(&run)["completed"], true);
}

/// Slabs of adapted length, from a first one far too short. The interruption is a signal, at any point of the run.
#[test]
fn a_run_with_adapted_slabs_has_the_same_bits_for_any_number_of_threads() {
    let directory = TempDir::new().unwrap();
    let changes = ["time.step=0.01", "time.adaptive.tolerance=5e-4"];
    for threads in ["1", "2"] {
        run(directory.path(), &changes, "2", threads, &["--threads", threads]);
    }
    let [one, two] = ["1", "2"].map(|output| directory.path().join(output));
    assert_same_bits(&one, &two, "two threads");
    let lengths = column(&one, "dt");
    assert!(lengths.iter().fold(0.0, |most: f64, dt| most.max(*dt)) > 10.0 * lengths[0], "{lengths:?}");
}

/// A run that has reached its end is resumed: nothing is left to do, and the errors at the end are those of before.
#[test]
fn a_finished_run_that_is_resumed_has_the_same_errors() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let errors = || summary(&at.join("run"))["error"].clone();
    run(at, &[], "2", "run", &[]);
    let before = errors();
    run(at, &[], "2", "run", &["--resume"]);
    assert_eq!(errors(), before);
    // An end before the checkpoint is told.
    let case = shipped("vortex.toml");
    let mut arguments = vec!["run", &case, "--output", "run", "--resume", "--set", "time.end=1"];
    MOVED.iter().for_each(|change| arguments.extend(["--set", change]));
    stsolve(at, &arguments).expect(0, &["the checkpoint is at t = 2, after the end 1: nothing is left to do"]);
}

/// A mesh file whose boundaries have changed their names was taken: the membrane was then held on its other side.
#[test]
fn a_mesh_with_other_boundaries_is_refused() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let mesh = std::fs::read_to_string(shipped("cooks_membrane.msh")).unwrap();
    std::fs::copy(shipped("cooks_membrane.toml"), at.join("case.toml")).unwrap();
    let run = |mesh: &str, slabs: u32, extra: &[&str]| {
        std::fs::write(at.join("cooks_membrane.msh"), mesh).unwrap();
        let (end, slabs) = (format!("time.end={}", 0.25 * f64::from(slabs)), format!("time.slabs={slabs}"));
        let arguments = ["run", "case.toml", "--output", "run", "--set", &end, "--set", &slabs];
        stsolve(at, &[&arguments, extra].concat())
    };
    run(&mesh, 2, &[]).expect(0, &[]);
    let swapped = mesh.replace("\"left\"", "\"x\"").replace("\"right\"", "\"left\"").replace("\"x\"", "\"right\"");
    run(&swapped, 4, &["--resume"])
        .expect(2, &["the boundaries of the mesh are others, perhaps because its file has changed"]);
    run(&mesh, 4, &["--resume"]).expect(0, &[]);
}

/// A case that is moved by a table of t^3 (1 - t) up to a time `end`, 0.05 apart.
fn moved_by_table(end: f64) -> [String; 2] {
    let t: Vec<f64> = (0..=(end / 0.05).round() as i32).map(|k| 0.05 * f64::from(k)).collect();
    let values: Vec<f64> = t.iter().map(|t| t.powi(3) * (1.0 - t)).collect();
    let table = format!("tables.way={{t={t:?},values={values:?}}}");
    [table, "motion.displacement=[\"0.1*way(t)*sin(pi*x)*sin(pi*y)\",0]".to_owned()]
}

/// A longer table does not change the motion so far; where it does, another way is told.
#[test]
fn a_run_goes_on_with_a_longer_table() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |table: f64, end: &str, output: &str, extra: &[&str]| {
        let [table, motion] = moved_by_table(table);
        let time = format!("time={{order=2,step=0.1,{end}}}");
        let set = ["mesh.generate.box.cells=[2,2]", &time, &table, &motion];
        on_case(at, "run", "couette", &set, output, extra)
    };
    go(3.0, "end=0.4", "run", &[]).expect(0, &[]);
    go(4.0, "end=0.6", "run", &["--resume"]).expect(0, &[]);
    // Once more with another table, and without any change.
    go(5.0, "end=0.8", "run", &["--resume"]).expect(0, &[]);
    go(5.0, "end=0.9", "run", &["--resume"]).expect(0, &[]);
    assert_eq!(column(&at.join("run"), "t").len(), 9);
    let refused = go(0.9, "end=0.9", "run", &["--resume"]);
    refused.expect(2, &["`tables.way.t` was", "`restart.from`"]);
    go(1.0, "end=1", "short", &[]).expect(0, &[]);
    let refused = go(2.0, "end=1.2", "short", &["--resume"]);
    refused
        .expect(2, &["`way` change its spline before the checkpoint at t = 1 too", "0 points after", "`restart.from`"]);
}

/// The run was told to be complete, and its flow was the one that the search had left.
#[test]
fn a_search_for_a_steady_flow_that_has_failed_goes_on() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let small = ["mesh.order=3", "mesh.generate.annulus.cells=[12,8]", "time={order=1,end=0,step=1}", "flow.order=3"];
    let go = |steps: &[&str], extra: &[&str]| {
        on_case(at, "run", "cylinder_steady", &[&small[..], steps].concat(), "run", extra)
    };
    go(&["solver.steady.steps=2"], &[]).expect(1, &["steady"]);
    go(&["solver.steady.steps=2"], &["--resume"]).expect(1, &["steady"]);
    go(&[], &["--resume"]).expect(0, &[]);
    let drag = |run: &str| number(&summary(&at.join(run)), "steady.walls.wall.drag_coefficient");
    on_case(at, "run", "cylinder_steady", &small, "at_once", &[]).expect(0, &[]);
    assert!((drag("run") - drag("at_once")).abs() < 1e-8, "{} {}", drag("run"), drag("at_once"));
}
