//! A run that goes on on another mesh.

use crate::common::{Surface, assert_same_bits, column, number, on_text, summary};
use crate::from;
use tempfile::TempDir;

/// A wave of density that the stream carries through a periodic box, on `mesh`; exact.
fn wave(mesh: &str, end: f64) -> String {
    format!(
        "mesh = {{ {mesh} }}
         flow.order = 4
         flow.reference = {{ density = 1, speed = 1, pressure = 10 }}
         flow.exact.expression = {{ density = \"1+0.2*sin(2*pi*(x-t))\", velocity = [1, 0.5], pressure = 10 }}
         time = {{ order = 2, end = {end}, step = 0.05 }}"
    )
}

/// Another mesh was refused: a flow that had developed on a coarse one could not go on on a finer one.
#[test]
fn a_restart_on_another_mesh_interpolates_the_flow() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let of = |cells: &str, order: usize| {
        format!(
            "order = {order}, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = {cells}, periodic = [\"x\", \"y\"], curving.wavy.amplitude = 0.03 }}"
        )
    };
    let (coarse, fine) = (of("[3, 2]", 3), of("[6, 3]", 4));
    let go = |text: &str, output: &str, set: &[&str]| on_text(at, text, set, output, &[]);
    go(&wave(&coarse, 0.2), "coarse", &[]).expect(0, &[]);
    go(&wave(&fine, 0.4), "fine", &[]).expect(0, &[]);
    let from = from(at, "coarse");
    go(&wave(&fine, 0.4), "refused", &[&from]).expect(2, &["6 cells", "18 cells", "restart.allow = [\"mesh\"]"]);
    let sets = [&from[..], "restart.allow=[\"mesh\"]"];
    go(&wave(&fine, 0.4), "restarted", &sets).expect(0, &[]);
    assert_eq!(column(&at.join("restarted"), "t"), column(&at.join("fine"), "t"));
    let error = |name: &str| number(&summary(&at.join(name)), "error.density_l2");
    let [coarse_error, restarted, fine_error] = ["coarse", "restarted", "fine"].map(error);
    println!("errors: coarse {coarse_error:.1e}, restarted {restarted:.1e}, fine {fine_error:.1e}");
    // The error of the coarse mesh goes on with the stream.
    let both = coarse_error.hypot(fine_error);
    assert!((fine_error..both).contains(&restarted), "{coarse_error:e} {restarted:e} {fine_error:e}");
    let balance = number(&summary(&at.join("restarted")), "conservation.mass_error");
    assert!(balance < 1e-12, "the balance begins at the restart: {balance:e}");

    let moved = "motion.displacement=[\"0.02*sin(2*pi*x)*sin(t)\",\"0\"]";
    go(&wave(&coarse, 0.2), "moved", &[moved]).expect(0, &[]);
    let moved = format!("restart.from={}", at.join("moved").display());
    go(&wave(&fine, 0.4), "refused", &[&moved, sets[1]]).expect(2, &["moved by up to", "at t = 0.2", "at rest only"]);
}

/// A stream along a wall, in so many cells of the box up to `upper`.
fn wall(cells: usize, upper: [f64; 2], rest: &str) -> String {
    format!(
        "mesh = {{ order = 3, generate.box = {{ lower = [0, 0], upper = {upper:?}, cells = [{cells}, {cells}] }} }}
         {rest}
         [flow]
         order = 4
         gas = {{ gamma = 1.4, prandtl = 0.72, viscosity.constant = 0.02 }}
         initial.uniform = {{ velocity = [0.5, 0], pressure = 1 }}
         boundary = {{ bottom.adiabatic_wall = {{}}, others.far_field = {{ velocity = [0.5, 0], pressure = 1 }} }}"
    )
}

/// The steady flow on a coarse mesh is the start of the search on a finer one.
#[test]
fn a_steady_flow_continues_on_a_finer_mesh() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let steady = "time = { order = 1, end = 0, step = 1 }\nsolver.steady.tolerance = 1e-10";
    let case = |cells: usize| wall(cells, [2.0, 1.0], steady);
    on_text(at, &case(4), &["output.surfaces.walls=[\"bottom\"]"], "coarse", &[]).expect(0, &[]);
    // The distribution was in a file alone, without intervals.
    let series =
        output::ResultReader::open(&at.join("coarse/result.vtkhdf")).unwrap().series("surface_bottom").unwrap();
    assert_eq!(series.unwrap().times, [0.0]);
    on_text(at, &case(8), &[], "direct", &[]).expect(0, &[]);
    on_text(at, &case(8), &[&from(at, "coarse"), "restart.allow=[\"mesh\"]"], "continued", &[]).expect(0, &[]);
    let of =
        |name: &str| (number(&summary(&at.join(name)), "steady.newton"), column(&at.join(name), "bottom_force_x")[0]);
    let ((steps_directly, directly), (steps, continued)) = (of("direct"), of("continued"));
    assert!(steps < steps_directly, "{steps} {steps_directly}");
    assert!((continued / directly - 1.0).abs() < 1e-8, "{continued} {directly}");
}

