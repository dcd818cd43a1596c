//! A block from outside of `coupled`: a mass on a spring that holds the right wall of a box of gas.
//!
//! ```text
//! m [ sum_b T_ab W_b - phi_a(0) w_n ] + dt omega_a k q(s_a) - sum_q phi_a(s_q) sum_i L_q,i . e_x = 0
//! ```

use basis::RadauTime;
use coupled::block::{Block, Body, BodyState, Couplings, Exchange, Quantity};
use coupled::{
    FlowMarch, Interval, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, SlabError, State, System,
};
use fem::{Clock, Orders};
use mesh::{BoxMesh, Curving, NodeNumbering};
use navier_stokes::{Boundary, Riemann, SlipWall, Viscosity};
use newton_krylov::{newton, problem::Inadmissible};

const MASS: f64 = 0.7;
const SPRING: f64 = 3.0;

struct SpringMass {
    time: RadauTime,
    /// Times of the loads.
    points: Vec<f64>,
    /// Nodes that follow, with their weights.
    nodes: Vec<(usize, f64)>,
    dt: f64,
    /// q_n and w_n.
    bottom: [f64; 2],
}

impl SpringMass {
    /// q_n + dt sum_b A_ab W_b
    fn position(&self, a: usize, q: f64, w: &[f64]) -> f64 {
        q + self.dt * self.time.collocation().row(a).iter().zip(w).map(|(a, w)| a * w).sum::<f64>()
    }
    fn move_nodes(&self, q: f64, w: &[f64], field: &mut [f64]) {
        let length = field.len() / w.len();
        for (a, field) in field.chunks_exact_mut(length).enumerate() {
            self.nodes.iter().for_each(|(node, weight)| field[2 * node] += weight * self.position(a, q, w));
        }
    }
    /// The equation without loads, for the bottom q, w_n.
    fn dynamics(&self, [q, bottom]: [f64; 2], w: &[f64], r: &mut [f64]) {
        for (a, r) in r.iter_mut().enumerate() {
            let rate = self.time.slab_matrix().row(a).iter().zip(w).map(|(t, w)| t * w).sum::<f64>();
            let inertia = MASS * (rate - self.time.values(0.0)[a] * bottom);
            *r = inertia + self.dt * self.time.weights()[a] * SPRING * self.position(a, q, w);
        }
    }
    fn subtract_loads(&self, exchange: &Exchange, r: &mut [f64]) {
        let length = exchange.wall_loads.len() / self.points.len();
        for (s, loads) in self.points.iter().zip(exchange.wall_loads.chunks_exact(length)) {
            let force: f64 = loads.iter().step_by(2).sum();
            r.iter_mut().zip(self.time.values(*s)).for_each(|(r, phi)| *r -= phi * force);
        }
    }
}

impl Block for SpringMass {
    fn field(&self) -> &'static str {
        "spring"
    }
    fn couplings(&self) -> Couplings {
        Couplings { reads: &[Quantity::WallLoads], writes: &[Quantity::WallDisplacement] }
    }
    fn weights(&self) -> Vec<f64> {
        vec![1.0; self.time.order()]
    }
    fn begin_slab(&mut self, interval: Interval, _: Clock, state: &State) -> Result<(), SlabError> {
        (self.dt, self.bottom) = (interval.end - interval.start, [state.bodies[0][0], state.bodies[0][1]]);
        Ok(())
    }
    fn residual(&mut self, z: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible> {
        self.move_nodes(self.bottom[0], z, &mut exchange.wall_displacement);
        self.dynamics(self.bottom, z, r);
        Ok(())
    }
    fn receive(&mut self, exchange: &Exchange, r: &mut [f64]) {
        self.subtract_loads(exchange, r);
    }
    fn linearise(&mut self, z: &[f64], exchange: &mut Exchange, _: f64) {
        self.move_nodes(self.bottom[0], z, &mut exchange.wall_displacement);
    }
    fn product(&mut self, x: &[f64], _: &mut Exchange, out: &mut [f64]) {
        self.dynamics([0.0; 2], x, out);
    }
    fn receive_product(&mut self, tangent: &Exchange, out: &mut [f64]) {
        self.subtract_loads(tangent, out);
    }
    fn precondition(&mut self, r: &[f64], _: &mut Exchange, x: &mut [f64]) {
        x.iter_mut().zip(r).for_each(|(x, r)| *x = r / MASS);
    }
    fn add_pseudo_time(&mut self, _: &[f64], _: &mut [f64]) {}
}

