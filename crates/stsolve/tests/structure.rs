//! A structure as a case: frequencies, energy, loads, files, resumption.

#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_same_bits, column, finished, number, on_case, on_text, shipped, stsolve, summary};
use tempfile::TempDir;

/// Frequency of samples q_k of a vibration, `step` apart: the best fit of q_{k-1} + q_{k+1} = 2 cos(2 pi f dt) q_k.
fn fitted_frequency(q: &[f64], step: f64) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for q in q.windows(3) {
        above += q[1] * (q[0] + q[2]);
        below += 2.0 * q[1] * q[1];
    }
    (above / below).acos() / step / std::f64::consts::TAU
}

/// Every coordinate of history.csv oscillates at the frequency of its mode, and the energy balance is closed.
#[test]
fn modes_swing_at_their_frequencies() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "cantilever", &["time.end=0.012"]);
    let run = directory.path().join("cantilever");
    for mode in 1..=3 {
        let exact = summary["structure"]["natural_frequencies"][mode - 1].as_f64().unwrap();
        let found = fitted_frequency(&column(&run, &format!("mode_{mode}")), 2e-4);
        assert!((found / exact - 1.0).abs() < 1e-4, "mode {mode}: {found} against {exact}");
    }
    // The energy of a blow without loads and moving supports.
    let energy = |key: &str| number(&summary, &format!("structure.{key}"));
    assert_eq!((energy("load_work"), energy("support_work")), (0.0, 0.0));
    assert!(energy("energy_error").abs() < 1e-9 * energy("energy_at_start"));
    assert!(energy("dissipation") > 0.0 && energy("energy") < energy("energy_at_start"));
    assert_eq!(column(&run, "tip_y").len(), 60);
}

/// The summary of a structure alone has the amplitudes and frequencies of its points, like that of a structure in a flow.
#[test]
fn amplitude_and_frequency_of_a_point_are_told() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "turek_hron_csm3", &["mesh.order=3", "time.end=2"]);
    let tip = column(&directory.path().join("turek_hron_csm3"), "tip_y");
    let [low, high] = [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| tip.iter().copied().fold(0.0, pick));
    let found = |key: &str| number(&summary, &format!("bodies.structure.coordinates.tip_y.{key}"));
    assert!((found("amplitude") / (0.5 * (high - low)) - 1.0).abs() < 0.02, "{}", found("amplitude"));
    // Published: 1.0995 Hz.
    assert!((found("frequency") / 1.0995 - 1.0).abs() < 0.02, "{}", found("frequency"));
    let body = |key: &str| number(&summary, &format!("bodies.structure.{key}"));
    let energy = body("kinetic_energy") + body("strain_energy") + body("numerical_dissipation");
    assert!((energy / body("force_work") - 1.0).abs() < 1e-6, "{energy}");
}

/// A slowly applied weight ends in the deflection q L^4 / (8 E' I) of beam theory, and its work is the energy.
#[test]
fn a_slow_load_does_the_work_of_the_deflection() {
    let directory = TempDir::new().unwrap();
    let set = [
        "structure.initial={}",
        "structure.body_force=[0, \"-1e4*t\"]",
        "structure.boundary.top={traction=[0, \"-500*t\"]}",
        "structure.natural_modes=0",
        "time={order=2,end=1,step=0.1}",
    ];
    let summary = finished(directory.path(), "cantilever", &set);
    let run = directory.path().join("cantilever");
    let tip = *column(&run, "tip_y").last().unwrap();
    // q = 1e4 * 0.05 + 500, I = h^3 / 12, E' = E / (1 - nu^2).
    let beam_theory = -1000.0 * (1.0 - 0.33 * 0.33) / (8.0 * 70e9 * 0.05_f64.powi(3) / 12.0);
    assert!((tip / beam_theory - 1.0).abs() < 0.01, "{tip} against {beam_theory}");
    let (work, strain) = (number(&summary, "structure.load_work"), *column(&run, "strain_energy").last().unwrap());
    assert!((strain / work - 1.0).abs() < 0.02, "{strain} of {work}");
    assert!(number(&summary, "structure.energy_error").abs() < 1e-9 * work);
}

