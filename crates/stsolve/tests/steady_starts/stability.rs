//! Steady flows that are spurious or unstable are told from those that are not.

use crate::COARSE;
use crate::common::{number, on_case, stsolve, summary};
use std::path::Path;
use tempfile::TempDir;

/// An airfoil at 6 degrees and Re = 20000 on 328 cells of order 2 with two quadrature points per direction: hopelessly coarse, so that the
/// discrete equations have several steady solutions.
const UNRESOLVED: &str = r#"
[constants]
alpha = "6*pi/180"
[mesh]
order = 4
[mesh.generate.airfoil]
first_cell = 0.01
trailing_edge_cell = 0.03
surface_cells = 10
wake_cells = 6
near_wake = { extent = 2, cells = 3 }
normal_cells = 9
near_wall = { extent = 0.6, cells = 6 }
[flow]
order = 2
quadrature = { points = 2 }
gas = { gamma = 1.4, prandtl = 0.72, mach = 0.2, viscosity = { constant = 5e-5 } }
reference = { density = 1, speed = 1, pressure = 17.857142857142858 }
initial = { uniform = { velocity = [1, 0], mach = 0.2 } }
[flow.boundary]
airfoil = { adiabatic_wall = {} }
far = { far_field = { velocity = [0.9945218953682733, 0.10452846326765347], mach = 0.2 } }
[flow.forces]
airfoil = { drag_direction = [0.9945218953682733, 0.10452846326765347] }
[time]
order = 1
end = 0
step = 1
[solver.steady]
first_step = 100
sequence = false
[output]
fields = []
"#;

/// The steady section of the summary of UNRESOLVED with changes, and whether the run has warned; None where no steady flow was found.
fn unresolved(directory: &Path, changes: &[&str]) -> Option<(serde_json::Value, bool)> {
    let file = directory.join("case.toml");
    std::fs::write(&file, UNRESOLVED).unwrap();
    let mut arguments = vec!["run", file.to_str().unwrap(), "--output", "run", "--force"];
    changes.iter().for_each(|change| arguments.extend(["--set", change]));
    let outcome = stsolve(directory, &arguments);
    let told = outcome.stdout + &outcome.stderr;
    let warned = told.contains("warning: the steady flow is unstable") && told.contains("a higher `flow.order`");
    println!("{changes:?}: {}", outcome.code);
    (outcome.code == 0).then(|| (summary(&directory.join("run"))["steady"].clone(), warned))
}

/// Newton's method finds lifts of 0.448 and 0.632 from a uniform stream and of 0.113 from gas at rest, all with residuals below 1e-9. No flow in
/// time stays at the first two: a march fails after some time units.
#[test]
fn a_spurious_steady_flow_is_told_by_a_march_in_time() {
    let directory = TempDir::new().unwrap();
    let lift = |steady: &serde_json::Value| number(&steady["walls"]["airfoil"], "lift_coefficient");
    let judged = |(steady, warned): &(serde_json::Value, bool), unstable: bool| {
        println!("{steady}");
        assert!(number(steady, "next_order_residual") > 0.1, "{steady}");
        assert_eq!(steady["stability"]["unstable"], unstable, "{steady}");
        assert_eq!(*warned, unstable, "{steady}");
    };
    // The way of Newton's method from there is long, and rounding in the preconditioner decides where it ends.
    let (long, low_order) = ("solver.steady.first_step=1e4", "solver.preconditioner=low_order");
    let first_steps: Vec<String> =
        std::iter::once(31).chain(25..=60).map(|step| format!("solver.steady.first_step={step}")).collect();
    let ways = first_steps.iter().map(|step| vec![step.as_str()]).chain([vec![long], vec![long, low_order]]);
    let is_spurious = |(steady, _): &(serde_json::Value, bool)| (lift(steady) - 0.113).abs() > 0.1;
    let spurious = ways.filter_map(|way| unresolved(directory.path(), &way)).find(is_spurious);
    judged(&spurious.expect("the spurious flow was not found"), true);
    let at_rest = "flow.initial={ uniform = { velocity = [0, 0.01], mach = 0.002 } }";
    let ways: [&[&str]; 3] = [&[at_rest, "solver.steady.first_step=10"], &[at_rest, long], &[at_rest]];
    let rest = ways.iter().find_map(|way| unresolved(directory.path(), way)).unwrap();
    assert!((lift(&rest.0) - 0.113).abs() < 1e-3, "{}", rest.0);
    judged(&rest, false);
}

/// A flow that is resolved costs no march, and is stable where the case asks for one.
#[test]
fn a_resolved_steady_flow_is_not_doubted() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=4", COARSE, "flow.order=4", "time.end=0"];
    for (name, more) in [("usual", "flow.order=4"), ("asked", "solver.steady.stability_time=8")] {
        on_case(directory.path(), "run", "naca0012_heave", &[&set[..], &[more]].concat(), name, &[]).expect(0, &[]);
        let steady = &summary(&directory.path().join(name))["steady"];
        println!("{name}: {steady}");
        assert!(number(steady, "next_order_residual") < 0.1, "{steady}");
        assert_eq!(steady.get("stability").is_some(), name == "asked", "{steady}");
    }
    // The march is not repeated, and was not told of.
    let asked = directory.path().join("asked");
    let from = format!("restart={{from={:?}}}", asked.to_str().unwrap());
    let more = [&set[..], &["solver.steady.stability_time=9", &from]].concat();
    on_case(directory.path(), "run", "naca0012_heave", &more, "again", &[]).expect(0, &[]);
    let log = std::fs::read_to_string(directory.path().join("again/log.jsonl")).unwrap();
    assert!(log.contains("`solver.steady.stability_time` has no effect here"), "{log}");
}

/// The steady flow around a cylinder at Re = 100 exists, but vortices are shed: the disturbance grows by exp(0.13 t).
#[test]
fn the_steady_flow_around_a_cylinder_at_re_100_is_unstable() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", "flow.order=4", "flow.gas.viscosity.constant=0.01", "solver.steady.stability_time=60"];
    on_case(directory.path(), "run", "cylinder_steady", &set, "run", &[]).expect(0, &[]);
    let steady = &summary(&directory.path().join("run"))["steady"];
    println!("{steady}");
    assert_eq!(steady["stability"]["unstable"], true, "{steady}");
}