impl Body for SpringMass {
    fn initial(&self) -> Vec<f64> {
        vec![0.0, 0.1]
    }
    fn read(&self, stored: &[f64]) -> BodyState {
        let [kinetic_energy, potential_energy] = [MASS * stored[1].powi(2) / 2.0, SPRING * stored[0].powi(2) / 2.0];
        let [position, rate] = [vec![stored[0]], vec![stored[1]]];
        BodyState { position, rate, kinetic_energy, potential_energy, ..BodyState::default() }
    }
    fn travel(&self, z: &[f64]) -> f64 {
        MASS * z.iter().map(|w| w * w).sum::<f64>().sqrt()
    }
    fn guess(&mut self, _: Option<(&[f64], f64)>, exchange: &mut Exchange, z: &mut [f64]) {
        z.fill(self.bottom[1]);
        self.move_nodes(self.bottom[0], z, &mut exchange.wall_displacement);
    }
    fn move_walls(&mut self, x: &[f64], displacement: &mut [f64]) {
        self.move_nodes(0.0, x, displacement);
    }
    fn end_slab(&mut self, z: &[f64], stored: &mut Vec<f64>) {
        *stored = vec![self.position(z.len() - 1, self.bottom[0], z), z[z.len() - 1]];
    }
}

#[test]
fn a_mass_on_a_spring_swings_on_a_box_of_gas() {
    let (lower, upper, cells, periodic) = ([0.0; 2], [1.0; 2], [3, 1], [false; 2]);
    let mesh = BoxMesh { lower, upper, cells, order: 2, curving: Curving::None, periodic }.build().unwrap();
    let (orders, numbering) = (Orders { flow: 3, mesh: 2, time: 2 }, NodeNumbering::new(&mesh, 2));
    let law = verification::law::<2>(Viscosity::Inviscid, Riemann::Roe);
    let data = verification::free_stream::<2, 4>(&law);
    let mut flow = verification::operator(&mesh, law, orders, Boundary::SlipWall(SlipWall), data);
    flow.load_boundaries(&mesh.boundary_names().iter().map(|name| name == "right").collect::<Vec<bool>>());
    let mover = MeshMover::new(MeshMotion::Followed, mesh, numbering, orders.time);
    let nodes = mover.positions().iter().enumerate().map(|(node, x)| (node, x[0])).collect();
    let points = flow.tables.time_points.iter().map(|point| point.s).collect();
    let body = SpringMass { time: RadauTime::new(2), points, nodes, dt: 0.0, bottom: [0.0; 2] };
    let rest: [f64; 4] = [1.0, 0.0, 0.0, 1.0 / 0.4];
    let mut u = crate::slab_operator::uniform_coefficients(&flow, &rest, 1);
    u.truncate(flow.layout.at_one_time().len());
    let newton = newton::Settings { relative_tolerance: 1e-12, ..newton::Settings::default() };
    let (predictor, jacobian) = (Predictor::Elastic, Jacobian::Exact);
    let settings = Settings { schedule: Schedule::uniform(2.0, 10), newton, predictor, jacobian, max_halvings: 0 };
    let mut march = FlowMarch::new(System::with_bodies(flow, mover, vec![Box::new(body)]), u, settings);
    let energy = |march: &FlowMarch<2, 4>| march.totals()[3] + march.bodies()[0].energy();
    let start = energy(&march);
    while !march.is_done() {
        let report = march.advance().unwrap();
        assert!(report.newton.steps.len() <= 5, "{:?}", report.newton.steps.len());
        // Jumps in time take energy and never make any.
        assert!(energy(&march) <= start * (1.0 + 1e-12) && energy(&march) > start * (1.0 - 1e-3), "{}", energy(&march));
    }
    assert!(march.bodies()[0].position[0].abs() > 1e-3, "{:?}", march.bodies());
}
