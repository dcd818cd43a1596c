//! Newton's steps never invert a cell.

use coupled::{MeshMotion, Predictor};
use fem::VectorField;
use newton_krylov::problem::NonlinearProblem;
use std::sync::Arc;
use verification::vortex::{Setting, VortexRun};

/// x - 5 shrinks to a tenth, by a factor that falls around t = 0.55. The parabola of a slab of length 1 is negative in between; those of shorter slabs
/// are not.
struct Squeezing;

impl VectorField<2> for Squeezing {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        [-0.45 * ((12.0 * t - 6.6).tanh() + 6.6_f64.tanh()) * (x[0] - 5.0), 0.0]
    }
    fn rate(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        [-5.4 / (12.0 * t - 6.6).cosh().powi(2) * (x[0] - 5.0), 0.0]
    }
}

fn squeezed(predictor: Predictor) -> VortexRun {
    let mut run =
        VortexRun::new(Setting { order: 3, time_order: 2, cells: 4, slabs: 1, end: 1.0, tolerance: 1e-8, predictor });
    let MeshMotion::Elastic { boundary, .. } = &mut run.march.solver.system.mesh.mover.motion else { unreachable!() };
    boundary.fields = vec![Arc::new(Squeezing)];
    run
}

/// The state and the mesh at the bottom, at every time node.
fn constant_guess(run: &VortexRun) -> Vec<f64> {
    let layout = run.march.solver.system.flow.operator.layout;
    let mut z = vec![0.0; run.march.solver.system.len()];
    let u = &mut z[run.march.solver.system.flow_range()];
    for (cell, a) in (0..layout.cells).flat_map(|cell| (0..layout.time_order).map(move |a| (cell, a))) {
        u[layout.cell_at(cell, a)].copy_from_slice(&run.march.state.u[layout.at_one_time().cell(cell)]);
    }
    z
}

#[test]
fn a_step_that_would_invert_cells_is_shortened() {
    let mut run = squeezed(Predictor::Constant);
    let z = constant_guess(&run);
    let (state, problem) = (&run.march.state, &mut run.march.solver.system);
    problem.begin(coupled::Interval { start: 0.0, end: 1.0, halvings: 0 }, state).unwrap();
    let (mut r, mut dz) = (vec![0.0; z.len()], vec![0.0; z.len()]);
    problem.residual(&z, &mut r).unwrap();
    problem.linearise(&z, &[0.0, 0.0]).unwrap();
    r.iter_mut().for_each(|r| *r = -*r);
    problem.guess_increment(&r, &mut dz);
    let step = problem.largest_step(&z, &dz);
    let mut residual_at = |a: f64| {
        let trial: Vec<f64> = z.iter().zip(&dz).map(|(z, dz)| z + a * dz).collect();
        problem.residual(&trial, &mut r)
    };
    assert_eq!(step, 0.5);
    assert!(residual_at(step).is_ok());
    let inverted = residual_at(1.0).unwrap_err();
    assert!(inverted.quantity == "det J / det J_0" && inverted.value < 0.0, "{inverted:?}");
    // An increment of the flow alone is not limited.
    dz[..run.march.solver.system.mesh_len()].fill(0.0);
    assert_eq!(run.march.solver.system.largest_step(&z, &dz), 1.0);
}

#[test]
fn the_slab_is_halved_until_the_mesh_is_proved_to_be_valid() {
    for predictor in [Predictor::Constant, Predictor::Extrapolated] {
        let mut run = squeezed(predictor);
        assert!(run.march.advance().is_err(), "the mesh of the whole slab is inverted");
        run.march.max_halvings = 3;
        let mut rejected = 0;
        while !run.march.is_done() {
            let report = run.march.advance().unwrap();
            assert!(report.quality.is_valid());
            rejected += report.rejected;
        }
        assert!(rejected > 0, "{predictor:?}");
    }
}
