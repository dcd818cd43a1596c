//! Vortices leave through an outflow.

use crate::common::{assert_same_bits, number, on_text, summary};
use crate::{pressure_off, survives};
use tempfile::TempDir;

/// A vortex that leaves a box at M = 0.3 through its right side, at t = 5. The strength is the largest velocity in units of the
/// stream, times sqrt(e).
const VORTEX: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [-5, -4]
upper = [5, 4]
cells = [10, 8]
[flow]
order = 4
exact = { uniform = { density = 1, velocity = [1, 0], mach = 0.3 } }
[flow.initial.vortex]
free_stream = { density = 1, velocity = [1, 0], mach = 0.3 }
centre = [0, 0]
strength = 2.5
[flow.boundary]
right = { outflow = { pressure = 7.936507936507937 } }
others = { far_field = { density = 1, velocity = [1, 0], mach = 0.3 } }
[time]
order = 2
end = 8
step = 0.1
"#;

/// At a strength of 2.5 a run fails at t = 5.1 if gas that comes back has the entropy and the shear of the gas inside.
#[test]
fn vortices_leave_through_an_outflow() {
    for strength in ["1", "2.5", "4"] {
        let summary = survives(VORTEX, &[&format!("flow.initial.vortex.strength={strength}")]);
        // The weakest vortex is slower than the stream, so nothing comes back.
        if strength == "1" {
            assert!(summary["openings"]["right"].get("backflow").is_none(), "{summary}");
            continue;
        }
        let backflow = &summary["openings"]["right"]["backflow"];
        assert!((2.0..6.0).contains(&number(backflow, "since")), "{summary}");
        assert!((0.05..0.7).contains(&number(backflow, "largest_share")), "{summary}");
    }
}

/// The same through an outflow that lets sound pass.
#[test]
fn vortices_leave_through_an_outflow_of_velocity() {
    for strength in ["2.5", "4"] {
        let outflow = "flow.boundary.right={ outflow = { pressure = 7.936507936507937, velocity = [1, 0] } }";
        survives(VORTEX, &[&format!("flow.initial.vortex.strength={strength}"), outflow]);
    }
}

#[test]
#[ignore = "a minute"]
fn the_pressure_is_that_of_the_outlet_30_after_a_vortex() {
    let directory = TempDir::new().unwrap();
    for strength in ["1", "2.5", "4"] {
        let set = [&format!("flow.initial.vortex.strength={strength}")[..], "time.end=30"];
        on_text(directory.path(), VORTEX, &set, strength, &["--quiet"]).expect(0, &[]);
        let off = pressure_off(&directory.path().join(strength));
        assert!(off < 1e-3, "{strength}: {off:e}");
    }
}

/// Checkpoints hold the observations of a run at its openings.
#[test]
fn a_resumed_run_knows_what_came_back() {
    let directory = TempDir::new().unwrap();
    let coarse = ["mesh.generate.box.cells=[5,4]", "flow.order=3"];
    let to = |end: &str, output: &str, extra: &[&str]| {
        on_text(directory.path(), VORTEX, &[&coarse[..], &[end]].concat(), output, extra).expect(0, &[]);
    };
    to("time.end=5", "through", &[]);
    to("time.end=4.5", "resumed", &[]);
    to("time.end=5", "resumed", &["--resume"]);
    let at = |name: &str| directory.path().join(name);
    assert_same_bits(&at("through"), &at("resumed"), "resumed");
    let [through, resumed] = ["through", "resumed"].map(|name| summary(&at(name))["openings"].clone());
    assert_eq!(through, resumed);
    assert!(number(&through, "right.backflow.since") < 4.5, "{through}");
}
