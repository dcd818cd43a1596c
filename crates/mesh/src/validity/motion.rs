//! The cells of a moving mesh, slab after slab.

use super::sweep::{BoundPack, Scratch, Sweep, Swept};
use super::{Bound, SHARPNESS, SlabPoint, Validity, ValidityCheck};
use crate::parallel::{self, Grain};
use crate::{Mesh, NodeNumbering};
use rayon::prelude::*;
use tensor::Arch;
use tensor::WIDTH;

/// Proves bounds of det J / det J_0 for all cells of a moving mesh.
///
/// 1. Bound eight cells at a time, see `sweep`.
/// 2. Bound all halves of the undecided cells, eight cells at a time.
/// 3. Search in the cells that are still undecided, as [`ValidityCheck::decide`] for det J / det J_0.
///
/// Data of the mesh at rest are kept.
#[derive(Clone, Debug)]
pub struct MotionCheck<const D: usize> {
    check: ValidityCheck<D>,
    sweep: Sweep<D>,
    numbering: NodeNumbering,
    /// Positions at rest relative to the first node of the cell, `[cell][node][component]`.
    positions: Vec<f64>,
    /// det J_0, `[cell][point]`, and a bound of its error, `[cell]`.
    references: Vec<f64>,
    reference_errors: Vec<f64>,
}

impl<const D: usize> MotionCheck<D> {
    /// For displacements of the C0 nodes of `mesh` that are polynomials in time, given at the distinct `times` in [0, 1].
    /// `numbering` has the order of the mesh.
    ///
    /// # Panics
    /// If there is no time.
    pub fn new(mesh: &Mesh<D>, numbering: &NodeNumbering, times: &[f64]) -> Self {
        let check = ValidityCheck::new(mesh.order(), times);
        let at_rest = ValidityCheck::<D>::new(mesh.order(), &[0.0]);
        let determinant = |cell| at_rest.determinant(mesh.cell_coordinates(cell), &at_rest.time_values);
        let determinants = parallel::map(mesh.n_cells(), Grain::Any, &determinant);
        let relative = |cell| {
            let x = mesh.cell_coordinates(cell);
            (0..x.len()).map(move |k| x[k] - x[k % D])
        };
        MotionCheck {
            sweep: Sweep::new(mesh.order(), &check.time_values, &check.directions),
            numbering: numbering.clone(),
            positions: (0..mesh.n_cells()).flat_map(relative).collect(),
            references: determinants.iter().flat_map(|(values, _)| &values.values).copied().collect(),
            reference_errors: determinants.iter().map(|(_, polynomial)| polynomial.error()).collect(),
            check,
        }
    }

    /// Decides the sign of det J / det J_0 in every cell. The lower bound reaches at least half of the smallest value sampled in
    /// any cell. `displacements` are `[time][C0 node][component]`.
    pub fn decide(&self, displacements: &[f64]) -> Vec<Validity<D>> {
        debug_assert_eq!(displacements.len(), self.check.n_times * self.numbering.count * D);
        let cells: Vec<usize> = (0..self.reference_errors.len()).collect();
        let mut bounds = self.bound(&cells, displacements, false);
        let smallest = bounds.iter().map(|bound| bound.sampled_min).fold(f64::INFINITY, f64::min);
        let proved = |bound: &Bound<D>| bound.lower > 0.0 && bound.lower >= SHARPNESS * smallest;
        // A NaN does not show in the sampled values.
        let refuted = |bound: &Bound<D>| bound.sampled_min <= 0.0 && !bound.lower.is_nan();
        let is_open = |cell: &usize| !proved(&bounds[*cell]) && !refuted(&bounds[*cell]);
        let open: Vec<usize> = cells.into_iter().filter(is_open).collect();
        for (cell, bound) in open.iter().zip(self.bound(&open, displacements, true)) {
            bounds[*cell].lower = bounds[*cell].lower.max(bound.lower);
        }
        let answer = |cell: usize| match bounds[cell] {
            bound if proved(&bound) => Validity::Valid(bound),
            bound if refuted(&bound) => Validity::Invalid(bound),
            _ => self.search(cell, displacements, smallest),
        };
        parallel::map(bounds.len(), Grain::Any, &answer)
    }

