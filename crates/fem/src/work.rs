//! The number of floating-point operations of the kernels.

use crate::batches::cells_of;
use crate::cell::{CellCoefficients, CellContext};
use crate::facet::FacetContext;
use crate::gather::gather_cells;
use crate::kernels::{Differentiate, Times};
use crate::operator::SlabOperator;
use tensor::WIDTH;

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Operations of one evaluation of the residual or, with [`Differentiate::State`], of one Jacobian product. A batch of cells and a
    /// batch of interior facets are counted and scaled to all cells and interior facets, in the state and on the mesh last set. Traces,
    /// sources and boundaries are left out. None without the feature `operation-counts`.
    pub fn operations(&self, along: Differentiate) -> Option<u64> {
        let facets: usize = self.facets.batches.iter().filter(|batch| batch.boundary.is_none()).map(|b| b.count).sum();
        let of_all = |number: usize, of_batch: u64| of_batch * number as u64 / WIDTH as u64;
        Some(of_all(self.layout.cells, self.cell_operations(along)?) + of_all(facets, self.facet_operations(along)?))
    }

    /// Of the first batch of cells, with the state as its own direction.
    fn cell_operations(&self, along: Differentiate) -> Option<u64> {
        let (dt, clock) = (self.interval().1, self.clock());
        let (geometry, positions) = (self.geometry.of_cells(0), &self.positions_and_top);
        let context = CellContext { tables: &self.tables, dt, clock, positions, source: None, geometry };
        self.cells.with(|scratch| {
            let mut packs = std::mem::take(&mut scratch.coefficients);
            let cells = cells_of(0, self.layout.cells);
            gather_cells(&[self.traced_state().coefficients; 2], cells, &mut packs.state);
            gather_cells(&[&self.mesh.data], cells, &mut packs.mesh);
            let [state, [mesh, _]] = packs.blocks();
            let (state, mesh) = (&state[..along.state_blocks()], &[mesh][..]);
            let before = scratch.scratch.multiplications;
            let at_points =
                self.problem.kernels.count_cells(along, &context, CellCoefficients { state, mesh }, scratch);
            scratch.coefficients = packs;
            Some(at_points? + in_lanes(scratch.scratch.multiplications - before))
        })
    }

    /// Of the first batch of facets between cells, if there is one.
    fn facet_operations(&self, along: Differentiate) -> Option<u64> {
        let Some(batch) = self.facets.batches.iter().find(|batch| batch.boundary.is_none()) else { return Some(0) };
        let (dt, clock) = (self.interval().1, self.clock());
        let geometry = self.facet_geometry(along, batch);
        let context = FacetContext { tables: &self.tables, dt, clock, geometry };
        let times = Times {
            time_points: &self.tables.time_points,
            in_time: self.in_time(),
            test: &self.tables.test,
            weight: dt,
        };
        let state = [self.traced_state(); 2];
        self.facet_scratch.with(|scratch| {
            self.gather_states(along, &state[..along.state_blocks()], batch, scratch);
            self.gather_mesh(Differentiate::Nothing, batch, scratch);
            let before = scratch.scratch.multiplications;
            let at_points = self.problem.kernels.count_facets(along, &context, &times, scratch);
            Some(at_points? + in_lanes(scratch.scratch.multiplications - before))
        })
    }
}

/// A multiplication of packs comes with an addition, in every lane.
fn in_lanes(multiplications: usize) -> u64 {
    (2 * WIDTH * multiplications) as u64
}
