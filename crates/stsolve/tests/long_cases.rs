//! Figures of README and docs, from runs of minutes: `scripts/test --long` runs these tests and writes docs/src/long.md.
//!
//! Each figure is printed as a line `| run | figure | value | reference | allowed |`, which that script collects.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{SLOW, column, number, on_case, power_of_rates, summary};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// A run of a shipped case, whole, in a directory of its own.
struct Run {
    directory: TempDir,
    title: String,
    summary: Value,
}

impl Run {
    fn new(case: &str, set: &[&str], title: &str) -> Self {
        let directory = TempDir::new().unwrap();
        on_case(directory.path(), "run", case, set, "run", &[]).expect(0, &[]);
        let summary = summary(&directory.path().join("run"));
        assert_eq!(summary["completed"], true);
        let run = Run { directory, title: format!("`{case}`{title}"), summary };
        println!(
            "| {} | seconds on {} threads | {:.1} | | |",
            run.title,
            run.summary["cost"]["threads"],
            run.at("cost.wall_seconds")
        );
        run
    }

    fn at(&self, path: &str) -> f64 {
        number(&self.summary, path)
    }

    /// Fails unless `value` is within `allowed` of `reference`.
    fn expect(&self, figure: &str, value: f64, reference: f64, allowed: f64) {
        println!("| {} | {figure} | {value:.7} | {reference} | {allowed:.1e} |", self.title);
        assert!((value - reference).abs() <= allowed, "{}: {figure} {value}, not {reference} +- {allowed}", self.title);
    }

    /// The same of the impulse and the work of the airfoil.
    fn expect_airfoil(&self, impulse: f64, work: f64, allowed: f64) {
        let wall = &self.summary["walls"]["airfoil"];
        self.expect("impulse", wall["impulse"][1].as_f64().unwrap(), impulse, allowed * impulse.abs());
        self.expect("work", wall["work"].as_f64().unwrap(), work, allowed * work.abs());
    }

    fn path(&self) -> std::path::PathBuf {
        self.directory.path().join("run")
    }
}

/// Against the workshop's finest run, from 63,632 quadrilaterals of degree 3.
const HEAVE: [f64; 2] = [-2.369197, -1.657725];

#[test]
#[ignore = "long: seconds to a minute; scripts/test --long"]
fn long_heaving_airfoil() {
    let run = Run::new("naca0012_heave", &[], "");
    run.expect_airfoil(HEAVE[0], HEAVE[1], 2e-4);
    run.expect("steady drag coefficient", run.at("steady.walls.airfoil.drag_coefficient"), 0.12001, 5e-5);
}

#[test]
#[ignore = "long: minutes; scripts/test --long"]
fn long_heaving_airfoil_on_896_cells() {
    let mesh = "mesh.generate.airfoil={ first_cell = 0.012, trailing_edge_cell = 0.015, surface_cells = 20, wake_cells = 12, normal_cells = 14, \
                near_wake = { extent = 2, cells = 9 }, near_wall = { extent = 0.6, cells = 9 } }";
    let set = [mesh, "mesh.order=6", "flow.order=6", "time.order=3", "time.step=0.05"];
    let run = Run::new("naca0012_heave", &set, ", 896 cells, N_s = 6, steps of 0.05");
    assert_eq!(run.summary["mesh"]["cells"], 896);
    run.expect_airfoil(HEAVE[0], HEAVE[1], 5e-5);
}

/// Case C2, against our own study on finer meshes, with its bars (docs/src/airfoils.md): there is no other.
#[test]
#[ignore = "long: seconds; scripts/test --long"]
fn long_heaving_and_pitching_airfoil() {
    let run = Run::new("naca0012_heave_pitch", &[], "");
    let wall = &run.summary["walls"]["airfoil"];
    run.expect("impulse", wall["impulse"][1].as_f64().unwrap(), 0.86392, 0.00701);
    run.expect("work", wall["work"].as_f64().unwrap(), -2.30283, 0.00574);
}

/// Case C2 at a Mach number of 0.01: the work hardly depends on the step, and the power is that of force and moment.
#[test]
#[ignore = "long: minutes; scripts/test --long"]
fn long_power_and_work_of_a_pitching_airfoil_at_a_low_mach_number() {
    let fine =
        Run::new("naca0012_heave_pitch", &[&SLOW[..], &["time.step=0.0125"]].concat(), ", M = 0.01, steps of 0.0125");
    let run = Run::new("naca0012_heave_pitch", &SLOW, ", M = 0.01");
    let work = fine.at("walls.airfoil.work");
    run.expect("work", run.at("walls.airfoil.work"), work, 5e-4 * work.abs());
    let (power, rates) = (column(&run.path(), "airfoil_power"), power_of_rates(&run.path()));
    let peak = rates.iter().fold(0.0, |peak: f64, power| peak.max(power.abs()));
    let apart = power.iter().zip(&rates).fold(0.0, |apart: f64, (a, b)| apart.max((a - b).abs()));
    run.expect("power against F h' + M theta', relative to its peak", apart / peak, 0.0, 1e-2);
}

