//! The geometry of all cells and facets of a slab, where it is kept.
//!
//! A mesh serves many evaluations. In two dimensions, and for collocated rules, its geometry at the points is computed once for each
//! position of the mesh. Other rules have too many points in space: they compute it in every evaluation.

use crate::batches::{BATCHES_PER_TASK, FacetBatch, cells_of};
use crate::cell_geometry::{CellMotion, GeometryOfSlab, GeometryOfSpace, GeometryScratch, kept_len};
use crate::facet_geometry::{GeometryOfFacets, facet_geometry_len};
use crate::gather::{gather, gather_cells, scatter};
use crate::kernels::Differentiate;
use crate::mode::{AlongStateAndMesh, Values};
use crate::operator::SlabOperator;
use crate::parallel::{self, Grain};
use crate::scratch::CellScratch;
use crate::tables::{Orders, Quadrature, Tables};
use std::marker::PhantomData;
use tensor::{Arch, Pack, WIDTH, zeroed};

/// An end of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlabEnd {
    /// Its start.
    Bottom,
    /// Its end, on the mesh last set.
    Top,
}

/// The geometry at the points, and the determinants that are carried.
#[derive(Default)]
pub(crate) struct SlabGeometry {
    /// By batches of cells, see [`kept_len`]; empty where it is not kept.
    cells: Vec<Pack>,
    /// By batches of facets, `[batch][time point][number][p]`.
    facets: Vec<Pack>,
    /// Packs of one batch of cells, and of facets.
    of_batch: [usize; 2],
    /// J at the nodes at the bottom and at the top, `[cell][node]`; empty where it is not carried.
    carried: [Vec<f64>; 2],
}

impl SlabGeometry {
    /// Memory for `cells` cells and so many `batches` of facets.
    pub(crate) fn new<const D: usize>(tables: &Tables<D>, viscous: bool, [cells, batches]: [usize; 2]) -> Self {
        let collocated = tables.collocation.is_some();
        let points = [tables.rule.points.len(), tables.time_points.len()];
        let of_batch @ [of_cells, of_facets] = kept_of_batch(D, points, collocated, viscous);
        let ends = vec![1.0; if collocated { cells * tables.orders.flow.pow(D as u32) } else { 0 }];
        SlabGeometry {
            cells: zeroed(cells.div_ceil(WIDTH) * of_cells),
            facets: zeroed(batches * of_facets),
            of_batch,
            carried: [ends.clone(), ends],
        }
    }

    /// The geometry of a batch of cells, if it is kept.
    pub(crate) fn of_cells(&self, batch: usize) -> Option<&[Pack]> {
        self.cells.get(batch * self.of_batch[0]..(batch + 1) * self.of_batch[0]).filter(|kept| !kept.is_empty())
    }

    /// The geometry of a batch of facets at the time points, if it is kept.
    pub(crate) fn of_facets(&self, batch: usize) -> Option<&[Pack]> {
        self.facets.get(batch * self.of_batch[1]..(batch + 1) * self.of_batch[1]).filter(|kept| !kept.is_empty())
    }

    /// J at the nodes at an end of the slab, `[cell][node]`; empty where it is not carried.
    fn determinants(&self, end: SlabEnd) -> &[f64] {
        &self.carried[end as usize]
    }
}

/// Numbers that are kept for a cell and for a facet. `points` holds the points per direction in space and the time points.
fn kept_of_batch(dimension: usize, points: [usize; 2], collocated: bool, viscous: bool) -> [usize; 2] {
    let ([line, time_points], axes) = (points, dimension as u32);
    if !collocated && dimension > 2 {
        return [0; 2];
    }
    let of_facet = time_points * facet_geometry_len(dimension, viscous) * line.pow(axes - 1);
    [kept_len(dimension, time_points, line.pow(axes), !collocated), of_facet]
}

/// Bytes of the geometry that an operator keeps on `cells` cells and `facets` facets.
pub fn kept_geometry_bytes(
    dimension: usize,
    orders: Orders,
    quadrature: Quadrature,
    viscous: bool,
    [cells, facets]: [usize; 2],
) -> usize {
    let points = [quadrature.space_points(dimension, orders), quadrature.time_points(dimension, orders)];
    let collocated = matches!(quadrature, Quadrature::Collocated(_));
    let [of_cell, of_facet] = kept_of_batch(dimension, points, collocated, viscous);
    size_of::<f64>() * (cells * of_cell + facets * of_facet)
}

