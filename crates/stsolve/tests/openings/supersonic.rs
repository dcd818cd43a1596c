//! A supersonic stream, and the messages about openings that do not suit it or cannot be.

use crate::common::{number, on_text, stsolve, summary};
use crate::survives;
use tempfile::TempDir;

/// A stream at M = 2 through a box.
const SUPERSONIC: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [2, 1]
cells = [4, 2]
periodic = ["y"]
[flow]
order = 3
exact = { uniform = { density = 1, velocity = [1, 0], mach = 2 } }
[flow.boundary]
left = { supersonic_inflow = { uniform = { density = 1, velocity = [1, 0], mach = 2 } } }
right = { outflow = { pressure = 0.5 } }
[time]
order = 2
end = 1
step = 0.1
"#;

#[test]
fn a_supersonic_stream_enters_by_its_state() {
    let summary = survives(SUPERSONIC, &[]);
    assert!(number(&summary, "conservation.free_stream_error") < 1e-12, "{summary}");
    assert!(summary["openings"]["left"].get("subsonic").is_none(), "{summary}");
    assert!((number(&summary, "openings.left.mass_flow") + 1.0).abs() < 1e-12, "{summary}");
}

/// Check, run and summary report a supersonic stream through `inflow`.
#[test]
fn a_supersonic_stream_through_a_subsonic_inflow_is_told() {
    // p_0 = p 1.8^3.5 and T_0 = 1.8 T of M = 2.
    let inflow =
        "flow.boundary.left={ inflow = { total_pressure = 1.3973, total_temperature = 0.32143, direction = [1, 0] } }";
    let directory = TempDir::new().unwrap();
    let outcome = on_text(directory.path(), SUPERSONIC, &[inflow], "run", &[]);
    let told = "gas enters through the subsonic inflow `left` faster than sound (normal Mach number 2.000), on 100 % of it, since t = 0";
    assert!(outcome.stderr.contains(told), "{}", outcome.stderr);
    let summary = summary(&directory.path().join("run"));
    let seen = &summary["openings"]["left"]["supersonic"];
    assert_eq!((number(seen, "since"), number(seen, "largest_share")), (0.0, 1.0), "{summary}");
    let check = stsolve(directory.path(), &["check", "case.toml", "--probe", "never", "--set", inflow]);
    assert!(check.stdout.contains(told), "{}", check.stdout);
}

/// With one Newton step allowed every slab fails; the opening must be named first among the causes.
#[test]
fn a_misused_opening_is_the_first_cause() {
    let inflow =
        "flow.boundary.left={ inflow = { total_pressure = 1.3973, total_temperature = 0.32143, direction = [1, 0] } }";
    let directory = TempDir::new().unwrap();
    let set = [inflow, "solver.newton_steps=1", "solver.slab_halvings=0"];
    let outcome = on_text(directory.path(), SUPERSONIC, &set, "run", &["--quiet"]);
    outcome.expect(
        1,
        &["likely cause: gas enters through the subsonic inflow `left` faster than sound", "supersonic_inflow"],
    );
}

#[test]
fn openings_that_cannot_be_are_refused() {
    let directory = TempDir::new().unwrap();
    let refused =
        |change: &str, parts: &[&str]| on_text(directory.path(), SUPERSONIC, &[change], "run", &[]).expect(2, parts);
    let uniform = |mach: &str| {
        format!("flow.boundary.left={{ supersonic_inflow = {{ uniform = {{ velocity = [1, 0], mach = {mach} }} }} }}")
    };
    refused(&uniform("0.8"), &["at most 0.800", "more than 1; for slower gas `inflow`"]);
    let outwards = "flow.boundary.left={ inflow = { total_pressure = 1, total_temperature = 1, direction = [-1, 0] } }";
    refused(outwards, &["direction", "into the domain: the outward normal", "-1.000"]);
    let velocity = |keys: &str| format!("flow.boundary.left={{ velocity_inflow = {{ {keys} }} }}");
    refused(&velocity("temperature = 1"), &["the velocity is missing", "one of `velocity` and `mass_flux`"]);
    refused(&velocity("velocity = [1, 0], mass_flux = [1, 0], temperature = 1"), &["given twice"]);
    refused(
        &velocity("velocity = [1, 0], temperature = \"y - 0.5\""),
        &["the temperature of -0.5 at [0.0, 0.0] and t = 0", "positive"],
    );
    refused(&velocity("velocity = [\"1/0\", 0], temperature = 1"), &["the vector at"]);
    refused("solver.start_layer=0.1", &["walls without slip, and there is none", "`flow.initial`"]);
    refused(
        "flow.boundary.right={ outflow = { pressure = 1, total_temperature = 0 } }",
        &["total_temperature", "positive"],
    );
}
