//! The vortex of the paper (IV.A) on a mesh that stretches and travels with it.

use crate::prescribed;
use coupled::{
    BoundaryDisplacement, FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, System,
};
use elasticity::{Accuracy, ElasticMesh, Material, Stiffness};
use fem::{Orders, Problem, Quadrature, SlabOperator, StateField, VectorField, squared_errors};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::exact::Vortex;
use navier_stokes::{Compiled, Exact, Gas, Primitive, Reference, Riemann, Viscosity};
use newton_krylov::newton;
use std::f64::consts::PI;
use std::sync::Arc;

/// (13), (14) of the paper, (14) corrected: x' = x + 0.1 (x - x_c) sin(pi t / 4) + t, y' = y - 0.1 (y - y_c) sin(pi t / 4).
pub struct Stretching;

impl VectorField<2> for Stretching {
    fn value(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let s = 0.1 * (PI * t / 4.0).sin();
        [(x[0] - 5.0) * s + t, -(x[1] - 5.0) * s]
    }
    fn rate(&self, x: &[f64; 2], t: f64) -> [f64; 2] {
        let s = 0.1 * PI / 4.0 * (PI * t / 4.0).cos();
        [(x[0] - 5.0) * s + 1.0, -(x[1] - 5.0) * s]
    }
}

/// A run of the vortex.
pub struct VortexRun {
    /// The run.
    pub march: FlowMarch<2, 4>,
    /// The exact solution.
    pub exact: Arc<dyn StateField<2, 4>>,
}

/// The setting of a run.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// N_s of flow and mesh.
    pub order: usize,
    /// N_t.
    pub time_order: usize,
    /// Cells along each side.
    pub cells: usize,
    /// Slabs until `end`.
    pub slabs: usize,
    /// The end of the run; the period of the mesh is 8.
    pub end: f64,
    /// Newton's relative tolerance.
    pub tolerance: f64,
    /// First guess of the mesh.
    pub predictor: Predictor,
}

impl VortexRun {
    /// Sets up a run with an elastic interior.
    pub fn new(setting: Setting) -> Self {
        Self::with_motion(setting, true)
    }

    /// Sets up a run whose motion is prescribed everywhere.
    pub fn prescribed(setting: Setting) -> Self {
        Self::with_motion(setting, false)
    }

    fn with_motion(setting: Setting, elastic: bool) -> Self {
        let Setting { order, time_order, cells, slabs, end, tolerance, predictor } = setting;
        let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid).unwrap();
        let free_stream = Primitive { density: 1.0, velocity: [1.0, 0.0], pressure: 1.0 / (1.4 * 0.25) };
        let exact = Arc::new(Exact(Vortex::new(gas, free_stream, [5.0, 5.0], 1.0, 0.2, None).unwrap()));
        let law = crate::plain_law(gas, Riemann::Roe, Reference::new(&gas, 1.0, 1.0, free_stream.pressure).unwrap());
        let (lower, upper, cells) = ([0.0; 2], [10.0; 2], [cells; 2]);
        let mesh =
            BoxMesh { lower, upper, cells, order, curving: Curving::None, periodic: [false; 2] }.build().unwrap();
        let numbering = NodeNumbering::new(&mesh, order);
        let data = vec![Some(exact.clone() as Arc<dyn StateField<2, 4>>); 4];
        let problem = Problem { kernels: law.kernels(vec![prescribed(); 4]), data, source: None };
        let orders = Orders { flow: order, mesh: order, time: time_order };
        let flow = SlabOperator::new(problem, &mesh, numbering.clone(), orders, Quadrature::Conserving);
        let motion =
            if elastic { elastic_motion(&mesh, &numbering) } else { MeshMotion::Prescribed(Arc::new(Stretching)) };
        let u = coupled::interpolate(&flow, exact.as_ref(), 0.0);
        let newton = newton::Settings {
            relative_tolerance: tolerance,
            absolute_tolerance: 1e-13,
            ..newton::Settings::default()
        };
        let (schedule, jacobian) = (Schedule::uniform(end, slabs), Jacobian::Exact);
        let settings = Settings { schedule, newton, predictor, jacobian, max_halvings: 0 };
        let mover = MeshMover::new(motion, mesh, numbering, time_order);
        VortexRun { march: FlowMarch::new(System::new(flow, mover), u, settings), exact }
    }

    /// The largest distance of a node from its position by the affine map.
    pub fn displacement_error(&self) -> f64 {
        let state = &self.march.state;
        let nodes = self.march.solver.system.mesh.mover.positions().iter().zip(state.d.chunks_exact(2));
        let distance = |(x, d): (&[f64; 2], &[f64])| {
            let exact = Stretching.value(x, state.time);
            (d[0] - exact[0]).hypot(d[1] - exact[1])
        };
        nodes.map(distance).fold(0.0, f64::max)
    }

    /// The L2 error of the density at the time reached.
    pub fn density_error(&self) -> f64 {
        let flow = &self.march.solver.system.flow.operator;
        let row = flow.top_row();
        squared_errors(flow, &self.march.state.u, row.row(0), self.exact.as_ref(), self.march.state.time)[0].sqrt()
    }
}

/// All boundaries move by [`Stretching`], and the interior follows with constant stiffness.
fn elastic_motion(mesh: &Mesh<2>, numbering: &NodeNumbering) -> MeshMotion<2> {
    let mut constrained = vec![[false; 2]; numbering.count];
    (0..4).flat_map(|b| numbering.on_boundary(mesh, b)).for_each(|node| constrained[node] = [true; 2]);
    let material = Material::new(1.0, 0.4).unwrap();
    let elastic = ElasticMesh::new(mesh, numbering, material, Stiffness::Constant, &constrained).unwrap();
    let field_of_node = constrained.iter().map(|&c| (c == [true; 2]).then_some(0)).collect();
    let boundary = BoundaryDisplacement { fields: vec![Arc::new(Stretching)], field_of_node };
    let accuracy = Accuracy { solve: 1e-13, position: 1e-3 };
    MeshMotion::Elastic { mesh: Box::new(elastic), boundary, accuracy }
}
