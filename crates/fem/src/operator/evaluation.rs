//! An evaluation: the kernels on all facets, then on all cells.

use super::SlabOperator;
use crate::batches::{BATCHES_PER_TASK, FacetBatch, cells_of};
use crate::cell::{CellCoefficients, CellContext};
use crate::facet::{Across, DataAt, FacetContext};
use crate::gather::{gather, gather_cells, scatter};
use crate::kernels::{Differentiate, Times};
use crate::mesh_traces::MeshTraces;
use crate::prescribed::Prescribed;
use crate::scratch::{CellScratch, FacetScratch};
use crate::time_points::InTime;
use crate::traces::Traced;
use crate::wall_loads::scatter_loads;
use mesh::Side;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use tensor::{Pack, WIDTH};

/// What an evaluation differentiates, with the direction of the state in own cells.
type Direction<'a> = (Differentiate, &'a [f64]);

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Facets, then cells: the terms of every facet are computed once and read by both its cells. Returns the first cell, in the order
    /// of the whole mesh, with a NaN in its result: violations are passed on as NaN, and arithmetic may produce it. The traces of the
    /// `direction`, that of the state in own cells, must be taken. The residual has an empty one.
    pub(super) fn run(&mut self, along: Differentiate, direction: &[f64], out: &mut [f64]) -> Option<usize> {
        let (mut terms, mut loads) = (std::mem::take(&mut self.terms), std::mem::take(&mut self.wall_loads.terms));
        self.all_facets(along, direction, &mut terms, &mut loads);
        self.wall_loads.terms = loads;
        self.sum_loads();
        let (cell_len, first) = (self.layout.cell_len(), AtomicUsize::new(usize::MAX));
        let cells = out.par_chunks_mut(WIDTH * cell_len).enumerate();
        cells.with_max_len(BATCHES_PER_TASK).for_each(|(batch, out)| {
            self.cells.with(|scratch| self.cell_batch((along, direction), batch, scratch, &terms, out));
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
    fn all_facets(&mut self, along: Differentiate, direction: &[f64], terms: &mut [f64], loads: &mut [Vec<f64>]) {
        let by = (along, direction);
        if along == Differentiate::Nothing || !self.share.has_cuts() {
            return self.facets(by, |_| true, terms, loads);
        }
        let (own, lattice) = (self.layout.cells, &self.facets.permutations[0]);
        let [_, traced] = self.states(direction);
        let mut messages = self.share.trace_messages(traced, lattice);
        let is_inner = |batch: &FacetBatch| batch.sides_of_all().all(|side| side.cell < own);
        self.share.exchange_while(&mut messages, &mut || self.facets(by, is_inner, terms, loads));
        self.share.put_traces(&messages, lattice, &mut self.direction_of_ghosts, &mut self.direction_traces);
        self.facets(by, |batch| !is_inner(batch), terms, loads);
    }

    /// The terms of the batches of facets that are `wanted`.
    fn facets(
        &self,
        by: Direction,
        wanted: impl Fn(&FacetBatch) -> bool + Sync,
        terms: &mut [f64],
        loads: &mut [Vec<f64>],
    ) {
        let facet_len = 2 * self.state_traces.layout.face_len();
        let facets = terms.par_chunks_mut(WIDTH * facet_len).zip(loads).zip(&self.facets.batches);
        let wanted = facets.with_max_len(BATCHES_PER_TASK).filter(|(_, batch)| wanted(batch));
        wanted.for_each(|((terms, loads), batch)| {
            self.facet_scratch.with(|scratch| self.facet_batch(by, batch, scratch, terms, loads));
        });
    }

    /// The facet terms of one batch, `[facet][side][kind][a][m][face node]`, every side in its own lattice.
    fn facet_batch(
        &self,
        (along, direction): Direction,
        batch: &FacetBatch,
        scratch: &mut FacetScratch,
        terms: &mut [f64],
        loads: &mut [f64],
    ) {
        let states = self.states(direction);
        let Some(along) = self.changed_on_facets(along, states[1], batch) else {
            terms.fill(0.0);
            return loads.fill(0.0);
        };
        self.gather_states(along, &states[..along.state_blocks()], batch, scratch);
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
        self.scatter_terms(batch, scratch, terms);
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
        (along, direction): Direction,
        batch: usize,
        scratch: &mut CellScratch,
        terms: &[f64],
        out: &mut [f64],
    ) {
        let cell_len = self.layout.cell_len();
        match self.changed_in_cells(along, direction, batch) {
            Some(along) => self.volume_terms((along, direction), batch, scratch),
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
    fn volume_terms(&self, (along, direction): Direction, batch: usize, scratch: &mut CellScratch) {
        let (state_blocks, geometry_blocks) = (along.state_blocks(), along.geometry_blocks());
        let geometry = self.geometry.of_cells(batch).filter(|_| geometry_blocks == 1);
        let mut packs = std::mem::take(&mut scratch.coefficients);
        let cells = cells_of(batch, self.layout.cells);
        gather_cells(&[&self.state, direction][..state_blocks], cells, &mut packs.state);
        if geometry.is_none() || self.problem.source.is_some() {
            let meshes = [&self.mesh.data[..], &self.mesh_direction.data];
            gather_cells(&meshes[..geometry_blocks], cells, &mut packs.mesh);
        }
        let [state, mesh] = packs.blocks();
        let (state, mesh) = (&state[..state_blocks], &mesh[..geometry_blocks]);
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
            geometry,
        };
        if let [_, _] = mesh {
            self.differentiate_geometry(batch, mesh, scratch);
        }
        self.problem.kernels.slab_cells(along, &context, CellCoefficients { state, mesh }, scratch);
        scratch.coefficients = packs;
    }

    /// What changes in a batch of cells.
    fn changed_in_cells(&self, along: Differentiate, direction: &[f64], batch: usize) -> Option<Differentiate> {
        let cells = batch * WIDTH..((batch + 1) * WIDTH).min(self.layout.cells);
        let changes = |coefficients: &[f64], len: usize| {
            coefficients[cells.start * len..cells.end * len].iter().any(|value| *value != 0.0)
        };
        along.restricted(
            || changes(&self.mesh_direction.data, self.mesh.cell_len()),
            || changes(direction, self.layout.cell_len()),
        )
    }

    /// What changes on a batch of facets.
    fn changed_on_facets(&self, along: Differentiate, direction: Traced, batch: &FacetBatch) -> Option<Differentiate> {
        let nodes = &self.facets.permutations[0].flow_of_cell;
        let changes = |end: Side| {
            direction.values_on(end.cell, &nodes[end.face]).any(|value| value != 0.0)
                || direction.traces.derivatives_on(end).iter().any(|value| *value != 0.0)
        };
        along.restricted(
            || self.mesh_direction_traces.change_on_facets(batch.number),
            || batch.sides_of_all().any(changes),
        )
    }

    /// The state, and a direction of it in own cells.
    fn states<'a>(&'a self, direction: &'a [f64]) -> [Traced<'a>; 2] {
        let ghosts = &self.direction_of_ghosts;
        [self.traced_state(), Traced { coefficients: direction, ghosts, traces: &self.direction_traces }]
    }

    /// The mesh, and its direction.
    pub(crate) fn mesh_and_direction(&self) -> [&MeshTraces; 2] {
        [&self.mesh_traces, &self.mesh_direction_traces]
    }

    /// Adds the terms of the facets of a batch of cells to its residual.
    fn lift(&self, cells: [usize; WIDTH], terms: &[f64], scratch: &mut CellScratch) {
        let layout = self.state_traces.layout;
        let len = layout.face_len();
        for (face, packs) in scratch.face_terms.chunks_exact_mut(len).enumerate().take(2 * D) {
            let of_cell = |cell: usize| {
                let (slot, side) = self.facets.of_face[cell * 2 * D + face];
                let start = (2 * slot as usize + side as usize) * len;
                &terms[start..start + len]
            };
            gather(cells.map(of_cell), packs);
        }
        let tensors = layout.slots * layout.components;
        self.flow_faces.lift(tensors, &scratch.face_terms, layout.kinds, &mut scratch.residual);
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