/// A shaken clamp in three dimensions, a pressure, a plane of symmetry.
#[test]
fn supports_move_in_three_dimensions() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh={order=3,generate={box={lower=[0,0,0],upper=[1,0.2,0.1],cells=[3,1,1]}}}",
        "structure.initial={}",
        "structure.points={tip=[1,0.1,0.1]}",
        "structure.boundary={left={displacement=[0,0,\"1e-3*(1-cos(300*t))\"]},bottom={held=[\"y\"]},back={pressure=1e3},others=\"free\"}",
        "time={order=3,end=0.01,step=0.001}",
    ];
    let summary = finished(directory.path(), "cantilever", &set);
    let run = directory.path().join("cantilever");
    assert!(column(&run, "tip_z").iter().any(|z| z.abs() > 1e-3));
    let (loads, supports) = (number(&summary, "structure.load_work"), number(&summary, "structure.support_work"));
    let size = loads.abs() + supports.abs();
    assert!(supports.abs() > 0.0 && loads.abs() > 0.0);
    assert!(number(&summary, "structure.energy_error").abs() < 1e-8 * size, "{summary}");
}

/// The static analysis of a bar under its weight, `set` apart.
fn hanging(directory: &std::path::Path, set: &[&str]) -> serde_json::Value {
    let still = [
        "structure.analysis=\"static\"",
        "structure.initial={}",
        "structure.natural_modes=0",
        "structure.young_modulus=1e5",
        "structure.body_force=[\"3*t\", \"-2*t\"]",
        "mesh.generate.box.cells=[4,1]",
        "time={order=1,end=1,slabs=2}",
    ];
    finished(directory, "cantilever", &[&still[..], set].concat())
}

/// No file had the force of a clamp. A node of two supports counts once, for the first one.
#[test]
fn reactions_of_supports_carry_the_weight() {
    let directory = TempDir::new().unwrap();
    let run = directory.path().join("cantilever");
    let weight = |t: f64| [3.0, -2.0].map(|b: f64| 0.05 * b * t);
    let assert_carried = |columns: [&[&str]; 2]| {
        for (i, columns) in columns.into_iter().enumerate() {
            let columns: Vec<Vec<f64>> = columns.iter().map(|name| column(&run, name)).collect();
            for (step, t) in [0.5, 1.0].into_iter().enumerate() {
                let carried: f64 = columns.iter().map(|column| column[step]).sum();
                assert!((carried + weight(t)[i]).abs() < 1e-10, "axis {i}: {carried}, {columns:?}");
            }
        }
    };
    let clamped = hanging(directory.path(), &[]);
    assert_carried([&["left_reaction_x"], &["left_reaction_y"]]);
    // There is no velocity without inertia.
    assert!(clamped["bodies"]["structure"].get("velocity").is_none(), "{clamped}");
    hanging(directory.path(), &["structure.boundary={left=\"fixed\",bottom={held=[\"y\"]},others=\"free\"}"]);
    assert_carried([&["left_reaction_x"], &["left_reaction_y", "bottom_reaction_y"]]);
    assert!(column(&run, "bottom_reaction_y")[1] > 0.05);
}

/// The table of times had nothing but orthogonalisation.
#[test]
fn products_and_preconditioners_of_a_structure_are_timed() {
    let directory = TempDir::new().unwrap();
    for set in
        [&["structure.law=\"neo_hookean\""][..], &["structure.law=\"neo_hookean\"", "structure.analysis=\"dynamic\""]]
    {
        let summary = hanging(directory.path(), set);
        for part in ["product", "preconditioner", "preconditioner_setup"] {
            assert!(number(&summary, &format!("cost.parts.{part}.calls")) > 0.0, "{part}: {summary}");
        }
    }
}

/// The error had the text of a factorisation.
#[test]
fn a_structure_without_supports_is_told_that_it_can_move() {
    let directory = TempDir::new().unwrap();
    for boundary in ["others=\"free\"", "others={held=[\"x\"]}"] {
        let set = ["structure.analysis=\"static\"", "structure.initial={}", "structure.natural_modes=0"];
        let boundary = format!("structure.boundary={{{boundary}}}");
        let outcome = on_case(directory.path(), "run", "cantilever", &[&set[..], &[&boundary]].concat(), "free", &[]);
        outcome.expect(2, &["can move as a rigid body", "structure.boundary"]);
    }
}

/// A point had the name of a reaction, and readers of history.csv found the wrong one of two columns.
#[test]
fn a_point_with_the_name_of_a_reaction_is_refused() {
    let directory = TempDir::new().unwrap();
    let points = "structure.points={left_reaction=[0.5,0.01]}";
    let outcome = on_case(directory.path(), "run", "cantilever", &[points], "twice", &[]);
    outcome.expect(2, &["two columns of history.csv would be named `left_reaction_x`", "a point"]);
}

