//! Runs in several parts: what they write about walls and averages is what a single run writes, or they say what differs.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Outcome, stsolve};
use output::{RESULT_FILE, ResultReader};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A gas that is heated evenly: p = 1 + t everywhere.
const HEATED: &str = r#"
    mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], periodic = ["x"] } }
    time = { order = 2, end = 2, step = 0.1 }
    [flow]
    order = 2
    initial.uniform = { density = 1, velocity = [0.1, 0], pressure = 1 }
    source.given.energy = "1/0.4"
    boundary.others = "slip_wall"
"#;

/// A command on the heated gas, with `changes` and more arguments.
fn heated(directory: &Path, command: &str, changes: &[&str], more: &[&str]) -> Outcome {
    fs::write(directory.join("case.toml"), HEATED).unwrap();
    let mut arguments = vec![command, "case.toml"];
    changes.iter().for_each(|change| arguments.extend(["--set", change]));
    arguments.extend(more);
    stsolve(directory, &arguments)
}

/// Fails unless the mean pressure at all points of a wall is `expected`.
fn assert_mean(run: &Path, wall: &str, expected: f64) {
    let text = fs::read_to_string(run.join(format!("surface_{wall}_mean.csv"))).unwrap();
    let pressures: Vec<f64> = text.lines().skip(1).map(|row| row.split(',').nth(3).unwrap().parse().unwrap()).collect();
    assert!(!pressures.is_empty());
    assert!(pressures.iter().all(|pressure| (pressure - expected).abs() < 1e-6), "{expected}: {pressures:?}");
}

/// With one distribution inside the window this was called the mean; with none there was no file, and no word about it.
#[test]
fn a_window_between_two_distributions_has_its_mean() {
    let directory = TempDir::new().unwrap();
    let every = "output.surfaces={walls=[\"top\"],every=7}";
    for (from, to, mean) in [(1.0, 1.9, 2.45), (1.0, 1.3, 2.15), (0.8, 2.0, 2.4)] {
        let averages = format!("output.averages={{from={from},to={to},fields=[\"pressure\"]}}");
        heated(directory.path(), "run", &[every, &averages], &["--output", "run", "--force"]).expect(0, &[]);
        assert_mean(&directory.path().join("run"), "top", mean);
        assert!(!directory.path().join("run/surface_top_separation.csv").exists(), "the gas slips");
    }
    let early = "output.averages={from=0.1,to=0.3,fields=[\"pressure\"]}";
    let told = ["the wall `top` has no means", "from t = 0.7 to 2", "output.surfaces.every"];
    heated(directory.path(), "run", &[every, early], &["--output", "early"]).expect(0, &told);
}

/// The distributions and the fields at the first end stayed, and changed the means. A first end before the averages was refused.
#[test]
fn a_run_with_a_later_end_writes_what_a_single_run_writes() {
    let directory = TempDir::new().unwrap();
    let set = [
        "output.surfaces={walls=[\"top\"],every=3}",
        "output.averages={from=1.25,fields=[\"pressure\"]}",
        "output.every=3",
        "output.checkpoint_every=2",
    ];
    let first = [&set[..], &["time.end=1"]].concat();
    let go = |set: &[&str], more: &[&str]| heated(directory.path(), "run", set, more);
    go(&set, &["--output", "through"]).expect(0, &[]);
    let told = ["the run has no averages", "t = 1.25", "output.averages.from"];
    go(&first, &["--output", "split"]).expect(0, &told);
    let checked = heated(directory.path(), "check", &first, &[]);
    assert!(checked.stdout.contains("the run has no averages: they begin at t = 1.25"), "{}", checked.stdout);
    go(&[&set[..], &["restart.from=split"]].concat(), &["--output", "restarted"]).expect(0, &[]);
    go(&set, &["--output", "split", "--resume"]).expect(0, &[]);
    let file = |run: &str, name: &str| fs::read_to_string(directory.path().join(run).join(name)).unwrap();
    for name in ["surface_top.csv", "surface_top_mean.csv"] {
        for run in ["split", "restarted"] {
            assert!(file(run, name) == file("through", name), "{run}/{name}");
        }
    }
    let result = |run: &str| ResultReader::open(&directory.path().join(run).join(RESULT_FILE)).unwrap();
    let (one, other) = (result("through"), result("split"));
    assert_eq!((&one.times, &one.layout), (&other.times, &other.layout));
    for step in 0..one.times.len() {
        let bits = |result: &ResultReader| -> Vec<u64> {
            result.exact("mean_pressure", step).unwrap().unwrap().iter().map(|value| value.to_bits()).collect()
        };
        assert!(bits(&one) == bits(&other), "step {step}");
    }
    // The arc of a wall with ends is NaN.
    let series = |result: &ResultReader| {
        let series = result.series("surface_top").unwrap().unwrap();
        (series.times, series.values.into_iter().map(f64::to_bits).collect::<Vec<u64>>())
    };
    assert_eq!(series(&one), series(&other));
}

