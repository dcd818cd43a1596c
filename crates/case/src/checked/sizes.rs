//! Numbers of unknowns of a case, and what follows from them.

use super::{AllowedChange, Case, Motion, Preconditioner, constrained};
use ::mesh as mesh_crate;

/// From this order of the flow in three dimensions the low-order preconditioner takes less memory than blocks and no more time
/// (docs/src/speed.md). At order 2 it takes 1.2 times as much time.
const LOW_ORDER_FROM: usize = 3;

/// With bodies that the flow moves, the low-order preconditioner takes four times the iterations of blocks, and twice the time. Blocks serve as
/// long as they take fewer bytes than this.
const MOST_BYTES_OF_BLOCKS: usize = 2_000_000_000;

impl<const D: usize> Case<D> {
    /// Whether this difference to the case of the earlier run is allowed.
    pub fn allows(&self, change: AllowedChange) -> bool {
        self.allowed_changes.contains(&change)
    }

    /// The unknown displacements of a slab: the components at the nodes of an elastic mesh that no boundary prescribes.
    pub fn mesh_unknowns(&self) -> Option<usize> {
        let Some(Motion::Elastic { slides, .. }) = &self.motion else { return None };
        let numbering = mesh_crate::NodeNumbering::new(&self.mesh, self.mesh.order());
        let constrained = constrained(&self.mesh, &numbering, slides);
        Some(constrained.as_flattened().iter().filter(|constrained| !**constrained).count() * self.time.order)
    }

    /// The preconditioner of the flow in slabs: the given one, or the cheapest in time and memory.
    pub fn preconditioner(&self) -> Preconditioner {
        let order = self.flow.as_ref().map_or(0, |flow| flow.order);
        let needs_blocks = self.has_moved_bodies() && self.bytes_of_blocks() <= MOST_BYTES_OF_BLOCKS;
        let cheapest = match D == 3 && order >= LOW_ORDER_FROM && !needs_blocks {
            true => Preconditioner::LowOrder,
            false => Preconditioner::Blocks,
        };
        self.solver.preconditioner.unwrap_or(cheapest)
    }

    /// Whether there are bodies or structures that the flow moves.
    pub fn has_moved_bodies(&self) -> bool {
        self.flow.is_some() && (!self.bodies.is_empty() || self.structure.is_some())
    }

    /// About the bytes of the preconditioner by blocks: the square of the unknowns of each cell, in single precision for the Jacobian and in
    /// half precision for every factor.
    fn bytes_of_blocks(&self) -> usize {
        let block = self.flow.as_ref().map_or(0, |flow| flow.order.pow(D as u32) * (D + 2));
        self.mesh.n_cells() * block * block * (4 + 2 * self.time.order)
    }

    /// Unknowns of the flow in a slab, 0 without a flow.
    pub fn flow_unknowns(&self) -> usize {
        let per_cell = self.flow.as_ref().map_or(0, |flow| flow.order.pow(D as u32) * (D + 2));
        self.mesh.n_cells() * per_cell * self.time.order
    }
}