/// Averages and distributions have points of the mesh. The history goes on, and a run that continues there resumes with the same bits.
#[test]
fn what_has_points_of_the_mesh_begins_anew_on_another_one() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let case = |cells: usize, upper: [f64; 2]| {
        let observed = "output = { surfaces = { walls = [\"bottom\"], every = 1 }, averages = { from = 0.05, fields = [\"velocity\"] } }";
        wall(cells, upper, &format!("time = {{ order = 2, end = 0.2, step = 0.05 }}\n{observed}"))
    };
    let (coarse, fine) = (case(2, [2.0, 1.0]), case(3, [2.0, 1.0]));
    on_text(at, &coarse, &[], "coarse", &[]).expect(0, &[]);
    let start = [&from(at, "coarse")[..], "restart.allow=[\"mesh\"]"];
    let go = |text: &str, end: &'static str, output: &str, extra: &[&str]| {
        on_text(at, text, &[&start[..], &[end]].concat(), output, extra)
    };
    let told = ["the averages begin at t = 0.2, and not at 0.05"];
    go(&fine, "time.end=0.4", "through", &[]).expect(0, &told);
    go(&fine, "time.end=0.3", "resumed", &[]).expect(0, &told);
    go(&fine, "time.end=0.4", "resumed", &["--resume"]).expect(0, &[]);
    assert_same_bits(&at.join("through"), &at.join("resumed"), "resumed on another mesh");
    assert_eq!(column(&at.join("through"), "t").len(), 8);
    let times = Surface::read(&at.join("through"), "bottom").column("t");
    assert!((times[0] - 0.2).abs() < 1e-12 && times.iter().all(|t| *t >= times[0]), "{times:?}");

    let wider = go(&case(3, [2.4, 1.0]), "time.end=0.25", "wider", &[]);
    wider.expect(0, &["nodes lie outside of the mesh of", "up to 4.0e-1"]);
    let part = go(&case(3, [0.02, 0.01]), "time.end=0.25", "part", &[]);
    part.expect(0, &["this mesh is a small part", "x from 0 to 2, y from 0 to 1", "compare units"]);
    let millimetres = go(&case(3, [2000.0, 1000.0]), "time.end=0.25", "refused", &[]);
    millimetres.expect(2, &["there: x from 0 to 2, y from 0 to 1; here: x from 0 to 2000", "compare places and units"]);
}

/// The polynomials of a cell with a jump overshoot. Density and pressure of the new state were negative, and a vacuum \"in the initial state\" was
/// blamed.
#[test]
fn a_jump_within_a_cell_gives_no_negative_pressure_on_another_mesh() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let case = |cells: usize, time: &str| {
        let beside = |state: [f64; 2]| {
            format!("far_field = {{ density = {}, pressure = {}, velocity = [0, 0] }}", state[0], state[1])
        };
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 0.1], cells = [{cells}, 1], periodic = [\"y\"] }} }}
             time = {{ order = 2, {time} }}
             [flow]
             order = 6
             initial.expression = {{ density = \"if(x<0.52,1,0.01)\", velocity = [0, 0], pressure = \"if(x<0.52,1,0.001)\" }}
             boundary = {{ left.{}, right.{} }}
             shock_capturing = {{}}
             reference = {{ density = 1, speed = 1, pressure = 1 }}",
            beside([1.0, 1.0]),
            beside([0.01, 0.001])
        )
    };
    on_text(at, &case(5, "end = 1e-9, step = 1e-9"), &[], "coarse", &[]).expect(0, &[]);
    let start = [&from(at, "coarse")[..], "restart.allow=[\"mesh\"]"];
    let run = on_text(at, &case(23, "end = 1e-4, step = 1e-4"), &start, "fine", &[]);
    assert!(run.stderr.contains("nodes begin with the mean of a cell there"), "{}", run.stderr);
    assert!(!run.stderr.contains("initial state"), "{}", run.stderr);
}

/// A run whose search for a steady flow was not finished has the initial state, which was taken without a word.
#[test]
fn a_search_that_was_not_finished_is_told() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let steady = "time = { order = 1, end = 0.1, step = 0.1 }\nsolver.steady = { steps = 1, sequence = false }";
    on_text(at, &wall(3, [2.0, 1.0], steady), &[], "unfinished", &[]).expect(1, &[]);
    let marched = wall(3, [2.0, 1.0], "time = { order = 1, end = 0.1, step = 0.1 }");
    on_text(at, &marched, &[&from(at, "unfinished")], "marched", &[]).expect(0, &["was not finished", "--resume"]);
}

/// Keys of the start that are new in a restart of a run that has marched were ignored without a word.
#[test]
fn new_keys_of_the_start_are_told_to_have_no_effect() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let until =
        |end: f64, rest: &str| wall(3, [2.0, 1.0], &format!("time = {{ order = 1, end = {end}, step = 0.1 }}\n{rest}"));
    let layer = "solver.start_layer = 0.1";
    on_text(at, &until(0.1, layer), &[], "marched", &[]).expect(0, &[]);
    let from = [&from(at, "marched")[..]];
    let same = on_text(at, &until(0.2, layer), &from, "same", &[]);
    assert!(same.code == 0 && !same.stderr.contains("no effect"), "{}", same.stderr);
    for (rest, key) in [("solver.start_layer = 0.2", "solver.start_layer"), ("solver.steady = {}", "solver.steady")] {
        let told = format!("`{key}` has no effect here");
        on_text(at, &until(0.2, rest), &from, key, &[]).expect(0, &[&told, "has marched to t = 0.1"]);
    }
}
