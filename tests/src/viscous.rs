//! A manufactured viscous flow on a curved mesh whose motion is prescribed everywhere.

use crate::{gas, prescribed};
use coupled::{Jacobian, March, MeshMotion, MeshMover, Predictor, Schedule, Settings, SlabProblem};
use fem::{Orders, Problem, Quadrature, SlabOperator, StateField, VectorField, squared_errors};
use mesh::{BoxMesh, Curving, NodeNumbering};
use navier_stokes::exact::Waves;
use navier_stokes::{Compiled, Exact, Manufactured, NavierStokes, Primitive, Reference, Riemann, Viscosity};
use newton_krylov::newton;
use std::f64::consts::PI;
use std::sync::Arc;

/// A motion that bends cells inside and moves the boundary.
struct Swaying;

impl VectorField<2> for Swaying {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let s = (2.0 * t).sin();
        [
            0.04 * (PI * x[0]).sin() * (2.0 * PI * x[1]).cos() * s + 0.1 * t,
            -0.05 * (PI * x[1]).sin() * (PI * x[0]).cos() * s,
        ]
    }
    fn rate(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let h = 1e-6;
        let (ahead, behind) = (self.value(x, t + h), self.value(x, t - h));
        std::array::from_fn(|d| (ahead[d] - behind[d]) / (2.0 * h))
    }
}

/// The L2 error of all components at t = 0.1, for orders N_s and N_t on `cells` x `cells` curved cells in `slabs` slabs.
pub fn error(order: usize, time_order: usize, cells: usize, slabs: usize) -> f64 {
    let gas = gas(Viscosity::Constant(0.05));
    // About as fast as sound. Where the flow carries density much more slowly than the numerical flux damps it (a third of
    // this speed, say), even degrees are still half an order short on meshes of this size.
    let mean = Primitive { density: 1.0, velocity: [1.2, 1.0], pressure: 1.0 };
    let law = NavierStokes { gas, riemann: Riemann::Roe, reference: Reference::new(&gas, 1.0, 1.5, 1.0).unwrap() };
    let waves = Waves::new(gas, mean, 0.1, 1.0).unwrap();
    let exact: Arc<dyn StateField<2, 4>> = Arc::new(Exact(waves));
    let (lower, upper, cells) = ([0.0; 2], [1.0; 2], [cells; 2]);
    let curving = Curving::Smooth { amplitude: 0.03 };
    let mesh = BoxMesh { lower, upper, cells, order, curving, periodic: [false; 2] }.build().unwrap();
    let numbering = NodeNumbering::new(&mesh, order);
    let problem = Problem {
        kernels: law.kernels(vec![prescribed(); mesh.boundary_names().len()]),
        data: vec![Some(exact.clone()); mesh.boundary_names().len()],
        source: Some(Arc::new(Manufactured { law, exact: waves })),
    };
    let orders = Orders { flow: order, mesh: order, time: time_order };
    let flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
    let u = coupled::interpolate(&flow, exact.as_ref(), 0.0);
    let mover = MeshMover::new(MeshMotion::Prescribed(Arc::new(Swaying)), mesh, numbering, time_order);
    let newton =
        newton::Settings { relative_tolerance: 1e-8, absolute_tolerance: 1e-13, ..newton::Settings::default() };
    let (schedule, predictor, jacobian) = (Schedule::uniform(0.1, slabs), Predictor::Elastic, Jacobian::Exact);
    let settings = Settings { schedule, newton, predictor, jacobian, max_halvings: 0 };
    let mut march = March::new(SlabProblem::new(flow, mover), u, settings);
    while !march.is_done() {
        march.advance().unwrap();
    }
    let flow = &march.problem.flow;
    let squares = squared_errors(flow, &march.state.u, flow.top_row().row(0), exact.as_ref(), march.state.time);
    squares.iter().sum::<f64>().sqrt()
}
