//! A manufactured motion of a viscous gas and a solid of large displacement that share a wall.
//!
//! The solid fills -1 <= X <= 0, the gas lies behind the wall x = g(t) s(y), both 0 <= y <= 1. Sources in both and a traction on the wall,
//! the defect q, make this motion exact:
//!
//! ```text
//! d = ( g s (1 + X) (1 + X / 2),  (1 + X) sin(2 X) s sin(t + Y) / 20 ),    g = 0.08 sin 2t,    s = sin(pi y)        (solid)
//! w = ( g' s + 0.3 psi sin(2 y + t),  0.3 psi cos(x - t) ),   psi = x - g s
//! T = 1 + psi^2 cos(y + t) / 5,    p = 1 + sin(x + 2 y - 3 t) / 10                                               (gas)
//! q = P N + (p - tau) cof(F) N                                                                                  (defect)
//! ```
//!
//! On the wall the gas has the velocity of the solid and conducts no heat through it.

use crate::strip::followers;
use coupled::blocks::elastic_body::{ElasticBodyData, Interface};
use coupled::blocks::{ElasticBody, SlabTimes};
use coupled::{FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Reactions, Schedule, Settings, Supports, System};
use elasticity::{FluidLayer, Lame, Law, Loads, Material, Structure};
use fem::{ConservationLaw, Orders, Problem, Quadrature, SlabOperator, StateField, VectorField, squared_errors};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::exact::ExactState;
use navier_stokes::{
    AdiabaticWall, Boundary, Compiled, Exact, Gas, Manufactured, NavierStokes, Primitive, Reference, Riemann, Viscosity,
};
use newton_krylov::{forcing, newton};
use std::f64::consts::PI;
use std::sync::Arc;
use tensor::{Dual, Transcendental};

/// The density of the solid at rest.
const DENSITY: f64 = 2.0;

/// The end of the runs.
const END: f64 = 0.4;

/// Mesh, orders and slabs.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Nodes per direction of flow, mesh and solid.
    pub order: usize,
    /// Nodes in time.
    pub time_order: usize,
    /// Cells of the gas, and of the solid, along each side.
    pub cells: usize,
    /// Slabs until the end.
    pub slabs: usize,
}

/// The errors at the end, each as a root of a mean square.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of all components of the flow.
    pub flow: f64,
    /// Of the displacement at the nodes of the solid.
    pub displacement: f64,
    /// Of their velocity.
    pub velocity: f64,
}

fn g<T: Transcendental>(t: T) -> T {
    (t * 2.0).sin() * 0.08
}

fn s<T: Transcendental>(y: T) -> T {
    (y * PI).sin()
}

/// (solid)
fn displacement<T: Transcendental>([x, y]: [T; 2], t: T) -> [T; 2] {
    let shape = s(y) * (x + 1.0);
    [g(t) * shape * (x * 0.5 + 1.0), shape * (x * 2.0).sin() * (t + y).sin() * 0.05]
}

/// `f` along axis `i` of x and, with i = 2, along t.
fn derivative<T: Transcendental, const C: usize>(
    f: impl Fn([Dual<T>; 2], Dual<T>) -> [Dual<T>; C],
    x: [T; 2],
    t: T,
    i: usize,
) -> [T; C] {
    let seed = |j: usize, value: T| Dual::new(value, T::from(if i == j { 1.0 } else { 0.0 }));
    f([seed(0, x[0]), seed(1, x[1])], seed(2, t)).map(|f| f.derivative)
}

/// The motion as the supports of the solid have it.
struct Motion;

impl VectorField<2> for Motion {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        displacement(*x, t)
    }
    fn rate(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        derivative(displacement, *x, t, 2)
    }
}

/// (gas)
#[derive(Clone, Copy)]
struct ExactGas(Gas);

impl ExactState<2, 4> for ExactGas {
    fn state<T: Transcendental>(&self, x: &[T; 2], t: T) -> [T; 4] {
        let ([x, y], rate) = (*x, (t * 2.0).cos() * 0.16);
        let psi = x - g(t) * s(y);
        let velocity = [rate * s(y) + psi * (y * 2.0 + t).sin() * 0.3, psi * (x - t).cos() * 0.3];
        let temperature = psi * psi * (y + t).cos() * 0.2 + 1.0;
        let pressure = (x + y * 2.0 - t * 3.0).sin() * 0.1 + 1.0;
        Primitive { density: pressure / temperature, velocity, pressure }.pack(&self.0)
    }
}

