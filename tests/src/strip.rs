//! A column of gas that an elastic bar closes: both are one cell high, between walls without friction.
//!
//! The bar lies at -length <= x <= 0, the gas at 0 <= x <= column. With the impedance z = rho_s c_s of the bar and a wave f(t - x / c_s) that
//! comes through it, the interface has the velocity V with
//!
//! ```text
//! z (2 f' - V) = p - p0,     p = p0 (1 + (gamma - 1) / 2 V / c0)^(2 gamma / (gamma - 1))                          (elastic piston)
//! ```
//!
//! as long as the gas is a simple wave. gamma = 1.4, rho0 = c0 = 1, p0 = 1 / gamma.

use coupled::block::BodyState;
use coupled::blocks::elastic_body::{ElasticBodyData, Follower, Interface};
use coupled::blocks::{ElasticBody, Instants};
use coupled::{FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, Supports, System};
use elasticity::{Damping, FluidLayer, Law, Loads, Material, Structure};
use fem::{Orders, Problem, Quadrature, SlabOperator};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::{Boundary, Compiled, Gas, Reference, Riemann, SlipWall, Viscosity};
use newton_krylov::{forcing, newton};

/// The pressure of the gas at rest.
pub const PRESSURE: f64 = 1.0 / 1.4;

/// How high gas and bar are.
const HEIGHT: f64 = 0.1;

/// A bar and a column of gas.
pub struct Strip {
    /// Nodes per direction of the mesh and of the flow.
    pub order: usize,
    /// Nodes in time.
    pub time_order: usize,
    /// Cells of the gas and of the bar along x.
    pub cells: [usize; 2],
    /// Length of the gas and of the bar.
    pub lengths: [f64; 2],
    /// The law of the bar and its damping.
    pub law: Law,
    /// See [`Damping`].
    pub damping: Damping,
    /// z
    pub impedance: f64,
    /// c_s
    pub wave_speed: f64,
    /// The end of the run.
    pub end: f64,
    /// Slabs until then.
    pub slabs: usize,
}

impl Strip {
    fn mesh(&self, region: usize) -> Mesh<2> {
        let (low, high) = if region == 0 { (0.0, self.lengths[0]) } else { (-self.lengths[1], 0.0) };
        let (lower, upper, cells) = ([low, 0.0], [high, HEIGHT], [self.cells[region], 1]);
        BoxMesh { lower, upper, cells, order: self.order, curving: Curving::None, periodic: [false; 2] }
            .build()
            .unwrap()
    }

    /// The bar without Poisson's effect: a wave along it is one-dimensional. It holds the pressure of the gas at rest without a strain.
    fn structure(&self) -> (Structure<2>, Loads<2>) {
        let mesh = self.mesh(1);
        let numbering = NodeNumbering::new(&mesh, self.order);
        let mut fixed = vec![[false; 2]; numbering.count];
        let mut loads = Loads::default();
        for (boundary, name) in mesh.boundary_names().iter().enumerate() {
            for node in numbering.on_boundary(&mesh, boundary) {
                match name.as_str() {
                    "left" => fixed[node] = [true; 2],
                    "right" => {}
                    _ => fixed[node][1] = true,
                }
            }
            if name == "right" {
                loads.tractions.push((boundary, Box::new(|point, _| point.normal.map(|n| PRESSURE * n))));
            }
        }
        let density = self.impedance / self.wave_speed;
        let material = Material::new(density * self.wave_speed.powi(2), 0.0).unwrap().with_law(self.law);
        let structure = Structure::new(mesh, numbering, material, density, fixed).unwrap();
        (structure.with_damping(self.damping), loads)
    }