    /// The bounds of some cells.
    fn bound(&self, cells: &[usize], displacements: &[f64], in_halves: bool) -> Vec<Bound<D>> {
        let mut bounds = vec![Bound::UNKNOWN; cells.len()];
        let bound_pack = |work: &mut Scratch, (cells, bounds): (&[usize], &mut [Bound<D>])| {
            self.gather(cells, displacements, work);
            let swept = Arch::new().dispatch(BoundPack { sweep: &self.sweep, work, in_halves });
            bounds.iter_mut().enumerate().for_each(|(lane, bound)| *bound = self.lane_bound(&swept, lane));
        };
        let packs = cells.par_chunks(WIDTH).zip(bounds.par_chunks_mut(WIDTH));
        packs.for_each_init(|| self.sweep.scratch(), bound_pack);
        bounds
    }

    /// At most [`WIDTH`] cells in lanes; the last cell fills the remaining lanes.
    fn gather(&self, cells: &[usize], displacements: &[f64], work: &mut Scratch) {
        let (nodes, points) = (self.nodes_per_cell(), self.sweep.points());
        for lane in 0..WIDTH {
            let cell = cells[lane.min(cells.len() - 1)];
            let (numbers, at_rest) = (self.numbering.cell(cell), &self.positions[cell * nodes * D..][..nodes * D]);
            let length = self.numbering.count * D;
            for (d, out) in displacements.chunks_exact(length).zip(work.nodes.chunks_exact_mut(nodes * D)) {
                // A translation, at any time, does not change det J, but would cost digits.
                let first = &d[numbers[0] * D..][..D];
                for (k, number) in numbers.iter().enumerate() {
                    for i in 0..D {
                        out[i * nodes + k].0[lane] = at_rest[k * D + i] + (d[number * D + i] - first[i]);
                    }
                }
            }
            let reference = &self.references[cell * points..][..points];
            work.reference.iter_mut().zip(reference).for_each(|(pack, det)| pack.0[lane] = *det);
            work.reference_error.0[lane] = self.reference_errors[cell];
        }
    }

    fn lane_bound(&self, swept: &Swept, lane: usize) -> Bound<D> {
        let mut rest = swept.place.0[lane] as usize;
        let mut coordinate = |axis: usize| {
            let points = &self.check.directions[axis].points;
            let x = points[rest % points.len()];
            rest /= points.len();
            x
        };
        let at = SlabPoint { xi: std::array::from_fn(&mut coordinate), s: 0.5 + 0.5 * coordinate(D) };
        let [lower, sampled_min, sampled_max] =
            [swept.lower, swept.sampled_min, swept.sampled_max].map(|pack| pack.0[lane]);
        Bound { lower, sampled_min, sampled_max, at }
    }

    /// The search in one cell; `smallest` is the smallest value sampled in any cell.
    fn search(&self, cell: usize, displacements: &[f64], smallest: f64) -> Validity<D> {
        let (numbers, length) = (self.numbering.cell(cell), self.nodes_per_cell() * D);
        let at_rest = &self.positions[cell * length..][..length];
        let moved = |d: &[f64]| -> Vec<f64> {
            let relative = |k: usize| d[numbers[k / D] * D + k % D] - d[numbers[0] * D + k % D];
            (0..length).map(|k| at_rest[k] + relative(k)).collect()
        };
        let positions: Vec<f64> = displacements.chunks_exact(self.numbering.count * D).flat_map(moved).collect();
        self.check.search(&positions, Some(at_rest)).decide(&self.check.directions, smallest)
    }

    fn nodes_per_cell(&self) -> usize {
        self.positions.len() / (D * self.reference_errors.len())
    }
}
