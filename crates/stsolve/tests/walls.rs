//! Forces on walls and runs that start from the steady flow, on coarse meshes, against published numbers.

#![allow(clippy::unwrap_used)]

mod common;

use common::{SLOW, Surface, assert_same_bits, column, finished, number, on_case, on_text, power_of_rates, summary};
use tempfile::TempDir;

fn at_end(run: &std::path::Path, name: &str) -> f64 {
    *column(run, name).last().unwrap()
}

/// Case M1 of the 2024 workshop. The wall does work on the gas, all gas stays inside, and the mesh follows the affine
/// map.
#[test]
fn a_closed_cylinder_keeps_its_mass_and_gains_the_work_of_its_wall() {
    let directory = TempDir::new().unwrap();
    let summary = finished(directory.path(), "cylinder_m1", &["mesh.order=6", "flow.order=6", "time.slabs=10"]);
    let (wall, run) = (&summary["walls"]["wall"], directory.path().join("cylinder_m1"));
    assert!(number(&summary, "conservation.mass_error") <= 1e-12, "{summary}");
    assert!(number(&summary, "conservation.energy_error") <= 1e-12, "{summary}");
    assert!(number(&summary, "error.displacement_max") <= 1e-10, "{summary}");
    let gained = at_end(&run, "energy") + number(wall, "work");
    // rho E = 50 in the disc of the mesh.
    let (start, mass) = (50.0, at_end(&run, "mass"));
    assert!((gained - start * mass).abs() <= 1e-11, "{:e}", gained - start * mass);
    let impulse = wall["impulse"][1].as_f64().unwrap();
    assert!((impulse / -0.591_592_1 - 1.0).abs() < 1.5e-4, "{impulse}");
    assert!((number(wall, "work") / -0.306_314_8 - 1.0).abs() < 1e-4, "{wall}");
    // At a given time it converges more slowly.
    let power = at_end(&run, "wall_power");
    assert!((power / -0.719_161_8 - 1.0).abs() < 0.04, "{power}");
}

/// A coarse mesh around the airfoil of case C1.
const COARSE: [&str; 3] = [
    "mesh.order=3",
    "flow.order=3",
    "mesh.generate.airfoil={ first_cell = 0.015, trailing_edge_cell = 0.02, surface_cells = 8, wake_cells = 6, normal_cells = 10, far_field = 20 }",
];

#[test]
fn the_steady_flow_around_an_airfoil_has_the_published_drag() {
    let directory = TempDir::new().unwrap();
    let set = [&COARSE[..], &["time.end=0.1"]].concat();
    let summary = finished(directory.path(), "naca0012_heave", &set);
    let drag = number(&summary, "steady.walls.airfoil.drag_coefficient");
    assert!((drag / 0.120_01 - 1.0).abs() < 0.01, "{drag}");
    // The flow is symmetric, and steady: so is the first row, which comes before any slab.
    assert!(number(&summary, "steady.walls.airfoil.lift_coefficient").abs() < 1e-6, "{summary}");
    let run = directory.path().join("naca0012_heave");
    assert_eq!((column(&run, "t")[0], column(&run, "airfoil_work_in_slab")[0]), (0.0, 0.0));
    assert!((column(&run, "airfoil_drag_coefficient")[0] - drag).abs() < 1e-15);
    assert!(number(&summary, "steady.newton") <= 12.0 && number(&summary, "steady.krylov") <= 150.0, "{summary}");
}

/// An airfoil that does not move stays in the steady flow.
#[test]
fn the_steady_flow_stays() {
    let directory = TempDir::new().unwrap();
    let still = ["motion.boundary.airfoil=fixed", "time.end=1", "time.step=1", "time.order=1"];
    let summary = finished(directory.path(), "naca0012_heave", &[&COARSE[..], &still].concat());
    let drag = number(&summary, "steady.walls.airfoil.drag_coefficient");
    let later = number(&summary["walls"]["airfoil"], "drag_coefficient");
    assert!((later - drag).abs() < 1e-7, "{drag} {later}");
}

