//! Packs that a thread keeps from one batch of cells or facets to the next.

use crate::cell_geometry::GeometryScratch;
use crate::entropy_viscosity::EntropyScratch;
use crate::facet_geometry::facet_geometry_len;
use crate::tables::{Orders, Tables};
use crate::tensor_product::Scratch;
use tensor::{Pack, WIDTH, zeroed};

/// Coefficients of a batch of cells, for the values and for a direction.
#[derive(Default)]
pub struct CellCoefficientPacks {
    /// Of the state, `[b][a][m][i]`.
    pub(crate) state: Vec<Pack>,
    /// Of the mesh, `[b][slot][d][mesh node]`.
    pub(crate) mesh: Vec<Pack>,
}

impl CellCoefficientPacks {
    /// The blocks of state and mesh.
    pub(crate) fn blocks(&self) -> [[&[Pack]; 2]; 2] {
        [&self.state, &self.mesh].map(|packs| packs.split_at(packs.len() / 2).into())
    }
}

/// Packs of one batch of cells, for any mode.
///
/// `b` counts blocks (values, derivatives), `p` the points of a block of planes, `i` space nodes, `a` time nodes, `m` components of the state.
pub struct CellScratch {
    /// Coefficients in the slab.
    pub(crate) coefficients: CellCoefficientPacks,
    /// Residual, `[a][m][i]`.
    pub residual: Vec<Pack>,
    /// State, `[b][time, last the top][m][i]`; for the operator of space alone and for the mass product at one time.
    pub state_at: Vec<Pack>,
    /// Flux terms, `[time point][m][i]`.
    pub flux_at: Vec<Pack>,
    /// Mass product of the state, int psi u J, `[time point, last the top][m][i]`.
    pub mass_product_at: Vec<Pack>,
    /// Positions at points relative to the origins of the cells, `[b][d][p]`: read by sources.
    pub x: Vec<Pack>,
    /// Source at points, `[b][m][p]`.
    pub source: Vec<Pack>,
    /// The geometry.
    pub geometry: GeometryScratch,
    /// J at the nodes, for the mass product at one time; collocated rules only.
    pub determinant_at: Vec<Pack>,
    /// Terms of all faces, each in its own lattice, `[face][kind][a][m][face node]`.
    pub(crate) face_terms: Vec<Pack>,
    /// One where a state or a Jacobian determinant of the lane was inadmissible.
    pub violated: Pack,
    pub(crate) u: Vec<Pack>,
    pub(crate) gradient: Vec<Pack>,
    pub(crate) flux: Vec<Pack>,
    pub(crate) mass_product: Vec<Pack>,
    /// Packs of (entropy viscosity), for points that are the nodes.
    pub(crate) entropy: EntropyScratch,
    pub(crate) scratch: Scratch,
}

impl CellScratch {
    /// Memory for any mode.
    pub fn new<const D: usize, const M: usize>(tables: &Tables<D>) -> Self {
        let (n_t, time_points, points) = (tables.orders.time, tables.time_points.len(), tables.block_points());
        let nodes = tables.orders.flow.pow(D as u32);
        let widest = tables.rule.points.len().max(tables.orders.flow).max(tables.orders.mesh);
        let mesh_nodes = tables.orders.mesh.pow(D as u32);
        let [state, mesh] = [n_t * M * nodes, (n_t + 1) * D * mesh_nodes].map(|len| zeroed(2 * len));
        CellScratch {
            coefficients: CellCoefficientPacks { state, mesh },
            residual: zeroed(n_t * M * nodes),
            state_at: zeroed(2 * (time_points + 1) * M * nodes),
            flux_at: zeroed(time_points * M * nodes),
            mass_product_at: zeroed((time_points + 1) * M * nodes),
            x: zeroed(2 * D * points),
            source: zeroed(2 * M * points),
            geometry: GeometryScratch::new(tables),
            determinant_at: zeroed(if tables.collocation.is_some() { nodes } else { 0 }),
            face_terms: zeroed(2 * D * 2 * n_t * M * (nodes / tables.orders.flow)),
            violated: Pack::ZERO,
            u: zeroed(2 * M * points),
            gradient: zeroed(D * 2 * M * points),
            flux: zeroed(D * M * points),
            mass_product: zeroed(M * points),
            entropy: match tables.flow.is_nodal {
                true => EntropyScratch::new(D, M, nodes),
                false => EntropyScratch::default(),
            },
            scratch: Scratch::new(D, 2 * M, widest),
        }
    }
}

