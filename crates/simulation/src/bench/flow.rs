//! Residual and exact Jacobian products of the flow: viscous, on a curved mesh in motion.

use super::subject::{Build, Size, Subject, Work, bytes};
use fem::{Bottom, Differentiate, Orders, Problem, Share, SlabOperator};
use mesh::{BoxMesh, Curving, Mesh, MeshError, NodeNumbering};
use navier_stokes::{
    Boundary, Compiled, Gas, NavierStokes, Primitive, Reference, Riemann, Source, Viscosity, VolumeFlux, WallFlux,
};

/// Nodes in time.
const TIME_ORDER: usize = 2;

/// Length of the slab.
pub const DT: f64 = 0.01;

/// Nodes per direction in 2-D and in 3-D: some hundred thousand unknowns.
pub const PLANE_NODES: usize = 128;
pub const SPACE_NODES: usize = 32;

/// The operator on a periodic box, with a state and a direction.
pub struct Flow<const D: usize, const M: usize> {
    pub operator: SlabOperator<D, M>,
    pub state: Vec<f64>,
    direction: Vec<f64>,
    velocities: Vec<f64>,
    out: Vec<f64>,
}

/// A number in [-1, 1] that is different for every i.
fn wave(i: usize) -> f64 {
    (0.7 * i as f64).sin()
}

/// A curved mesh of `cells` cells per direction.
pub fn periodic_box<const D: usize>(cells: usize, order: usize) -> Result<Mesh<D>, MeshError> {
    let curving = Curving::Wavy { amplitude: 0.02 };
    BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [cells; D], order, curving, periodic: [true; D] }.build()
}

impl<const D: usize, const M: usize> Flow<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    /// On `cells` cells per direction, of the orders of `size`.
    pub fn on(cells: usize, size: Size) -> anyhow::Result<Self> {
        let mesh = periodic_box(cells, size.mesh_order)?;
        let share = Share::whole(&mesh);
        Self::of_share(&mesh, size, share)
    }

    /// On a share of `mesh`.
    pub fn of_share(mesh: &Mesh<D>, size: Size, share: Share) -> anyhow::Result<Self> {
        let Size { order, mesh_order, quadrature, .. } = size;
        let numbering = NodeNumbering::new(mesh, mesh_order);
        let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Constant(1e-3))?;
        let law = NavierStokes {
            gas,
            riemann: Riemann::Roe,
            reference: Reference::new(&gas, 1.0, 0.5, 1.0)?,
            source: Source::Given,
            volume_flux: VolumeFlux::Central,
            shock_capturing: None,
            wall_flux: WallFlux::Inside,
        };
        let problem = Problem { kernels: law.kernels(Vec::new()), data: Vec::new(), source: None };
        let orders = Orders { flow: order, mesh: mesh_order, time: TIME_ORDER };
        let mut operator = SlabOperator::of_share(problem, mesh, &numbering, orders, quadrature, share);
        let mean: [f64; M] = Primitive { density: 1.0, velocity: [0.4; D], pressure: 1.0 }.pack(&gas);
        let layout = operator.layout;
        let state: Vec<f64> =
            (0..layout.len()).map(|i| mean[layout.component_of(i)] * (1.0 + 1e-3 * wave(i))).collect();
        let nodes = operator.mesh.field_len();
        let velocities: Vec<f64> = (0..TIME_ORDER * nodes).map(|i| 1e-3 * wave(i)).collect();
        operator.begin_slab(0.0, DT, Bottom::new(&state[..layout.at_one_time().len()], &vec![0.0; nodes]));
        operator.set_mesh(&velocities);
        operator.linearise(&state);
        let direction = (0..layout.len()).map(|i| wave(i + 5)).collect();
        Ok(Flow { out: vec![0.0; state.len()], operator, state, direction, velocities })
    }
}

impl<const D: usize, const M: usize> Build for Flow<D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        Self::on(size.even_cells(PLANE_NODES, SPACE_NODES), size).map(Some)
    }
}

impl<const D: usize, const M: usize> Subject for Flow<D, M> {
    /// State, mesh and direction in, residual out.
    fn work(&self) -> Vec<Work> {
        let (state, mesh) = (self.state.len(), self.operator.mesh.data.len());
        let flops = |along| self.operator.operations(along).map(|count| count as f64);
        let work = |kernel, flops, numbers| Work { kernel, unknowns: state as f64, flops, bytes: bytes(numbers) };
        vec![
            work("residual", flops(Differentiate::Nothing), 2 * state + mesh),
            work("product", flops(Differentiate::State), 3 * state + mesh),
            work("product with mesh", None, 3 * state + 2 * mesh),
        ]
    }

    fn run(&mut self, number: usize) {
        let Flow { operator, state, direction, velocities, out } = self;
        match number {
            0 => operator.residual(state, out).unwrap_or_else(|violation| unreachable!("{violation:?}")),
            1 => operator.product(direction, out),
            _ => operator.product_with_mesh(direction, velocities, out),
        }
    }
}