#[test]
fn a_resumed_run_does_not_look_for_the_steady_flow_again() {
    let directory = TempDir::new().unwrap();
    let run = |end: &str, output: &str, extra: &[&str]| {
        let set = [&COARSE[..], &[end]].concat();
        on_case(directory.path(), "run", "naca0012_heave", &set, output, extra).expect(0, &[]);
    };
    run("time.end=0.2", "through", &[]);
    run("time.end=0.1", "resumed", &[]);
    run("time.end=0.2", "resumed", &["--resume"]);
    let at = |name: &str| directory.path().join(name);
    assert_same_bits(&at("through"), &at("resumed"), "resumed");
    assert_eq!(summary(&at("through"))["steady"], summary(&at("resumed"))["steady"]);
}

/// Between the time nodes a wall that turns is a polynomial, and its volume oscillates. With the velocity of the mesh, the pressure at rest
/// would do work on that: 9 % of the peak, and -0.019 at the end, where the airfoil rests.
#[test]
fn power_of_a_rotating_wall_is_force_times_velocity_and_moment_times_angular_velocity() {
    let directory = TempDir::new().unwrap();
    let set = [&COARSE[..], &SLOW].concat();
    finished(directory.path(), "naca0012_heave_pitch", &set);
    let run = directory.path().join("naca0012_heave_pitch");
    let (power, rates) = (column(&run, "airfoil_power"), power_of_rates(&run));
    let peak = rates.iter().fold(0.0, |peak: f64, power| peak.max(power.abs()));
    let apart = power.iter().zip(&rates).fold(0.0, |apart: f64, (a, b)| apart.max((a - b).abs()));
    assert!(peak > 5.0 && power.len() == 41, "{peak} {}", power.len());
    assert!(apart < 1e-8 * peak, "{apart:e} of {peak}");
    assert!(power[40].abs() < 1e-9, "{:e} at rest", power[40]);
}

/// The meshes of the case do not depend on their past. With `reference = "updated"` they did, and the work was 3.7e-3 off. The long tests do
/// the same with the whole case.
#[test]
fn work_of_a_rotating_wall_depends_little_on_the_step() {
    let directory = TempDir::new().unwrap();
    let work = |step: &str| {
        let set = [&COARSE[..], &SLOW, &["time.end=0.6", step]].concat();
        number(&finished(directory.path(), "naca0012_heave_pitch", &set)["walls"]["airfoil"], "work")
    };
    let (long, short) = (work("time.step=0.05"), work("time.step=0.0125"));
    assert!((long / short - 1.0).abs() < 5e-4, "{long} {short}");
}

/// Gas of constant density between a wall at rest and a wall that slides with the speed t^2 / 100.
const SLIDING: &str = r#"
[mesh]
order = 2
[mesh.generate.box]
lower = [0, 0]
upper = [0.5, 1]
cells = [1, 2]
periodic = ["x"]
[flow]
order = 4
initial = { uniform = { density = 1, velocity = [0, 0], pressure = 10 } }
reference = { density = 1, speed = 0.1, pressure = 10, length = 1 }
gas = { viscosity = { constant = 1.0 }, gas_constant = 10 }
[flow.boundary]
bottom = { isothermal_wall = { temperature = 1, slide = ["0.01*t^2", 0] } }
top = { isothermal_wall = { temperature = 1 } }
[output.surfaces]
walls = ["bottom"]
[time]
order = 2
end = 3
step = 0.1
"#;