/// F = 1 + grad d.
fn deformation<T: Transcendental>(x: [T; 2], t: T) -> [[T; 2]; 2] {
    let [along_x, along_y] = [0, 1].map(|i| derivative(displacement, x, t, i));
    [[along_x[0] + 1.0, along_y[0]], [along_x[1], along_y[1] + 1.0]]
}

/// P = F S of the St. Venant-Kirchhoff law in plane strain, S = lambda tr(E) + 2 mu E, E = (F^T F - 1) / 2.
fn stress<T: Transcendental>(lame: Lame, x: [T; 2], t: T) -> [[T; 2]; 2] {
    let f = deformation(x, t);
    let product = |i: usize, j: usize| f[0][i] * f[0][j] + f[1][i] * f[1][j];
    let strain = |i: usize, j: usize| (product(i, j) - if i == j { 1.0 } else { 0.0 }) * 0.5;
    let trace = (strain(0, 0) + strain(1, 1)) * lame.lambda;
    let second = |i: usize, j: usize| strain(i, j) * (2.0 * lame.mu) + if i == j { trace } else { trace.zero() };
    [0, 1].map(|i| [0, 1].map(|j| f[i][0] * second(0, j) + f[i][1] * second(1, j)))
}

/// rho d_tt - div P
fn body_force(lame: Lame, x: [f64; 2], t: f64) -> [f64; 2] {
    let velocity = |x: [Dual<f64>; 2], t: Dual<f64>| derivative(displacement, x, t, 2);
    let acceleration = derivative(velocity, x, t, 2);
    let column = |j: usize| derivative(|x, t| stress(lame, x, t).map(|row| row[j]), x, t, j);
    let divergence = [column(0), column(1)];
    [0, 1].map(|i| DENSITY * acceleration[i] - divergence[0][i] - divergence[1][i])
}

/// (defect) at the point x = (0, y) of the wall at rest.
fn defect(law: &NavierStokes<2>, lame: Lame, x: [f64; 2], t: f64) -> [f64; 2] {
    let d = displacement(x, t);
    let at = [x[0] + d[0], x[1] + d[1]];
    let exact = ExactGas(law.gas);
    let slopes = [0, 1].map(|i| derivative(|x, t| exact.state(&x, t), at, t, i));
    let state: [f64; 4] = exact.state(&at, t);
    let wall = [state[1] / state[0], state[2] / state[0]];
    let (flux, f) = (law.flux(&state, &slopes, &wall), deformation(x, t));
    // cof(F) N with N = (1, 0).
    let area = [f[1][1], -f[0][1]];
    let stress = stress(lame, x, t);
    [0, 1].map(|i| stress[i][0] + flux[0][1 + i] * area[0] + flux[1][1 + i] * area[1])
}

impl Setting {
    /// Runs to the end.
    pub fn errors(self) -> Errors {
        let mut march = self.march();
        while !march.is_done() {
            march.advance().unwrap();
        }
        let (structure, _) = self.structure(&law());
        let (length, body, end) = (structure.length(), &march.state.bodies[0], march.state.time);
        let error = |field: &[f64], exact: &dyn Fn(&[f64; 2]) -> [f64; 2]| {
            let exact = structure.coordinates().iter().flat_map(exact);
            (field.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / length as f64).sqrt()
        };
        let flow = &march.solver.system.flow.operator;
        let exact = Exact(ExactGas(law().gas));
        let squares = squared_errors(flow, &march.state.u, flow.top_row().row(0), &exact, end);
        Errors {
            flow: squares.iter().sum::<f64>().sqrt(),
            displacement: error(&body[..length], &|x| Motion.value(x, end)),
            velocity: error(&body[length..2 * length], &|x| Motion.rate(x, end)),
        }
    }

    fn mesh(self, lower: f64) -> Mesh<2> {
        let (lower, upper, cells) = ([lower, 0.0], [lower + 1.0, 1.0], [self.cells; 2]);
        let curving = Curving::None;
        BoxMesh { lower, upper, cells, order: self.order, curving, periodic: [false; 2] }.build().unwrap()
    }

