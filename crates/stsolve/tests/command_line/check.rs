//! `stsolve check` and `stsolve info` explain cases and files of meshes.

use crate::common::shipped;
use crate::{is_empty, outcome};
use std::path::Path;
use tempfile::TempDir;

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

/// Nothing told that the mesh had not been moved.
#[test]
fn check_tells_that_it_did_not_move_the_mesh() {
    for (probe, is_told) in [("auto", true), ("never", false)] {
        let arguments = ["check", "--json", "--probe", probe, &shipped("turbine_blade.toml")];
        let (_, stdout, _) = outcome(Path::new("."), &arguments);
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        let told = json["mesh over the run"]["not computed"].as_str();
        assert_eq!(told.is_some_and(|told| told.contains("`--probe always`")), is_told, "{probe}");
    }
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

/// Only cells of files were judged.
#[test]
fn poor_cells_of_a_map_are_warned_of() {
    let directory = TempDir::new().unwrap();
    for (shear, is_poor) in [(1, false), (100, true)] {
        let mesh = format!("lower = [0, 0], upper = [1, 1], cells = [2, 2], map = [\"x + {shear}*y\", \"y\"]");
        let case = format!(
            "mesh.order = 2\nmesh.generate.box = {{ {mesh} }}\nmotion.displacement = [0, 0]\ntime = {{ order = 1, end = 1, slabs = 1 }}\n"
        );
        std::fs::write(directory.path().join("case.toml"), case).unwrap();
        let (_, stdout, stderr) = outcome(directory.path(), &["check", "case.toml", "--json", "--probe", "never"]);
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap_or_else(|_| panic!("{stderr}"));
        let warning = json["warnings"]["cells"].as_str().unwrap_or_default();
        assert_eq!(warning.contains("the orthogonality of cell"), is_poor, "{json}");
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

/// Trial computations took all cores of a machine that others use too.
#[test]
fn check_takes_as_many_threads_as_it_is_told() {
    let arguments = ["check", "--json", "--probe", "always", "--threads", "1", &shipped("free_stream.toml")];
    let (_, stdout, _) = outcome(Path::new("."), &arguments);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(json["seconds, measured"]["threads"].as_f64(), Some(1.0), "{json}");
}