/// Against our own study on finer meshes, with its error bars (docs/src/airfoils.md); there is no other reference.
#[test]
#[ignore = "long: minutes; scripts/test --long"]
fn long_heaving_and_pitching_airfoil_at_re_5000() {
    let run = Run::new("naca0012_paper", &[], "");
    run.expect("steady drag coefficient", run.at("steady.walls.airfoil.drag_coefficient"), 0.05253, 1e-4);
    let wall = &run.summary["walls"]["airfoil"];
    run.expect("impulse", wall["impulse"][1].as_f64().unwrap(), -1.36247, 0.00692);
    run.expect("work", wall["work"].as_f64().unwrap(), -3.63095, 0.01015);
}

/// Against the two finest results of the workshop's case M1, which agree to seven digits.
#[test]
#[ignore = "long: a minute; scripts/test --long"]
fn long_cylinder_m1() {
    let run = Run::new("cylinder_m1", &[], "");
    let wall = &run.summary["walls"]["wall"];
    run.expect("impulse", wall["impulse"][1].as_f64().unwrap(), -0.5915921, 2e-7);
    run.expect("work", wall["work"].as_f64().unwrap(), -0.3063148, 2e-7);
}

/// 1.52 is the value most often published for Re = 40; values spread by 2 %.
#[test]
#[ignore = "long: seconds; scripts/test --long"]
fn long_steady_cylinder_at_re_40() {
    let run = Run::new("cylinder_steady", &[], "");
    let finer = Run::new("cylinder_steady", &["flow.order=6", "mesh.order=6"], ", N_s = 6");
    let [drag, converged] = [&run, &finer].map(|run| run.at("steady.walls.wall.drag_coefficient"));
    run.expect("drag coefficient", drag, 1.52, 0.03);
    run.expect("drag coefficient against N_s = 6", drag, converged, 2e-3);
}

#[test]
#[ignore = "long: minutes; scripts/test --long"]
fn long_vortex_street_at_re_100() {
    let run = Run::new("cylinder_street", &[], "");
    let [strouhal, drag] = shedding(&run.path());
    run.expect("Strouhal number", strouhal, 0.165, 0.002);
    run.expect("mean drag coefficient", drag, 1.33, 0.01);
}

/// Strouhal number and mean drag with diameter and speed 1 over the last four whole periods, from upward zero to upward zero of the
/// lift.
fn shedding(run: &Path) -> [f64; 2] {
    let [t, dt, lift, drag] =
        ["t", "dt", "wall_lift_coefficient", "wall_drag_coefficient"].map(|name| column(run, name));
    let crossings: Vec<f64> = (1..t.len())
        .filter(|&k| lift[k - 1] < 0.0 && lift[k] >= 0.0)
        .map(|k| t[k - 1] - lift[k - 1] * (t[k] - t[k - 1]) / (lift[k] - lift[k - 1]))
        .collect();
    let [.., first, _, _, _, last] = crossings[..] else { panic!("{} periods only", crossings.len()) };
    let inside: Vec<usize> = (0..t.len()).filter(|&k| t[k] > first && t[k] <= last).collect();
    let integral: f64 = inside.iter().map(|&k| drag[k] * dt[k]).sum();
    [4.0 / (last - first), integral / inside.iter().map(|&k| dt[k]).sum::<f64>()]
}

/// Air of 288.15 K by Sutherland's law against constant viscosity. At M = 0.1 no gas is more than 0.2 % warmer than the stream,
/// which changes the viscosity by 0.15 %.
#[test]
#[ignore = "long: seconds; scripts/test --long"]
fn long_sutherland_cylinder_at_re_40() {
    let constant = Run::new("cylinder_steady", &[], "");
    // The temperature of the stream is 1: `flow.gas.mach` chooses R so.
    let law = "flow.gas.viscosity={ sutherland = { viscosity = 0.025, temperature = 1, constant = 0.38313 } }";
    let sutherland = Run::new("cylinder_steady", &[law], ", Sutherland's law");
    let [drag, law_drag] = [&constant, &sutherland].map(|run| run.at("steady.walls.wall.drag_coefficient"));
    sutherland.expect("drag coefficient", law_drag, drag, 2e-3 * drag);
    assert!(law_drag > drag, "a warmer gas is more viscous: {law_drag} and {drag}");
}

/// `scripts/shedding.py` prints the same.
#[test]
#[ignore = "long: needs python3; scripts/test --long"]
fn long_shedding_script_agrees() {
    let run = Run::new("cylinder_street", &["time.end=80", "mesh.order=4", "flow.order=4"], ", N_s = 4, to t = 80");
    let [strouhal, drag] = shedding(&run.path());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/shedding.py");
    let output = Command::new("python3").arg(script).arg(run.path()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with(&format!("St {strouhal:.4}  mean C_D {drag:.4}")), "{text}");
}
