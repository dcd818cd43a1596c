//! The forces of the mesh and their derivative K, matrix-free, in SIMD lanes and threads.
//!
//! ```text
//! psi . R(d) = int grad psi : P(grad d) dx = sum over cells and points of  W  (H' G) : P(H G)                  (forces)
//! psi . K(d) e = d/da  psi . R(d + a e)  at a = 0                                                              (K)
//! ```
//!
//! H and H' are the reference gradients of d and psi, `H[i][a]` = d d_i / d xi_a. G is the inverse Jacobian of the reference mesh,
//! `G[a][j]` = d xi_a / d x_j. W = omega det J E_Y / E_Y0 has the quadrature weight omega. Steps per cell: interpolate to the points,
//! differentiate there, apply the law, then the transposes of both in reverse order, O(N^(D+1)). K is the same source with dual
//! numbers. For a linear law R(d) = K d, and K is constant.

mod diagonal;
mod energy;
mod kernel;
#[cfg(test)]
mod tests;
mod updated;
mod work;

use crate::geometry::{Sample, StiffnessSampler};
use crate::law::{Law, NeoHookean, PointLaw, StVenantKirchhoff, Viscous};
use crate::material::Lame;
use crate::pool::Pool;
use crate::{ElasticityError, Inversion};
use basis::{Lagrange, Matrix};
use fem::NodalBatches;
use fem::parallel;
use kernel::{CellMatrices, Cells, Forces, Mode, Scratch, Tangent};
use rayon::prelude::*;
use std::marker::PhantomData;
use tensor::Arch;
use tensor::{Pack, WIDTH, zeroed};

/// R and K on all nodes; no node is constrained here.
pub(crate) struct Operator<const D: usize> {
    law: Law,
    lame: Lame,
    batches: NodalBatches<D>,
    lines: LineTables,
    /// W and G, `[batch][point][1 + D D]`.
    metric: Vec<Pack>,
    workspaces: Pool<Workspace>,
}

/// The one-dimensional matrices of a cell.
struct LineTables {
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
    /// The smallest J of every cell, one pack per batch.
    smallest: Vec<Pack>,
    /// The scratch of each task.
    scratch: Vec<Scratch>,
    batches_per_task: usize,
}

/// The work of a task: its first batch, results, smallest J and scratch.
type Task<'a> = dyn Fn(usize, &mut [Pack], &mut [Pack], &mut Scratch) + Sync + 'a;

impl Workspace {
    /// Does `work` in every task, in parallel. `cell_length` is that of the results of a batch.
    fn for_each_task(&mut self, cell_length: usize, work: &Task) {
        let in_task = self.batches_per_task;
        let results = self.results.par_chunks_mut(in_task * cell_length);
        let tasks = results.zip(self.smallest.par_chunks_mut(in_task)).zip(&mut self.scratch);
        tasks.enumerate().for_each(|(task, ((results, smallest), scratch))| {
            work(task * in_task, results, smallest, scratch);
        });
    }
}

impl LineTables {
    fn new(order: usize, points: &[f64]) -> Self {
        let interpolate = Lagrange::gauss_lobatto(order).value_matrix(points);
        let differentiate = Lagrange::new(points.to_vec()).derivative_matrix(points);
        let (interpolate_transposed, differentiate_transposed) = (interpolate.transpose(), differentiate.transpose());
        LineTables { interpolate, differentiate, interpolate_transposed, differentiate_transposed }
    }
    fn points<const D: usize>(&self) -> usize {
        self.interpolate.rows().pow(D as u32)
    }
}

impl<const D: usize> Operator<D> {
    /// The operator of order `order` for `law`, with the quadrature points of `sampler`.
    pub(crate) fn new(
        law: Law,
        lame: Lame,
        order: usize,
        batches: NodalBatches<D>,
        sampler: &StiffnessSampler<'_, D>,
    ) -> Result<Self, ElasticityError> {
        Self::weighted(law, lame, order, batches, sampler, |sample| sample.stiffness)
    }

