//! A case far from the origin of coordinates gives the same figures as at the origin.

#![allow(clippy::unwrap_used)]

mod common;

use common::{number, on_case, summary};
use std::path::Path;
use tempfile::TempDir;

/// The free-stream case of `dimension`, translated by `shift` along every axis.
fn free_stream(directory: &Path, dimension: usize, shift: &str) -> serde_json::Value {
    let name = if dimension == 2 { "free_stream" } else { "free_stream_3d" };
    let output = format!("{name}_{shift}");
    let corner = |x: &str| format!("[{}]", vec![x; dimension].join(","));
    let upper = format!("{}", shift.parse::<f64>().unwrap() + 1.0);
    let moved = |formula: &str| {
        let at = |axis: &str| format!("({axis}-({shift}))");
        formula.replace("X", &at("x")).replace("Y", &at("y"))
    };
    // Wavy in space and time.
    let first = moved("0.03*sin(pi*X)*cos(2*pi*Y)*sin(3*t) + 0.04*sin(2*t)");
    let second = moved("-0.04*cos(pi*X)*sin(2*pi*Y)*sin(2*t)");
    let third = moved("0.03*sin(pi*X)*sin(pi*Y)*t");
    let components = [first, second, third].map(|formula| format!("\"{formula}\""));
    let set = [
        format!("mesh.generate.box.lower={}", corner(shift)),
        format!("mesh.generate.box.upper={}", corner(&upper)),
        format!("motion.displacement=[{}]", components[..dimension].join(",")),
        "time.end=0.3".into(),
        "time.slabs=3".into(),
    ];
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    on_case(directory, "run", name, &set, &output, &[]).expect(0, &[]);
    summary(&directory.join(output))
}

/// With derivatives of absolute positions, the free-stream error would be 6.9e-13 at x = 100 and 5.8e-9 at x = 1e6, and the mass error
/// 1.5e-10 there: they lose the digits that positions have in common.
#[test]
fn free_stream_is_kept_far_from_the_origin() {
    let directory = TempDir::new().unwrap();
    for (dimension, shift) in [(2, "0"), (2, "100"), (2, "1000000"), (2, "-1000000"), (3, "0"), (3, "1000000")] {
        let summary = free_stream(directory.path(), dimension, shift);
        for key in ["conservation.free_stream_error", "conservation.mass_error"] {
            let error = number(&summary, key);
            assert!(error <= 1e-12, "{dimension}-D, x = {shift}: {key} = {error:e}");
        }
    }
}

/// Cells 5e-5 thin at a distance of 1,000.
#[test]
fn free_stream_is_kept_in_thin_cells() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box={lower=[1000,0],upper=[1000.0001,1],cells=[2,4]}",
        "motion.displacement=[\"0.04*sin(2*t)\",\"0.05*sin(2*pi*y)*sin(t)\"]",
        "time.end=0.3",
        "time.slabs=3",
    ];
    on_case(directory.path(), "run", "free_stream", &set, "thin", &[]).expect(0, &[]);
    let summary = summary(&directory.path().join("thin"));
    let error = number(&summary, "conservation.free_stream_error");
    assert!(error <= 1e-12, "{error:e}");
}

/// Both sides of a periodic pair have the same shape to the bit, also far away.
#[test]
fn free_stream_is_kept_across_a_periodic_pair() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.generate.box.lower=[1000000,0]",
        "mesh.generate.box.upper=[1000001,1]",
        "mesh.generate.box.periodic=[\"x\"]",
        "mesh.scramble=5",
        "motion.displacement=[\"0.04*sin(2*pi*y)*sin(2*t)\",\"0.03*sin(pi*y)*cos(2*pi*(x-1000000))*sin(3*t)\"]",
        "time.end=0.3",
        "time.slabs=3",
    ];
    on_case(directory.path(), "run", "free_stream", &set, "periodic", &[]).expect(0, &[]);
    let summary = summary(&directory.path().join("periodic"));
    let error = number(&summary, "conservation.free_stream_error");
    assert!(error <= 1e-12, "{error:e}");
}
