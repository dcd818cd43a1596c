//! Averages over time and over phases: exact values, limits inside slabs, moving meshes, resumed runs.
#![allow(clippy::unwrap_used)]

#[path = "../common/mod.rs"]
mod common;

mod along;

use common::{assert_same_bits, on_case, on_text, shipped, stsolve};
use output::{RESULT_FILE, ResultReader, read_viewer_file};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Runs the case `text` into `run`, with `extra` arguments.
fn run(directory: &Path, text: &str, extra: &[&str]) {
    on_text(directory, text, &[], "run", &[&["--quiet"], extra].concat()).expect(0, &[]);
}

/// The array `name` at the last step of the run in `directory`.
fn last(directory: &Path, name: &str) -> Vec<f64> {
    let reader = ResultReader::open(&directory.join(RESULT_FILE)).unwrap();
    reader.exact(name, reader.times.len() - 1).unwrap().unwrap()
}

fn assert_all(values: &[f64], exact: f64, tolerance: f64, what: &str) {
    let error = values.iter().map(|value| (value - exact).abs()).fold(0.0, f64::max);
    assert!(!values.is_empty() && error < tolerance, "{what}: {error:e}");
}

/// The mean of t^n from a to b.
fn power(n: i32, [a, b]: [f64; 2]) -> f64 {
    (b.powi(n + 1) - a.powi(n + 1)) / (f64::from(n + 1) * (b - a))
}

/// A uniform gas in a periodic box with the velocity (0.1 + 0.3 t, -0.1 t^2): the solution is a polynomial in time, so that its
/// averages are exact to the tolerance of the solver.
const FALLING: &str = r#"
    mesh = { order = 3, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], periodic = ["x", "y"] } }
    flow = { order = 3, initial.uniform = { density = 2, velocity = [0.1, 0], pressure = 3 }, source = { acceleration = ["0.3", "-0.2*t"] } }
    time = { order = 5, end = 1, slabs = 4 }
    solver.newton_tolerance = 1e-12
"#;

#[test]
fn means_and_stresses_of_a_polynomial_are_exact_between_limits_inside_slabs() {
    let directory = TempDir::new().unwrap();
    let wanted = r#"
        [output.averages]
        from = 0.3
        to = 0.9
        fields = ["density", "velocity", "momentum", "pressure", "temperature", "reynolds_stress", "rms_density", "rms_pressure"]
    "#;
    run(directory.path(), &format!("{FALLING}{wanted}"), &[]);
    let at = |name: &str| last(&directory.path().join("run"), name);
    let mean = |n: i32| power(n, [0.3, 0.9]);
    let velocity = [0.1 + 0.3 * mean(1), -0.1 * mean(2)];
    for (name, factor) in [("mean_velocity", 1.0), ("mean_momentum", 2.0)] {
        for (cell, values) in at(name).chunks_exact(18).enumerate() {
            assert_all(&values[..9], factor * velocity[0], 1e-11, &format!("{name} x, {cell}"));
            assert_all(&values[9..], factor * velocity[1], 1e-11, &format!("{name} y, {cell}"));
        }
    }
    let stress = [
        ("xx", 0.09 * (mean(2) - mean(1).powi(2))),
        ("xy", -0.03 * (mean(3) - mean(1) * mean(2))),
        ("yy", 0.01 * (mean(4) - mean(2).powi(2))),
    ];
    for (name, exact) in stress {
        assert_all(&at(&format!("reynolds_stress_{name}")), exact, 1e-12, name);
    }
    let rest = [
        ("mean_density", 2.0),
        ("mean_pressure", 3.0),
        ("mean_temperature", 1.5),
        ("rms_density", 0.0),
        ("rms_pressure", 0.0),
    ];
    for (name, exact) in rest {
        assert_all(&at(name), exact, 1e-10, name);
    }
}