    /// The same with another factor of the constants of Lame in place of the stiffness of the samples.
    pub(crate) fn weighted(
        law: Law,
        lame: Lame,
        order: usize,
        batches: NodalBatches<D>,
        sampler: &StiffnessSampler<'_, D>,
        factor: impl Fn(&Sample<D>) -> f64 + Sync,
    ) -> Result<Self, ElasticityError> {
        let metric = metric(&batches, sampler, factor)?;
        let lines = LineTables::new(order, &sampler.rule().points);
        Ok(Operator { law, lame, batches, lines, metric, workspaces: Pool::new() })
    }

    /// out = R(d), both `[C0 node][component]`. `out` is meaningless after an error.
    pub(crate) fn forces(&self, d: &[f64], out: &mut [f64]) -> Result<(), Inversion> {
        match self.law {
            Law::Linear | Law::Incremental => self.apply::<Forces, _>(self.lame, &[d], out),
            Law::NeoHookean => self.apply::<Forces, _>(NeoHookean(self.lame), &[d], out),
            Law::StVenantKirchhoff => self.apply::<Forces, _>(StVenantKirchhoff(self.lame), &[d], out),
        }
    }

    /// out = K(d) w, for a `d` where R is defined. A linear law does not read `d`.
    pub(crate) fn product(&self, d: &[f64], w: &[f64], out: &mut [f64]) {
        let applied = match self.law {
            Law::Linear | Law::Incremental => self.apply::<Forces, _>(self.lame, &[w], out),
            Law::NeoHookean => self.apply::<Tangent, _>(NeoHookean(self.lame), &[d, w], out),
            Law::StVenantKirchhoff => self.apply::<Tangent, _>(StVenantKirchhoff(self.lame), &[d, w], out),
        };
        debug_assert!(applied.is_ok(), "K is asked for where R is defined");
    }

    /// out = the forces of (viscous) for the displacement `d` and the velocity `v`; for a law that is not linear.
    pub(crate) fn viscous_forces(&self, d: &[f64], v: &[f64], out: &mut [f64]) {
        // This law has no barrier.
        let _ = self.apply::<Forces, _>(Viscous(self.lame), &[d, v], out);
    }

    /// out = the derivative of these forces at the displacement and velocity `at`, along the displacement and velocity `along`.
    pub(crate) fn viscous_product(&self, at: (&[f64], &[f64]), along: (&[f64], &[f64]), out: &mut [f64]) {
        let _ = self.apply::<Tangent, _>(Viscous(self.lame), &[at.0, at.1, along.0, along.1], out);
    }

    /// The integral of Psi(grad d), for a `d` where R is defined.
    pub(crate) fn energy(&self, d: &[f64]) -> f64 {
        match self.law {
            Law::Linear | Law::Incremental => self.energy_by(self.lame, d),
            Law::NeoHookean => self.energy_by(NeoHookean(self.lame), d),
            Law::StVenantKirchhoff => self.energy_by(StVenantKirchhoff(self.lame), d),
        }
    }

    /// The matrices K(d) of the cells of one batch, `[column][row]`, both `[component][node]`.
    pub(crate) fn cell_matrices(&self, d: &[f64], batch: usize) -> Vec<Pack> {
        let mut matrices = zeroed(self.batches.cell_length().pow(2));
        match self.law {
            Law::Linear | Law::Incremental => self.columns::<Forces, _>(self.lame, d, batch, &mut matrices),
            Law::NeoHookean => self.columns::<Tangent, _>(NeoHookean(self.lame), d, batch, &mut matrices),
            Law::StVenantKirchhoff => {
                self.columns::<Tangent, _>(StVenantKirchhoff(self.lame), d, batch, &mut matrices);
            }
        }
        matrices
    }

    fn columns<M: Mode, L: PointLaw>(&self, law: L, point: &[f64], batch: usize, columns: &mut [Pack]) {
        let mode = PhantomData::<M>;
        Arch::new().dispatch(CellMatrices { operator: self, law, mode, batch, point, columns });
    }

