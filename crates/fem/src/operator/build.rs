//! Memory and tables of a slab operator.

use super::{Problem, SlabOperator};
use crate::batches::FacetBatches;
use crate::layout::Layout;
use crate::mesh_traces::MeshTraces;
use crate::moving_mesh::MovingMesh;
use crate::per_thread::PerThread;
use crate::scratch::{CellScratch, FacetScratch};
use crate::share::Share;
use crate::slab_geometry::SlabGeometry;
use crate::tables::{Orders, Quadrature, Tables};
use crate::time_points::Clock;
use crate::traces::{FaceMaps, TraceLayout, Traces};
use crate::wall_loads::NodalLoads;
use basis::Matrix;
use mesh::{Mesh, NodeNumbering};
use std::sync::Arc;
use tensor::WIDTH;

/// The cells of an operator: own cells and ghosts.
struct Cells<'a, const D: usize> {
    /// A mesh of these cells.
    mesh: &'a Mesh<D>,
    /// Its C0 nodes.
    numbering: NodeNumbering,
    /// For every boundary facet its number in the whole mesh.
    boundary_facets: Vec<usize>,
    share: Share,
}

impl<'a, const D: usize> Cells<'a, D> {
    fn whole(mesh: &'a Mesh<D>, numbering: NodeNumbering) -> Self {
        let boundary_facets = (0..mesh.boundary_facets().len()).collect();
        Cells { mesh, numbering, boundary_facets, share: Share::whole(mesh) }
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// The operator on `mesh` (of order `orders.mesh`).
    ///
    /// # Panics
    /// If the orders disagree with the mesh, or a boundary has no condition.
    pub fn new(
        problem: Problem<D, M>,
        mesh: &Mesh<D>,
        numbering: NodeNumbering,
        orders: Orders,
        quadrature: Quadrature,
    ) -> Self {
        Self::of_cells(problem, Cells::whole(mesh, numbering), orders, quadrature)
    }

    /// The operator on a share of `mesh`.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn of_share(
        problem: Problem<D, M>,
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        orders: Orders,
        quadrature: Quadrature,
        share: Share,
    ) -> Self {
        if share.is_whole() {
            return Self::new(problem, mesh, numbering.clone(), orders, quadrature);
        }
        let cells: Vec<usize> = share.cells().collect();
        let subset = mesh.subset(&cells, share.own.len());
        let (mesh, numbering) = (&subset.mesh, numbering.subset(&cells));
        let cells = Cells { mesh, numbering, boundary_facets: subset.boundary_facets, share };
        Self::of_cells(problem, cells, orders, quadrature)
    }

    /// The operator on `cells`.
    fn of_cells(problem: Problem<D, M>, cells: Cells<'_, D>, orders: Orders, quadrature: Quadrature) -> Self {
        let Cells { mesh, numbering, boundary_facets, share } = cells;
        assert_eq!(mesh.order(), orders.mesh, "the mesh must have the order of the space");
        assert_eq!(mesh.boundary_names().len(), problem.kernels.boundaries(), "every boundary needs a condition");
        let tables = Tables::<D>::new(orders, M, quadrature);
        let (own, cells) = (share.own.len(), mesh.n_cells());
        let layout = Layout { cells: own, time_order: orders.time, components: M, nodes: orders.flow.pow(D as u32) };
        let facets = FacetBatches::new(mesh, orders.flow, orders.mesh);
        let moving = MovingMesh::new(mesh, numbering, orders.time);
        let viscous = problem.kernels.is_viscous();
        let flow_traces = TraceLayout::new::<D>(if viscous { 2 } else { 1 }, [orders.time, M], orders.flow);
        let mesh_traces = TraceLayout::new::<D>(2, [orders.time + 1, D], orders.mesh);
        let batches = facets.batches.len();
        let terms = batches * WIDTH * 2 * flow_traces.face_len();
        let mut operator = SlabOperator {
            flow_faces: FaceMaps::new(&tables.flow, D),
            mesh_faces: FaceMaps::new(&tables.mesh, D),
            start: 0.0,
            clock: Clock::stopped(0.0),
            held_time: None,
            dt: 0.0,
            position_rows: Vec::new(),
            positions: Matrix::identity(0),
            positions_and_top: Matrix::identity(0),
            bottom_values: tables.time.values(0.0),
            bottom_mass_product: vec![0.0; layout.at_one_time().len()],
            state: Vec::new(),
            state_traces: Traces::new(flow_traces, cells),
            direction_of_ghosts: vec![0.0; (cells - own) * layout.cell_len()],
            direction_traces: Traces::new(flow_traces, cells),
            mesh_traces: MeshTraces::new(mesh_traces, batches),
            mesh_direction: moving.direction(cells),
            mesh_direction_traces: MeshTraces::new(mesh_traces, batches),
            mesh_derivatives: Traces::new(mesh_traces, cells),
            terms: vec![0.0; terms],
            geometry: SlabGeometry::new(&tables, viscous, [own, batches]),
            cells: PerThread::new(|| CellScratch::new::<D, M>(&tables)),
            facet_scratch: PerThread::new(|| FacetScratch::new::<D, M>(&tables)),
            wall_loads: NodalLoads::unloaded(batches),
            share: Arc::new(share),
            boundary_facets,
            problem,
            mesh: moving,
            facets,
            layout,
            tables,
        };
        operator.set_bottom_determinants(&[]);
        operator
    }
}