/// Every phase is averaged over its parts of both periods.
#[test]
fn phases_are_averaged_one_by_one() {
    let directory = TempDir::new().unwrap();
    let wanted =
        "output.averages = { from = 0.1, period = 0.4, phases = 2, fields = [\"velocity\", \"reynolds_stress\"] }";
    run(directory.path(), &format!("{FALLING}{wanted}"), &[]);
    let file = directory.path().join("run/phases.vtkhdf");
    let (times, velocity) = read_viewer_file(&file, "mean_velocity").unwrap();
    assert!((times[0] - 0.1).abs() < 1e-15 && (times[1] - 0.3).abs() < 1e-15 && times.len() == 2, "{times:?}");
    let (_, stress) = read_viewer_file(&file, "reynolds_stress_xx").unwrap();
    // The last period ends at 0.9; a tenth of the next one belongs to the first phase.
    let parts: [&[[f64; 2]]; 2] = [&[[0.1, 0.3], [0.5, 0.7], [0.9, 1.0]], &[[0.3, 0.5], [0.7, 0.9]]];
    for (phase, parts) in parts.iter().enumerate() {
        let whole: f64 = parts.iter().map(|[a, b]| b - a).sum();
        let mean = |n: i32| parts.iter().map(|part| power(n, *part) * (part[1] - part[0])).sum::<f64>() / whole;
        let values = &velocity[phase * velocity.len() / 2..][..velocity.len() / 2];
        let along = |axis: usize| values.iter().skip(axis).step_by(3).copied().collect::<Vec<_>>();
        assert_all(&along(0), 0.1 + 0.3 * mean(1), 1e-11, "x");
        assert_all(&along(1), -0.1 * mean(2), 1e-11, "y");
        assert_all(&along(2), 0.0, 1e-300, "z");
        let exact = 0.09 * (mean(2) - mean(1).powi(2));
        assert_all(&stress[phase * stress.len() / 2..][..stress.len() / 2], exact, 1e-12, "stress");
    }
    // The mean of all phases is that of the whole time.
    assert_all(
        &last(&directory.path().join("run"), "mean_velocity")[..9],
        0.1 + 0.3 * power(1, [0.1, 1.0]),
        1e-11,
        "all",
    );
}

/// A gas at rest whose density grows along x, on a mesh that moves by 0.2 t^2: its points see density fluctuate.
#[test]
fn averages_follow_the_points_of_the_mesh() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 3, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2] } }
        motion.displacement = ["0.2*t^2", 0]
        time = { order = 4, end = 1, slabs = 3 }
        solver.newton_tolerance = 1e-12
        [flow]
        order = 3
        exact.expression = { density = "1 + 0.1*x", velocity = [0, 0], pressure = 1 }
        reference = { density = 1, speed = 1, pressure = 1 }
        boundary.others = "exact"
        [output.averages]
        from = 0
        period = 1
        phases = 1
        fields = ["density", "rms_density", "rms_pressure"]
    "#;
    run(directory.path(), text, &[]);
    let at = |name: &str| last(&directory.path().join("run"), name);
    let rms = 0.02 * (power(4, [0.0, 1.0]) - power(2, [0.0, 1.0]).powi(2)).sqrt();
    assert_all(&at("rms_density"), rms, 1e-10, "rms");
    assert_all(&at("rms_pressure"), 0.0, 1e-9, "pressure");
    // Cell 0 lies between x = 0 and 0.5 at rest.
    for (i, value) in at("mean_density")[..9].iter().enumerate() {
        let rest = [0.0, 0.25, 0.5][i % 3];
        assert!((value - 1.0 - 0.1 * (rest + 0.2 * power(2, [0.0, 1.0]))).abs() < 1e-11, "{value} at {rest}");
    }
    let (_, points) = read_viewer_file(&directory.path().join("run/phases.vtkhdf"), "Points").unwrap();
    assert!((points[0] - 0.2 / 3.0).abs() < 1e-14 && points[1].abs() < 1e-14, "the mean mesh: {:?}", &points[..3]);
}

