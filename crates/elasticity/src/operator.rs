//! The stiffness operator K, matrix-free, in SIMD lanes and threads.
//!
//! ```text
//! d . K w = int eps(d) : sigma(w) dx = sum over cells and points of  W  (H G) : sigma(H' G)                    (K)
//! ```
//!
//! with the reference gradient H of the displacement, `H[i][a]` = d d_i / d xi_a, the inverse Jacobian of the reference mesh,
//! `G[a][j]` = d xi_a / d x_j, and W = w det J E / E_0 with the quadrature weight w. Per cell: interpolate to the points, differentiate there, apply the law, and the
//! transposes of both in reverse order: O(N^(D+1)).

mod diagonal;
#[cfg(test)]
mod tests;

use crate::ElasticityError;
use crate::batches::Batches;
use crate::geometry::Sampler;
use crate::material::Lame;
use crate::pool::Pool;
use basis::{Lagrange, Matrix, Rule, apply_all_axes, apply_axis, apply_axis_add, scratch_length};
use rayon::prelude::*;
use tensor::pulp::{Arch, Simd, WithSimd};
use tensor::{Lanes, Pack, Real, WIDTH, zeroed};

/// K on all nodes: no node is constrained here.
pub(crate) struct Operator<const D: usize> {
    lame: Lame,
    batches: Batches<D>,
    lines: Lines,
    /// W and G, `[batch][point][1 + D D]`.
    metric: Vec<Pack>,
    workspaces: Pool<Workspace>,
}

/// The one-dimensional matrices of a cell.
struct Lines {
    /// Nodes to points, `[point][node]`.
    interpolate: Matrix,
    /// Values at the points to derivatives at the points.
    differentiate: Matrix,
    interpolate_transposed: Matrix,
    differentiate_transposed: Matrix,
}

/// Work space of one application.
struct Workspace {
    /// The cell field of results.
    results: Vec<Pack>,
    /// One per task.
    scratch: Vec<Scratch>,
    batches_per_task: usize,
}

/// Work space of one batch.
struct Scratch {
    /// `[component][node]`
    nodal: Vec<Pack>,
    /// `[component][point]`
    values: Vec<Pack>,
    /// `[direction][component][point]`
    gradients: Vec<Pack>,
    /// Between two axes.
    between: Vec<Pack>,
}

impl Lines {
    fn new(order: usize, points: &[f64]) -> Self {
        let interpolate = Lagrange::gauss_lobatto(order).value_matrix(points);
        let differentiate = Lagrange::new(points.to_vec()).derivative_matrix(points);
        let (interpolate_transposed, differentiate_transposed) = (interpolate.transpose(), differentiate.transpose());
        Lines { interpolate, differentiate, interpolate_transposed, differentiate_transposed }
    }
    fn points<const D: usize>(&self) -> usize {
        self.interpolate.rows().pow(D as u32)
    }
}

impl<const D: usize> Operator<D> {
    /// The operator of order `order` for the law `lame`, with the Gauss `rule` along each axis, whose points `sampler` samples.
    pub(crate) fn new(
        lame: Lame,
        order: usize,
        batches: Batches<D>,
        rule: &Rule,
        sampler: &Sampler<'_, D>,
    ) -> Result<Self, ElasticityError> {
        let metric = metric(&batches, rule, sampler)?;
        Ok(Operator { lame, batches, lines: Lines::new(order, &rule.points), metric, workspaces: Pool::new() })
    }

    /// out = K d, both `[C0 node][component]`.
    pub(crate) fn apply(&self, d: &[f64], out: &mut [f64]) {
        let mut workspace = self.workspaces.take(|| self.workspace());
        let Workspace { results, scratch, batches_per_task } = &mut workspace;
        let tasks = results.par_chunks_mut(*batches_per_task * self.batches.cell_length()).zip(scratch.par_iter_mut());
        tasks.enumerate().for_each(|(task, (results, scratch))| {
            let first = task * *batches_per_task;
            Arch::new().dispatch(ApplyToCells { operator: self, first, d, results, scratch });
        });
        self.batches.assemble(results, out);
        self.workspaces.give(workspace);
    }

    /// The matrices of the cells of one batch, `[column][row]`, column and row `[component][node]`.
    pub(crate) fn cell_matrices(&self, batch: usize) -> Vec<Pack> {
        let mut columns = zeroed(self.batches.cell_length().pow(2));
        Arch::new().dispatch(CellMatrices { operator: self, batch, columns: &mut columns });
        columns
    }

    /// The cells, in packs.
    pub(crate) fn batches(&self) -> &Batches<D> {
        &self.batches
    }

    /// Work space for the threads there are now; a few tasks per thread, so that none waits long for another.
    fn workspace(&self) -> Workspace {
        let tasks = 4 * rayon::current_num_threads();
        let batches_per_task = self.batches.count().div_ceil(tasks).max(1);
        let scratch = (0..tasks).map(|_| self.scratch()).collect();
        Workspace { results: zeroed(self.batches.field_length()), scratch, batches_per_task }
    }

    fn scratch(&self) -> Scratch {
        let points = self.lines.points::<D>();
        let between = scratch_length(&[&self.lines.interpolate; D], D)
            .max(scratch_length(&[&self.lines.interpolate_transposed; D], D));
        Scratch {
            nodal: zeroed(self.batches.cell_length()),
            values: zeroed(D * points),
            gradients: zeroed(D * D * points),
            between: zeroed(between),
        }
    }

    /// W and G at the points of a batch.
    fn batch_metric(&self, batch: usize) -> &[Pack] {
        let length = self.lines.points::<D>() * (1 + D * D);
        &self.metric[batch * length..][..length]
    }
}

