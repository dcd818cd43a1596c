//! The mass matrix, and all other integrals over the cells against the displacement functions, matrix-free.
//!
//! ```text
//! w . M v = int rho w . v dx = sum over cells and points of  rho W  w . v                                      (M)
//! w . f   = int w . b dx     = sum over cells and points of      W  w . b                                      (body force)
//! ```
//!
//! with W = w det J of the quadrature weight w. The mass is consistent: v or b is interpolated to the points, and the transposed
//! interpolation tests it.

use crate::pool::Pool;
use basis::{AllAxes, Lagrange, Matrix, apply_all_axes, gauss, scratch_length};
use fem::NodalBatches;
use fem::parallel::{self, Grain};
use mesh::{CellMap, Mesh};
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, WIDTH, zeroed};

/// Gauss points per direction for displacements of order `order` on a geometry of order `geometry`.
///
/// A body accelerated as a whole resists with int rho phi_k dx at node k. This is exact if the degree of phi_k det J per direction,
/// (N - 1) + D (G - 1) - 1, is at most 2 n - 1. N points integrate M on affine cells.
fn quadrature_points(dimension: usize, order: usize, geometry: usize) -> usize {
    ((order - 1) + dimension * (geometry - 1)).div_ceil(2).max(order)
}

/// M on all nodes, and (body force).
pub(crate) struct Mass<const D: usize> {
    density: f64,
    interpolate: Matrix,
    transposed: Matrix,
    /// W, `[batch][point]`.
    weights: Vec<Pack>,
    /// Positions, `[cell][point]`.
    positions: Vec<[f64; D]>,
    results: Pool<Vec<Pack>>,
    scratch: Pool<Scratch>,
}

/// Work space of one batch.
struct Scratch {
    /// `[component][node]`
    nodal: Vec<Pack>,
    /// `[component][point]`
    values: Vec<Pack>,
    /// Intermediate results between two axes.
    between: Vec<Pack>,
}

impl<const D: usize> Mass<D> {
    /// The mass matrix of a body of constant `density` for displacements of order `order`; `batches` belong to `mesh`.
    pub(crate) fn new(mesh: &Mesh<D>, batches: &NodalBatches<D>, order: usize, density: f64) -> Self {
        let rule = gauss(quadrature_points(D, order, mesh.order()));
        let interpolate = Lagrange::gauss_lobatto(order).value_matrix(&rule.points);
        let map = CellMap::on_grid(mesh.order(), &rule.points);
        Mass {
            density,
            transposed: interpolate.transpose(),
            interpolate,
            weights: weights(mesh, batches, &map, &rule.tensor_weights(D)),
            positions: (0..mesh.n_cells()).flat_map(|cell| map.positions(mesh.cell_coordinates(cell))).collect(),
            results: Pool::new(),
            scratch: Pool::new(),
        }
    }

    /// rho
    pub(crate) fn density(&self) -> f64 {
        self.density
    }

    /// out = M v, both `[C0 node][component]`.
    pub(crate) fn apply(&self, batches: &NodalBatches<D>, v: &[f64], out: &mut [f64]) {
        let values_of_batch = |batch: usize, scratch: &mut Scratch| {
            batches.gather(batch, v, &mut scratch.nodal);
            Arch::new().dispatch(Interpolate::<D> { matrix: &self.interpolate, scratch });
        };
        self.integrate(batches, self.density, values_of_batch, out);
    }

    /// out = int phi_k b for every node k, `[C0 node][component]`, of a body force b(x).
    pub(crate) fn load(&self, batches: &NodalBatches<D>, b: impl Fn(&[f64; D]) -> [f64; D] + Sync, out: &mut [f64]) {
        let points = self.points();
        let values_of_batch = |batch: usize, scratch: &mut Scratch| {
            for lane in 0..WIDTH {
                let positions = &self.positions[batches.cell(batch, lane) * points..][..points];
                for (point, x) in positions.iter().enumerate() {
                    for (i, value) in b(x).into_iter().enumerate() {
                        scratch.values[i * points + point].0[lane] = value;
                    }
                }
            }
        };
        self.integrate(batches, 1.0, values_of_batch, out);
    }

    /// out = `factor` int phi_k times the values that `values_of_batch` writes at the points.
    fn integrate(
        &self,
        batches: &NodalBatches<D>,
        factor: f64,
        values_of_batch: impl Fn(usize, &mut Scratch) + Sync,
        out: &mut [f64],
    ) {
        let mut results = self.results.take(|| zeroed(batches.field_length()));
        parallel::for_each_chunk(&mut results, batches.cell_length(), Grain::Any, &|batch, result| {
            let mut scratch = self.scratch.take(|| self.new_scratch());
            values_of_batch(batch, &mut scratch);
            let weights = &self.weights[batch * self.points()..][..self.points()];
            let matrix = &self.transposed;
            Arch::new().dispatch(Test::<D> { matrix, weights, factor, scratch: &mut scratch, result });
            self.scratch.give(scratch);
        });
        batches.assemble(&results, out);
        self.results.give(results);
    }

    /// Points of a cell.
    fn points(&self) -> usize {
        self.interpolate.rows().pow(D as u32)
    }

    fn new_scratch(&self) -> Scratch {
        let (to_points, to_nodes) = ([&self.interpolate; D], [&self.transposed; D]);
        Scratch {
            nodal: zeroed(D * self.interpolate.cols().pow(D as u32)),
            values: zeroed(D * self.points()),
            between: zeroed(scratch_length(&to_points, D).max(scratch_length(&to_nodes, D))),
        }
    }
}

/// W = w det J, `[batch][point]`.
fn weights<const D: usize>(mesh: &Mesh<D>, batches: &NodalBatches<D>, map: &CellMap<D>, rule: &[f64]) -> Vec<Pack> {
    let mut weights = zeroed(batches.count() * rule.len());
    parallel::for_each_chunk(&mut weights, rule.len(), Grain::Any, &|batch, weights| {
        for lane in 0..WIDTH {
            let determinants = map.determinants(mesh.cell_coordinates(batches.cell(batch, lane)));
            for ((entry, w), det) in weights.iter_mut().zip(rule).zip(determinants) {
                entry.0[lane] = w * det;
            }
        }
    });
    weights
}

/// Nodal values of a batch to values at its points.
struct Interpolate<'a, const D: usize> {
    matrix: &'a Matrix,
    scratch: &'a mut Scratch,
}

impl<const D: usize> WithSimd for Interpolate<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Scratch { nodal, values, between } = self.scratch;
        apply_all_axes(simd, AllAxes { matrices: &[self.matrix; D], components: D }, nodal, values, between, false);
    }
}

/// `result` = `factor` W times the values at the points of a batch, tested.
struct Test<'a, const D: usize> {
    /// The transpose of the interpolation.
    matrix: &'a Matrix,
    weights: &'a [Pack],
    factor: f64,
    scratch: &'a mut Scratch,
    result: &'a mut [Pack],
}

impl<const D: usize> WithSimd for Test<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Scratch { values, between, .. } = self.scratch;
        for (value, weight) in values.iter_mut().zip(self.weights.iter().cycle()) {
            for part in 0..Lanes::<S>::PARTS {
                let weighted = Lanes::read(simd, value, part) * Lanes::read(simd, weight, part) * self.factor;
                weighted.write(value, part);
            }
        }
        apply_all_axes(
            simd,
            AllAxes { matrices: &[self.matrix; D], components: D },
            values,
            self.result,
            between,
            false,
        );
    }
}

#[cfg(test)]
mod tests;