/// The gas at the end of a slab differs from the wall by the error in time. The penalty multiplied that by the number of cells: the friction
/// was wrong by 7.7 % with 16 cells.
#[test]
fn friction_on_a_wall_that_slides_faster_and_faster_does_not_depend_on_the_cells() {
    let directory = TempDir::new().unwrap();
    let friction = |cells: &str| {
        let run = directory.path().join(cells);
        let set = format!("mesh.generate.box.cells=[1,{cells}]");
        on_text(directory.path(), SLIDING, &[&set], cells, &[]).expect(0, &[]);
        let friction = at_end(&run, "bottom_friction_force_x");
        let surface = Surface::read(&run, "bottom").at(at_end(&run, "t"));
        assert!((surface.integral("friction_x") - friction).abs() <= 1e-12, "{friction}");
        // F . w with the exact velocity of the wall.
        let power = at_end(&run, "bottom_force_x") * 0.09;
        assert!((at_end(&run, "bottom_power") - power).abs() <= 1e-12, "{power}");
        friction
    };
    // u = w - w y + w' f + w'' g with f = y^2/2 - y^3/6 - y/3 and g'' = f, g'(0) = 1/45, after the start has faded.
    let (speed, rate, curvature) = (0.09, 0.06, 0.02);
    let exact = 0.5 * (-speed - rate / 3.0 + curvature / 45.0);
    for cells in ["2", "16"] {
        let friction = friction(cells);
        assert!((friction / exact - 1.0).abs() <= 2e-3, "{cells} cells: {friction}, exact {exact}");
    }
}

/// A closed box of gas that is shaken as a whole: the net force is - m a, for sound crosses the box in no time. Forces at slab ends have order
/// N_t, means over slabs 2 N_t - 1. With walls at prescribed positions at all time nodes the former had order N_t - 1: 17 % with N_t = 2.
#[test]
fn the_force_that_accelerates_gas_with_its_walls() {
    const OMEGA: f64 = 200.0;
    let directory = TempDir::new().unwrap();
    let case = "[mesh]\norder=3\ngenerate.box={lower=[0,0],upper=[0.01,0.01],cells=[2,2]}\n[motion]\n\
                displacement=[\"1e-3*(1-cos(200*t))\",0]\n[flow]\norder=4\ngas={gas_constant=287}\n\
                reference={density=1.2,speed=0.2,pressure=101325,length=0.01}\n\
                initial.uniform={density=1.2,velocity=[0,0],pressure=101325}\nboundary={others=\"slip_wall\"}\n\
                [time]\norder=2\nend=\"2*pi/200\"\nslabs=24\n";
    let errors_with = |order: usize, slabs: usize, displacement: &str| {
        let set = [format!("time.order={order}"), format!("time.slabs={slabs}"), displacement.into()];
        on_text(directory.path(), case, &set.each_ref().map(String::as_str), "run", &["--force"]).expect(0, &[]);
        let run = directory.path().join("run");
        let sum = |name: &str| sum_of_walls(&run, &["left", "right"], name);
        let (t, dt) = (column(&run, "t"), column(&run, "dt"));
        let at_end = sum("force_x").into_iter().zip(&t).map(|(force, t)| (force, (OMEGA * t).cos()));
        let mean = sum("impulse_in_slab_x").into_iter().zip(t.iter().zip(&dt)).map(|(impulse, (t, dt))| {
            let rates = [t - dt, *t].map(|t| (OMEGA * t).sin() / OMEGA);
            (impulse / dt, (rates[1] - rates[0]) / dt)
        });
        // - m a over m A omega^2, after the first quarter.
        let amplitude = 1.2e-4 * 1e-3 * OMEGA * OMEGA;
        let largest = |forces: Vec<(f64, f64)>| {
            forces[slabs / 4..].iter().map(|(force, a)| (force / amplitude + a).abs()).fold(0.0, f64::max)
        };
        [largest(at_end.collect()), largest(mean.collect())]
    };
    let plain = "motion.displacement=[\"1e-3*(1-cos(200*t))\",0]";
    let errors = |order: usize, slabs: usize| errors_with(order, slabs, plain);
    for (order, most) in [(1, 0.27), (2, 0.008), (3, 0.0003)] {
        let [coarse, fine] = [errors(order, 24), errors(order, 48)];
        let order_of = |i: usize| (coarse[i] / fine[i]).log2();
        let n = order as f64;
        assert!(coarse[0] < most && order_of(0) > n - 0.2, "N_t = {order}: {coarse:?} {fine:?}");
        // The time that sound takes leaves 3e-6.
        assert!(order_of(1) > 2.0 * n - 1.2 || fine[1] < 5e-6, "N_t = {order}: {coarse:?} {fine:?}");
    }
    // The rate of this formula is not a number.
    let root = "motion.displacement=[\"1e-3*(1-cos(200*t))+1e-3*sqrt(max(0,t-1))\",0]";
    let [at_end, _] = errors_with(3, 24, root);
    assert!(at_end < 0.0003, "{at_end}");
}

