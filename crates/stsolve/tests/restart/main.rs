//! A run that starts from the result of another one, with the same or other orders.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod other_mesh;

use common::{Surface, assert_same_bits, column, number, on_case, summary};
use std::path::Path;
use tempfile::TempDir;

/// A vortex on few cells of a mesh that moves much.
const SMALL: [&str; 4] =
    ["mesh.generate.box.cells=[3,3]", "time.step=0.4", "constants.stretch=0.8", "solver.krylov_tolerance=1e-3"];

/// Runs the vortex to `end` into `output`.
fn run(directory: &Path, changes: &[&str], end: f64, output: &str) -> common::Outcome {
    let end = format!("time.end={end}");
    on_case(directory, "run", "vortex", &[&SMALL[..], changes, &[&end]].concat(), output, &[])
}

/// The key that starts a run from the result in `output`.
fn from(directory: &Path, output: &str) -> String {
    format!("restart.from={}", directory.join(output).display())
}

#[test]
fn a_restart_with_the_same_orders_leaves_no_trace() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &[], 2.8, "through").expect(0, &[]);
    run(at, &[], 2.0, "first").expect(0, &[]);
    run(at, &[&from(at, "first/result.vtkhdf")], 2.8, "second").expect(0, &[]);
    assert_same_bits(&at.join("through"), &at.join("second"), "restarted");
}

/// The error of the exact solution shows that a higher order improves the result from there on.
#[test]
fn a_restart_with_other_orders_keeps_mass_and_energy() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    // The residual left by Newton's method is not conserved either.
    let exactly = "solver.newton_tolerance=1e-13";
    let lower = ["flow.order=3", "time.order=2", exactly];
    run(at, &lower, 0.8, "first").expect(0, &[]);
    run(at, &lower, 1.6, "lower").expect(0, &[]);
    let from = from(at, "first");
    for (orders, name) in [([4, 2], "4"), ([5, 3], "5"), ([2, 1], "2"), ([3, 3], "time")] {
        let orders = [format!("flow.order={}", orders[0]), format!("time.order={}", orders[1])];
        run(at, &[&orders[0], &orders[1], &from, exactly], 1.6, name).expect(0, &[]);
        let run = at.join(name);
        for sum in ["mass_error", "energy_error"] {
            let error = number(&summary(&run), &format!("conservation.{sum}"));
            println!("to {orders:?}: {sum} {error:.1e}");
            assert!(error < 2e-14, "{orders:?}: {sum} = {error:e}");
        }
        assert_eq!(column(&run, "t").len(), 4, "rows before and after the restart");
        assert_eq!(summary(&run)["slabs"], 4);
    }
    let error = |name: &str| number(&summary(&at.join(name)), "error.density_l2");
    println!(
        "density errors: {:e} at orders 3, 2; then {:e} at 4, 2; {:e} at 5, 3",
        error("lower"),
        error("4"),
        error("5")
    );
    assert!(error("4") < error("lower") && error("5") < error("lower"));
}

/// Rows stood below the names of other columns, or were cut at wrong places.
#[test]
fn a_restart_finds_its_columns_by_their_names() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["output.integrals=[\"kinetic_energy\"]"], 0.8, "first").expect(0, &[]);
    run(at, &["output.integrals=[\"entropy\",\"kinetic_energy\"]", &from(at, "first")], 1.6, "second").expect(0, &[]);
    let of = |run: &str, name: &str| column(&at.join(run), name);
    assert_eq!(of("second", "kinetic_energy")[..2], of("first", "kinetic_energy"));
    assert_eq!(of("second", "energy")[..2], of("first", "energy"));
    assert_eq!(of("second", "entropy").iter().map(|s| s.is_nan()).collect::<Vec<_>>(), [true, true, false, false]);
}

/// The columns of a point went on at another place without a word.
#[test]
fn columns_that_mean_something_else_after_a_restart_are_told() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["output.probes.w={at=[5,5]}"], 0.4, "first").expect(0, &[]);
    let log = |name: &str| std::fs::read_to_string(at.join(name).join("log.jsonl")).unwrap();
    run(at, &["output.probes.w={at=[4,6]}", &from(at, "first")], 0.8, "second").expect(0, &[]);
    for told in ["`output.probes.w.at` differs from that of", "rows of history.csv up to t = 0.4"] {
        assert!(log("second").contains(told), "{}", log("second"));
    }
    run(at, &["output.probes={w={at=[5,5]},v={at=[4,6]}}", &from(at, "first")], 0.8, "third").expect(0, &[]);
    assert!(!log("third").contains("history.csv up to"), "{}", log("third"));
}