/// Averages that begin inside a slab and are interrupted, for one and two threads, against those of one run.
#[test]
fn averages_of_a_resumed_run_have_the_same_bits() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let averages = "output.averages={from=0.5,period=0.9,phases=3}";
    let set = ["mesh.generate.box.cells=[3,3]", "time.step=0.4", "constants.stretch=0.8", averages];
    let go = |end: &str, output: &str, extra: &[&str]| {
        let end = format!("time.end={end}");
        on_case(at, "run", "vortex", &[&set[..], &[&end]].concat(), output, extra).expect(0, &[]);
    };
    go("2", "through", &["--threads", "1"]);
    let fields = ["mean_velocity", "mean_density", "mean_pressure", "reynolds_stress_xy", "rms_pressure"];
    for threads in ["1", "2"] {
        go("1.2", threads, &["--threads", threads]);
        go("2", threads, &["--threads", threads, "--resume"]);
        assert_same_bits(&at.join("through"), &at.join(threads), threads);
        for name in fields {
            let [one, other] = ["through", threads].map(|run| last(&at.join(run), name));
            assert!(one.iter().map(|x| x.to_bits()).eq(other.iter().map(|x| x.to_bits())), "{name}, {threads} threads");
            let [one, other] =
                ["through", threads].map(|run| read_viewer_file(&at.join(run).join("phases.vtkhdf"), name));
            let ((times, one), (_, other)) = (one.unwrap(), other.unwrap());
            assert_eq!(times.len(), 3);
            assert!(one.iter().map(|x| x.to_bits()).eq(other.iter().map(|x| x.to_bits())), "phases: {name}");
        }
    }
    // Before their start there are none.
    let reader = ResultReader::open(&at.join("through").join(RESULT_FILE)).unwrap();
    assert!(reader.exact("mean_density", 1).unwrap().unwrap().iter().all(|value| value.is_nan()));
    stsolve(at, &["report", "through"]).expect(0, &[]);
    let page = fs::read_to_string(at.join("through/report.html")).unwrap();
    for label in ["Mean pressure", "Mean velocity, magnitude", "Kinetic energy of fluctuations", "Pressure, r.m.s."] {
        assert!(page.contains(label), "no {label} in the report");
    }
}

/// A run that starts from another one continues averages with the same settings, and begins others anew.
#[test]
fn a_restart_continues_averages_of_the_same_kind() {
    let directory = TempDir::new().unwrap();
    let averages = "output.averages={from=0.1,fields=[\"velocity\"]}";
    run(directory.path(), FALLING, &["--set", averages, "--set", "time.end=0.5", "--set", "time.slabs=2"]);
    let restart = |output: &str, set: &[&str]| {
        on_text(directory.path(), FALLING, &[&["restart.from=run"], set].concat(), output, &[])
    };
    restart("same", &[averages]).expect(0, &[]);
    assert_all(
        &last(&directory.path().join("same"), "mean_velocity")[..9],
        0.1 + 0.3 * power(1, [0.1, 1.0]),
        1e-11,
        "same",
    );
    let others = "output.averages={from=0.2,fields=[\"velocity\"]}";
    restart("others", &[others]).expect(0, &["they begin anew"]);
    assert_all(
        &last(&directory.path().join("others"), "mean_velocity")[..9],
        0.1 + 0.3 * power(1, [0.5, 1.0]),
        1e-11,
        "others",
    );
    // A run without averages: those of this one began late, without a word.
    on_text(directory.path(), FALLING, &["time.end=0.5", "time.slabs=2"], "none", &[]).expect(0, &[]);
    let late = on_text(directory.path(), FALLING, &["restart.from=none", averages], "late", &[]);
    late.expect(0, &["the averages begin at t = 0.5, and not at 0.1"]);
    assert_all(
        &last(&directory.path().join("late"), "mean_velocity")[..9],
        0.1 + 0.3 * power(1, [0.5, 1.0]),
        1e-11,
        "late",
    );
}