/// The sums over `walls` of a column of each.
fn sum_of_walls(run: &std::path::Path, walls: &[&str], name: &str) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = walls.iter().map(|wall| column(run, &format!("{wall}_{name}"))).collect();
    (0..columns[0].len()).map(|row| columns.iter().map(|column| column[row]).sum()).collect()
}

/// The box swings on an arm, as a boundary and as the wall of a body.
#[test]
fn the_force_of_gas_in_a_box_that_turns() {
    const MOTION: &str = "motion.boundary.others={rigid=[{rotate={angle=\"0.5*(1-cos(20*t))\",centre=[0,0]}}]}\n";
    const BODY: &str = "bodies.box={walls=[\"left\",\"right\",\"bottom\",\"top\"],mass=1,moment_of_inertia=1,pivot=[0,0],\
                        rotation={motion=\"0.5*(1-cos(20*t))\"}}\n";
    let case = "[mesh]\norder=3\ngenerate.box={lower=[0.045,-0.005],upper=[0.055,0.005],cells=[2,2]}\n[flow]\norder=4\n\
                gas={gas_constant=287}\nreference={density=1.2,speed=0.5,pressure=101325,length=0.01}\n\
                initial.uniform={density=1.2,velocity=[0,0],pressure=101325}\nboundary={others=\"slip_wall\"}\n\
                [time]\norder=2\nend=\"2*pi/20\"\nslabs=24\n";
    let directory = TempDir::new().unwrap();
    let error = |kind: &str, order: usize, slabs: usize| {
        let set = [format!("time.order={order}"), format!("time.slabs={slabs}")];
        on_text(directory.path(), &format!("{kind}{case}"), &[&set[0], &set[1]], "run", &["--force"]).expect(0, &[]);
        let run = directory.path().join("run");
        let force = |name: &str| sum_of_walls(&run, &["left", "right", "bottom", "top"], name);
        let (angle, rate, arm, mass): (f64, f64, f64, f64) = (0.5, 20.0, 0.05, 1.2e-4);
        let error = |(t, (x, y)): (&f64, (f64, f64))| {
            let (turn, spin) = (angle * (1.0 - (rate * t).cos()), angle * rate * (rate * t).sin());
            let growth = angle * rate * rate * (rate * t).cos();
            let a = [
                -arm * (growth * turn.sin() + spin * spin * turn.cos()),
                arm * (growth * turn.cos() - spin * spin * turn.sin()),
            ];
            (x + mass * a[0]).hypot(y + mass * a[1]) / (mass * arm * angle * rate * rate)
        };
        let t = column(&run, "t");
        let errors = t.iter().zip(force("force_x").into_iter().zip(force("force_y"))).map(error);
        errors.skip(slabs / 4).fold(0.0, f64::max)
    };
    for kind in [MOTION, BODY] {
        for (order, most) in [(2, 0.012), (3, 0.0007)] {
            let [coarse, fine] = [error(kind, order, 24), error(kind, order, 48)];
            let found = (coarse / fine).log2();
            assert!(coarse < most && found > order as f64 - 0.2, "{kind}N_t = {order}: {coarse} {fine}");
        }
    }
}
