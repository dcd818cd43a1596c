//! Sponges, given sources and a rotating frame.

use crate::common::stsolve;
use crate::{largest_error, run};
use tempfile::TempDir;

/// A uniform gas that a sponge draws to its target: u - u_t = exp(-2 t) (u_0 - u_t) in all conserved quantities.
const DECAY: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [1, 1]
cells = [2, 2]
periodic = ["x", "y"]
[flow]
order = 2
reference = { density = 1, speed = 0.5, pressure = 1 }
sponge = { strength = 2, target = { density = 1, velocity = [0.5, 0], pressure = 1 } }
[flow.exact.expression]
density = "1 + 0.1*exp(-2*t)"
velocity = ["(0.5 + 0.2*exp(-2*t))/(1 + 0.1*exp(-2*t))", 0]
pressure = "0.4*(2.625 + 0.3*exp(-2*t) - 0.5*(0.5 + 0.2*exp(-2*t))^2/(1 + 0.1*exp(-2*t)))"
[time]
order = 2
end = 1
slabs = 8
"#;

#[test]
fn a_sponge_draws_the_gas_to_its_target_with_the_order_of_time() {
    let directory = TempDir::new().unwrap();
    let error = |slabs: &str| largest_error(&run(directory.path(), DECAY, &[&format!("time.slabs={slabs}")], slabs));
    let (coarse, fine) = (error("8"), error("16"));
    println!("errors with 8 and 16 slabs: {coarse:.2e}, {fine:.2e}");
    let order = (coarse / fine).log2();
    assert!(fine < 1e-5 && (order - 3.0).abs() < 0.2, "{coarse:e}, {fine:e}: order {order}");
}

/// A given source acts as its formulas say: rho = 1 + 0.3 t, rho u = 0.2 t^2, rho E = 2.5 + t.
#[test]
fn a_given_source_adds_mass_momentum_and_energy() {
    let directory = TempDir::new().unwrap();
    let set = [
        "flow.source={ given = { density = 0.3, momentum = [\"0.4*t\", 0], energy = 1 } }",
        "flow.exact.expression={ density = \"1 + 0.3*t\", velocity = [\"0.2*t^2/(1 + 0.3*t)\", 0], \
         pressure = \"0.4*(2.5 + t - 0.02*t^4/(1 + 0.3*t))\" }",
    ];
    let case: String = DECAY.lines().filter(|line| !line.starts_with("sponge")).collect::<Vec<_>>().join("\n");
    let summary = run(directory.path(), &case, &set, "run");
    let error = largest_error(&summary);
    assert!(error < 1e-9, "{error:e}");
    assert!(summary["conservation"]["mass_error"].is_null(), "{summary}");
}

/// A uniform stream of speed u, seen from a frame that turns at the rate 2: w = R(-2 t) u - 2 x r. The state is a polynomial in space.
const TURNING: &str = r#"
[constants]
u = 0.5
[mesh]
order = 2
[mesh.generate.box]
lower = [-0.5, -1]
upper = [1, 0.5]
cells = [2, 2]
[flow]
order = 3
reference = { density = 1, speed = 1, pressure = 1 }
rotation = { rate = 2 }
[flow.exact.expression]
density = 1
velocity = ["u*cos(2*t) + 2*y", "-u*sin(2*t) - 2*x"]
pressure = 1
[flow.boundary]
others = "exact"
[time]
order = 2
end = 1
slabs = 8
"#;

/// Nothing was said of a box that is periodic in the plane of rotation.
#[test]
fn the_centrifugal_force_jumps_across_a_periodic_boundary() {
    let directory = TempDir::new().unwrap();
    std::fs::write(directory.path().join("case.toml"), TURNING).unwrap();
    let set = ["time.end=1e-6", "time.slabs=1", "mesh.generate.box.periodic=[\"x\"]"];
    let set: Vec<&str> = set.iter().flat_map(|change| ["--set", *change]).collect();
    let warning = "the centrifugal force of `flow.rotation` jumps";
    let checked = |set: &[&str]| stsolve(directory.path(), &[&["check", "case.toml"], set].concat()).stdout;
    assert!(checked(&set).contains(warning) && !checked(&[]).contains(warning));
    let command = [&["run", "case.toml", "--output", "periodic"], &set[..]].concat();
    stsolve(directory.path(), &command).expect(0, &[warning]);
    // The joined sides of a full ring are in the same place, up to rounding.
    let ring = [
        "mesh.generate.box={lower=[1,0],upper=[2,1],cells=[1,6],periodic=[\"y\"],map=[\"x*cos(2*pi*y)\",\"x*sin(2*pi*y)\"]}",
        "mesh.order=5",
    ];
    let ring: Vec<&str> = ring.iter().flat_map(|change| ["--set", *change]).collect();
    let said = checked(&ring);
    assert!(said.contains("warnings") && !said.contains(warning), "{said}");
}

#[test]
fn a_uniform_stream_is_one_in_a_rotating_frame() {
    let directory = TempDir::new().unwrap();
    let error = |set: &[&str], output: &str| largest_error(&run(directory.path(), TURNING, set, output));
    let (coarse, fine) = (error(&["time.slabs=16"], "16"), error(&["time.slabs=32"], "32"));
    let order = (coarse / fine).log2();
    println!("a uniform stream in a rotating frame: errors {coarse:.2e} and {fine:.2e}, order {order:.2}");
    assert!(fine < 1e-3 && order > 2.7, "{coarse:e}, {fine:e}: order {order}");
    let still = error(&["constants.u=0"], "still");
    assert!(still < 1e-9, "gas at rest: {still:e}");
    let elsewhere = error(&["constants.u=0", "flow.rotation.centre=[0.1, 0]"], "elsewhere");
    assert!(elsewhere > 1e-3, "about another axis: {elsewhere:e}");
}