    /// The solid with all its loads but those of the gas; all sides but the wall are supports.
    fn structure(self, law: &NavierStokes<2>) -> (Structure<2>, Loads<2>) {
        let mesh = self.mesh(-1.0);
        let numbering = NodeNumbering::new(&mesh, self.order);
        let boundary = |name: &str| mesh.boundary_names().iter().position(|other| other == name).unwrap();
        let mut fixed = vec![[false; 2]; numbering.count];
        for side in ["left", "bottom", "top"] {
            numbering.on_boundary(&mesh, boundary(side)).into_iter().for_each(|node| fixed[node] = [true; 2]);
        }
        let material = Material::new(6.0, 0.3).unwrap().with_law(Law::StVenantKirchhoff);
        let (lame, wall, law) = (material.lame(), boundary("right"), *law);
        let mut loads = Loads { body_force: Some(Box::new(move |x, t| body_force(lame, *x, t))), ..Loads::default() };
        loads.tractions.push((wall, Box::new(move |point, t| defect(&law, lame, point.position, t))));
        (Structure::new(mesh, numbering, material, DENSITY, fixed).unwrap(), loads)
    }

    fn march(self) -> FlowMarch<2, 4> {
        let (mesh, law) = (self.mesh(0.0), law());
        let numbering = NodeNumbering::new(&mesh, self.order);
        let exact: Arc<dyn StateField<2, 4>> = Arc::new(Exact(ExactGas(law.gas)));
        let is_wall: Vec<bool> = mesh.boundary_names().iter().map(|name| name == "left").collect();
        let condition = |wall: &bool| {
            if *wall { Boundary::AdiabaticWall(AdiabaticWall::new([0.0; 2]).unwrap()) } else { crate::prescribed() }
        };
        let problem = Problem {
            kernels: law.kernels(is_wall.iter().map(condition).collect()),
            data: is_wall.iter().map(|wall| (!wall).then(|| exact.clone())).collect(),
            source: Some(Arc::new(Manufactured { law, exact: ExactGas(law.gas) })),
        };
        let orders = Orders { flow: self.order, mesh: self.order, time: self.time_order };
        let mut flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
        flow.load_boundaries(&is_wall);
        let mover = MeshMover::new(MeshMotion::Followed, mesh, numbering, self.time_order);
        let body = self.body(&flow, &mover);
        let u = coupled::interpolate(&flow, exact.as_ref(), 0.0);
        FlowMarch::new(System::with_bodies(flow, mover, vec![Box::new(body)]), u, self.settings())
    }

    fn settings(self) -> Settings {
        let newton = newton::Settings {
            relative_tolerance: 1e-9,
            absolute_tolerance: 1e-13,
            forcing: forcing::Settings { minimum: 1e-4, ..Default::default() },
            ..Default::default()
        };
        let schedule = Schedule::uniform(END, self.slabs);
        Settings { schedule, newton, predictor: Predictor::Extrapolated, jacobian: Jacobian::Exact, max_halvings: 0 }
    }

    fn body(self, flow: &SlabOperator<2, 4>, mover: &MeshMover<2>) -> ElasticBody<2> {
        let (structure, loads) = self.structure(&law());
        let positions = structure.coordinates().to_vec();
        let wet: Vec<bool> = positions.iter().map(|x| x[0] == 0.0).collect();
        let (pairs, behind) = followers(&structure, mover, 1.0);
        let interface = Interface::new(&pairs, flow.loaded_nodes()).with_followers(behind);
        let areas = structure.wet_areas(&wet);
        let data = ElasticBodyData {
            displacement: positions.iter().flat_map(|x| Motion.value(x, 0.0)).collect(),
            velocity: positions.iter().flat_map(|x| Motion.rate(x, 0.0)).collect(),
            fluid: FluidLayer { density: 1.0, speed_of_sound: 1.2, depth: 0.1, areas },
            supports: Supports {
                fields: vec![Arc::new(Motion)],
                field_of_node: vec![Some(0); wet.len()],
                reactions: Reactions::default(),
            },
            structure,
            loads,
            points: Vec::new(),
        };
        let points = flow.tables.time_points.iter().map(|point| point.s).collect();
        let times = SlabTimes { time: flow.tables.time.clone(), points, step: END / self.slabs as f64 };
        ElasticBody::new(data, interface, 0, times)
    }
}

fn law() -> NavierStokes<2> {
    let gas = crate::gas(Viscosity::Constant(0.002));
    let reference = Reference::new(&gas, 1.0, 0.3, 1.0).unwrap();
    crate::plain_law(gas, Riemann::Roe, reference)
}
