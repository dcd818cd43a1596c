//! The first time at which det J <= 0 at a sample point, as published tables give it. The proof of `mesh` is stricter.

use crate::mesh_mover::MeshMover;
use crate::state::Interval;
use basis::gauss;
use fem::parallel::{self, Grain};
use mesh::CellMap;
use newton_krylov::inner_product::smallest;

impl<const D: usize> MeshMover<D> {
    /// The first time in a slab at which det J <= 0 at a sample point, to a thousandth of the slab. The points are 2N Gauss points per
    /// direction of a cell, with N the order of the mesh (Diosady & Murman, AIAA 2018-0919, section III.C). The search covers the
    /// intervals between the time nodes of the slab.
    pub fn first_invalid_sampled(&self, bottom: &[f64], v: &[f64], interval: Interval) -> Option<f64> {
        let map = CellMap::on_grid(self.reference.order(), &gauss(2 * self.reference.order()).points);
        let dt = interval.length();
        let is_valid = |s: f64| self.smallest_determinant(&map, dt, bottom, v, s) > 0.0;
        let nodes: Vec<f64> = std::iter::once(0.0).chain(self.slab_motion.time().nodes().iter().copied()).collect();
        let first = nodes.iter().position(|&s| !is_valid(s))?;
        let (mut valid, mut invalid) = (nodes[first.saturating_sub(1)], nodes[first]);
        while invalid - valid > 1e-3 {
            let middle = 0.5 * (valid + invalid);
            if is_valid(middle) { valid = middle } else { invalid = middle }
        }
        Some(interval.start + invalid * dt)
    }

    /// The smallest det J at the points of `map` in all cells, at s in [0, 1].
    fn smallest_determinant(&self, map: &CellMap<D>, dt: f64, bottom: &[f64], v: &[f64], s: f64) -> f64 {
        let mut d = vec![0.0; bottom.len()];
        self.slab_motion.displacement(dt, bottom, v, s, &mut d);
        let in_cell = |cell: usize| {
            let mut x = self.reference.cell_coordinates(cell).to_vec();
            for (x, &node) in x.chunks_exact_mut(D).zip(self.numbering.cell(cell)) {
                (0..D).for_each(|i| x[i] += d[node * D + i]);
            }
            smallest(map.determinants(&x))
        };
        let of_cells: Vec<f64> = parallel::map(self.reference.n_cells(), Grain::Any, &in_cell);
        smallest(of_cells)
    }
}