/// Nodal `values[cell][node]` of a batch of cells; none if there are none.
fn gather_nodal(values: &[f64], batch: usize, packs: &mut [Pack]) {
    if !values.is_empty() {
        let nodes = packs.len();
        let of_cell = |cell: usize| &values[cell * nodes..(cell + 1) * nodes];
        gather(cells_of(batch, values.len() / nodes).map(of_cell), packs);
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// J at the nodes at the top of the slab, `[cell][node]`, on the mesh last set: the next slab starts with it. Empty where the rule does
    /// not carry it.
    pub fn determinants_at_top(&self) -> &[f64] {
        self.geometry.determinants(SlabEnd::Top)
    }

    /// Sets J at the bottom: `carried`, or I(det dx/dxi) where that is empty.
    pub(crate) fn set_bottom_determinants(&mut self, carried: &[f64]) {
        let [mut bottom, mut top] = std::mem::take(&mut self.geometry.carried);
        if carried.len() == bottom.len() {
            bottom.copy_from_slice(carried);
        } else {
            self.determinants_of_mesh(&mut bottom);
        }
        top.copy_from_slice(&bottom);
        self.geometry.carried = [bottom, top];
    }

    /// det dx/dxi at the nodes, `[cell][node]`, at the bottom of the slab.
    fn determinants_of_mesh(&self, out: &mut [f64]) {
        let (nodes, row) = (self.layout.nodes, self.tables.bottom_row());
        parallel::for_each_chunk(out, WIDTH * nodes, Grain::Any, &|batch, out| {
            self.cells.with(|CellScratch { geometry, .. }| {
                self.geometry_of_space(batch, [row.row(0), &vec![0.0; self.mesh.slots()]], geometry);
                scatter(geometry.nodal.determinants(0, nodes), nodes, out);
            });
        });
    }

    /// The geometry of a batch of cells at one time, with the weights of the slots for position and velocity.
    pub(crate) fn geometry_of_space(&self, batch: usize, rows: [&[f64]; 2], scratch: &mut GeometryScratch) {
        let slot = self.mesh.slot_len();
        for (lane, cell) in cells_of(batch, self.layout.cells).into_iter().enumerate() {
            self.mesh.gather_sum(cell, rows[0], lane, &mut scratch.position_at[..slot]);
            self.mesh.gather_sum(cell, rows[1], lane, &mut scratch.velocity_at[..slot]);
        }
        Arch::new().dispatch(GeometryOfSpace { tables: &self.tables, scratch });
    }

    /// Computes the geometry that is kept, on the mesh last set.
    pub(crate) fn take_geometry(&mut self) {
        let mut geometry = std::mem::take(&mut self.geometry);
        if !geometry.cells.is_empty() {
            self.take_cells(&mut geometry);
            self.take_facets(&mut geometry);
        } else if self.tables.collocation.is_some() {
            self.take_tops(&mut geometry);
        }
        self.geometry = geometry;
    }

    /// Computes the determinants at the top, where no geometry is kept.
    fn take_tops(&self, geometry: &mut SlabGeometry) {
        let SlabGeometry { of_batch: [len, _], carried: [bottom, top], .. } = geometry;
        parallel::for_each_chunk(top, WIDTH * self.layout.nodes, Grain::AtMost(BATCHES_PER_TASK), &|batch, top| {
            self.cells.with(|scratch| {
                let mut out = std::mem::take(&mut scratch.geometry.known);
                self.geometry_of_batch(batch, bottom, scratch, (&mut out[..*len], top));
                scratch.geometry.known = out;
            });
        });
    }

    /// The geometry of a batch of cells in the slab, and the determinants at the top if they are carried.
    fn geometry_of_batch(
        &self,
        batch: usize,
        bottom: &[f64],
        scratch: &mut CellScratch,
        (out, top): (&mut [Pack], &mut [f64]),
    ) {
        let CellScratch { coefficients, geometry: scratch, determinant_at, .. } = scratch;
        let (tables, nodes) = (&self.tables, self.layout.nodes);
        gather_nodal(bottom, batch, determinant_at);
        gather_cells(&[&self.mesh.data], cells_of(batch, self.layout.cells), &mut coefficients.mesh);
        let [_, [mesh, _]] = coefficients.blocks();
        let mesh = &[mesh];
        let motion = CellMotion { tables, positions: &self.positions_and_top, mesh, bottom: determinant_at };
        Arch::new().dispatch(GeometryOfSlab { motion, scratch, out, mode: PhantomData::<Values> });
        if !top.is_empty() {
            scatter(scratch.nodal.determinants(tables.time_points.len() - 1, nodes), nodes, top);
        }
    }

    fn take_cells(&self, geometry: &mut SlabGeometry) {
        let SlabGeometry { cells, of_batch: [len, _], carried: [bottom, top], .. } = geometry;
        // Nothing is carried by rules that are not collocated: there the chunks are empty.
        let mut tops: Vec<&mut [f64]> = top.chunks_mut(WIDTH * self.layout.nodes).collect();
        tops.resize_with(cells.len() / *len, Default::default);
        parallel::for_each_pair((cells, *len), (&mut tops, 1), Grain::AtMost(BATCHES_PER_TASK), &|batch, out, top| {
            self.cells.with(|scratch| self.geometry_of_batch(batch, bottom, scratch, (out, &mut *top[0])));
        });
    }

    fn take_facets(&self, geometry: &mut SlabGeometry) {
        let len = geometry.of_batch[1];
        parallel::for_each_chunk(&mut geometry.facets, len, Grain::AtMost(BATCHES_PER_TASK), &|number, out| {
            let batch = &self.facets.batches[number];
            self.facet_scratch.with(|scratch| {
                self.gather_mesh(Differentiate::Nothing, batch, scratch);
                let (viscous, used) = (self.problem.kernels.is_viscous(), batch.sides());
                let (tables, in_time) = (&self.tables, self.in_time());
                Arch::new().dispatch(GeometryOfFacets { tables, viscous, used, in_time, scratch, out });
            });
        });
    }

    /// Computes the geometry of a batch of cells with its derivatives along the direction of the `mesh`, for collocated rules. Other rules do
    /// that in their kernels.
    pub(crate) fn differentiate_geometry(&self, batch: usize, mesh: &[&[Pack]], scratch: &mut CellScratch) {
        if self.tables.collocation.is_none() {
            return;
        }
        gather_nodal(self.geometry.determinants(SlabEnd::Bottom), batch, &mut scratch.determinant_at);
        let CellScratch { geometry: scratch, determinant_at: bottom, .. } = scratch;
        let motion = CellMotion { tables: &self.tables, positions: &self.positions_and_top, mesh, bottom };
        let mut out = std::mem::take(&mut scratch.known);
        let mode = PhantomData::<AlongStateAndMesh>;
        Arch::new().dispatch(GeometryOfSlab { motion, scratch, out: &mut out, mode });
        scratch.known = out;
    }

    /// Puts what the mass product of a batch at an end of the slab need into `scratch`: J where it is carried, positions otherwise.
    pub(crate) fn gather_end(&self, batch: usize, end: SlabEnd, row: &[f64], scratch: &mut CellScratch) {
        if self.tables.collocation.is_some() {
            return gather_nodal(self.geometry.determinants(end), batch, &mut scratch.determinant_at);
        }
        let slot = self.mesh.slot_len();
        for (lane, cell) in cells_of(batch, self.layout.cells).into_iter().enumerate() {
            self.mesh.gather_sum(cell, row, lane, &mut scratch.geometry.position_at[..slot]);
        }
    }

    /// The geometry of a batch of facets at the time points, where it is kept and not differentiated.
    pub(crate) fn facet_geometry(&self, along: Differentiate, batch: &FacetBatch) -> Option<&[Pack]> {
        self.geometry.of_facets(batch.number).filter(|_| along.geometry_blocks() == 1)
    }
}
