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

use coupled::block::Ledger;
use coupled::blocks::elastic_body::{ElasticBodyData, Follower, Interface};
use coupled::blocks::{ElasticBody, SlabTimes};
use coupled::{FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Reactions, Schedule, Settings, Supports, System};
use elasticity::{Damping, FluidLayer, Law, Loads, Material, Structure};
use fem::{Orders, Problem, Quadrature, SlabOperator};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::{Boundary, Compiled, Gas, NavierStokes, Reference, Riemann, SlipWall, Viscosity};
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
    fn mesh<const D: usize>(&self, region: usize) -> Mesh<D> {
        let (low, high) = if region == 0 { (0.0, self.lengths[0]) } else { (-self.lengths[1], 0.0) };
        let (mut lower, mut upper, mut cells) = ([0.0; D], [HEIGHT; D], [1; D]);
        (lower[0], upper[0], cells[0]) = (low, high, self.cells[region]);
        BoxMesh { lower, upper, cells, order: self.order, curving: Curving::None, periodic: [false; D] }
            .build()
            .unwrap()
    }

    /// The bar without Poisson's effect: a wave along it is one-dimensional. It holds the pressure of the gas at rest without a strain.
    fn structure<const D: usize>(&self) -> (Structure<D>, Loads<D>) {
        let mesh = self.mesh(1);
        let numbering = NodeNumbering::new(&mesh, self.order);
        let mut fixed = vec![[false; D]; numbering.count];
        let mut loads = Loads::default();
        for (boundary, name) in mesh.boundary_names().iter().enumerate() {
            for node in numbering.on_boundary(&mesh, boundary) {
                match name.as_str() {
                    "left" => fixed[node] = [true; D],
                    "right" => {}
                    "bottom" | "top" => fixed[node][1] = true,
                    _ => fixed[node][2] = true,
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
    pub fn march<const D: usize, const M: usize>(
        &self,
        d: impl Fn(f64) -> f64,
        v: impl Fn(f64) -> f64,
    ) -> FlowMarch<D, M>
    where
        NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
    {
        let mesh = self.mesh(0);
        let numbering = NodeNumbering::new(&mesh, self.order);
        let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid).unwrap();
        let reference = Reference::new(&gas, 1.0, 1.0, PRESSURE).unwrap();
        let law = crate::plain_law(gas, Riemann::Roe, reference);
        let walls = vec![Boundary::SlipWall(SlipWall); 2 * D];
        let problem = Problem { kernels: law.kernels(walls), data: vec![None; 2 * D], source: None };
        let orders = Orders { flow: self.order, mesh: self.order, time: self.time_order };
        let mut flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
        flow.load_boundaries(&mesh.boundary_names().iter().map(|name| name == "left").collect::<Vec<_>>());
        let mover = MeshMover::new(MeshMotion::Followed, mesh, numbering, self.time_order);
        let body = self.body(&flow, &mover, d, v);
        let one = flow.layout.at_one_time();
        let mut state = [0.0; M];
        (state[0], state[M - 1]) = (1.0, PRESSURE / 0.4);
        let state = state.iter().flat_map(|&u| vec![u; one.nodes]).collect::<Vec<_>>();
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

    fn body<const D: usize, const M: usize>(
        &self,
        flow: &SlabOperator<D, M>,
        mover: &MeshMover<D>,
        d: impl Fn(f64) -> f64,
        v: impl Fn(f64) -> f64,
    ) -> ElasticBody<D> {
        let (structure, loads) = self.structure();
        let (pairs, behind) = followers(&structure, mover, self.lengths[0]);
        let interface = Interface::new(&pairs, flow.loaded_nodes()).with_followers(behind);
        let wet: Vec<bool> = structure.coordinates().iter().map(|x| x[0] == 0.0).collect();
        let along_x = |value: f64| std::array::from_fn::<_, D, _>(|i| if i == 0 { value } else { 0.0 });
        let along = |f: &dyn Fn(f64) -> f64| structure.coordinates().iter().flat_map(|x| along_x(f(x[0]))).collect();
        let data = ElasticBodyData {
            displacement: along(&d),
            velocity: along(&v),
            fluid: FluidLayer {
                density: 1.0,
                speed_of_sound: 1.0,
                depth: self.lengths[0],
                areas: structure.wet_areas(&wet),
            },
            supports: Supports {
                fields: Vec::new(),
                field_of_node: vec![None; wet.len()],
                reactions: Reactions::default(),
            },
            structure,
            loads,
            points: Vec::new(),
        };
        let points = flow.tables.time_points.iter().map(|point| point.s).collect();
        let times = SlabTimes { time: flow.tables.time.clone(), points, step: self.end / self.slabs as f64 };
        ElasticBody::new(data, interface, 0, times)
    }

    /// The velocity of the interface at the time reached.
    pub fn interface_velocity(&self, march: &FlowMarch<2, 4>) -> f64 {
        let (structure, _) = self.structure::<2>();
        let node = structure.coordinates().iter().position(|x| x[0] == 0.0).unwrap();
        march.state.bodies[0][structure.length() + 2 * node]
    }
}

/// The pairs of nodes of the wall x = 0, one of the solid and one of the gas. Then how the other nodes of the gas follow the node of the
/// solid beside them: less and less towards x = `length`.
pub fn followers<const D: usize>(
    structure: &Structure<D>,
    mover: &MeshMover<D>,
    length: f64,
) -> (Vec<(usize, usize)>, Vec<Follower>) {
    let x = structure.coordinates();
    let wall: Vec<usize> = (0..x.len()).filter(|node| x[*node][0] == 0.0).collect();
    let beside = |at: &[f64; D]| {
        let distance = |node: &usize| (1..D).map(|i| (x[*node][i] - at[i]).abs()).fold(0.0, f64::max);
        wall.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    let follower = |(node, x): (usize, &[f64; D])| Follower { solid: beside(x), node, weight: 1.0 - x[0] / length };
    let all = mover.positions().iter().enumerate().map(follower);
    let (on_wall, behind): (Vec<Follower>, Vec<Follower>) =
        all.filter(|follower| follower.weight != 0.0).partition(|follower| follower.weight == 1.0);
    (on_wall.iter().map(|follower| (follower.solid, follower.node)).collect(), behind)
}

/// The energy of gas and bar and all that has left them: constant but for rounding.
pub fn coupled_energy(march: &FlowMarch<2, 4>) -> f64 {
    let body = &march.bodies()[0];
    let Ledger { numerical, damped, force, drive, defect, .. } = body.ledger;
    let left = numerical + damped - force - drive - defect;
    march.totals()[3] + body.energy() + left
}