/// The integrals by other points differ by much more than a scheme may lose.
#[test]
fn a_restart_with_another_quadrature_begins_its_balances_anew() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let [exactly, lower] = ["solver.newton_tolerance=1e-13", "flow.order=3"];
    run(at, &[exactly, lower], 0.8, "first").expect(0, &[]);
    run(at, &[exactly, lower, "flow.quadrature=collocated_lobatto", &from(at, "first")], 1.6, "second").expect(0, &[]);
    for sum in ["mass_error", "energy_error"] {
        let error = number(&summary(&at.join("second")), &format!("conservation.{sum}"));
        println!("{sum} {error:.1e}");
        assert!(error < 1e-13, "{sum} = {error:e}");
    }
}

/// A slab in progress is finished first: the slabs of the case count from its own start.
#[test]
fn a_restart_joins_the_slabs_of_the_case() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["flow.order=3"], 1.2, "first").expect(0, &[]);
    run(at, &["flow.order=4", "time.step=0.5", &from(at, "first")], 2.0, "second").expect(0, &[]);
    let ends: Vec<f64> = column(&at.join("second"), "t").iter().map(|t| (t * 1e9).round() / 1e9).collect();
    assert_eq!(ends, [0.4, 0.8, 1.2, 1.5, 2.0]);
}

/// The steady flow of order 3 is near the one of order 5: both runs end with the same drag, the second with less work.
#[test]
fn a_steady_flow_is_found_from_that_of_a_lower_order() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |changes: &[&str], output: &str| {
        let small = ["mesh.order=3", "mesh.generate.annulus.cells=[12,8]", "time={order=1,end=0,step=1}"];
        on_case(at, "run", "cylinder_steady", &[&small[..], changes].concat(), output, &[]).expect(0, &[]);
        summary(&at.join(output))
    };
    go(&["flow.order=3"], "coarse");
    let scratch = go(&["flow.order=5"], "scratch");
    let continued = go(&["flow.order=5", &from(at, "coarse")], "continued");
    let [steps, iterations] = ["newton", "krylov"].map(|key| {
        let count = |run| number(run, &format!("steady.{key}"));
        [count(&scratch), count(&continued)]
    });
    println!("from the free stream and from order 3: {steps:?} Newton steps, {iterations:?} iterations");
    let drag = |run| number(run, "steady.walls.wall.drag_coefficient");
    assert!((drag(&scratch) - drag(&continued)).abs() < 1e-7, "{} {}", drag(&scratch), drag(&continued));
    assert!(steps[1] < steps[0] && iterations[1] < iterations[0], "{steps:?} {iterations:?}");
    assert_eq!(continued["slabs"], 0);
}

#[test]
fn what_does_not_fit_is_told() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["flow.order=2", "time.order=1"], 0.4, "first").expect(0, &[]);
    let from = from(at, "first");
    let refused = |changes: &[&str], end: f64, parts: &[&str]| {
        run(at, &[&[&from[..]], changes].concat(), end, "refused").expect(2, parts);
        assert!(!at.join("refused").exists(), "nothing is written");
    };
    refused(&["mesh.generate.box.cells=[3,4]"], 0.8, &["the mesh", "9 cells", "12 cells"]);
    refused(&["mesh.order=2"], 0.8, &["the mesh", "4 nodes each"]);
    refused(&["mesh.generate.box.upper=[6,5]"], 0.8, &["nodes of the mesh at rest"]);
    refused(&["flow.gas.gamma=1.3"], 0.8, &["the gas", "1.4", "1.3"]);
    refused(&["time.start=0.8", "motion.boundary.others=fixed"], 2.0, &["stands at t = 0.4", "covers t = 0.8 to 2"]);
    refused(&[], 0.4, &["stands at t = 0.4", "time.end"]);
    refused(&["restart.from=nowhere"], 0.8, &["nowhere", "does not exist"]);
    let three = on_case(at, "run", "free_stream_3d", &[&from], "refused", &[]);
    three.expect(2, &["the mesh", "in 2 dimensions", "in 3 dimensions"]);
    let motion = on_case(at, "run", "rotating_box", &[&from], "refused", &[]);
    motion.expect(2, &["restart", "[flow]"]);
}

