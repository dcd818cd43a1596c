//! The geometry of all cells of a slab in collocated rules, computed once for each position of the mesh.

use crate::batches::{BATCHES_PER_TASK, cells_of};
use crate::cell_geometry::{GeometryOfSlab, GeometryOfSpace, GeometryScratch};
use crate::collocation::geometry_len;
use crate::gather::{gather, scatter};
use crate::mode::{AlongStateAndMesh, Values};
use crate::operator::SlabOperator;
use crate::scratch::CellScratch;
use crate::tables::Tables;
use basis::Matrix;
use rayon::prelude::*;
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

/// (metric), (grid flux) and (carried) of all cells.
pub(crate) struct SlabGeometry {
    /// `[batch][instant][number][p]`, see [`GeometryScratch::at_points`].
    at_points: Vec<Pack>,
    /// Packs of one batch.
    batch_len: usize,
    /// J at the nodes at the bottom and at the top, `[cell][node]`.
    bottom: Vec<f64>,
    top: Vec<f64>,
}

impl SlabGeometry {
    /// Memory for `cells` cells; `None` where the rule is not collocated.
    pub(crate) fn new<const D: usize>(tables: &Tables<D>, cells: usize) -> Option<Self> {
        tables.collocation.as_ref()?;
        let nodes = tables.orders.flow.pow(D as u32);
        let batch_len = tables.instants.len() * geometry_len(D) * nodes;
        let ends = vec![1.0; cells * nodes];
        let at_points = zeroed(cells.div_ceil(WIDTH) * batch_len);
        Some(SlabGeometry { at_points, batch_len, bottom: ends.clone(), top: ends })
    }

    /// The geometry of a batch, `[instant][number][p]`.
    pub(crate) fn batch(&self, number: usize) -> &[Pack] {
        &self.at_points[number * self.batch_len..][..self.batch_len]
    }

    /// J at the nodes at an end of the slab, `[cell][node]`.
    pub(crate) fn determinants(&self, end: SlabEnd) -> &[f64] {
        if end == SlabEnd::Bottom { &self.bottom } else { &self.top }
    }
}

/// J_n of a batch of cells at the nodes.
fn gather_nodal(values: &[f64], batch: usize, packs: &mut [Pack]) {
    let nodes = packs.len();
    let of_cell = |cell: usize| &values[cell * nodes..(cell + 1) * nodes];
    gather(cells_of(batch, values.len() / nodes).map(of_cell), packs);
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// J at the nodes at the top of the slab, `[cell][node]`, on the mesh last set: the next slab starts with it. Empty where the rule does
    /// not carry it.
    pub fn determinants_at_top(&self) -> &[f64] {
        self.geometry.as_ref().map_or(&[], |geometry| geometry.determinants(SlabEnd::Top))
    }

    /// Sets J at the bottom: `carried`, or I(det dx/dxi) where that is empty.
    pub(crate) fn set_bottom_determinants(&mut self, carried: &[f64]) {
        let Some(mut geometry) = self.geometry.take() else { return };
        if carried.is_empty() {
            self.determinants_of_mesh(&mut geometry.bottom);
        } else {
            geometry.bottom.copy_from_slice(carried);
        }
        geometry.top.copy_from_slice(&geometry.bottom);
        self.geometry = Some(geometry);
    }

    /// det dx/dxi at the nodes, `[cell][node]`, at the bottom of the slab.
    fn determinants_of_mesh(&self, out: &mut [f64]) {
        let (nodes, row) = (self.layout.nodes, self.tables.bottom_row());
        let batches = out.par_chunks_mut(WIDTH * nodes).enumerate();
        batches.for_each(|(batch, out)| {
            self.cells.with(|CellScratch { geometry, .. }| {
                self.geometry_of_space(batch, [row.row(0), &vec![0.0; self.mesh.slots()]], geometry);
                scatter(geometry.determinant_at_nodes(&self.tables), nodes, out);
            });
        });
    }

    /// The geometry of a batch of cells at one time, with the weights of the slots for position and velocity.
    pub(crate) fn geometry_of_space(&self, batch: usize, rows: [&[f64]; 2], scratch: &mut GeometryScratch) {
        if self.tables.collocation.is_none() {
            return;
        }
        let slot = self.mesh.slot_len();
        for (lane, cell) in cells_of(batch, self.layout.cells).into_iter().enumerate() {
            self.mesh.gather_sum(cell, rows[0], lane, &mut scratch.position_at[..slot]);
            self.mesh.gather_sum(cell, rows[1], lane, &mut scratch.velocity_at[..slot]);
        }
        Arch::new().dispatch(GeometryOfSpace { tables: &self.tables, scratch, mode: PhantomData::<Values> });
    }

    /// Computes the geometry of the slab on the mesh last set.
    pub(crate) fn take_geometry(&mut self) {
        let Some(mut geometry) = self.geometry.take() else { return };
        let SlabGeometry { at_points, batch_len, bottom, top } = &mut geometry;
        let nodes = self.layout.nodes;
        let batches = at_points.par_chunks_mut(*batch_len).zip(top.par_chunks_mut(WIDTH * nodes)).enumerate();
        batches.with_max_len(BATCHES_PER_TASK).for_each(|(batch, (out, top))| {
            self.cells.with(|CellScratch { geometry: scratch, determinant_at, .. }| {
                gather_nodal(bottom, batch, determinant_at);
                let (mesh, bottom) = (&[self.mesh_traces.coefficients(batch)][..], &determinant_at[..]);
                let (tables, positions) = (&self.tables, &self.positions);
                let mode = PhantomData::<Values>;
                Arch::new().dispatch(GeometryOfSlab { tables, positions, mesh, bottom, scratch, mode });
                out.copy_from_slice(scratch.of_slab(tables, 1));
                scatter(scratch.determinant_at_top(tables), nodes, top);
            });
        });
        self.geometry = Some(geometry);
    }

    /// Computes the geometry of a batch with its derivatives along the direction of the mesh last set, in `scratch`.
    pub(crate) fn differentiate_geometry(&self, batch: usize, scratch: &mut CellScratch) {
        let Some(geometry) = &self.geometry else { return };
        gather_nodal(&geometry.bottom, batch, &mut scratch.determinant_at);
        let mesh = self.mesh_and_direction().map(|traces| traces.coefficients(batch));
        let CellScratch { geometry: room, determinant_at, .. } = scratch;
        Arch::new().dispatch(GeometryOfSlab {
            tables: &self.tables,
            positions: &self.positions,
            mesh: &mesh,
            bottom: determinant_at,
            scratch: room,
            mode: PhantomData::<AlongStateAndMesh>,
        });
    }

    /// Puts what the moments of a batch at an end of the slab need into `scratch`: J where it is carried, else positions.
    pub(crate) fn gather_end(&self, batch: usize, end: SlabEnd, row: &Matrix, scratch: &mut CellScratch) {
        if let Some(geometry) = &self.geometry {
            return gather_nodal(geometry.determinants(end), batch, &mut scratch.determinant_at);
        }
        let slot = self.mesh.slot_len();
        for (lane, cell) in cells_of(batch, self.layout.cells).into_iter().enumerate() {
            self.mesh.gather_sum(cell, row.row(0), lane, &mut scratch.position_at[..slot]);
        }
    }
}
