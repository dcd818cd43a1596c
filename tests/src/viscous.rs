//! A manufactured viscous flow on a curved mesh whose motion is prescribed everywhere.

use crate::{gas, prescribed};
use coupled::{FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, System};
use fem::{Orders, Problem, Quadrature, SlabOperator, StateField, VectorField, squared_errors};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::exact::Waves;
use navier_stokes::{Compiled, Exact, Gas, Manufactured, Primitive, Reference, Riemann, Viscosity};
use newton_krylov::newton;
use std::f64::consts::PI;
use std::sync::Arc;

/// The end of the runs.
const END: f64 = 0.1;

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

/// Waves of length 1 on the unit square, in a gas of density and pressure 1.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// N_s of flow and mesh; N_t is 3.
    pub order: usize,
    /// Cells along each side.
    pub cells: usize,
    /// Slabs until the end.
    pub slabs: usize,
    /// The Mach number of the mean flow.
    pub mach: f64,
    /// mu.
    pub viscosity: f64,
    /// The amplitude of the waves that curve the mesh: 0 for squares at the start.
    pub curving: f64,
}

impl Setting {
    /// The L2 errors of density, momentum and energy at the end.
    pub fn errors(self) -> [f64; 3] {
        let gas = gas(Viscosity::Constant(self.viscosity));
        let speed = self.mach * gas.gamma().sqrt();
        let mean = Primitive { density: 1.0, velocity: [0.8 * speed, 0.6 * speed], pressure: 1.0 };
        let exact = Waves::new(gas, mean, 0.1, 1.0).unwrap();
        let mut march = self.march(gas, speed, exact);
        while !march.is_done() {
            march.advance().unwrap();
        }
        let (flow, state) = (&march.solver.system.flow.operator, &march.state);
        let squares = squared_errors(flow, &state.u, flow.top_row().row(0), &Exact(exact), state.time);
        [squares[0].sqrt(), (squares[1] + squares[2]).sqrt(), squares[3].sqrt()]
    }

    fn mesh(self) -> Mesh<2> {
        let curving = match self.curving {
            0.0 => Curving::None,
            amplitude => Curving::Smooth { amplitude },
        };
        let (lower, upper, cells) = ([0.0; 2], [1.0; 2], [self.cells; 2]);
        BoxMesh { lower, upper, cells, order: self.order, curving, periodic: [false; 2] }.build().unwrap()
    }

    fn march(self, gas: Gas, speed: f64, waves: Waves<2>) -> FlowMarch<2, 4> {
        let law = crate::plain_law(gas, Riemann::Roe, Reference::new(&gas, 1.0, speed, 1.0).unwrap());
        let exact: Arc<dyn StateField<2, 4>> = Arc::new(Exact(waves));
        let mesh = self.mesh();
        let numbering = NodeNumbering::new(&mesh, self.order);
        let problem = Problem {
            kernels: law.kernels(vec![prescribed(); mesh.boundary_names().len()]),
            data: vec![Some(exact.clone()); mesh.boundary_names().len()],
            source: Some(Arc::new(Manufactured { law, exact: waves })),
        };
        let orders = Orders { flow: self.order, mesh: self.order, time: 3 };
        let flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
        let u = coupled::interpolate(&flow, exact.as_ref(), 0.0);
        let mover = MeshMover::new(MeshMotion::Prescribed(Arc::new(Swaying)), mesh, numbering, orders.time);
        let newton =
            newton::Settings { relative_tolerance: 1e-8, absolute_tolerance: 1e-13, ..newton::Settings::default() };
        let (schedule, predictor, jacobian) = (Schedule::uniform(END, self.slabs), Predictor::Elastic, Jacobian::Exact);
        let settings = Settings { schedule, newton, predictor, jacobian, max_halvings: 0 };
        FlowMarch::new(System::new(flow, mover), u, settings)
    }
}

/// The orders of density, momentum and energy between two meshes of `cells`, otherwise as in `setting`; printed, with the errors.
pub fn orders(setting: Setting, cells: [usize; 2]) -> [f64; 3] {
    let [coarse, fine] = cells.map(|cells| Setting { cells, ..setting }.errors());
    let ratio = (cells[1] as f64 / cells[0] as f64).ln();
    let orders = std::array::from_fn(|c| (coarse[c] / fine[c]).ln() / ratio);
    let Setting { order, mach, viscosity, curving, .. } = setting;
    let fine = fine.map(|error| format!("{error:.1e}")).join(", ");
    println!(
        "N_s = {order}, M = {mach}, mu = {viscosity}, curving {curving}, {cells:?} cells: orders of density, momentum, energy \
         {orders:.2?}, errors {fine}"
    );
    orders
}
