//! An evaluation: the kernels on all facets, then on all cells.

use super::SlabOperator;
use crate::batches::{BATCHES_PER_TASK, FacetBatch, cells_of};
use crate::cell::{CellCoefficients, CellContext};
use crate::facet::{Across, DataAt, FacetContext};
use crate::gather::{gather, scatter};
use crate::kernels::{Differentiate, Times};
use crate::mesh_traces::MeshTraces;
use crate::prescribed::Prescribed;
use crate::scratch::{CellScratch, FacetScratch};
use crate::time_points::InTime;
use crate::traces::Traces;
use crate::wall_loads::scatter_loads;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use tensor::{Pack, WIDTH};

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Facets, then cells: the terms of every facet are computed once and read by both its cells. Returns the first cell, in the order
    /// of the whole mesh, with a NaN in its result: violations are passed on as NaN, and arithmetic may produce it.
    pub(super) fn run(&mut self, along: Differentiate, out: &mut [f64]) -> Option<usize> {
        let (mut terms, mut loads) = (std::mem::take(&mut self.terms), std::mem::take(&mut self.wall_loads.terms));
        self.all_facets(along, &mut terms, &mut loads);
        self.wall_loads.terms = loads;
        self.sum_loads();
        let (cell_len, first) = (self.layout.cell_len(), AtomicUsize::new(usize::MAX));
        let cells = out.par_chunks_mut(WIDTH * cell_len).enumerate();
        cells.with_max_len(BATCHES_PER_TASK).for_each(|(batch, out)| {
            self.cells.with(|scratch| self.cell_batch(along, batch, scratch, &terms, out));
            for (lane, out) in out.chunks_exact(cell_len).enumerate() {
                if !sums_to_a_number(out) {
                    first.fetch_min(self.share.own[batch * WIDTH + lane], Ordering::Relaxed);
                }
            }
        });
        self.terms = terms;
        let first = first.into_inner();
        if first == usize::MAX {
            return None;
        }
        self.share.own.iter().position(|&cell| cell == first)
    }

    /// The terms of all facets. Directions of ghosts arrive while facets between own cells are computed.
    fn all_facets(&mut self, along: Differentiate, terms: &mut [f64], loads: &mut [Vec<f64>]) {
        if along == Differentiate::Nothing || !self.share.has_cuts() {
            return self.facets(along, |_| true, terms, loads);
        }
        let (viscous, own) = (self.problem.kernels.is_viscous(), self.layout.cells);
        let mut messages = self.share.trace_messages(&self.direction_traces, viscous);
        let is_inner = |batch: &FacetBatch| batch.sides_of_all().all(|side| side.cell < own);
        self.share.exchange_while(&mut messages, &mut || self.facets(along, is_inner, terms, loads));
        self.share.put_traces(&messages, viscous, &mut self.direction_traces);
        self.facets(along, |batch| !is_inner(batch), terms, loads);
    }

    /// The terms of the batches of facets that are `wanted`.
    fn facets(
        &self,
        along: Differentiate,
        wanted: impl Fn(&FacetBatch) -> bool + Sync,
        terms: &mut [f64],
        loads: &mut [Vec<f64>],
    ) {
        let facet_len = 2 * self.state_traces.layout.face_len();
        let facets = terms.par_chunks_mut(WIDTH * facet_len).zip(loads).zip(&self.facets.batches);
        let wanted = facets.with_max_len(BATCHES_PER_TASK).filter(|(_, batch)| wanted(batch));
        wanted.for_each(|((terms, loads), batch)| {
            self.facet_scratch.with(|scratch| self.facet_batch(along, batch, scratch, terms, loads));
        });
    }

    /// The facet terms of one batch, `[facet][side][kind][a][m][face node]`, every side in its own lattice.
    fn facet_batch(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        scratch: &mut FacetScratch,
        terms: &mut [f64],
        loads: &mut [f64],
    ) {
        let viscous = self.problem.kernels.is_viscous();
        let Some(along) = self.changed_on_facets(along, batch) else {
            terms.fill(0.0);
            return loads.fill(0.0);
        };
        let state = &self.state_and_direction()[..along.state_blocks()];
        self.gather_states(along, state, batch, scratch);
        let geometry = self.facet_geometry(along, batch);
        if geometry.is_none() || batch.boundary.is_some() {
            self.gather_mesh(along, batch, scratch);
        }
        let (time_points, test) = (&self.tables.time_points[..], &self.tables.test);
        let times = Times { time_points, in_time: self.in_time(), test, weight: self.dt };
        scratch.with_loads = !loads.is_empty();
        self.facet_kernel(along, batch, &times, geometry, scratch);
        scatter_loads(&scratch.loads, loads);
        scratch.with_loads = false;
        self.scatter_terms(batch, scratch, viscous, terms);
    }

    /// The map from time nodes and slots to the Gauss points in time.
    pub(crate) fn in_time(&self) -> InTime<'_> {
        InTime { values: &self.tables.values, velocities: &self.tables.velocities, positions: &self.positions }
    }

    /// Runs the facet kernel on a batch that has been gathered, with its geometry at these times if that is known.
    pub(crate) fn facet_kernel(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        times: &Times,
        geometry: Option<&[Pack]>,
        scratch: &mut FacetScratch,
    ) {
        self.across(along, batch, |context, across| {
            self.problem.kernels.facets(along, &FacetContext { geometry, ..*context }, times, across, scratch);
        });
    }

    /// Passes the data on the other side of the facets of a batch to `kernel`.
    pub(crate) fn across(
        &self,
        along: Differentiate,
        batch: &FacetBatch,
        kernel: impl FnOnce(&FacetContext<D>, &Across),
    ) {
        let field = batch.boundary.and_then(|boundary| self.problem.data[boundary].as_deref());
        let fill = |time: f64, x: &[Pack], data: &mut [Pack]| {
            if let Some(field) = field {
                let (blocks, origins) = (along.geometry_blocks(), self.facet_origins(batch));
                Prescribed { field, blocks, origins }.fill(time, self.tables.facet_points(), x, data);
            }
        };
        let data = field.is_some().then_some(&fill as DataAt);
        let across = batch.boundary.map_or(Across::Cells, |boundary| Across::Boundary(boundary, data));
        kernel(&FacetContext { tables: &self.tables, dt: self.dt, clock: self.clock, geometry: None }, &across);
    }

    /// The origins of the positions of a batch of facets: the origins of the minus cells.
    pub(crate) fn facet_origins(&self, batch: &FacetBatch) -> [&[f64]; WIDTH] {
        batch.minus.map(|side| self.mesh.origin(side.cell))
    }

    /// Volume terms and facet terms of one batch of cells.
    fn cell_batch(
        &self,
        along: Differentiate,
        batch: usize,
        scratch: &mut CellScratch,
        terms: &[f64],
        out: &mut [f64],
    ) {
        let cell_len = self.layout.cell_len();
        match self.changed_in_cells(along, batch) {
            Some(along) => self.volume_terms(along, batch, scratch),
            None => {
                scratch.residual.fill(Pack::ZERO);
                scratch.violated = Pack::ZERO;
            }
        }
        self.lift(cells_of(batch, self.layout.cells), terms, scratch);
        scatter(&scratch.residual, cell_len, out);
        for (lane, out) in out.chunks_exact_mut(cell_len).enumerate() {
            if along == Differentiate::Nothing {
                self.subtract_bottom(batch * WIDTH + lane, out);
            }
            if scratch.violated.0[lane] != 0.0 {
                out[0] = f64::NAN;
            }
        }
    }

    /// The volume terms of one batch of cells.
    fn volume_terms(&self, along: Differentiate, batch: usize, scratch: &mut CellScratch) {
        let state = self.state_and_direction().map(|traces| traces.coefficients(batch));
        let mesh = self.mesh_and_direction().map(|traces| traces.coefficients(batch));
        let (state, mesh) = (&state[..along.state_blocks()], &mesh[..along.geometry_blocks()]);
        let fill = |time: f64, points: usize, x: &[Pack], data: &mut [Pack]| {
            if let Some(field) = self.problem.source.as_deref() {
                let origins = cells_of(batch, self.layout.cells).map(|cell| self.mesh.origin(cell));
                Prescribed { field, blocks: along.geometry_blocks(), origins }.fill(time, points, x, data);
            }
        };
        let context = CellContext {
            tables: &self.tables,
            dt: self.dt,
            clock: self.clock,
            positions: &self.positions_and_top,
            source: self.problem.source.is_some().then_some(&fill),
            geometry: self.geometry.of_cells(batch).filter(|_| mesh.len() == 1),
        };
        if mesh.len() == 2 {
            self.differentiate_geometry(batch, scratch);
        }
        self.problem.kernels.slab_cells(along, &context, CellCoefficients { state, mesh }, scratch);
    }

    /// What changes in a batch of cells.
    fn changed_in_cells(&self, along: Differentiate, batch: usize) -> Option<Differentiate> {
        let changes = |packs: &[Pack]| packs.iter().any(|pack| *pack != Pack::ZERO);
        along.restricted(
            || changes(self.mesh_direction_traces.coefficients(batch)),
            || changes(self.direction_traces.coefficients(batch)),
        )
    }

    /// What changes on a batch of facets.
    fn changed_on_facets(&self, along: Differentiate, batch: &FacetBatch) -> Option<Differentiate> {
        let of_side = |side: usize| batch.ends(side).into_iter().flat_map(|end| [0, 1].map(|kind| (end, kind)));
        let mut ends = (0..batch.sides()).flat_map(of_side);
        along.restricted(
            || self.mesh_direction_traces.change_on_facets(batch.number),
            || ends.any(|(end, kind)| self.direction_traces.of(end.cell, end.face, kind).iter().any(|x| *x != 0.0)),
        )
    }

    fn state_and_direction(&self) -> [&Traces; 2] {
        [&self.state_traces, &self.direction_traces]
    }
    pub(crate) fn mesh_and_direction(&self) -> [&MeshTraces; 2] {
        [&self.mesh_traces, &self.mesh_direction_traces]
    }

    /// Adds the terms of the facets of a batch of cells to its residual.
    fn lift(&self, cells: [usize; WIDTH], terms: &[f64], scratch: &mut CellScratch) {
        let (layout, viscous) = (self.state_traces.layout, self.problem.kernels.is_viscous());
        let len = if viscous { layout.face_len() } else { layout.kind_len() };
        for (face, packs) in scratch.face_terms.chunks_exact_mut(layout.face_len()).enumerate() {
            let of_cell = |cell: usize| {
                let (slot, side) = self.facets.of_face[cell * 2 * D + face];
                let start = (2 * slot as usize + side as usize) * layout.face_len();
                &terms[start..start + len]
            };
            gather(cells.map(of_cell), &mut packs[..len]);
        }
        let tensors = layout.slots * layout.components;
        self.flow_faces.lift(tensors, &scratch.face_terms, viscous, &mut scratch.residual);
    }

    /// - phi_a(0) int_K psi u_n J at t_n.
    fn subtract_bottom(&self, cell: usize, out: &mut [f64]) {
        let mass_product = &self.bottom_mass_product[self.layout.at_one_time().cell(cell)];
        for (out, phi) in out.chunks_exact_mut(mass_product.len()).zip(&self.bottom_values) {
            for (r, m) in out.iter_mut().zip(mass_product) {
                *r -= phi * m;
            }
        }
    }
}

/// Whether all of `r` is finite: sums of it are then finite too, except for overflow. The sums are independent, so that they run at the
/// same time.
fn sums_to_a_number(r: &[f64]) -> bool {
    let mut sums = [0.0; WIDTH];
    let (chunks, rest) = r.as_chunks::<WIDTH>();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, r)| *sum += r);
    }
    sums.iter().chain(rest).sum::<f64>().is_finite()
}