    /// The march from gas at rest and a bar with the displacement d(x) and the velocity v(x) along x.
    pub fn march(&self, d: impl Fn(f64) -> f64, v: impl Fn(f64) -> f64) -> FlowMarch<2, 4> {
        let mesh = self.mesh(0);
        let numbering = NodeNumbering::new(&mesh, self.order);
        let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid).unwrap();
        let reference = Reference::new(&gas, 1.0, 1.0, PRESSURE).unwrap();
        let law = crate::plain_law(gas, Riemann::Roe, reference);
        let walls = vec![Boundary::SlipWall(SlipWall); 4];
        let problem = Problem { kernels: law.kernels(walls), data: vec![None; 4], source: None };
        let orders = Orders { flow: self.order, mesh: self.order, time: self.time_order };
        let mut flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
        flow.load_boundaries(&mesh.boundary_names().iter().map(|name| name == "left").collect::<Vec<_>>());
        let mover = MeshMover::new(MeshMotion::Followed, mesh, numbering, self.time_order);
        let body = self.body(&flow, &mover, d, v);
        let one = flow.layout.at_one_time();
        let state = [1.0, 0.0, 0.0, PRESSURE / 0.4].iter().flat_map(|&u| vec![u; one.nodes]).collect::<Vec<_>>();
        let system = System::with_bodies(flow, mover, vec![Box::new(body)]);
        FlowMarch::new(system, state.repeat(one.cells), self.settings())
    }

    fn settings(&self) -> Settings {
        let newton = newton::Settings {
            relative_tolerance: 1e-12,
            absolute_tolerance: 1e-13,
            forcing: forcing::Settings { minimum: 1e-6, ..Default::default() },
            ..Default::default()
        };
        let schedule = Schedule::uniform(self.end, self.slabs);
        Settings { schedule, newton, predictor: Predictor::Extrapolated, jacobian: Jacobian::Exact, max_halvings: 0 }
    }

    fn body(
        &self,
        flow: &SlabOperator<2, 4>,
        mover: &MeshMover<2>,
        d: impl Fn(f64) -> f64,
        v: impl Fn(f64) -> f64,
    ) -> ElasticBody<2> {
        let (structure, loads) = self.structure();
        let (pairs, behind) = followers(&structure, mover, self.lengths[0]);
        let interface = Interface::new(&pairs, flow.loaded_nodes()).with_followers(behind);
        let wet: Vec<bool> = structure.coordinates().iter().map(|x| x[0] == 0.0).collect();
        let along = |f: &dyn Fn(f64) -> f64| structure.coordinates().iter().flat_map(|x| [f(x[0]), 0.0]).collect();
        let data = ElasticBodyData {
            displacement: along(&d),
            velocity: along(&v),
            fluid: FluidLayer {
                density: 1.0,
                speed_of_sound: 1.0,
                depth: self.lengths[0],
                areas: structure.wet_areas(&wet),
            },
            supports: Supports { fields: Vec::new(), field_of_node: vec![None; wet.len()] },
            structure,
            loads,
            points: Vec::new(),
        };
        let points = flow.tables.instants.iter().map(|point| point.s).collect();
        let instants = Instants { time: flow.tables.time.clone(), points, step: self.end / self.slabs as f64 };
        ElasticBody::new(data, interface, 0, instants)
    }

    /// The velocity of the interface at the time reached.
    pub fn interface_velocity(&self, march: &FlowMarch<2, 4>) -> f64 {
        let (structure, _) = self.structure();
        let node = structure.coordinates().iter().position(|x| x[0] == 0.0).unwrap();
        march.state.bodies[0][structure.length() + 2 * node]
    }
}

/// The pairs of nodes of the wall x = 0, one of the solid and one of the gas. Then how the other nodes of the gas follow the node of the
/// solid beside them: less and less towards x = `length`.
pub fn followers(structure: &Structure<2>, mover: &MeshMover<2>, length: f64) -> (Vec<(usize, usize)>, Vec<Follower>) {
    let x = structure.coordinates();
    let wall: Vec<usize> = (0..x.len()).filter(|node| x[*node][0] == 0.0).collect();
    let beside = |y: f64| {
        let distance = |node: &usize| (x[*node][1] - y).abs();
        wall.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    let follower = |(node, x): (usize, &[f64; 2])| Follower { solid: beside(x[1]), node, weight: 1.0 - x[0] / length };
    let all = mover.positions().iter().enumerate().map(follower);
    let (on_wall, behind): (Vec<Follower>, Vec<Follower>) =
        all.filter(|follower| follower.weight != 0.0).partition(|follower| follower.weight == 1.0);
    (on_wall.iter().map(|follower| (follower.solid, follower.node)).collect(), behind)
}

/// The energy of gas and bar and all that has left them: constant but for rounding.
pub fn coupled_energy(march: &FlowMarch<2, 4>) -> f64 {
    let BodyState { kinetic_energy, potential_energy, ledger, .. } = march.bodies()[0].clone();
    let left = ledger.numerical + ledger.damped - ledger.force - ledger.drive - ledger.defect;
    march.totals()[3] + kinetic_energy + potential_energy + left
}