/// Distributions along walls have the means of a run that was not interrupted, after a restart too.
#[test]
fn a_restart_continues_means_along_walls() {
    let directory = TempDir::new().unwrap();
    let averages = "output.averages={from=0.1,fields=[\"velocity\"]}";
    let set = [averages, "output.surfaces={walls=[\"bottom\"],every=1}", "time.slabs=4"];
    let walls = FALLING
        .replace("[\"x\", \"y\"]", "[\"x\"]")
        .replace("} }\n    time", "}, boundary.others = \"slip_wall\" }\n    time");
    let go = |output: &str, more: &[&str]| {
        on_text(directory.path(), &walls, &[&set[..], more].concat(), output, &[]).expect(0, &[]);
    };
    go("through", &[]);
    go("half", &["time.end=0.5", "time.slabs=2"]);
    go("rest", &["restart.from=half"]);
    let mean = |run: &str| fs::read_to_string(directory.path().join(run).join("surface_bottom_mean.csv")).unwrap();
    assert_eq!(mean("rest"), mean("through"));
}

#[test]
fn check_tells_what_is_averaged() {
    let directory = TempDir::new().unwrap();
    let set = ["--set", "output.averages={from=0.25,period=0.3,phases=5}"];
    let out = stsolve(directory.path(), &[&["check", &shipped("free_stream.toml")], &set[..]].concat());
    for part in ["averages from", "0.25", "of 2.500 periods"] {
        assert!(out.stdout.contains(part), "no `{part}` in: {}", out.stdout);
    }
}

/// The first averages were those over 3e-16, and there was no warning of either.
#[test]
fn averages_outside_of_the_run_are_none() {
    for (key, set) in [
        ("from", ["time.slabs=3", "time.end=0.3", "output.averages.from=\"0.3 - 3e-16\""]),
        ("to", ["time.slabs=3", "time.end=0.3", "output.averages={from=-2,to=-1}"]),
    ] {
        let directory = TempDir::new().unwrap();
        let (case, set) = (shipped("free_stream.toml"), set.map(|change| ["--set", change]).concat());
        let told = ["the run has no averages", &format!("`output.averages.{key}`")];
        stsolve(directory.path(), &[&["run", &case, "--output", "run"], &set[..]].concat()).expect(0, &told);
        let checked = stsolve(directory.path(), &[&["check", &case], &set[..]].concat());
        assert!(checked.stdout.contains("the run has no averages"), "{}", checked.stdout);
    }
}

#[test]
fn averages_that_make_no_sense_are_refused() {
    let directory = TempDir::new().unwrap();
    let refused = [
        ("free_stream", "output.averages={from=0,fields=[\"enstrophy\"]}", "reynolds_stress"),
        ("free_stream", "output.averages={from=0,fields=[]}", "the list of averages is empty"),
        ("free_stream", "output.averages={from=0,fields=[\"density\",\"density\"]}", "is listed twice"),
        ("free_stream", "output.averages={from=\"1/0\"}", "a finite number"),
        ("free_stream", "output.averages={from=0.5,to=0.2}", "a time after their start, 0.5"),
        ("free_stream", "output.averages={from=0,period=1}", "the number of phases is missing"),
        ("free_stream", "output.averages={from=0,phases=4}", "`period` beside it"),
        ("free_stream", "output.averages={from=0,period=-1,phases=4}", "a positive number"),
        ("free_stream", "output.averages={from=0,period=1,phases=0}", "1 to 1000 phases"),
        ("free_stream", "output.averages={from=0,period=1e-9,phases=9}", "phases of 1e-4 or more"),
        ("free_stream", "output.averages={since=0}", "`from`"),
        ("free_stream", "output.averages={from=0,along=[\"z\"]}", "the mesh is two-dimensional"),
        ("free_stream", "output.averages={from=0,along=[\"x\",\"y\"]}", "1 at most"),
        ("cylinder_steady", "output.averages={from=0,along=[\"x\"]}", "not extruded along these directions"),
        ("cantilever", "output.averages={from=0}", "without a flow there is nothing to average"),
    ];
    for (case, change, message) in refused {
        let case = shipped(&format!("{case}.toml"));
        stsolve(directory.path(), &["check", &case, "--set", change]).expect(2, &[message]);
    }
}