#[test]
fn a_structure_resumes_with_the_same_bits() {
    let directory = TempDir::new().unwrap();
    let go = |end: &str, output: &str, extra: &[&str]| {
        let set = ["mesh.generate.box.cells=[4,1]", "mesh.order=4", "output.every=3", end];
        on_case(directory.path(), "run", "cantilever", &set, output, extra).expect(0, &[]);
    };
    go("time.end=0.004", "through", &["--threads", "1"]);
    go("time.end=0.0024", "resumed", &["--threads", "2"]);
    go("time.end=0.004", "resumed", &["--threads", "2", "--resume"]);
    assert_same_bits(&directory.path().join("through"), &directory.path().join("resumed"), "structure");
    assert_eq!(summary(&directory.path().join("resumed"))["slabs"], 20);
}

#[test]
fn what_does_not_go_with_a_structure_is_refused() {
    let directory = TempDir::new().unwrap();
    for (set, parts) in [
        ("motion.displacement=[0,0]", &["a structure without a flow moves by itself"][..]),
        ("structure.density=-1", &["the density is out of range", "a positive number"]),
        ("structure.poisson_ratio=0.5", &["Poisson's ratio is out of range", "below 0.5"]),
        ("structure.points.tip=[2,0]", &["the point is out of range", "a point inside the structure"]),
        ("structure.points={\"a\\nb\"=[0.5,0.025]}", &["the name of the point is out of range", "on one line"]),
        ("structure.boundary.left={held=[\"z\"]}", &["structure.boundary.left.held[0]", "two-dimensional"]),
        ("structure.initial.displacement=[0,1e-3]", &["not that of boundary `left`"]),
    ] {
        on_case(directory.path(), "run", "cantilever", &[set], "run", &[]).expect(2, parts);
    }
    let bad_load = ["structure.body_force=[0,\"1/(t-t)\"]"];
    on_case(directory.path(), "run", "cantilever", &bad_load, "run", &[])
        .expect(1, &["the force on the structure at t ="]);
    stsolve(directory.path(), &["motion", &shipped("cantilever.toml")]).expect(2, &["use `stsolve run`"]);
}

/// The flag swings far under five times its weight, and Newton's method fails in one of these long slabs.
#[test]
fn a_slab_that_cannot_be_solved_is_halved() {
    let directory = TempDir::new().unwrap();
    let heavy = ["mesh.order=3", "structure.body_force=[0,-10000]", "time.step=0.1", "time.end=0.6"];
    let summary = finished(directory.path(), "turek_hron_csm3", &heavy);
    assert!(number(&summary, "rejected_slabs") >= 1.0, "{summary}");
    assert!(number(&summary, "structure.energy_error").abs() < 1e-4, "{summary}");
}

/// These keys were ignored.
/// A small plate that is thrown fast did not fall: its weight is below the rounding of stiffness times displacement of a node.
#[test]
fn a_thrown_plate_falls() {
    let directory = TempDir::new().unwrap();
    for law in ["linear", "neo_hookean"] {
        let case = format!(
            r#"
            mesh = {{ order = 3, generate.box = {{ lower = [0, 0], upper = [0.001, 0.0005], cells = [4, 2] }} }}
            time = {{ order = 2, end = 1, slabs = 20 }}
            [structure]
            law = "{law}"
            young_modulus = 2e11
            poisson_ratio = 0.3
            density = 7800
            body_force = [0, "-7800*9.81"]
            boundary = {{ others = "free" }}
            initial = {{ velocity = [300, 0] }}
            points = {{ p = [0.001, 0.00025] }}
            "#
        );
        on_text(directory.path(), &case, &[], law, &[]).expect(0, &[]);
        let path = column(&directory.path().join(law), "p_y");
        let y = path[path.len() - 1];
        assert!((y + 4.905).abs() < 1e-3, "{law}: {y}");
    }
}

#[test]
fn what_only_a_flow_has_is_refused_without_one() {
    let directory = TempDir::new().unwrap();
    let case = shipped("cantilever.toml");
    for (change, message) in [
        ("time.adaptive={tolerance=1e-3}", "`time.adaptive` has no effect without a flow"),
        ("solver.steady={}", "`solver.steady` has no effect without a flow"),
        ("output.integrals=[\"entropy\"]", "`output.integrals` has no effect without a flow"),
        ("solver.start_layer=0.1", "`solver.start_layer` has no effect without a flow"),
    ] {
        stsolve(directory.path(), &["check", &case, "--set", change]).expect(2, &[message]);
    }
}

