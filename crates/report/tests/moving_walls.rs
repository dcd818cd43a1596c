//! Windows of two bodies, of which one moves. The file holds a mesh alone.

#![allow(clippy::unwrap_used)]

use output::{ArraySpec, FileLayout, Grid, History, Metadata, RestMesh, ResultFile, RunDirectory, SolverState, Step};
use report::Scenario;
use std::path::Path;

/// Unit cells per direction; steps; the movement of the right body in a step.
const CELLS: usize = 10;
const STEPS: usize = 4;
const SPEED: f64 = 0.3;

/// The cells whose lower edge is a body: squares at rest with their lower left corners at (3, 5) and (6, 5).
const LEFT: usize = 3 + 5 * CELLS;
const RIGHT: usize = 6 + 5 * CELLS;

/// `[cell][component][node]` at a step.
fn position(step: usize) -> Vec<f64> {
    let cell = |cell: usize| {
        let shift = if cell == RIGHT { SPEED * step as f64 } else { 0.0 };
        let x = (0..4).map(move |node| (cell % CELLS + node % 2) as f64 + shift);
        x.chain((0..4).map(move |node| (cell / CELLS + node / 2) as f64))
    };
    (0..CELLS * CELLS).flat_map(cell).collect()
}

/// Writes the files of the run.
fn run(directory: &Path) {
    let place = RunDirectory::open(directory).unwrap();
    let cells = CELLS * CELLS;
    let layout = FileLayout {
        grid: Grid { dimension: 2, points_per_direction: 2, cells },
        fields: vec![],
        exact: vec![ArraySpec::new("position", &[("cell", cells), ("component", 2), ("node", 4)])],
    };
    let mesh = RestMesh {
        position: position(0),
        boundary_names: ["left", "right"].map(str::to_owned).into(),
        boundary_facets: vec![[LEFT as i64, 2, 0], [RIGHT as i64, 2, 1]],
    };
    let [creator, case_name, case_fingerprint, mesh_id] = ["test", "bodies", "0", "0"].map(str::to_owned);
    let (space_nodes, time_nodes) = (vec![-1.0, 1.0], vec![1.0]);
    let case_text = String::new();
    let metadata = Metadata { creator, case_name, case_text, case_fingerprint, mesh_id, space_nodes, time_nodes, mesh };
    let mut result = ResultFile::create(&place, layout, &metadata).unwrap();
    let mut history = History::create(&place, &["t", "dt"].map(str::to_owned), &[]).unwrap();
    for step in 0..STEPS {
        let (time, points, exact) = (step as f64, vec![0.0; 12 * cells], position(step));
        result.append(&Step { time, points: &points, fields: &[], exact: &[("position", &exact)] }).unwrap();
        history.push(&[time, 1.0]).unwrap();
    }
    result.checkpoint(&SolverState::default()).unwrap();
}

#[test]
fn each_body_has_a_window_and_the_moving_one_is_followed() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path());
    let page = report::write(directory.path()).unwrap();
    let html = std::fs::read_to_string(page.path).unwrap();
    let data = html.split(r#"<script type="application/json" id="data">"#).nth(1).unwrap();
    let data: serde_json::Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let windows = data["pictures"]["windows"].as_array().unwrap();
    let labels: Vec<&str> = windows.iter().map(|window| window["label"].as_str().unwrap()).collect();
    assert_eq!(labels, ["near the walls", "moving with the walls", "near left", "moving with right", "whole domain"]);
    let shift = |window: usize, step: usize| windows[window]["shifts"][step][0].as_f64().unwrap();
    for step in 0..STEPS {
        let moved = SPEED * step as f64;
        // All bodies together move by the mean.
        assert!((shift(1, step) - 0.5 * moved).abs() < 1e-12 && (shift(3, step) - moved).abs() < 1e-12);
    }
    assert!(windows[2]["shifts"].is_null());
    let scenario = Scenario { field: "jacobian", window: Some("moving with right"), ..Scenario::default() };
    let movie = report::write_movie(directory.path(), &scenario).unwrap();
    assert_eq!((movie.frames, &movie.window[..]), (STEPS, "moving with right"));
}
