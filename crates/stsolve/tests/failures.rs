//! Slabs that cannot be solved: exit code 1, the last good state written, cell, time and cause named.

#![allow(clippy::unwrap_used)]

mod common;

use common::{checkpoint, column, number, on_case, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// The time in the checkpoint of a run, after a check that summary and history agree.
fn last_good_time(run: &Path) -> f64 {
    let time = f64::from_bits(checkpoint(run).0["time"][0]);
    let summary = summary(run);
    assert_eq!((summary["completed"].as_bool(), number(&summary, "time")), (Some(false), time));
    assert_eq!(column(run, "t").last().copied().unwrap_or(0.0), time);
    assert_eq!(output::inspect(&run.join("result.vtkhdf")).unwrap().times.last(), Some(&time));
    time
}

#[test]
fn a_slab_that_does_not_converge_stops_the_run() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box.cells=[3,3]",
        "time.end=0.4",
        "solver.newton_steps=1",
        "solver.slab_halvings=1",
        "solver.fallback=none",
    ];
    let outcome = on_case(directory.path(), "run", "vortex", &set, "run", &[]);
    outcome.expect(
        1,
        &["slab 1, t = 0 to 0.05", "largest in cell ", "no convergence in 1 steps", "run stopped at t = 0;"],
    );
    let run = directory.path().join("run");
    assert_eq!(last_good_time(&run), 0.0);
    let summary = summary(&run);
    let reason = summary["reason"].as_str().unwrap().to_string();
    assert!(reason.contains("slab 1") && reason.contains("no convergence"), "{reason}");
    // Attempts at the slab that was never solved were not counted.
    assert_eq!(number(&summary, "rejected_slabs"), 1.0, "{summary}");
    assert!(number(&summary, "cost.residual_evaluations") > 1.0 && number(&summary, "cost.jacobian_products") > 1.0);
}

/// Two attempts with an easier start were counted as shorter slabs.
#[test]
fn an_easier_start_is_no_shorter_slab() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.annulus.cells=[12,8]",
        "flow.order=4",
        "flow.initial.expression.velocity=[1,0]",
        "solver.newton_steps=1",
        "solver.fallback=none",
        "time.adaptive={tolerance=1e-3,smallest=0.4}",
    ];
    let outcome = on_case(directory.path(), "run", "cylinder_street", &set, "run", &[]);
    outcome.expect(1, &["slab 1, t = 0 to 0.5, could not be solved\n"]);
    assert_eq!(number(&summary(&directory.path().join("run")), "rejected_slabs"), 2.0);
}

/// With this stretch det J falls below zero at t = 0.929: every slab until then is kept.
#[test]
fn a_cell_that_inverts_stops_the_run_at_the_last_good_slab() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box.cells=[3,3]",
        "constants.stretch=1.5",
        "time.step=0.4",
        "time.end=4",
        "solver.slab_halvings=2",
    ];
    for predictor in ["elastic", "extrapolate"] {
        let choice = format!("solver.predictor={predictor}");
        let set = [&set[..], &[&choice]].concat();
        let outcome = on_case(directory.path(), "run", "vortex", &set, predictor, &[]);
        outcome.expect(1, &["run stopped at t = 0.9;", "slab 4, t = 0.9", "cell ", "det J"]);
        let run = directory.path().join(predictor);
        assert!((last_good_time(&run) - 0.9).abs() < 1e-14);
        assert!(summary(&run)["reason"].as_str().unwrap().contains("det J"));
        // Halved to 0.2, which fails again, and to 0.1, which succeeds.
        assert_eq!(column(&run, "rejected"), [0.0, 0.0, 2.0]);
    }
}

/// The state that one must look at after a failure was in no step for ParaView and in no row of a line.
#[test]
fn the_last_state_of_a_failed_run_is_a_step() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box.cells=[3,3]",
        "constants.stretch=1.5",
        "time.step=0.4",
        "time.end=4",
        "solver.slab_halvings=2",
        "output.every=50",
        "output.lines.a={from=[0.1,0.1],to=[0.3,0.2],points=2,every=50}",
    ];
    on_case(directory.path(), "run", "vortex", &set, "run", &[]).expect(1, &["run stopped at t = 0.9;"]);
    let run = directory.path().join("run");
    let last = last_good_time(&run);
    let result = output::inspect(&run.join("result.vtkhdf")).unwrap();
    assert_eq!(result.times, [0.0, last]);
    let line = std::fs::read_to_string(run.join("line_a.csv")).unwrap();
    assert_eq!(line.lines().skip(1).filter(|row| row.starts_with(&format!("{last:?},"))).count(), 2, "{line}");
}