/// Packs of one side of a batch of facets, in the lattice of the minus face.
///
/// Traces have two kinds: 0 the values, 1 the derivative along the reference axis that leaves the facet. Gradients and Jacobian matrices
/// `[b][direction][..][p]` have the tangential directions first and the leaving axis last.
pub struct SideScratch {
    /// State traces, `[kind][b][a][m][i]`.
    pub state: Vec<Pack>,
    /// Mesh traces, `[kind][b][slot][d][i]`.
    pub mesh: Vec<Pack>,
    /// Terms to test with, `[kind][a][m][i]`.
    pub terms: Vec<Pack>,
    /// State traces, `[kind][b][time point][m][i]`.
    pub(crate) state_at: Vec<Pack>,
    /// Mesh traces, `[kind][b][time point][d][i]`.
    pub(crate) position_at: Vec<Pack>,
    /// Terms `[kind][time point][m][i]`.
    pub(crate) terms_at: Vec<Pack>,
    pub(crate) u: Vec<Pack>,
    pub(crate) gradient: Vec<Pack>,
    /// dx/dxi at the points, `[b][direction][d][p]`.
    pub(crate) jacobian: Vec<Pack>,
    pub(crate) tested: Vec<Pack>,
    pub(crate) tested_gradient: Vec<Pack>,
}

/// Packs of a batch of facets, kept by a thread from one batch to the next.
pub struct FacetScratch {
    /// Minus and plus side; the plus side is unused on boundaries.
    pub sides: [SideScratch; 2],
    /// +1 or -1 per lane: the sign that turns the minus face's tangential cross product into the outward normal.
    pub normal_sign: Pack,
    /// Positions at points relative to the origins of the minus cells, `[b][d][p]`.
    pub x: Vec<Pack>,
    /// Data of conditions at points, `[b][m][p]`.
    pub data: Vec<Pack>,
    /// The flux through a boundary facet at one time, see [`crate::boundary::FacetFlux`].
    pub through: Vec<Pack>,
    /// Whether the facets of the batch leave loads, see [`crate::wall_loads`].
    pub(crate) with_loads: bool,
    /// The momentum of the flux through boundary facets with loads, `[d][p]`.
    pub(crate) momentum: Vec<Pack>,
    /// Loads of boundary facets, `[time point][d][face node of the mesh]`.
    pub(crate) loads: Vec<Pack>,
    /// The velocity at which forces on a boundary do work, `[d][face node]`, see [`crate::boundary::FacetFlux`].
    pub boundary_velocity: Vec<Pack>,
    /// One where a trace of the lane was inadmissible.
    pub violated: Pack,
    /// One trace of every lane in another order of nodes.
    pub(crate) reordered: Vec<f64>,
    /// Velocity of the facet, `[b][time point][d][i]`.
    pub(crate) velocity_at: Vec<Pack>,
    /// The velocity at which forces do work at the points, `[d][p]`.
    pub(crate) work_velocity: Vec<Pack>,
    /// The penalty of (penalty at top) and its heat at the points, `[m][p]`.
    pub(crate) penalty: Vec<Pack>,
    /// The geometry at the points that is not known, `[b][number][p]`, see [`crate::facet_geometry`].
    pub(crate) geometry: Vec<Pack>,
    /// Intermediate results of the area vectors of collocated rules.
    pub(crate) on_nodes: FaceNodes,
    pub(crate) scratch: Scratch,
}

