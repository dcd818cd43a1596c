//! Solutions of a slab that are inadmissible at its top, where the next slab begins.

use coupled::{FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, SlabError, System};
use fem::{Orders, Problem, Quadrature, SlabOperator, StateField};
use mesh::{BoxMesh, Curving, NodeNumbering};
use navier_stokes::{Compiled, NavierStokes, Riemann, Viscosity};
use newton_krylov::newton;
use std::sync::Arc;
use tensor::Dual;
use verification::law;

/// Gas at rest whose density falls by 1 in a time unit. With a density of 1 and a pressure of 1 at t = 0 it is (1 - t, 0, 0, 2.5).
struct Leak;

impl StateField<2, 4> for Leak {
    fn value(&self, _x: &[f64; 2], _t: f64) -> [f64; 4] {
        [-1.0, 0.0, 0.0, 0.0]
    }
    fn dual(&self, _x: &[Dual<f64>; 2], _t: f64) -> [Dual<f64>; 4] {
        [-1.0, 0.0, 0.0, 0.0].map(|value| Dual::new(value, 0.0))
    }
}

/// The march of that gas in slabs of length `step` with three nodes in time, for which it is exact.
fn march(step: f64, max_halvings: u32) -> FlowMarch<2, 4>
where
    NavierStokes<2>: Compiled<2, 4>,
{
    let mesh = BoxMesh {
        lower: [0.0; 2],
        upper: [1.0; 2],
        cells: [2; 2],
        order: 2,
        curving: Curving::None,
        periodic: [true; 2],
    };
    let mesh = mesh.build().unwrap();
    let numbering = NodeNumbering::new(&mesh, 2);
    let law = law::<2>(Viscosity::Inviscid, Riemann::Roe);
    let problem = Problem { kernels: law.kernels(Vec::new()), data: Vec::new(), source: Some(Arc::new(Leak)) };
    let orders = Orders { flow: 2, mesh: 2, time: 3 };
    let flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
    let u = [1.0, 0.0, 0.0, 2.5].iter().flat_map(|&u| [u; 4]).cycle().take(4 * 16).collect();
    let mover = MeshMover::new(MeshMotion::Still, mesh, numbering, 3);
    let settings = Settings {
        schedule: Schedule::uniform(2.0 * step, 2),
        newton: newton::Settings { relative_tolerance: 1e-10, ..newton::Settings::default() },
        predictor: Predictor::Elastic,
        jacobian: Jacobian::Exact,
        max_halvings,
    };
    FlowMarch::new(System::new(flow, mover), u, settings)
}

/// An airfoil that pitched fast once continued from a negative density. The density had changed its sign between the points where the
/// equations are evaluated and the top of the slab, where they are not.
#[test]
fn a_slab_whose_top_is_no_state_is_not_accepted() {
    let error = march(1.01, 0).advance().unwrap_err();
    assert!(matches!(error.source, SlabError::Top(_)), "{error:?}");
    let told = coupled::chain(&error);
    assert!(told.contains("density = -") && told.contains("at t = 1.01"), "{told}");

    let mut halved = march(1.01, 1);
    let report = halved.advance().unwrap();
    assert_eq!((report.rejected, report.interval.end), (1, 0.505));
    assert!((halved.state.u[0] - 0.495).abs() < 1e-10, "{}", halved.state.u[0]);
}
