//! Distributions along walls: their integrals are the forces of history.csv, in the plane and in space, on walls that move.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Surface, column, finished, number, on_case, on_text, stsolve};
use output::read_viewer_file;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A coarse mesh around an airfoil that heaves and pitches.
const COARSE: [&str; 5] = [
    "mesh.order=3",
    "flow.order=3",
    "mesh.generate.airfoil={ first_cell = 0.015, trailing_edge_cell = 0.02, surface_cells = 8, wake_cells = 6, normal_cells = 10, far_field = 20 }",
    "time.step=0.05",
    "output.surfaces={walls=[\"airfoil\"],every=2}",
];

/// Fails unless forces and heat of `surface` are those of history.csv in the row of the time `t`.
fn assert_integrals_are_those_of_the_history(run: &Path, wall: &str, surface: &Surface, t: f64, axes: &[&str]) {
    let row = column(run, "t").iter().position(|time| *time == t).unwrap();
    let of_history = |name: String| column(run, &format!("{wall}_{name}"))[row];
    for axis in axes {
        let (force, exact) = (surface.force(axis), of_history(format!("force_{axis}")));
        let scale = surface.column("area").iter().zip(surface.column("pressure")).map(|(a, p)| a * p).sum::<f64>();
        assert!((force - exact).abs() < 1e-13 * scale, "{wall}, t = {t}: force_{axis} {force} {exact}");
        let friction = of_history(format!("friction_force_{axis}"));
        assert!((surface.integral(&format!("friction_{axis}")) - friction).abs() < 1e-13 * scale, "{friction}");
    }
    let (heat, exact) = (surface.integral("heat_flux"), of_history("heat_flow".to_owned()));
    assert!((heat - exact).abs() < 1e-12 * exact.abs().max(1.0), "{wall}, t = {t}: heat {heat} {exact}");
}

#[test]
fn the_forces_on_a_moving_airfoil_are_integrals_of_its_surface() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    let go = |end: &str, output: &str, extra: &[&str]| {
        on_case(at, "run", "naca0012_heave", &[&COARSE[..], &[end]].concat(), output, extra).expect(0, &[]);
    };
    go("time.end=0.25", "through", &["--threads", "1"]);
    go("time.end=0.15", "resumed", &["--threads", "2"]);
    go("time.end=0.25", "resumed", &["--threads", "2", "--resume"]);
    let run = at.join("through");
    let times = column(&run, "t");
    // The first is that of the steady start.
    for (number, t) in [(0, times[0]), (2, times[2]), (4, times[4]), (5, times[5])] {
        let surface = Surface::read(&run, "airfoil").at(t);
        assert_integrals_are_those_of_the_history(&run, "airfoil", &surface, t, &["x", "y"]);
        assert!(surface.column("s").is_sorted() && surface.column("arc_length").is_sorted(), "slab {number}");
        let arc = surface.column("arc_length");
        let length: f64 = surface.column("area").iter().sum();
        assert!(arc[0] > 0.0 && *arc.last().unwrap() < length && (2.03..2.05).contains(&length), "{length}");
    }
    // The first end of the resumed run was a distribution more.
    let all = |name: &str| Surface::read(&at.join(name), "airfoil").column("t");
    assert_eq!(all("through"), all("resumed"));
    for t in [times[0], times[2], times[4], times[5]] {
        let [one, other] =
            ["through", "resumed"].map(|name| Surface::read(&at.join(name), "airfoil").at(t).column("pressure"));
        assert!(!one.is_empty() && one.iter().map(|x| x.to_bits()).eq(other.iter().map(|x| x.to_bits())), "t = {t}");
    }
    let (steps, pressure) = read_viewer_file(&run.join("surface_airfoil.vtkhdf"), "pressure").unwrap();
    let expected = vec![times[0], times[2], times[4], times[5]];
    assert_eq!((steps, pressure.len() % 12), (expected, 0), "4 times, 3 points of a facet");
}

/// The drag coefficient from the file of a steady cylinder, and the points of separation.
#[test]
fn the_drag_of_a_steady_cylinder_is_the_integral_of_its_surface() {
    let directory = TempDir::new().unwrap();
    let set = ["flow.order=3", "mesh.order=3", "output.surfaces={walls=[\"wall\"]}"];
    let summary = finished(directory.path(), "cylinder_steady", &set);
    let run = directory.path().join("cylinder_steady");
    let surface = Surface::read(&run, "wall");
    let t = *column(&run, "t").last().unwrap();
    assert_integrals_are_those_of_the_history(&run, "wall", &surface, t, &["x", "y"]);
    let drag = number(&summary["walls"]["wall"], "drag_coefficient");
    // q A = 1/2.
    let unit = column(&run, "wall_force_x").last().unwrap() / drag;
    assert!((surface.force("x") / unit - drag).abs() < 1e-12, "{drag}");
    // At the front the gas flows backwards along the wall only behind the points of separation, at about 54 degrees (Re = 40).
    let [x, y, friction] = ["x", "y", "skin_friction_y"].map(|name| surface.column(name));
    let reversed = |i: &usize| y[*i] > 0.0 && x[*i] > 0.0 && friction[*i] > 0.0;
    let angle = (0..x.len()).filter(reversed).map(|i| y[i].atan2(x[i]).to_degrees()).fold(0.0, f64::max);
    assert!((45.0..62.0).contains(&angle), "separation at {angle} degrees");
}