/// St. Venant-Kirchhoff carries -E / 3^(3/2) at most under compression. Beyond, bodies were turned inside out without a word, and the
/// failure of a body was told as round-off.
#[test]
fn a_body_is_never_inside_out() {
    let case = |rest: &str| {
        format!(
            "mesh = {{ order = 3, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [2, 2] }} }}\n\
             time = {{ order = 2, end = 1, slabs = 4 }}\n[structure]\nyoung_modulus = 1\npoisson_ratio = 0\nlaw = \"st_venant_kirchhoff\"\n{rest}"
        )
    };
    let supported = "boundary.left.held = [\"x\"]\nboundary.bottom.held = [\"y\"]\nboundary.top = \"free\"\n";
    let loaded = format!("analysis = \"static\"\n{supported}boundary.right = {{ traction = [\"-t\", 0] }}\n");
    let start = format!("density = 1\n{supported}boundary.right = \"free\"\ninitial.displacement = [\"-3*x\", 0]\n");
    for (rest, cause) in [(loaded, "exceed what the body can carry"), (start, "turns a cell inside out")] {
        let directory = TempDir::new().unwrap();
        std::fs::write(directory.path().join("body.toml"), case(&rest)).unwrap();
        let failed = stsolve(directory.path(), &["run", "body.toml"]);
        failed.expect(1, &[cause]);
        assert!(!failed.stderr.contains("round-off") && !failed.stderr.contains("shear wave"), "{}", failed.stderr);
    }
}

/// Damping of a structure alone was told as the error of the integration in time.
#[test]
fn damping_is_no_numerical_dissipation() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 4, generate.box = { lower = [0, 0], upper = [1, 0.1], cells = [4, 1] } }
        time = { order = 3, end = 1, slabs = 40 }
        [structure]
        young_modulus = 100
        poisson_ratio = 0
        density = 1
        damping = { mass = 0.5, stiffness = 0.01 }
        boundary.left.held = ["x"]
        boundary.bottom.held = ["y"]
        boundary.top.held = ["y"]
        boundary.right = "free"
        initial.displacement = ["0.01*sin(pi*x/2)", 0]
    "#;
    std::fs::write(directory.path().join("case.toml"), case).unwrap();
    stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--quiet"]).expect(0, &[]);
    let told = summary(&directory.path().join("run"));
    let [damped, numerical] =
        ["damped", "numerical_dissipation"].map(|name| number(&told["bodies"]["structure"], name));
    assert!(damped > 1e-4 && numerical.abs() < 1e-3 * damped, "{damped:e} {numerical:e}");
}

/// A support that bends or jumps within a slab stayed where the quadrature of its velocity had taken it.
#[test]
fn supports_reach_the_position_that_a_case_prescribes() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 3, generate = { box = { lower = [0, 0], upper = [1, 1], cells = [3, 3] } } }
        time = { order = 2, end = 1, slabs = 10 }
        [structure]
        young_modulus = 10
        poisson_ratio = 0.3
        density = 1
        points = { moved = [1, 1] }
        [structure.boundary]
        left = "fixed"
        right = { displacement = ["WAY", 0] }
        others = "free"
    "#;
    for (way, end) in [("0.1*min(t/0.33, 1)", 0.1), ("if(t < 0.5, 0, 0.1)", 0.1), ("0.01*sin(40*pi*t)", 0.0)] {
        std::fs::write(directory.path().join("case.toml"), case.replace("WAY", way)).unwrap();
        let run = ["run", "case.toml", "--output", "run", "--force", "--set", "time.order=1"];
        for arguments in [&run[..5], &run] {
            stsolve(directory.path(), arguments).expect(0, &[]);
            let at = directory.path().join("run");
            let moved = *column(&at, "moved_x").last().unwrap();
            assert!((moved - end).abs() < 1e-13, "{way}: {moved}");
            let error = number(&summary(&at), "structure.energy_error");
            assert!(
                error.abs() < 1e-10 * number(&summary(&at), "structure.support_work").abs().max(1e-3),
                "{way}: {error}"
            );
        }
    }
}