/// Restarted with another stretch, the boundary would move by up to a tenth of the square in one slab.
#[test]
fn a_restart_accepted_a_motion_that_jumps() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["flow.order=2", "time.order=1"], 0.8, "first").expect(0, &[]);
    let from = from(at, "first");
    let jumps = ["at t = 0.8 the point at [", "is displaced by [", "the motion of this case puts it at ["];
    let still = "motion={boundary={others=\"fixed\"}}";
    let everywhere = "motion={displacement=[\"0.1*(x-5)*sin(pi*t/4)+t\",\"-0.1*(y-5)*sin(pi*t/4)\"]}";
    for (change, distance) in
        [("constants.stretch=0.3", ""), (still, ""), (everywhere, ""), ("constants.stretch=0.80001", "e-5 away")]
    {
        run(at, &["flow.order=2", "time.order=1", change, &from], 1.2, "refused").expect(2, &jumps);
        run(at, &["flow.order=2", "time.order=1", change, &from], 1.2, "refused").expect(2, &[distance]);
        assert!(!at.join("refused").exists(), "nothing is written");
    }
}

/// The square stops: the position is continuous, the velocity jumps by 1. A continuous motion gives no warning.
#[test]
fn a_restart_with_another_velocity_is_warned_of() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let low = ["flow.order=2", "time.order=1"];
    run(at, &low, 0.8, "first").expect(0, &[]);
    let from = from(at, "first");
    let x = |stop: &str| {
        let travel = format!("if(t<{stop},t,{stop})");
        format!(
            "motion.boundary.others.displacement=[\"stretch*(x-5)*sin(pi*t/4)+{travel}\",\"-stretch*(y-5)*sin(pi*t/4)\"]"
        )
    };
    for (motion, output, warns) in [(x("0.8"), "stops", true), (x("0.9"), "goes on", false)] {
        run(at, &[&low[..], &[&motion, &from]].concat(), 1.2, output).expect(0, &[]);
        let log = std::fs::read_to_string(at.join(output).join("log.jsonl")).unwrap();
        assert_eq!(log.contains("the boundary changes its velocity at once at t = 0.8"), warns, "{log}");
    }
}

/// From one Reynolds number to the next: the flow at Re = 10 is a better start for Re = 40 than the free stream.
#[test]
fn a_steady_flow_is_continued_to_another_viscosity_and_mach_number_if_that_is_allowed() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let small = [
        "mesh.order=3",
        "mesh.generate.annulus.cells=[12,8]",
        "time={order=1,end=0,step=1}",
        "flow.order=3",
        "output.surfaces={walls=[\"wall\"],every=1}",
    ];
    let go = |changes: &[&str], output: &str| {
        on_case(at, "run", "cylinder_steady", &[&small[..], changes].concat(), output, &[])
    };
    let drag = |output: &str| number(&summary(&at.join(output)), "steady.walls.wall.drag_coefficient");
    go(&["flow.gas.viscosity.constant=0.1"], "re_10").expect(0, &[]);
    let from = from(at, "re_10");
    let refused = go(&[&from], "refused");
    refused.expect(2, &["the gas", "0.1", "0.025", "restart.allow = [\"viscosity\"]"]);
    go(&[], "re_40").expect(0, &[]);
    go(&[&from, "restart.allow=[\"viscosity\"]"], "viscosity").expect(0, &[]);
    println!("C_D: Re = 10 {}, Re = 40 {}, continued {}", drag("re_10"), drag("re_40"), drag("viscosity"));
    assert!((drag("viscosity") - drag("re_40")).abs() < 1e-6 && drag("re_10") > drag("re_40") + 0.5);
    // The distribution at Re = 10 stood in the file, too, at the same time.
    let rows = |output: &str| Surface::read(&at.join(output), "wall").column("t").len();
    assert_eq!(rows("viscosity"), rows("re_40"));

    let faster = [
        "flow.gas.mach=0.3",
        "flow.initial.uniform.mach=0.3",
        "flow.boundary.far.far_field.mach=0.3",
        "flow.gas.viscosity.constant=0.1",
    ];
    go(&faster, "mach").expect(0, &[]);
    go(&[&faster[..], &[&from]].concat(), "refused").expect(2, &["the gas", "mach"]);
    go(&[&faster[..], &[&from, "restart.allow=[\"mach\"]"]].concat(), "continued_mach").expect(0, &[]);
    // The pressure of M = 0.1 with the gas constant of M = 0.3: the gas was hotter at once, without a word. The run need not succeed.
    let hot = ["flow.reference={density=1,speed=1,pressure=71.428571428}", "restart.allow=[\"mach\"]"];
    go(&[&faster[..], &[&from], &hot].concat(), "hot");
    let said = std::fs::read_to_string(at.join("hot/log.jsonl")).unwrap();
    assert!(said.contains("the temperature of all gas changes at once"), "{said}");
    println!("C_D at M = 0.3: {}, continued {}", drag("mach"), drag("continued_mach"));
    assert!((drag("continued_mach") - drag("mach")).abs() < 1e-6);
    let steps = |output: &str| number(&summary(&at.join(output)), "steady.newton");
    assert!(steps("continued_mach") < steps("mach"), "the pressure is shifted to its new level");
}