/// Collocated rules see a mesh of a higher order at the nodes of the flow. Distributions took the mesh as it is.
#[test]
fn walls_of_a_mesh_of_higher_order_have_their_forces_with_collocated_quadrature() {
    let directory = TempDir::new().unwrap();
    for quadrature in ["\"collocated\"", "\"collocated_lobatto\""] {
        let quadrature = format!("flow.quadrature={quadrature}");
        let set = ["flow.order=3", "mesh.order=4", "output.surfaces={walls=[\"wall\"]}", &quadrature];
        finished(directory.path(), "cylinder_steady", &set);
        let run = directory.path().join("cylinder_steady");
        let of_end = Surface::read(&run, "wall").at(*column(&run, "t").last().unwrap());
        for axis in ["x", "y"] {
            let (force, exact) = (of_end.force(axis), *column(&run, &format!("wall_force_{axis}")).last().unwrap());
            assert!((force - exact).abs() < 1e-6 * exact.abs().max(1.0), "{quadrature}: {axis} {force} {exact}");
        }
        std::fs::remove_dir_all(&run).unwrap();
    }
}

#[test]
fn walls_of_a_box_in_space_have_their_forces() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("case.toml");
    let text = r#"
        mesh = { order = 3, generate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [2, 1, 2] } }
        motion.displacement = ["0.1*t*(1-x)*y", 0, "0.05*t*x"]
        time = { order = 2, end = 0.2, slabs = 2 }
        output.surfaces = { walls = ["left", "top"] }
        [flow]
        order = 3
        gas = { viscosity = { constant = 0.05 } }
        initial.uniform = { velocity = [0, 0.1, 0], pressure = 1 }
        boundary.left.adiabatic_wall = {}
        boundary.top.isothermal_wall = { temperature = 1.1 }
        boundary.others = "slip_wall"
    "#;
    fs::write(&case, text).unwrap();
    stsolve(directory.path(), &["run", case.to_str().unwrap(), "--output", "run", "--quiet"]).expect(0, &[]);
    let run = directory.path().join("run");
    for wall in ["left", "top"] {
        let surface = Surface::read(&run, wall);
        let t = *column(&run, "t").last().unwrap();
        assert_integrals_are_those_of_the_history(&run, wall, &surface, t, &["x", "y", "z"]);
        let (steps, points) = read_viewer_file(&run.join(format!("surface_{wall}.vtkhdf")), "Points").unwrap();
        assert_eq!((steps.len(), points.len() % 27), (1, 0), "3 x 3 points of a facet");
    }
}

/// A wall with ends that is extruded along z had neither a mean nor a separation, and no warning. The end of a box is not extruded.
#[test]
fn open_walls_in_space_have_means() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 1] }, extrude = { depth = 0.5, layers = 2 } }
        time = { order = 1, end = 0.2, slabs = 2 }
        output = { averages.from = 0, surfaces = { walls = ["bottom", "front"], every = 1 } }
        [flow]
        order = 2
        gas = { viscosity = { constant = 0.05 } }
        initial.uniform = { velocity = [0.1, 0, 0], pressure = 1 }
        boundary.bottom.adiabatic_wall = {}
        boundary.others = "slip_wall"
    "#;
    let told = ["the wall `front` has no means", "not extruded along z"];
    on_text(directory.path(), text, &[], "run", &[]).expect(0, &told);
    let run = directory.path().join("run");
    assert!(run.join("surface_bottom_separation.csv").exists() && !run.join("surface_front_mean.csv").exists());
    let mean = fs::read_to_string(run.join("surface_bottom_mean.csv")).unwrap();
    assert!(mean.starts_with("arc_length,x,y,pressure,"), "{mean}");
    for line in mean.lines().skip(1) {
        let row: Vec<f64> = line.split(',').take(3).map(|number| number.parse().unwrap()).collect();
        assert!((row[0] + row[1] - 1.0).abs() < 1e-14 || (row[0] - row[1]).abs() < 1e-14, "{line}");
    }
}

/// Without `every` there was a mean over the one distribution at the end.
#[test]
fn means_along_walls_need_distributions_at_several_times() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("case.toml");
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 1] } }
        time = { order = 1, end = 0.2, slabs = 2 }
        output.averages = { from = 0 }
        [flow]
        order = 2
        gas = { viscosity = { constant = 0.05 } }
        initial.uniform = { velocity = [0, 0.1], pressure = 1 }
        boundary.left.adiabatic_wall = {}
        boundary.others = "slip_wall"
    "#;
    fs::write(&case, text).unwrap();
    for (every, has_means) in [("", false), (",every=1", true)] {
        let set = format!("output.surfaces={{walls=[\"left\"]{every}}}");
        let arguments = ["run", "case.toml", "--output", "run", "--quiet", "--force", "--set", &set];
        stsolve(directory.path(), &arguments).expect(0, &[]);
        for end in ["mean", "separation"] {
            let file = directory.path().join(format!("run/surface_left_{end}.csv"));
            assert_eq!(file.exists(), has_means, "{set}: {end}");
        }
    }
}
