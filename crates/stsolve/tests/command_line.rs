//! The command as a user meets it: exit codes, messages, files.

#![allow(clippy::unwrap_used)]

mod common;

use common::{shipped, stsolve};
use std::path::Path;
use tempfile::TempDir;

/// Calls the program in `directory`; exit code, stdout, stderr.
fn outcome(directory: &Path, arguments: &[&str]) -> (i32, String, String) {
    let common::Outcome { code, stdout, stderr } = stsolve(directory, arguments);
    (code, stdout, stderr)
}

fn is_empty(directory: &TempDir) -> bool {
    std::fs::read_dir(directory.path()).unwrap().next().is_none()
}

#[test]
fn check_explains_every_shipped_case_and_writes_nothing() {
    let directory = TempDir::new().unwrap();
    for name in ["vortex", "vortex_sinusoidal", "free_stream", "free_stream_3d", "couette", "manufactured"] {
        let case = shipped(&format!("{name}.toml"));
        let (code, stdout, stderr) = outcome(directory.path(), &["check", &case, "--probe", "never"]);
        assert_eq!((code, stderr.as_str()), (0, ""), "{name}");
        for part in
            [name, "Mach number", "flow unknowns", "defaults taken", "solver.newton_tolerance", "warnings\n  none"]
        {
            assert!(stdout.contains(part), "{name}: no {part}");
        }
    }
    assert!(is_empty(&directory));
}

