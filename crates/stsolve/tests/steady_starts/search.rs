//! The search for a steady flow takes other ways where the first fails, tells its steps, and says what is wrong if there is no flow.

use crate::common::{number, on_case, summary};
use crate::{COARSE, run};
use tempfile::TempDir;

/// Euler flow around the airfoil at two degrees, on 216 cells; the drag of a flow without shocks is zero.
fn inviscid(mach: f64, order: usize) -> String {
    let [x, y] = [2.0_f64.to_radians().cos(), 2.0_f64.to_radians().sin()];
    format!(
        "time = {{ order = 1, end = 0, step = 1 }}
         solver.steady = {{}}
         [mesh]
         order = 4
         [mesh.generate.airfoil]
         first_cell = 0.03
         trailing_edge_cell = 0.03
         surface_cells = 8
         wake_cells = 5
         near_wake = {{ extent = 2, cells = 3 }}
         normal_cells = 8
         near_wall = {{ extent = 0.6, cells = 5 }}
         [flow]
         order = {order}
         initial = {{ uniform = {{ velocity = [{x}, {y}], mach = {mach} }} }}
         [flow.boundary]
         airfoil = \"slip_wall\"
         far = {{ far_field = {{ velocity = [{x}, {y}], mach = {mach} }} }}
         [flow.forces.airfoil]
         drag_direction = [{x}, {y}]"
    )
}

/// From the free stream orders 3 to 5 stall at once at Mach numbers of 0.1 and 0.5. Lift: a thin airfoil of 12 % has
/// 2 pi (1 + 0.77 * 0.12) alpha / sqrt(1 - M^2) = 0.241 at M = 0.1, 0.277 at M = 0.5. Order 3 is coarse here, order 4 is not.
#[test]
fn an_inviscid_airfoil_is_found_by_lower_orders() {
    let directory = TempDir::new().unwrap();
    for (mach, lift) in [(0.1, 0.241), (0.5, 0.277)] {
        for (order, bound) in [(3, 0.2), (4, 0.05)] {
            let name = format!("order_{order}_mach_{mach}");
            run(directory.path(), &name, &inviscid(mach, order)).expect(0, &[]);
            let steady = &summary(&directory.path().join(&name))["steady"];
            println!("M = {mach}, order {order}: {steady}");
            let wall = &steady["walls"]["airfoil"];
            let found = number(wall, "lift_coefficient");
            assert!((found / lift - 1.0).abs() < bound, "M = {mach}, order {order}: C_L = {found}, not {lift}");
            assert!(number(wall, "drag_coefficient").abs() < 5e-3, "{wall}");
        }
    }
}

/// At Re = 4000 the wake of a cylinder is unsteady on this mesh. The search must report this with its measurements, and must not
/// advise anything that it has tried.
#[test]
fn a_flow_without_a_steady_state_is_called_unsteady_and_its_rate_of_change_is_shown() {
    let directory = TempDir::new().unwrap();
    let set = [
        "mesh.order=3",
        "mesh.generate.annulus.cells=[16,10]",
        "time={order=1,end=0,step=1}",
        "flow.order=5",
        "flow.gas.viscosity.constant=0.00025",
    ];
    let outcome = on_case(directory.path(), "run", "cylinder_steady", &set, "unsteady", &[]);
    println!("{}", outcome.stderr);
    outcome.expect(1, &["the flow is unsteady", "its rate of change went from", "remove `[solver.steady]`"]);
    for tried in ["solver.steady.steps", "krylov_iterations", "lax_friedrichs"] {
        assert!(!outcome.stderr.contains(tried), "{tried} was tried: {}", outcome.stderr);
    }
}

/// The most dissipative flux at M = 0.05: iterations, but no failure. Table: cargo test ... -- --nocapture
#[test]
fn the_lax_friedrichs_flux_works_at_a_low_mach_number_and_costs_iterations() {
    let directory = TempDir::new().unwrap();
    let airfoil = ["mesh.order=3", COARSE, "flow.order=3", "time.end=0.2"];
    let cylinder = ["mesh.order=4", "flow.order=4"];
    for (case, coarse, wall) in [("naca0012_heave", &airfoil[..], "airfoil"), ("cylinder_steady", &cylinder, "wall")] {
        let [roe, dissipative] = ["roe", "lax_friedrichs"].map(|flux| {
            let mach = ["gas", "initial.uniform", "boundary.far.far_field"].map(|key| format!("flow.{key}.mach=0.05"));
            let flux = format!("flow.riemann={flux}");
            let set: Vec<&str> =
                coarse.iter().copied().chain(mach.iter().map(String::as_str)).chain([&flux[..]]).collect();
            on_case(directory.path(), "run", case, &set, "run", &["--force"]).expect(0, &[]);
            let summary = summary(&directory.path().join("run"));
            assert_eq!(number(&summary, "rejected_slabs"), 0.0, "{summary}");
            let (steady, slabs) = (&summary["steady"], number(&summary, "krylov.total"));
            let drag = number(&steady["walls"][wall], "drag_coefficient");
            println!("{case}, {flux}: steady {} Krylov iterations, slabs {slabs}, C_D {drag:.5}", steady["krylov"]);
            [number(steady, "krylov"), drag]
        });
        assert!((dissipative[1] / roe[1] - 1.0).abs() < 0.02, "{case}: {roe:?} {dissipative:?}");
        assert!(dissipative[0] > 1.5 * roe[0], "{case}: {roe:?} {dissipative:?}");
    }
}

/// The same flow in other units of length, speed and density: steps in pseudo-time follow the units.
#[test]
fn a_steady_start_takes_the_same_steps_in_all_units() {
    let directory = TempDir::new().unwrap();
    let steps = |length: f64, speed: f64, density: f64| {
        let stream = format!("{{density={density:e},velocity=[{speed:e},0],mach=0.1}}");
        let set = [
            "mesh.order=4".into(),
            "flow.order=4".into(),
            format!(
                "mesh.generate.annulus={{inner_radius={:e},outer_radius={:e},first_cell={:e},cells=[20,14]}}",
                0.5 * length,
                100.0 * length,
                0.1 * length
            ),
            format!("flow.gas.viscosity.constant={:e}", 0.025 * density * speed * length),
            format!("flow.initial.uniform={stream}"),
            format!("flow.boundary.far.far_field={stream}"),
            format!(
                "flow.reference={{density={density:e},speed={speed:e},pressure={:e},length={length:e}}}",
                density * speed * speed / (1.4 * 0.01)
            ),
            "time={order=1,end=0,step=1}".into(),
        ];
        on_case(directory.path(), "run", "cylinder_steady", &set.each_ref().map(String::as_str), "run", &["--force"])
            .expect(0, &[]);
        let steady = &summary(&directory.path().join("run"))["steady"];
        println!("length {length}, speed {speed}, density {density}: {steady}");
        [number(steady, "newton"), number(steady, "krylov"), number(&steady["walls"]["wall"], "drag_coefficient")]
    };
    let [newton, krylov, drag] = steps(1.0, 1.0, 1.0);
    for [length, speed, density] in [[1.0, 1e-3, 1.0], [1e-3, 340.0, 1.2], [1e3, 1.0, 1e-3], [1e6, 10.0, 1.0]] {
        let other = steps(length, speed, density);
        assert_eq!(other[0], newton, "{other:?}");
        assert!((other[1] - krylov).abs() <= 0.1 * krylov, "{other:?} {krylov}");
        assert!((other[2] / drag - 1.0).abs() < 1e-6, "{other:?} {drag}");
    }
}
