//! Input that cannot be used ends the command with code 2 and a message.

use crate::common::shipped;
use crate::{is_empty, outcome};
use std::path::Path;
use tempfile::TempDir;

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

/// Exact states that are not solutions, or not what their name says.
#[test]
fn exact_states_that_are_none_are_refused() {
    let directory = TempDir::new().unwrap();
    let sutherland = "flow.gas.viscosity={sutherland={viscosity=0.02,temperature=0.8,constant=0.1}}";
    let still = "flow.exact.vortex.free_stream={density=1,velocity=[0,0],pressure=1}";
    for (case, set, parts) in [
        ("couette.toml", sutherland, ["flow.exact.couette", "`flow.gas.viscosity.constant`"]),
        ("vortex.toml", still, ["flow.exact.vortex.strength", "that moves"]),
    ] {
        let (code, _, stderr) = outcome(directory.path(), &["check", &shipped(case), "--set", set]);
        assert_eq!(code, 2, "{stderr}");
        parts.iter().for_each(|part| assert!(stderr.contains(part), "{part}: {stderr}"));
    }
}

/// A curved inlet that bends back: gas at rest was sucked out where the direction points out of the domain.
#[test]
fn an_inflow_points_into_the_domain_everywhere() {
    let directory = TempDir::new().unwrap();
    let case = |angle: f64| {
        format!(
            r#"
            constants = {{ A = {angle} }}
            mesh = {{ order = 4, generate.box = {{ lower = [0, -1], upper = [1, 1], cells = [3, 8], map = ["-(0.5+0.5*x)*cos(A*y)", "-(0.5+0.5*x)*sin(A*y)"] }} }}
            time = {{ order = 2, end = 0.1, slabs = 4 }}
            [flow]
            order = 3
            reference = {{ density = 1, speed = 0.1, pressure = 1 }}
            initial.uniform = {{ density = 1, velocity = [0, 0], pressure = 1 }}
            boundary.right.inflow = {{ total_pressure = 1, total_temperature = 1, direction = [1, 0] }}
            boundary.others = "slip_wall"
            "#
        )
    };
    for (angle, expected) in [(1.5, 0), (1.7, 2)] {
        std::fs::write(directory.path().join("arc.toml"), case(angle)).unwrap();
        let (code, _, stderr) = outcome(directory.path(), &["check", "arc.toml"]);
        assert_eq!(code, expected, "{angle}: {stderr}");
        assert!(code == 0 || stderr.contains("inflow.direction") && stderr.contains("outward normal"), "{stderr}");
    }
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
    std::fs::write(directory.path().join("my case.toml"), "[mesh]").unwrap();
    for (file, expected) in [
        ("my case.toml", "`stsolve check 'my case.toml'` explains it"),
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