#[test]
fn check_as_json_has_the_numbers() {
    let case = shipped("vortex.toml");
    let (code, stdout, _) =
        outcome(Path::new("."), &["check", "--json", &case, "--set", "flow.order=6", "--probe", "never"]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(code, 0);
    assert_eq!(json["mesh"]["cells"], 100);
    // 100 cells, 2 nodes in time, 4 components, 6^2 nodes.
    assert_eq!(json["unknowns and memory"]["flow unknowns"], 28800);
    assert!((json["flow"]["Mach number"].as_f64().unwrap() - 0.5).abs() < 1e-14);
}

/// The smallest measurement of every group: counted quantities are present and positive; seconds are not tested.
#[test]
fn bench_as_json_has_the_roofs_and_a_row_per_kernel() {
    let arguments = ["bench", "--json", "--orders", "2", "--dimension", "2", "--nodes", "8", "--seconds", "0"];
    let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((code, stderr.as_str()), (0, ""));
    for roof in ["gflops_one", "gflops_all", "gbytes_one", "gbytes_all"] {
        assert!(json["machine"][roof].as_f64().unwrap() > 0.0, "{roof}");
    }
    let rows = json["rows"].as_array().unwrap();
    let of = |kernel: &str| rows.iter().find(|row| row["kernel"] == kernel).unwrap();
    // The peak was once a twentieth of that of the kernels: the crate that measured it was not optimised.
    let peak = json["machine"]["gflops_one"].as_f64().unwrap();
    assert!(cfg!(debug_assertions) || peak > of("product")["gflops"].as_f64().unwrap(), "{peak}");
    for kernel in ["elasticity operator", "residual", "product", "FGMRES vectors"] {
        assert!(of(kernel)["gflops"].as_f64().unwrap() > 0.0, "{kernel}");
    }
    for kernel in ["product with mesh", "preconditioner", "preconditioner set-up", "elasticity solve"] {
        assert!(of(kernel)["million_per_second"].as_f64().unwrap() > 0.0, "{kernel}");
    }
    // 4 x 4 cells, 2 nodes in time, 4 components, 2 x 2 nodes.
    assert_eq!(of("residual")["unknowns"], 512.0);
}

/// What ranks send is within 5 % of the model of docs/src/clusters.md.
#[test]
fn bench_counts_messages_beside_their_model() {
    let (code, stdout, _) = outcome(Path::new("."), &["bench", "--json", "--kernel", "messages", "--orders", "3,4"]);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let rows = json["messages"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 2 * 4);
    for row in rows {
        let of = |quantity: &str| ["counted", "model"].map(|which| row[which][quantity].as_f64().unwrap());
        let ([messages, most], [bytes, model]) = (of("messages"), of("bytes"));
        assert!((bytes - model).abs() <= 0.05 * model, "{row}");
        // A rank of which all cells at a cut come first has nothing for the neighbour on the way back.
        let fewest = if row["kernel"] == "application, blocks" { most / 2.0 } else { most };
        assert!((fewest..=most).contains(&messages), "{row}");
    }
}

#[test]
fn bench_refuses_what_it_cannot_measure() {
    for (option, value) in [("--orders", "1"), ("--orders", "17"), ("--kernel", "gpu"), ("--seconds", "nan")] {
        let arguments = ["bench", option, value];
        let (code, _, stderr) = outcome(Path::new("."), &arguments);
        assert_eq!(code, 2);
        assert!(stderr.contains(value), "{stderr}");
    }
}

#[test]
fn check_tries_what_the_run_will_do() {
    let case = shipped("vortex.toml");
    let (code, stdout, _) = outcome(Path::new("."), &["check", "--json", &case, "--set", "time.end=2.5"]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(code, 0);
    // At t = 2 the square is stretched to 1.1 and squeezed to 0.9.
    let mesh = &json["mesh over the run"];
    let [proved, met] = ["det J / det J_0", "smallest met"].map(|key| mesh[key].as_f64().unwrap());
    assert!((proved - 0.99).abs() < 1e-6 && (met - 0.99).abs() < 1e-6, "{mesh}");
    for part in ["residual", "Krylov iteration", "making the preconditioner", "a slab", "the run"] {
        assert!(json["seconds, measured"][part].as_f64().unwrap() > 0.0, "{part}");
    }
    // The square travels by 2.5, changed by up to 0.5 by its deformation.
    assert!((json["motion"]["amplitude A"].as_f64().unwrap() - 1.25).abs() < 0.3, "{}", json["motion"]);
    assert_eq!(json["warnings"]["none"], "");
}

#[test]
fn check_warns_of_doubtful_choices_and_names_the_remedy() {
    let airfoil = shipped("naca0012_heave.toml");
    let viscosity = "flow.gas.viscosity.constant=1e-7";
    for (settings, subject, remedy) in [
        (&["time.step=0.5", "time.order=1"][..], "slab length", "`time.step` of"),
        (&["mesh.generate.airfoil.far_field=5"], "far field", "`far_field`"),
        (&["mesh.generate.airfoil={first_cell=0.2}"], "first cell", "`first_cell`"),
        (&["flow.quadrature={points=5}"], "quadrature", "\"conserving\""),
        (&["motion.boundary.airfoil.displacement=[0, \"t\"]"], "start of the motion", "at_rest"),
        (&["motion={displacement=[0, \"0.5*t\"]}"], "start of the motion", "with a speed of 5.00e-1"),
        (
            &["flow.gas={viscosity={sutherland={viscosity=2e-2,temperature=288.15,constant=110.4}}}"],
            "Sutherland's law",
            "`flow.gas.gas_constant`",
        ),
        // This one starts from rest, although it is fast within the first slab.
        (&["motion.boundary.airfoil.displacement=[0, \"0.1*sin(pi*t)^2\"]"], "none", ""),
        (&["motion.boundary.airfoil.displacement=[0, \"3*t^2\"]"], "speed of walls", "`shock_capturing = {}`"),
        (&["flow.gas.gamma=14"], "ratio of specific heats", "1.4 for air"),
        (&["flow.initial.uniform.mach=0.9"], "Mach number", "`shock_capturing = {}`"),
        (&["flow.initial.uniform.mach=0.05", "flow.riemann=\"lax_friedrichs\""], "Mach number", "\"roe\""),
        (&[viscosity], "turbulence", "lower Reynolds number"),
        (&["solver={newton_tolerance=1e-5}"], "start of the flow", "`[solver.steady]`"),
        (&["flow.gas.viscosity=\"inviscid\""], "viscosity", "slip_wall"),
        (&["flow.boundary.airfoil=\"symmetry\"", "flow.forces={}"], "none", ""),
        (
            &["flow.boundary.airfoil={far_field={velocity=[1,0],mach=0.2}}", "flow.forces={}"],
            "moving boundary",
            "flow.boundary.airfoil",
        ),
        (&["flow.exact={uniform={velocity=[1,0],mach=0.2}}"], "exact solution", "`flow.initial`"),
        (&["flow.rotation={rate=0.5}"], "rotating frame", "`prescribed_state = { expression"),
        (&["solver.preconditioner=\"lines\""], "preconditioner", "\"blocks\""),
        (&["output.every=1", "flow.order=16", "time.step=0.001"], "result file", "`output.every`"),
    ] {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let arguments: Vec<&str> = ["check", "--json", "--probe", "never", &airfoil].into_iter().chain(set).collect();
        let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
        assert_eq!((code, stderr.as_str()), (0, ""), "{settings:?}");
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let warnings = json["warnings"].as_object().unwrap();
        assert_eq!(warnings.keys().collect::<Vec<_>>(), [subject], "{settings:?}");
        assert!(warnings[subject].as_str().unwrap().contains(remedy), "{settings:?}: {warnings:?}");
    }
    // Cells alone suffice for it.
    let (_, stdout, _) =
        outcome(Path::new("."), &["check", "--json", "--probe", "never", &shipped("vortex_period.toml")]);
    assert!(stdout.contains("\"none\":\"\"") && !stdout.contains("sound crosses"), "{stdout}");
    let (_, stdout, _) = outcome(Path::new("."), &["check", "--json", "--probe", "never", &airfoil]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(json["warnings"]["none"], "", "the case as it is shipped");
    // The airfoil moves by a chord, A = 1/2, at 8/9 at most: h' = (24 t^2 - 12 t^3) / 16 at t = 4/3.
    let number = |section: &str, key: &str| json[section][key].as_f64().unwrap();
    assert!((number("motion", "amplitude A") - 0.5).abs() < 1e-9);
    assert!((number("flow", "reduced frequency") - 8.0 / 9.0).abs() < 1e-3);
    assert!((number("flow", "Strouhal number") - 8.0 / 9.0 / std::f64::consts::PI).abs() < 1e-3);
    // Blasius at Re = 1000: u_tau / U = sqrt(0.332 / sqrt(1000)).
    let wall_units = number("walls", "first cell") * 1000.0 * (0.332 / 1000.0_f64.sqrt()).sqrt();
    assert!((number("walls", "first cell in wall units") / wall_units - 1.0).abs() < 1e-12);
}

/// Bodies were left out: a prescribed motion that starts suddenly, and walls beside them that bulge with their mesh.
#[test]
fn check_warns_of_doubtful_bodies() {
    let warns = |case: &str, settings: &[&str], subject: &str| {
        let case = shipped(case);
        let mut arguments = vec!["check", "--json", "--probe", "never", &case];
        settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
        let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
        assert_eq!((code, stderr.as_str()), (0, ""), "{settings:?}");
        serde_json::from_str::<serde_json::Value>(&stdout).unwrap()["warnings"].get(subject).is_some()
    };
    let cylinder = "cylinder_viv.toml";
    assert!(warns(cylinder, &["bodies.cylinder.y={motion=\"0.1*t\"}"], "start of the motion"));
    assert!(!warns(cylinder, &["bodies.cylinder.y={motion=\"0.1*t^2\"}"], "start of the motion"));
    let (walls, subject) = ("flow.boundary.far=\"slip_wall\"", "wall beside a body");
    assert!(warns(cylinder, &[walls, "bodies.cylinder.mesh.between.outer=60"], subject));
    assert!(!warns(cylinder, &[walls], subject));
    let released = "solver.steady={bodies=\"equilibrium\"}";
    assert!(warns(cylinder, &[released, "bodies.cylinder.x={}"], "equilibrium"));
    assert!(!warns(cylinder, &[released], "equilibrium"));
    // These walls move along themselves.
    let beside = ["mesh.generate.box.periodic=[]", "flow.boundary.others=\"slip_wall\""];
    assert!(!warns("piston_free.toml", &beside, subject));
}

#[test]
fn check_tells_when_the_mesh_will_fail() {
    let case = shipped("airfoil_motion.toml");
    let set = ["--set", "motion.elasticity.stiffness=constant"];
    let (code, stdout, _) = outcome(Path::new("."), &["check", "--json", &case, set[0], set[1]]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let warning = json["warnings"]["mesh"].as_str().unwrap();
    assert!(code == 0 && warning.contains("from t = 0.12") && warning.contains("inverse_jacobian"), "{warning}");
}

#[test]
fn the_schema_is_valid_json_and_lists_the_sections() {
    let (code, stdout, _) = outcome(Path::new("."), &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(code, 0);
    for section in ["title", "constants", "mesh", "motion", "flow", "time", "solver", "output"] {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

#[test]
fn completions_know_every_command_and_option() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let (code, stdout, stderr) = outcome(Path::new("."), &["completions", shell]);
        assert_eq!((code, stderr.as_str()), (0, ""), "{shell}");
        for word in ["run", "motion", "check", "info", "schema", "completions", "output", "threads", "resume"] {
            assert!(stdout.contains(word), "{shell}: no {word}");
        }
    }
    assert_eq!(outcome(Path::new("."), &["completions", "csh"]).0, 2);
}

#[test]
fn bad_input_ends_with_code_2_names_the_place_and_writes_nothing() {
    let directory = TempDir::new().unwrap();
    let case = shipped("vortex.toml");
    for command in ["run", "motion", "check"] {
        let (code, stdout, stderr) = outcome(directory.path(), &[command, &case, "--set", "flow.order=17"]);
        assert_eq!((code, stdout.as_str()), (2, ""), "{command}");
        assert_eq!(
            stderr,
            "error: --set flow.order=17: the order of the flow is out of range\n  accepted: 2 to 16 nodes per direction\n"
        );
    }
    assert!(is_empty(&directory));
}

#[test]
fn an_error_in_the_file_shows_its_line() {
    let directory = TempDir::new().unwrap();
    let text = std::fs::read_to_string(shipped("couette.toml")).unwrap();
    let file = directory.path().join("damaged.toml");
    std::fs::write(&file, text.replace("prandtl = 0.72", "prandlt = 0.72")).unwrap();
    let (code, _, stderr) = outcome(directory.path(), &["run", "damaged.toml"]);
    let line = text.lines().position(|line| line.contains("prandtl")).unwrap() + 1;
    assert_eq!(code, 2);
    assert!(stderr.starts_with(&format!("error: damaged.toml:{line}:")), "{stderr}");
    assert!(stderr.contains("^^^^^^^") && stderr.contains("did you mean `prandtl`?"), "{stderr}");
    assert!(!directory.path().join("runs").exists());
}

#[test]
fn files_that_are_not_there_or_not_ours_are_refused() {
    let directory = TempDir::new().unwrap();
    let (code, _, stderr) = outcome(directory.path(), &["run", "nowhere.toml"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("nowhere.toml") && stderr.contains("No such file"), "{stderr}");
    std::fs::write(directory.path().join("text.vtkhdf"), "no HDF5").unwrap();
    let (code, _, stderr) = outcome(directory.path(), &["info", "text.vtkhdf"]);
    assert!(!stderr.contains("resum"), "{stderr}");
    assert_eq!(code, 2);
    assert!(stderr.contains("text.vtkhdf"), "{stderr}");
    std::fs::write(directory.path().join("case.toml"), "[mesh]").unwrap();
    for (file, expected) in [
        ("nowhere", "`nowhere` cannot be read: No such file"),
        (".", "`./result.vtkhdf` cannot be read: No such file"),
        ("case.toml", "`case.toml` is a case; `stsolve check case.toml` explains it"),
        ("summary.json", "is neither the result of a run, `result.vtkhdf`, nor a mesh file"),
    ] {
        std::fs::write(directory.path().join("summary.json"), "{}").unwrap();
        let (code, _, stderr) = outcome(directory.path(), &["info", file]);
        assert!(code == 2 && stderr.contains(expected), "{file}: {stderr}");
    }
}

#[test]
fn an_output_directory_that_cannot_be_written_is_refused() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("file"), "").unwrap();
    let case = shipped("free_stream.toml");
    let (code, _, stderr) = outcome(directory.path(), &["run", &case, "--output", "file/inside"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("cannot write into the output directory `file/inside`"), "{stderr}");
}

#[test]
fn a_command_line_that_makes_no_sense_is_bad_input() {
    for arguments in
        [&["walk"][..], &[], &["run"], &["run", "a.toml", "--threads", "0"], &["run", "a.toml", "-q", "-v"]]
    {
        let (code, ..) = outcome(Path::new("."), arguments);
        assert_eq!(code, 2, "{arguments:?}");
    }
}

#[test]
fn what_goes_into_a_pipe_is_plain_text() {
    let directory = TempDir::new().unwrap();
    let case = shipped("free_stream.toml");
    let short = ["--set", "time.end=0.1", "--set", "time.slabs=1"];
    let run = [&["run", &case, "--output", "run"][..], &short].concat();
    let motion = [&["motion", &case, "--output", "motion"][..], &short].concat();
    for arguments in [&run[..], &motion, &["check", &case], &["schema"], &["info", "run/result.vtkhdf"], &["--help"]] {
        let (code, stdout, stderr) = outcome(directory.path(), arguments);
        assert_eq!(code, 0, "{arguments:?}: {stderr}");
        assert!(!stdout.is_empty() || !stderr.is_empty(), "{arguments:?}");
        for text in [stdout, stderr] {
            assert!(!text.contains(['\x1b', '\r', '\x08']), "{arguments:?}: {text:?}");
        }
    }
    assert!(outcome(directory.path(), &run).1.is_empty(), "results are for files, progress is for stderr");
}

/// Calls the program in `directory`, for some seconds at most; exit code and stderr.
#[cfg(unix)]
fn outcome_in_time(directory: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = assert_cmd::Command::cargo_bin("stsolve").unwrap();
    let command = command.current_dir(directory).args(arguments).timeout(std::time::Duration::from_secs(20));
    let output = command.output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn a_pipe_or_an_endless_file_blocked() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    assert!(std::process::Command::new("mkfifo").arg(at.join("pipe")).status().unwrap().success());
    std::fs::create_dir(at.join("run")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(at.join("run/result.vtkhdf")).status().unwrap().success());
    std::fs::File::create(at.join("large.toml")).unwrap().set_len(1 << 40).unwrap();
    let (vortex, cantilever) = (shipped("vortex.toml"), shipped("cantilever.toml"));
    let mesh = |file: &str| format!("mesh={{file=\"{}\"}}", at.join(file).display());
    let table = |file: &str| format!("tables.m={{file=\"{}\"}}", at.join(file).display());
    let (mesh_pipe, mesh_zero, table_pipe) = (mesh("pipe"), mesh("/dev/zero"), table("pipe"));
    let from = format!("restart.from={}", at.join("run").display());
    let kind = "it is a pipe or a device, and a regular file is expected";
    for (arguments, expected) in [
        (&["check", "pipe"][..], kind),
        (&["run", "/dev/zero"], kind),
        (&["run", "."], "it is a directory"),
        (&["check", "large.toml"], "at most 16.0 MB are read"),
        (&["check", &vortex, "--set", &mesh_pipe], kind),
        (&["check", &vortex, "--set", &mesh_zero], kind),
        (&["check", &cantilever, "--set", &table_pipe], kind),
        (&["run", &vortex, "--output", "new", "--set", &from], "it is a directory, a pipe or a device"),
        (&["info", "pipe"], kind),
        (&["info", "/dev/zero"], kind),
        (&["info", "run"], kind),
    ] {
        let (code, stderr) = outcome_in_time(at, arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(expected), "{arguments:?}: {stderr}");
    }
    assert!(!at.join("new").exists());
}

/// A mesh or a run that cannot fit is refused with the memory that it needs, before it is allocated.
#[cfg(target_os = "linux")]
#[test]
fn what_is_too_large_aborted_without_naming_the_memory() {
    let directory = TempDir::new().unwrap();
    let needed = |case: &str, changes: &[&str], kilobytes: &str| {
        let script = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
        let mut command = assert_cmd::Command::new("bash");
        command.current_dir(directory.path()).args(["-c", &script]).arg(assert_cmd::cargo::cargo_bin("stsolve"));
        command.args(["run", "--threads", "1", &shipped(&format!("{case}.toml"))]);
        for change in changes {
            command.args(["--set", change]);
        }
        let output = command.output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{case}, {changes:?}: {stderr}");
        assert!(stderr.contains("does not fit into memory: about ") && stderr.contains(" are there"), "{stderr}");
        stderr
    };
    let message = needed("vortex", &["mesh.generate.box.cells=[1000000,1000000]"], "unlimited");
    assert!(message.contains("a mesh of 1000000000000 cells with 16 nodes each"), "{message}");
    needed("vortex", &["mesh.generate.box.cells=[9000000000,9000000000]"], "unlimited");
    needed("free_stream_3d", &["mesh.generate.box.cells=[1000,1000,1000]", "mesh.order=16"], "unlimited");
    needed("naca0012_wave", &["mesh.extrude.layers=1000000000"], "unlimited");
    needed("vortex", &["mesh.generate.box.cells=[3000,3000]"], "4000000");
    // The mesh fits, the blocks of its flow do not.
    let message = needed(
        "vortex_period",
        &["mesh.generate.box.cells=[100,100]", "flow.order=16", "flow.quadrature.points=16"],
        "4000000",
    );
    assert!(message.contains("the run does not fit into memory") && message.contains("`flow.order`"), "{message}");
    assert!(is_empty(&directory));
}

/// Two triangles in a rectangle of a height.
fn triangles(height: f64) -> String {
    format!(
        "NDIME= 2\nNELEM= 2\n5 0 1 2 0\n5 0 2 3 1\nNPOIN= 4\n0 0 0\n1 0 1\n1 {height} 2\n0 {height} 3\nNMARK= 1\nMARKER_TAG= wall\n\
         MARKER_ELEMS= 4\n3 0 1\n3 1 2\n3 2 3\n3 3 0\n"
    )
}

/// A file of triangles is described with the remedy; poor cells that come of them cause a warning.
#[test]
fn triangles_are_described_and_judged() {
    let directory = TempDir::new().unwrap();
    let case = "mesh = { file = \"mesh.su2\", split_simplices = true }\nmotion.displacement = [0, 0]\ntime = { order = 1, end = 1, slabs = 1 }\n";
    std::fs::write(directory.path().join("case.toml"), case).unwrap();
    for (height, is_poor) in [(1.0, false), (0.01, true)] {
        std::fs::write(directory.path().join("mesh.su2"), triangles(height)).unwrap();
        let (code, stdout, stderr) = outcome(directory.path(), &["info", "mesh.su2"]);
        assert_eq!(code, 0, "{stderr}");
        for part in ["2 triangles", "mesh.split_simplices = true", "smallest scaled Jacobian", "cells  "] {
            assert!(stdout.contains(part), "no {part} in {stdout}");
        }
        let (_, stdout, _) = outcome(directory.path(), &["info", "mesh.su2", "--json"]);
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(json["mesh"]["cells"], 6);
        assert!(json["problem"].as_str().unwrap().contains("triangles"));
        let (_, stdout, stderr) = outcome(directory.path(), &["check", "case.toml", "--json", "--probe", "never"]);
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap_or_else(|_| panic!("{stderr}"));
        let warning = json["warnings"]["cells"].as_str().unwrap_or_default();
        assert_eq!(warning.contains("the orthogonality of cell"), is_poor, "{json}");
        assert!(!warning.contains("the scaled Jacobian"), "{json}");
        let scaled_jacobian = json["mesh"]["smallest scaled Jacobian"].as_f64().unwrap();
        assert!((scaled_jacobian - 1.0 / 3.0).abs() < 1e-12, "{json}");
    }
}

/// A defect that was: a check of the pieces of well-shaped tetrahedra had no warning, and did not tell the scaled Jacobian.
#[test]
fn pieces_of_tetrahedra_are_warned_of() {
    let directory = TempDir::new().unwrap();
    let mesh = "NDIME= 3\nNELEM= 1\n10 0 1 2 3\nNPOIN= 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nNMARK= 1\nMARKER_TAG= wall\n\
                MARKER_ELEMS= 4\n5 0 1 2\n5 0 1 3\n5 0 2 3\n5 1 2 3\n";
    let case = "mesh = { file = \"mesh.su2\", split_simplices = true }\nmotion.displacement = [0, 0, 0]\n\
                time = { order = 1, end = 1, slabs = 1 }\n";
    std::fs::write(directory.path().join("mesh.su2"), mesh).unwrap();
    std::fs::write(directory.path().join("case.toml"), case).unwrap();
    let (_, stdout, stderr) = outcome(directory.path(), &["check", "case.toml", "--json", "--probe", "never"]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap_or_else(|_| panic!("{stderr}"));
    let table = &json["mesh"];
    assert!((table["smallest scaled Jacobian"].as_f64().unwrap() - 2.0 / 27.0).abs() < 1e-12, "{json}");
    assert!(table["most distorted cell"].as_u64().unwrap() < 4, "{json}");
    let warning = json["warnings"]["cells"].as_str().unwrap_or_default();
    assert!(warning.contains("the scaled Jacobian of cell") && warning.contains("a mesh of hexahedra"), "{json}");
}

/// The warnings of a case, and its table of outputs.
fn checked(case: &str, settings: &[&str]) -> (serde_json::Value, serde_json::Value) {
    let case = shipped(&format!("{case}.toml"));
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let arguments: Vec<&str> = ["check", "--json", "--probe", "never", &case].into_iter().chain(set).collect();
    let (code, stdout, stderr) = outcome(Path::new("."), &arguments);
    assert_eq!(code, 0, "{settings:?}: {stderr}");
    let mut json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    (json["warnings"].take(), json["output"].take())
}

#[test]
fn check_lists_what_is_observed_and_warns_where_there_is_nothing_to_see() {
    let inside = [
        "output.lines.a={from=[0.1,0.1],to=[0.9,0.8]}",
        "output.probes.b={at=[0.5,0.4]}",
        "output.formulas.c=\"2*pressure\"",
    ];
    let (warnings, output) = checked("free_stream", &inside);
    assert_eq!(warnings["none"], "", "{warnings}");
    for (key, name) in [("lines", "a"), ("points", "b"), ("fields by formulas", "c")] {
        assert_eq!(output[key][0], name, "{output}");
    }
    let (warnings, _) = checked("free_stream", &["output.lines.away={from=[7,7],to=[8,9]}"]);
    assert!(warnings["lines"].as_str().unwrap().contains("no point of `away`"), "{warnings}");
    let slice = |z: f64| format!("output.slices.a={{point=[0.5,0.5,{z}],normal=[0,0,1]}}");
    let (warnings, output) = checked("free_stream_3d", &[&slice(0.5)]);
    assert!(warnings["slices"].is_null() && output["slices"][0] == "a", "{warnings}");
    let (warnings, _) = checked("free_stream_3d", &[&slice(3.0)]);
    assert!(warnings["slices"].as_str().unwrap().contains("does not cut the mesh"), "{warnings}");
}

#[test]
fn check_warns_of_phases_that_the_run_does_not_meet() {
    let averages = |period: f64| format!("output.averages={{from=0,period={period},phases=4,fields=[\"velocity\"]}}");
    let end = ["time.end=1", "time.slabs=4"];
    let (warnings, _) = checked("free_stream", &[end[0], end[1], &averages(1.0)]);
    assert!(warnings["averages"].is_null(), "{warnings}");
    let (warnings, _) = checked("free_stream", &[end[0], end[1], &averages(1.5)]);
    assert!(warnings["averages"].as_str().unwrap().contains("less than their period"), "{warnings}");
}

/// Flows that the mesh does not resolve are told what keeps them stable, unless it is in use.
#[test]
fn check_advises_robust_quadrature_where_a_flow_is_not_resolved() {
    let advice = "`flow.quadrature = \"three_halves\"`";
    let tells = |case: &str, settings: &[&str], subject: &str| {
        let (warnings, _) = checked(case, settings);
        warnings[subject].as_str().is_some_and(|text| text.contains(advice))
    };
    assert!(tells("naca0012_heave", &["mesh.generate.airfoil={first_cell=0.2}"], "first cell"));
    assert!(tells("naca0012_heave", &["flow.gas.viscosity.constant=1e-7"], "turbulence"));
    assert!(!tells(
        "naca0012_heave",
        &["flow.gas.viscosity.constant=1e-7", "flow.quadrature=\"double\""],
        "turbulence"
    ));
    assert!(tells("taylor_green_3d", &["flow.quadrature=\"conserving\""], "resolution"));
    assert!(!tells("taylor_green_3d", &[], "resolution"));
}