/// A table that ends within the run: the mesh was blamed, and the split form tried.
#[test]
fn formulas_without_a_value_are_named() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 2, generate = { box = { lower = [0, 0], upper = [2, 0.5], cells = [4, 1] } } }
        tables.b = { t = [0, 0.2, 0.4, 0.6], values = [0, 0.04, 0.05, 0.02] }
        time = { order = 2, end = 1, step = 0.1 }
        [flow]
        order = 3
        reference = { density = 1, speed = 1, pressure = 1 }
        initial = { uniform = { density = 1, velocity = [0.3, 0], pressure = 1 } }
    "#;
    let ends = "if((t < 0.62) + (t > 0.7), 0.01, b(t))";
    let state = "boundary = { left = { prescribed_state = { expression = { density = 1, velocity = [\"0.3 + ENDS\", 0], pressure = 1 } } }, others = \"slip_wall\" }";
    let source = "boundary = { others = \"slip_wall\" }\nsource = { acceleration = [\"ENDS\", 0] }";
    // No cell has its first node there, in the last cell along x.
    let near_the_end = source.replace("ENDS", "if(x < 1.8, 0, ENDS)");
    for (more, of) in [(state, "flow.boundary.left"), (source, "flow.source"), (&near_the_end, "flow.source")] {
        std::fs::write(directory.path().join("case.toml"), case.to_owned() + &more.replace("ENDS", ends)).unwrap();
        let outcome = stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--force"]);
        outcome.expect(1, &["likely cause: a formula of `", of, "has no finite value", "a table that covers it"]);
        assert!(!outcome.stderr.contains("split form"), "{}", outcome.stderr);
    }
}

/// A boundary value that is negative for a while, between the times at which `check` looks: some runs went on with it, others blamed the mesh.
#[test]
fn boundary_values_that_no_gas_has_are_named() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 2, generate = { box = { lower = [0, 0], upper = [2, 0.5], cells = [4, 1] } } }
        flow.order = 3
        flow.reference = { density = 1, speed = 1, pressure = 1 }
        flow.initial = { uniform = { velocity = [W, 0], pressure = 1 } }
        time = { order = 2, end = 1, step = 0.1 }
        flow.boundary = { CONDITION }
    "#;
    let dips = "1 - 1.2*exp(-((t - 0.4)/0.03)^2)";
    let cases = [
        (
            "temperature",
            "0",
            "left = { velocity_inflow = { velocity = [0.3, 0], temperature = \"DIPS\" } }, others = \"slip_wall\"",
        ),
        (
            "density",
            "2.4",
            "left = { supersonic_inflow = { expression = { density = \"DIPS\", velocity = [2.4, 0], pressure = 1 } } }, others = { outflow = { pressure = 1 } }",
        ),
        ("pressure", "0.3", "right = { outflow = { pressure = \"DIPS\" } }, others = \"slip_wall\""),
        (
            "density",
            "0.3",
            "left = { prescribed_state = { expression = { density = \"DIPS\", velocity = [0.3, 0], pressure = 1 } } }, others = \"slip_wall\"",
        ),
    ];
    for (key, speed, condition) in cases {
        let text = case.replace("CONDITION", condition).replace("DIPS", dips).replace('W', speed);
        std::fs::write(directory.path().join("case.toml"), text).unwrap();
        let outcome = stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--force"]);
        let boundary = if condition.starts_with("left") { "left" } else { "right" };
        let cause = format!("likely cause: `{key}` of the boundary `{boundary}` is -");
        outcome.expect(1, &[&cause, "and must be positive", &format!("`flow.boundary.{boundary}`")]);
        let told = outcome.stderr.clone() + &outcome.stdout;
        assert!(!told.contains("split form"), "{told}");
        let t = number(&summary(&directory.path().join("run")), "time");
        assert!(t > 0.25 && t < 0.4, "{key} at {t}");
    }
}