/// Packs at the nodes of the flow on a batch of facets, for collocated rules. All start with the block, `[b]`.
#[derive(Default)]
pub(crate) struct FaceNodes {
    /// Position and velocity, `[d][i]`.
    pub(crate) x: Vec<Pack>,
    pub(crate) v: Vec<Pack>,
    /// Tangents, `[direction][d][i]`, and in 3-D F of (metric) along both directions.
    pub(crate) tangents: Vec<Pack>,
    pub(crate) curled: Vec<Pack>,
    /// Area vector and normal velocity times area, `[d, last the velocity][i]`; the same at the points.
    pub(crate) area: Vec<Pack>,
    pub(crate) area_at_points: Vec<Pack>,
}

impl FaceNodes {
    fn new<const D: usize>(tables: &Tables<D>) -> Self {
        if tables.collocation.is_none() {
            return FaceNodes::default();
        }
        let fields = |count: usize| zeroed(2 * count * tables.orders.flow.pow(D as u32 - 1));
        let [area, area_at_points] = [fields(D + 1), fields(D + 1)];
        FaceNodes { x: fields(D), v: fields(D), tangents: fields(D * D), curled: fields(D * D), area, area_at_points }
    }
}

impl SideScratch {
    pub(crate) fn new<const D: usize, const M: usize>(tables: &Tables<D>) -> Self {
        let (n_t, time_points, points) = (tables.orders.time, tables.time_points.len(), tables.facet_points());
        let nodes = tables.orders.flow.pow(D as u32 - 1);
        let mesh_nodes = tables.orders.mesh.pow(D as u32 - 1);
        let kinds = 2;
        SideScratch {
            state: zeroed(kinds * 2 * n_t * M * nodes),
            mesh: zeroed(kinds * 2 * (n_t + 1) * D * mesh_nodes),
            terms: zeroed(kinds * n_t * M * nodes),
            state_at: zeroed(kinds * 2 * time_points * M * nodes),
            position_at: zeroed(kinds * 2 * time_points * D * mesh_nodes),
            terms_at: zeroed(kinds * time_points * M * nodes),
            u: zeroed(2 * M * points),
            gradient: zeroed(D * 2 * M * points),
            jacobian: zeroed(D * 2 * D * points),
            tested: zeroed(M * points),
            tested_gradient: zeroed(D * M * points),
        }
    }
}

impl FacetScratch {
    /// Memory for any mode.
    pub fn new<const D: usize, const M: usize>(tables: &Tables<D>) -> Self {
        let points = tables.facet_points();
        let Orders { flow, mesh, time } = tables.orders;
        let longest = (time * M * flow.pow(D as u32 - 1)).max((time + 1) * D * mesh.pow(D as u32 - 1));
        let widest = tables.rule.points.len().max(tables.orders.flow).max(tables.orders.mesh);
        FacetScratch {
            sides: [SideScratch::new::<D, M>(tables), SideScratch::new::<D, M>(tables)],
            normal_sign: Pack::ZERO,
            x: zeroed(2 * D * points),
            data: zeroed(2 * M * points),
            through: zeroed(2 * through_len(M) + 2),
            with_loads: false,
            momentum: zeroed(D * points),
            loads: zeroed(tables.time_points.len() * D * tables.orders.mesh.pow(D as u32 - 1)),
            boundary_velocity: zeroed(D * tables.orders.mesh.pow(D as u32 - 1)),
            violated: Pack::ZERO,
            reordered: vec![0.0; WIDTH * longest],
            velocity_at: zeroed(2 * tables.time_points.len() * D * tables.orders.mesh.pow(D as u32 - 1)),
            work_velocity: zeroed(D * points),
            penalty: zeroed((M + 1) * points),
            geometry: zeroed(2 * facet_geometry_len(D, true) * points),
            on_nodes: FaceNodes::new(tables),
            scratch: Scratch::new(D - 1, 2 * M.max(D + 1), widest),
        }
    }
}

/// Numbers of one part of a flux through a boundary: M fluxes, and those of momentum and of angular momentum.
pub(crate) const fn through_len(components: usize) -> usize {
    components + 6
}
