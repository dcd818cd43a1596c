//! Advection and diffusion of one scalar, u_t + div (a u - nu grad u) = 0, and a slab on a curved mesh that moves.

use fem::{
    BoundaryPoint, ConservationLaw, Imposed, LawKernels, Orders, Problem, Quadrature, SlabEnd, SlabOperator, StateField,
};
use mesh::{BoxMesh, Curving, NodeNumbering};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use tensor::{Dual, Over, Real, Transcendental, dot};

/// The operator of a slab.
pub type Operator = SlabOperator<2, 1>;

/// a
const VELOCITY: [f64; 2] = [0.8, 0.5];
/// nu
const DIFFUSIVITY: f64 = 0.01;
/// Nodes in time.
const TIME_ORDER: usize = 3;

/// The law. Its only boundary condition is a prescribed value.
struct AdvectionDiffusion;

impl ConservationLaw<2, 1> for AdvectionDiffusion {
    type Boundary = ();

    fn is_viscous(&self) -> bool {
        true
    }
    fn flux<T: Over<G>, G: Real>(&self, u: &[T; 1], gradient: &[[T; 1]; 2], v: &[G; 2]) -> [[T; 1]; 2] {
        let along = |k: usize| [u[0] * VELOCITY[k] - u[0].scale(v[k]) - gradient[k][0] * DIFFUSIVITY];
        [along(0), along(1)]
    }
    fn viscous_flux<T: Real>(&self, _: &[T; 1], gradient: &[[T; 1]; 2]) -> [[T; 1]; 2] {
        gradient.map(|[slope]| [slope * DIFFUSIVITY])
    }
    /// The viscous flux diffuses all that there is.
    fn slope_flux<T: Over<G>, G: Real>(&self, _: &[T; 1], slope: &[T; 1], _: G) -> [T; 1] {
        [slope[0].zero()]
    }
    /// Upwind.
    fn numerical_flux<T: Over<G>, G: Real>(&self, minus: &[T; 1], plus: &[T; 1], n: &[G; 2], v_n: G) -> [T; 1] {
        let speed = n[0] * VELOCITY[0] + n[1] * VELOCITY[1] - v_n;
        let (sum, jump) = (minus[0] + plus[0], minus[0] - plus[0]);
        [(sum.scale(speed) + jump.scale(speed.abs())) * 0.5]
    }
    fn takes_data(&self, (): ()) -> bool {
        true
    }
    fn impose<T: Over<G>, G: Real>(&self, (): (), minus: &[T; 1], at: BoundaryPoint<'_, G, 2, 1>) -> Imposed<T, 1> {
        let state = [T::lift(at.data[0])];
        Imposed { flux: self.numerical_flux(minus, &state, at.normal, dot(at.normal, at.velocity)), state }
    }
    fn boundary_viscous_flux<T: Over<G>, G: Real>(
        &self,
        (): (),
        _: &[T; 1],
        gradient: &[[T; 1]; 2],
        at: BoundaryPoint<'_, G, 2, 1>,
    ) -> [T; 1] {
        [(gradient[0][0].scale(at.normal[0]) + gradient[1][0].scale(at.normal[1])) * DIFFUSIVITY]
    }
    fn scales(&self) -> [f64; 1] {
        [1.0]
    }
}

/// 2 + exp(-2 nu k^2 t) sin k (x + y - (a_x + a_y) t) with k = pi: a solution.
pub struct DecayingWave;

impl DecayingWave {
    fn at<T: Transcendental>(x: &[T; 2], t: f64) -> [T; 1] {
        let phase = (x[0] + x[1] + -(VELOCITY[0] + VELOCITY[1]) * t) * PI;
        [phase.sin() * (-2.0 * DIFFUSIVITY * PI * PI * t).exp() + 2.0]
    }
}

impl StateField<2, 1> for DecayingWave {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 1] {
        Self::at(x, t)
    }
    fn dual(&self, x: &[Dual<f64>; 2], t: f64) -> [Dual<f64>; 1] {
        Self::at(x, t)
    }
}