/// W and G of all batches.
fn metric<const D: usize>(
    batches: &Batches<D>,
    rule: &Rule,
    sampler: &Sampler<'_, D>,
) -> Result<Vec<Pack>, ElasticityError> {
    let weights = tensor_weights::<D>(&rule.weights);
    let length = weights.len() * (1 + D * D);
    let mut metric = zeroed(batches.count() * length);
    let fill = |(batch, metric): (usize, &mut [Pack])| -> Result<(), ElasticityError> {
        for lane in 0..WIDTH {
            let samples = sampler.cell(batches.cell(batch, lane))?;
            for ((weight, sample), entry) in weights.iter().zip(&samples).zip(metric.chunks_exact_mut(1 + D * D)) {
                entry[0].0[lane] = weight * sample.determinant * sample.stiffness;
                for (pack, g) in entry[1..].iter_mut().zip(sample.inverse_jacobian.as_flattened()) {
                    pack.0[lane] = *g;
                }
            }
        }
        Ok(())
    };
    // All batches, then the first error: the same one for any number of threads.
    let filled: Vec<Result<(), _>> = metric.par_chunks_mut(length).enumerate().map(fill).collect();
    filled.into_iter().collect::<Result<(), _>>()?;
    Ok(metric)
}

/// Products of the weights along each axis, axis 0 fastest.
pub(crate) fn tensor_weights<const D: usize>(weights: &[f64]) -> Vec<f64> {
    (0..D).fold(vec![1.0], |product, _| weights.iter().flat_map(|w| product.iter().map(move |p| p * w)).collect())
}

/// W and G at one point.
#[inline(always)]
fn read_metric<S: Simd, const D: usize>(
    simd: S,
    metric: &[Pack],
    point: usize,
    part: usize,
) -> (Lanes<S>, [[Lanes<S>; D]; D]) {
    let entry = &metric[point * (1 + D * D)..][..1 + D * D];
    let mut g = [[Lanes::splat(simd, 0.0); D]; D];
    for a in 0..D {
        for j in 0..D {
            g[a][j] = Lanes::read(simd, &entry[1 + a * D + j], part);
        }
    }
    (Lanes::read(simd, &entry[0], part), g)
}

/// K d in consecutive batches from `first`.
struct ApplyToCells<'a, const D: usize> {
    operator: &'a Operator<D>,
    first: usize,
    d: &'a [f64],
    results: &'a mut [Pack],
    scratch: &'a mut Scratch,
}

impl<const D: usize> WithSimd for ApplyToCells<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let ApplyToCells { operator, first, d, results, scratch } = self;
        for (offset, result) in results.chunks_exact_mut(operator.batches.cell_length()).enumerate() {
            operator.batches.gather(first + offset, d, &mut scratch.nodal);
            operator.apply_to_batch(simd, first + offset, scratch, result);
        }
    }
}

/// The matrices of the cells of one batch, column by column.
struct CellMatrices<'a, const D: usize> {
    operator: &'a Operator<D>,
    batch: usize,
    /// `[column][row]`, both of them `[component][node]`.
    columns: &'a mut [Pack],
}

impl<const D: usize> WithSimd for CellMatrices<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut scratch = self.operator.scratch();
        for (number, column) in self.columns.chunks_exact_mut(self.operator.batches.cell_length()).enumerate() {
            scratch.nodal.fill(Pack::ZERO);
            scratch.nodal[number] = Pack([1.0; WIDTH]);
            self.operator.apply_to_batch(simd, self.batch, &mut scratch, column);
        }
    }
}

impl<const D: usize> Operator<D> {
    /// `result` = K of the cells of one batch times `scratch.nodal`.
    #[inline(always)]
    fn apply_to_batch<S: Simd>(&self, simd: S, batch: usize, scratch: &mut Scratch, result: &mut [Pack]) {
        let Scratch { nodal, values, gradients, between } = scratch;
        let Lines { interpolate, differentiate, interpolate_transposed, differentiate_transposed } = &self.lines;
        let (extents, block) = ([interpolate.rows(); D], values.len());
        apply_all_axes(simd, &[interpolate; D], D, nodal, values, between);
        for a in 0..D {
            apply_axis(simd, differentiate, a, &extents, D, values, &mut gradients[a * block..][..block]);
        }
        apply_law::<S, D>(simd, self.lame, self.batch_metric(batch), gradients);
        apply_axis(simd, differentiate_transposed, 0, &extents, D, &gradients[..block], values);
        for a in 1..D {
            apply_axis_add(simd, differentiate_transposed, a, &extents, D, &gradients[a * block..][..block], values);
        }
        apply_all_axes(simd, &[interpolate_transposed; D], D, values, result, between);
    }
}

/// Replaces H by W sigma(H G) G^T at every point: what the reference gradients of the test functions are multiplied by.
#[inline(always)]
fn apply_law<S: Simd, const D: usize>(simd: S, lame: Lame, metric: &[Pack], gradients: &mut [Pack]) {
    let points = gradients.len() / (D * D);
    for point in 0..points {
        for part in 0..Lanes::<S>::PARTS {
            let (weight, g) = read_metric::<S, D>(simd, metric, point, part);
            let mut physical = [[weight.zero(); D]; D];
            for a in 0..D {
                for i in 0..D {
                    let h = Lanes::read(simd, &gradients[(a * D + i) * points + point], part) * weight;
                    for j in 0..D {
                        physical[i][j] = h.mul_add(g[a][j], physical[i][j]);
                    }
                }
            }
            let sigma = lame.stress(&physical);
            for a in 0..D {
                for i in 0..D {
                    tensor::dot(&sigma[i], &g[a]).write(&mut gradients[(a * D + i) * points + point], part);
                }
            }
        }
    }
}
