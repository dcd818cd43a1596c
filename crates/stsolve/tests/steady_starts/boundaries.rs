//! The boundary data of a steady start are those of its time.

use crate::common::{self, number, on_case, summary};
use crate::{COARSE, run};
use tempfile::TempDir;

/// The state on the boundary varies in time: at t = 0 its density is 1, and its mean over the slab of the solver 1.0969.
#[test]
fn a_steady_start_takes_boundary_states_of_its_own_time() {
    let case = |start: f64| {
        format!(
            "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [3, 3] }} }}
             time = {{ order = 1, start = {start}, end = {start}, step = 1 }}
             solver = {{ steady = {{}} }}
             [flow]
             order = 3
             initial = {{ uniform = {{ velocity = [0.3, 0], pressure = 1 }} }}
             [flow.boundary.others.prescribed_state.expression]
             density = \"1 + 0.3*sin(t)\"
             velocity = [0.3, 0]
             pressure = 1"
        )
    };
    let directory = TempDir::new().unwrap();
    for (name, start) in [("zero", 0.0), ("later", 1.25)] {
        run(directory.path(), name, &case(start)).expect(0, &[]);
        let mass = common::column(&directory.path().join(name), "mass")[0];
        println!("start at {start}: mass {mass}");
        assert!((mass - (1.0 + 0.3 * f64::sin(start))).abs() < 1e-8, "{start}: {mass}");
    }
}

/// A gust that begins at t = 0 exerts no lift at that time.
#[test]
fn a_gust_is_not_felt_before_it_has_begun() {
    let gust = "flow.boundary.far={prescribed_state={expression={density=1,velocity=[1,\"0.1*sin(2*pi*t/5.3)\"],pressure=\"1/(1.4*0.2^2)\"}}}";
    let directory = TempDir::new().unwrap();
    let set = ["mesh.order=3", COARSE, "flow.order=3", gust, "time.end=0"];
    on_case(directory.path(), "run", "naca0012_heave", &set, "gust", &[]).expect(0, &[]);
    let wall = &summary(&directory.path().join("gust"))["steady"]["walls"]["airfoil"];
    println!("{wall}");
    assert!(number(wall, "lift_coefficient").abs() < 1e-7, "{wall}");
}