/// The operator on a curved unit square of `cells` x `cells` cells.
pub fn operator(order: usize, cells: usize, quadrature: Quadrature) -> Operator {
    let curving = Curving::Wavy { amplitude: 0.02 };
    let (lower, upper, cells) = ([0.0; 2], [1.0; 2], [cells; 2]);
    let mesh = BoxMesh { lower, upper, cells, order, curving, periodic: [false; 2] }.build().unwrap().scrambled(3);
    let boundaries = mesh.boundary_names().len();
    let data: Vec<Option<Arc<dyn StateField<2, 1>>>> = vec![Some(Arc::new(DecayingWave)); boundaries];
    let kernels = Box::new(LawKernels::new(AdvectionDiffusion, vec![(); boundaries]));
    let orders = Orders { flow: order, mesh: order, time: TIME_ORDER };
    let numbering = NodeNumbering::new(&mesh, order);
    SlabOperator::new(Problem { kernels, data, source: None }, &mesh, numbering, orders, quadrature)
}

/// Velocities of the mesh, smooth in space: `[time node][C0 node][component]`. The boundary moves, too.
pub fn velocities(operator: &Operator) -> Vec<f64> {
    let (length, row) = (operator.mesh.field_len(), operator.tables.bottom_row());
    let mut field = vec![0.0; TIME_ORDER * length];
    let mut x = vec![0.0; operator.mesh.slot_len()];
    for cell in 0..operator.layout.cells {
        operator.mesh.positions(cell, row.row(0), &mut x);
        for (i, node) in operator.mesh.numbering().cell(cell).iter().enumerate() {
            let (x, y) = (x[i], x[x.len() / 2 + i]);
            for (a, field) in field.chunks_exact_mut(length).enumerate() {
                let swing = 0.2 * (1.0 + 0.3 * a as f64);
                field[2 * node] = swing * (TAU * x).sin() * (0.5 * TAU * y).cos() + 0.1;
                field[2 * node + 1] = -swing * (TAU * y).sin() * (0.5 * TAU * x).cos();
            }
        }
    }
    field
}

/// Sets [`velocities`]; returns the displacement at the top that they lead to.
pub fn set_motion(operator: &mut Operator, displacement: &[f64]) -> Vec<f64> {
    let velocities = velocities(operator);
    operator.set_mesh(&velocities);
    let row = operator.top_row();
    let mut top = displacement.to_vec();
    for (velocity, weight) in velocities.chunks_exact(top.len()).zip(&row.row(0)[1..]) {
        top.iter_mut().zip(velocity).for_each(|(d, v)| *d += weight * v);
    }
    top
}

/// The exact solution at the nodes of a mesh at rest.
pub fn interpolated(operator: &Operator, t: f64) -> Vec<f64> {
    let (one, row) = (operator.layout.at_one_time(), operator.tables.bottom_row());
    let (mut u, mut x) = (vec![0.0; one.len()], vec![0.0; operator.mesh.slot_len()]);
    for cell in 0..one.cells {
        operator.mesh.positions(cell, row.row(0), &mut x);
        for i in 0..one.nodes {
            u[one.index(cell, 0, 0, i)] = DecayingWave.value(&[x[i], x[one.nodes + i]], t)[0];
        }
    }
    u
}

/// The state at the top, a node of the right-Radau basis.
pub fn at_top(operator: &Operator, u: &[f64]) -> Vec<f64> {
    (0..operator.layout.cells).flat_map(|cell| u[operator.layout.cell_at(cell, TIME_ORDER - 1)].to_vec()).collect()
}

/// The integral of a state at an end of the slab.
pub fn total(operator: &Operator, u: &[f64], end: SlabEnd) -> f64 {
    let mut mass_product = vec![0.0; u.len()];
    operator.mass_product(u, end, &mut mass_product);
    mass_product.iter().sum()
}

/// Numbers between -1 and 1.
pub fn waves(n: usize, phase: f64) -> Vec<f64> {
    (0..n).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}