/// A wall that turns faster and faster: the flow at `time.start` of the case was searched, and the march went on at the time of the earlier run.
#[test]
fn a_steady_flow_is_searched_anew_at_the_time_reached() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let turning = "flow.boundary.wall.adiabatic_wall.slide=[\"-0.1*t*y\",\"0.1*t*x\"]";
    let small = ["mesh.order=3", "mesh.generate.annulus.cells=[8,6]", "flow.order=3", turning];
    let go = |changes: &[&str], output: &str| {
        on_case(at, "run", "cylinder_steady", &[&small[..], changes].concat(), output, &[])
    };
    let lift = |output: &str| number(&summary(&at.join(output)), "steady.walls.wall.lift_coefficient");
    let other = "flow.gas.viscosity.constant=0.03";
    go(&["time={order=1,start=5,end=5,step=0.1}"], "first").expect(0, &[]);
    go(&["time={order=1,start=5,end=5,step=0.1}", other], "expected").expect(0, &[]);
    let continued = ["time={order=1,end=5.1,step=0.1}", other, "restart.allow=[\"viscosity\"]"];
    go(&[&continued[..], &[&from(at, "first")]].concat(), "continued").expect(0, &[]);
    let (found, expected) = (lift("continued"), lift("expected"));
    assert!((found / expected - 1.0).abs() < 1e-5 && expected.abs() > 0.1, "{found} and {expected}");
}

/// `check` refuses the cases that a run would refuse.
#[test]
fn check_looks_at_the_result_that_a_run_would_start_from() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    run(at, &["flow.order=2", "time.order=1"], 0.4, "first").expect(0, &[]);
    let check = |changes: &[&str]| {
        let case = common::shipped("vortex.toml");
        let set = [&SMALL[..], &["time.end=0.8"], changes].concat();
        let mut arguments = vec!["check", &case];
        set.iter().for_each(|change| arguments.extend(["--set", change]));
        common::stsolve(at, &arguments)
    };
    let from = from(at, "first");
    check(&[&from]).expect(0, &[]);
    check(&["restart.from=nowhere"]).expect(2, &["nowhere", "does not exist"]);
    check(&[&from, "mesh.order=2"]).expect(2, &["the mesh", "4 nodes each"]);
    check(&[&from, "flow.gas.gamma=1.3"]).expect(2, &["the gas"]);
    std::fs::write(at.join("broken.vtkhdf"), "no result").unwrap();
    check(&[&format!("restart.from={}", at.join("broken.vtkhdf").display())]).expect(2, &["broken.vtkhdf"]);
}

/// Nodes that slide are where the elastic mesh has put them; the boundary does not jump.
#[test]
fn a_restart_goes_on_with_boundaries_that_slide() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |changes: &[&str], output: &str| on_case(at, "run", "elastic_piston", changes, output, &[]);
    go(&["time.end=0.25", "time.slabs=10"], "first").expect(0, &[]);
    go(&["time.end=0.5", "time.slabs=20", &from(at, "first")], "second").expect(0, &[]);
    go(&["time.end=0.5", "time.slabs=20"], "through").expect(0, &[]);
    assert_same_bits(&at.join("through"), &at.join("second"), "restarted");
}