/// The last state of a run that stopped was in no step, line or series until the run went on; what is written there now must go again.
#[test]
fn a_run_that_stops_early_writes_its_last_state_and_a_resumed_run_drops_it() {
    let directory = TempDir::new().unwrap();
    let set = [
        "output.every=4",
        "output.surfaces={walls=[\"top\"],every=4}",
        "output.lines.a={from=[0.1,0.1],to=[0.9,0.9],points=3,every=4}",
    ];
    let fails = "solver={newton_steps=1,newton_tolerance=1e-12,slab_halvings=0,fallback=\"none\"}";
    let go = |more: &[&str], output: &str, extra: &[&str]| {
        heated(directory.path(), "run", &[&set[..], more].concat(), &[&["--output", output], extra].concat())
    };
    go(&[], "through", &[]).expect(0, &[]);
    go(&["time.end=0.2"], "run", &[]).expect(0, &[]);
    let result = |run: &str| ResultReader::open(&directory.path().join(run).join(RESULT_FILE)).unwrap();
    let series = |run: &str| result(run).series("surface_top").unwrap().unwrap().times;
    let line = |run: &str| fs::read_to_string(directory.path().join(run).join("line_a.csv")).unwrap();
    // Once more: the state is still there once.
    for _ in 0..2 {
        go(&[fails], "run", &["--resume"]).expect(1, &["run stopped at t = 0.2;"]);
        assert_eq!((result("run").times, series("run")), (vec![0.0, 0.2], vec![0.2]));
        assert_eq!(line("run").lines().filter(|row| row.starts_with("0.2,")).count(), 3);
    }
    go(&[], "run", &["--resume"]).expect(0, &[]);
    assert_eq!((result("run").times, series("run")), (result("through").times, series("through")));
    let times = |run: &str| line(run).lines().map(|row| row.split(',').next().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(times("run"), times("through"));
}

/// VTK could not read a file without any step.
#[test]
fn phases_that_no_slab_has_reached_have_no_file() {
    let directory = TempDir::new().unwrap();
    let averages = "output.averages={from=1.25,period=0.2,phases=2,fields=[\"pressure\"]}";
    let has_file = |end: &str, run: &str| {
        heated(directory.path(), "run", &[averages, end], &["--output", run]).expect(0, &[]);
        directory.path().join(run).join("phases.vtkhdf").exists()
    };
    assert!(!has_file("time.end=1", "before") && has_file("time.end=2", "through"));
}

/// A short last slab that could not be solved left its rest to the next slab, which was longer than `time.step`.
#[test]
fn no_slab_is_longer_after_a_short_one_that_failed() {
    let directory = TempDir::new().unwrap();
    let go = |set: &[&str], more: &[&str]| heated(directory.path(), "run", set, &[&["--output", "run"], more].concat());
    go(&["time.end=0.2"], &[]).expect(0, &[]);
    let fails = ["time.end=0.25", "solver={newton_steps=1,newton_tolerance=1e-12,slab_halvings=0,fallback=\"none\"}"];
    go(&fails, &["--resume"]).expect(1, &[]);
    go(&["time.end=0.6"], &["--resume"]).expect(0, &[]);
    let times = common::column(&directory.path().join("run"), "t");
    let expected = [0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6];
    assert!(times.len() == 7 && times.iter().zip(expected).all(|(t, at)| (t - at).abs() < 1e-12), "{times:?}");
}

/// The means of a wall that was added began at the next distribution, later than all others, without a word.
#[test]
fn a_wall_that_is_added_begins_with_the_present_state() {
    let directory = TempDir::new().unwrap();
    let averages = "output.averages={from=0.2,fields=[\"pressure\"]}";
    let one = [averages, "output.surfaces={walls=[\"top\"],every=4}"];
    let both = [averages, "output.surfaces={walls=[\"top\",\"bottom\"],every=4}"];
    let go = |set: &[&str], more: &[&str]| heated(directory.path(), "run", set, more);
    let first = [&one[..], &["time.end=1"]].concat();
    go(&first, &["--output", "first"]).expect(0, &[]);
    let told = ["the means along `bottom` begin at t = 1", "not at 0.2"];
    let restart = [&both[..], &["restart.from=first"]].concat();
    let checked = heated(directory.path(), "check", &restart, &[]);
    assert!(told.iter().all(|part| checked.stdout.contains(part)), "{}", checked.stdout);
    go(&restart, &["--output", "restarted"]).expect(0, &told);
    go(&both, &["--output", "first", "--resume"]).expect(0, &told);
    for run in ["restarted", "first"] {
        assert_mean(&directory.path().join(run), "bottom", 2.5);
        // The first distribution is at t = 0.4.
        assert_mean(&directory.path().join(run), "top", 2.2);
    }
}

/// It had no effect, and nothing said so.
#[test]
fn a_start_beside_a_restart_is_warned_of() {
    let directory = TempDir::new().unwrap();
    heated(directory.path(), "run", &["time.end=0.4"], &["--output", "first"]).expect(0, &[]);
    for (start, warns) in [("0.1", true), ("0.4", false), ("0", false)] {
        let set = ["restart.from=first", "time.end=0.6", &format!("time.start={start}")];
        let outcome = heated(directory.path(), "run", &set, &["--output", start]);
        outcome.expect(0, &[]);
        assert_eq!(outcome.stderr.contains("it goes on from t = 0.4"), warns, "{start}: {}", outcome.stderr);
    }
}
