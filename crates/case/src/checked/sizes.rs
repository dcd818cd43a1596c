//! Numbers of unknowns of a case, and what follows from them.

use super::{AllowedChange, Case, Freedom, Motion, Preconditioner, constrained};
use ::mesh as mesh_crate;
use navier_stokes::Boundary;

/// From this order of the flow in three dimensions the low-order preconditioner takes less memory than blocks and no more time
/// (docs/src/speed.md). At order 2 it takes 1.2 times as much time.
const LOW_ORDER_FROM: usize = 3;

/// With bodies that the flow moves, the low-order preconditioner takes four times the iterations of blocks, and twice the time; in a thin layer it
/// takes up to a hundred times as many. Blocks serve as long as they take fewer bytes than this.
const MOST_BYTES_OF_BLOCKS: usize = 2_000_000_000;

/// A layer that nothing holds is thin if sound crosses it more often in a slab. At 6 crossings the low-order preconditioner takes nine times the
/// iterations of blocks, at 60 thirty times.
const THIN: f64 = 5.0;

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
        if let Some(given) = self.solver.preconditioner {
            return given;
        }
        let needs_blocks = || self.has_moved_bodies() || self.has_thin_layer();
        match D == 3 && order >= LOW_ORDER_FROM && !(self.bytes_of_blocks() <= MOST_BYTES_OF_BLOCKS && needs_blocks()) {
            true => Preconditioner::LowOrder,
            false => Preconditioner::Blocks,
        }
    }

    /// Whether some cells are alone between planes of symmetry or periodic sides so near that sound crosses often in a slab: a span of one layer.
    pub fn has_thin_layer(&self) -> bool {
        let Some(flow) = &self.flow else { return false };
        let sound = flow.law.gas.sound_speed(flow.law.reference.density(), flow.reference_pressure());
        let across = |cell: usize, axis: usize| -> f64 {
            let nodes = self.mesh.cell_coordinates(cell);
            let middle = |side: usize| -> [f64; D] {
                let of_face = mesh_crate::face_nodes(D, self.mesh.order(), 2 * axis + side);
                std::array::from_fn(|i| {
                    of_face.iter().map(|node| nodes[node * D + i]).sum::<f64>() / of_face.len() as f64
                })
            };
            let [low, high] = [middle(0), middle(1)];
            tensor::norm(&std::array::from_fn::<f64, D, _>(|i| high[i] - low[i]))
        };
        self.free_across().into_iter().any(|(cell, axis)| sound * self.time.step > THIN * across(cell, axis))
    }

    /// The cells that are free on both sides along an axis of the reference cell, and that axis.
    fn free_across(&self) -> Vec<(usize, usize)> {
        let itself = self.mesh.interior_facets().iter().filter(|facet| facet.minus.cell == facet.plus.cell);
        let itself = itself.map(|facet| (facet.minus.cell, facet.minus.face / 2));
        let is_plane = |boundary: usize| {
            let condition = self.flow.as_ref().map(|flow| &flow.boundary[boundary].condition);
            condition.is_some_and(Boundary::is_slip)
        };
        let mut planes: Vec<(usize, usize)> = self
            .mesh
            .boundary_facets()
            .iter()
            .filter(|facet| is_plane(facet.boundary))
            .map(|facet| (facet.side.cell, facet.side.face))
            .collect();
        planes.sort_unstable();
        let both = planes.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 / 2 == pair[1].1 / 2);
        itself.chain(both.map(|pair| (pair[0].0, pair[0].1 / 2))).collect()
    }

    /// Whether there are bodies or structures that the flow moves.
    pub fn has_moved_bodies(&self) -> bool {
        self.flow.is_some() && (!self.bodies.is_empty() || self.structure.is_some())
    }

    /// Whether the flow moves a structure, or a coordinate of a body that is not driven over the whole run.
    pub fn is_moved_by_flow(&self) -> bool {
        let ends = |freedom: &Freedom| freedom.release.is_some_and(|release| release < self.time.end);
        let is_free = |freedom: &Freedom| freedom.motion.is_none() || ends(freedom);
        let structure = self.flow.is_some() && self.structure.is_some();
        structure || self.bodies.iter().flat_map(|body| &body.freedoms).any(is_free)
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