/// Averages, and means along walls, went on over a flow of another gas.
#[test]
fn another_gas_begins_averages_anew() {
    let directory = TempDir::new().unwrap();
    let averages = "output.averages={from=0.1,fields=[\"velocity\"]}";
    let gas = |viscosity: f64| format!("flow.gas={{gamma=1.4,prandtl=0.72,viscosity={{constant={viscosity}}}}}");
    let thin = [averages, &gas(0.01), "time.end=0.5", "time.slabs=2"];
    on_text(directory.path(), FALLING, &thin, "thin", &[]).expect(0, &[]);
    let thick = [averages, &gas(0.02), "restart={from=\"thin\",allow=[\"viscosity\"]}"];
    let told = ["the averages begin at t = 0.5, and not at 0.1"];
    on_text(directory.path(), FALLING, &thick, "thick", &[]).expect(0, &told);
    let mean = &last(&directory.path().join("thick"), "mean_velocity")[..9];
    assert_all(mean, 0.1 + 0.3 * power(1, [0.5, 1.0]), 1e-11, "thick");
}

/// The mean along a wall was a straight line over the time in which a resumed run kept no distributions there, without a word.
#[test]
fn a_gap_in_distributions_along_a_wall_is_told() {
    let directory = TempDir::new().unwrap();
    let walls = FALLING
        .replace("[\"x\", \"y\"]", "[\"x\"]")
        .replace("} }\n    time", "}, boundary.others = \"slip_wall\" }\n    time");
    let go = |walled: &str, [end, slabs]: [&str; 2], extra: &[&str]| {
        let (surfaces, end) = (format!("output.surfaces={{walls={walled},every=1}}"), format!("time.end={end}"));
        let set = ["output.averages={from=0.1,fields=[\"velocity\"]}", &surfaces, &end, &format!("time.slabs={slabs}")];
        on_text(directory.path(), &walls, &set, "run", extra)
    };
    go("[\"bottom\",\"top\"]", ["0.5", "2"], &[]).expect(0, &[]);
    let fewer = go("[\"top\"]", ["0.75", "3"], &["--resume"]);
    assert!(fewer.code == 0 && !fewer.stderr.contains("distributions"), "{}", fewer.stderr);
    go("[\"bottom\",\"top\"]", ["1", "4"], &["--resume"])
        .expect(0, &["there are no distributions along `bottom` between t = 0.5 and 0.75"]);
}

/// A tenth of the size of a file with averages was told.
#[test]
fn check_tells_the_size_of_a_result_with_averages() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box.cells=[12,12]",
        "flow.order=6",
        "output.averages={from=0.1,fields=[\"velocity\",\"reynolds_stress\",\"kinetic_energy_budget\"]}",
        "output.every=1",
    ];
    on_text(directory.path(), FALLING, &set, "run", &[]).expect(0, &[]);
    let size = 1e-6 * fs::metadata(directory.path().join("run").join(RESULT_FILE)).unwrap().len() as f64;
    let case = directory.path().join("large.toml");
    fs::write(&case, FALLING).unwrap();
    let sets = set.iter().flat_map(|set| ["--set", *set]);
    let arguments: Vec<&str> = ["check", case.to_str().unwrap(), "--probe", "never"].into_iter().chain(sets).collect();
    let table = stsolve(directory.path(), &arguments).stdout;
    let row = table.lines().find(|line| line.contains("result file")).unwrap();
    let told: f64 = row.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    assert!((told / size - 1.0).abs() < 0.1, "{told} for {size}");
}
