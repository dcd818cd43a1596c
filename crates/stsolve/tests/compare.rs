//! `stsolve compare`

#![allow(clippy::unwrap_used)]

mod common;

use common::{on_case, stsolve};
use serde_json::Value;
use tempfile::TempDir;

const SHORT: [&str; 3] = ["mesh.generate.box.cells=[3,3]", "time.end=0.8", "time.step=0.4"];

#[test]
fn two_runs_differ_where_their_cases_do() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |output: &str, order: &str| {
        on_case(at, "run", "vortex", &[&SHORT[..], &[order]].concat(), output, &[]).expect(0, &[]);
    };
    go("three", "flow.order=3");
    go("again", "flow.order=3");
    go("four", "flow.order=4");
    let compared: Value = serde_json::from_str(&stsolve(at, &["compare", "three", "four", "--json"]).stdout).unwrap();
    assert_eq!(compared["keys"], serde_json::json!({ "flow.order": ["3", "4"] }));
    assert_eq!(
        compared["figures"]["unknowns.flow"][0].as_f64().unwrap() * 16.0 / 9.0,
        compared["figures"]["unknowns.flow"][1].as_f64().unwrap()
    );
    let krylov = compared["curves"]["krylov"][0].as_f64().unwrap();
    assert!(krylov > 0.0 && krylov < 10.0, "{compared}");
    stsolve(at, &["compare", "three", "four"]).expect(0, &[]);
    assert_eq!(stsolve(at, &["compare", "three", "again"]).stdout.trim(), "no difference");
}

#[test]
fn a_directory_without_a_run_is_refused() {
    let directory = TempDir::new().unwrap();
    let outcome = stsolve(directory.path(), &["compare", ".", "."]);
    outcome.expect(2, &["result.vtkhdf", "name the directory of such a run"]);
    stsolve(directory.path(), &["compare", "absent", "."]).expect(2, &["`absent` is no directory"]);
    assert!(!outcome.stderr.contains("resum"), "{}", outcome.stderr);
}

/// What only one run has is told, not dropped.
#[test]
fn figures_and_columns_of_one_run_alone_are_told() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let probe = "output.probes={middle={at=[5,4]}}";
    on_case(at, "run", "vortex", &SHORT, "without", &[]).expect(0, &[]);
    on_case(at, "run", "vortex", &[&SHORT[..], &[probe]].concat(), "with", &[]).expect(0, &[]);
    let told = "history.csv: middle_density";
    let compared: Value = serde_json::from_str(&stsolve(at, &["compare", "without", "with", "--json"]).stdout).unwrap();
    assert_eq!(compared["alone"][told], "with", "{compared}");
    stsolve(at, &["compare", "with", "without"]).expect(0, &[]);
    assert!(stsolve(at, &["compare", "with", "without"]).stdout.contains(told));
    std::fs::remove_file(at.join("without/summary.json")).unwrap();
    let compared: Value = serde_json::from_str(&stsolve(at, &["compare", "without", "with", "--json"]).stdout).unwrap();
    assert_eq!(compared["alone"]["summary.json"], "with", "{compared}");
}

/// A run that had failed did not differ from one that had reached its end.
#[test]
fn a_run_that_is_not_completed_differs() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    for output in ["whole", "failed"] {
        on_case(at, "run", "vortex", &SHORT, output, &[]).expect(0, &[]);
    }
    let file = at.join("failed/summary.json");
    let summary = std::fs::read_to_string(&file).unwrap();
    let failed = summary.replace("\"completed\": true", "\"completed\": false");
    assert_ne!(failed, summary);
    std::fs::write(&file, failed).unwrap();
    let compared: Value = serde_json::from_str(&stsolve(at, &["compare", "whole", "failed", "--json"]).stdout).unwrap();
    assert_eq!(compared["figures"]["completed"], serde_json::json!([1.0, 0.0]), "{compared}");
}