    /// The constants of the law.
    pub(crate) fn lame(&self) -> Lame {
        self.lame
    }
    /// The cells, in packs.
    pub(crate) fn batches(&self) -> &NodalBatches<D> {
        &self.batches
    }
    /// W and G of all batches.
    pub(crate) fn metric(&self) -> &[Pack] {
        &self.metric
    }
    /// Replaces W and G by the metric of another mesh.
    pub(crate) fn set_metric(&mut self, metric: Vec<Pack>) {
        self.metric = metric;
    }

    /// Applies `law` to the cells, in parallel tasks, and sums the results.
    fn apply<M: Mode, L: PointLaw>(&self, law: L, fields: &[&[f64]], out: &mut [f64]) -> Result<(), Inversion> {
        let mut workspace = self.workspaces.take(|| self.workspace());
        workspace.for_each_task(self.batches.cell_length(), &|first, results, smallest, scratch| {
            let mode = PhantomData::<M>;
            Arch::new().dispatch(Cells { operator: self, law, mode, first, fields, results, smallest, scratch });
        });
        self.batches.assemble(&workspace.results, out);
        let checked = if L::HAS_BARRIER { self.check_inversion(&workspace.smallest) } else { Ok(()) };
        self.workspaces.give(workspace);
        checked
    }

    /// The cell with the smallest J, if that is not positive.
    fn check_inversion(&self, smallest: &[Pack]) -> Result<(), Inversion> {
        let of_cell = |cell: usize| Inversion { cell, volume_ratio: smallest[cell / WIDTH].0[cell % WIDTH] };
        let inverted =
            (0..self.batches.cells()).map(of_cell).filter(|i| i.volume_ratio.is_nan() || i.volume_ratio <= 0.0);
        inverted.min_by(|a, b| a.volume_ratio.total_cmp(&b.volume_ratio)).map_or(Ok(()), Err)
    }

    /// Work space for the present number of threads; a few tasks per thread, so that no thread waits long for another.
    fn workspace(&self) -> Workspace {
        let tasks = 4 * rayon::current_num_threads();
        let batches_per_task = self.batches.count().div_ceil(tasks).max(1);
        let fields = if self.law.is_linear() { Forces::BLOCKS } else { Tangent::BLOCKS * Viscous::FIELDS };
        let scratch = (0..tasks).map(|_| Scratch::new::<D>(&self.lines, fields)).collect();
        let smallest = zeroed(self.batches.count());
        Workspace { results: zeroed(self.batches.field_length()), smallest, scratch, batches_per_task }
    }

    /// W and G at the points of a batch.
    fn batch_metric(&self, batch: usize) -> &[Pack] {
        &self.metric[batch * self.metric_length()..][..self.metric_length()]
    }

    /// Packs of one batch in the metric, `[point][1 + D D]`.
    fn metric_length(&self) -> usize {
        self.lines.points::<D>() * (1 + D * D)
    }
}

/// W and G of all batches.
fn metric<const D: usize>(
    batches: &NodalBatches<D>,
    sampler: &StiffnessSampler<'_, D>,
    factor: impl Fn(&Sample<D>) -> f64 + Sync,
) -> Result<Vec<Pack>, ElasticityError> {
    let weights = sampler.rule().tensor_weights(D);
    let length = weights.len() * (1 + D * D);
    let mut metric = zeroed(batches.count() * length);
    let fill = |batch: usize, metric: &mut [Pack]| -> Result<(), ElasticityError> {
        for lane in 0..WIDTH {
            let samples = sampler.cell(batches.cell(batch, lane))?;
            for ((weight, sample), entry) in weights.iter().zip(&samples).zip(metric.chunks_exact_mut(1 + D * D)) {
                entry[0].0[lane] = weight * sample.determinant * factor(sample);
                for (pack, g) in entry[1..].iter_mut().zip(sample.inverse_jacobian.as_flattened()) {
                    pack.0[lane] = *g;
                }
            }
        }
        Ok(())
    };
    // All batches first, then the first error: the same one for any number of threads.
    let filled = parallel::map_chunks(&mut metric, length, &fill);
    filled.into_iter().collect::<Result<(), _>>()?;
    Ok(metric)
}
