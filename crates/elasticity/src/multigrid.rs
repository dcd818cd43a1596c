//! Algebraic multigrid on the low-order matrix: smoothed aggregation with the rigid motions as near-kernel.
//!
//! On every level a V-cycle does one forward sweep of block Gauss-Seidel, the correction from the next level with A_c = P^T A P, and
//! one backward sweep. It is symmetric, so it preconditions CG. Couplings above a threshold are strong, so that aggregates follow the
//! short sides of stretched cells. Without the threshold boundary layers take hundreds of iterations.

mod aggregation;
mod blocks;
mod colouring;
mod matrix;
mod prolongation;

pub(crate) use colouring::{Colouring, Couplings, nodes_per_chunk};
pub(crate) use matrix::BlockRows;

use crate::ElasticityError;
use crate::pool::Pool;
use aggregation::{Filtered, aggregates, smoothed, strong_neighbours, tentative};
use blocks::{Block, inverse};
use matrix::Direction;
use newton_krylov::inner_product;
use prolongation::Prolongation;
use sparse::{BlockMatrix, Factorisation, Kind};
use std::array::from_fn;
use std::sync::Arc;

/// The threshold of strong couplings on the finest level in two dimensions; it is halved on each coarser level.
const THETA: f64 = 0.08;

/// The same in three dimensions. On cells of order 8 CG takes 58 iterations with 0.08, but the second level has more entries than the first one.
/// With 0.045 it takes 63, and the second level half of the entries; with 0.03 it takes 77.
const THETA_IN_SPACE: f64 = 0.045;

/// The rigid motions in three dimensions. There (filtered) smooths the functions: in the boundary layer of a blade the iterations stay the
/// same, and the levels take a tenth of the time. In two dimensions A itself keeps levels sparse, and takes fewer iterations up to order 8.
const IN_SPACE: usize = 6;

/// A level with fewer unknowns than this is factored.
const COARSEST: usize = 1500;

/// A preconditioner on vectors in the order of its finest matrix, `[node][component]`.
pub(crate) trait Cycle: Send + Sync {
    /// x = P^{-1} x.
    fn apply(&self, x: &mut [f64]);
    /// Memory of all matrices.
    fn bytes(&self) -> usize;
}

/// The hierarchy for a matrix in D dimensions with nodes at `coordinates`, whose `fixed` components are coupled with nothing: coarse
/// functions leave them alone.
pub(crate) fn hierarchy<const D: usize>(
    matrix: BlockRows<D>,
    coordinates: &[[f64; D]],
    fixed: &[[bool; D]],
) -> Result<Box<dyn Cycle>, ElasticityError> {
    let along = |axis: usize| coordinates.iter().map(|x| x[axis]).collect::<Vec<f64>>();
    let centre: [f64; D] = from_fn(|axis| inner_product::sum(&along(axis)) / coordinates.len() as f64);
    let nodes = coordinates.iter().map(|x| from_fn(|i| x[i] - centre[i])).zip(fixed);
    if const { D == 2 } {
        let modes = nodes.map(|(x, fixed)| rigid_motions::<D, 3>(&x, fixed)).collect();
        Ok(Box::new(Hierarchy::new(matrix, modes)?))
    } else {
        let modes = nodes.map(|(x, fixed)| rigid_motions::<D, 6>(&x, fixed)).collect();
        Ok(Box::new(Hierarchy::new(matrix, modes)?))
    }
}

/// The rigid motions at x, `[component][motion]`, without the `fixed` components.
fn rigid_motions<const D: usize, const B: usize>(x: &[f64; D], fixed: &[bool; D]) -> Block<D, B> {
    let mut motions = [[0.0; B]; D];
    for (number, motion) in crate::geometry::rigid_motions(x).enumerate() {
        (0..D).for_each(|i| motions[i][number] = motion[i]);
    }
    (0..D).filter(|&i| fixed[i]).for_each(|i| motions[i] = [0.0; B]);
    motions
}

/// All levels; unknowns have R components per node on the finest and B, one per mode, on the others.
struct Hierarchy<const R: usize, const B: usize> {
    finest: Level<R, B>,
    others: Vec<Level<B, B>>,
    coarsest: Factorisation<f64>,
    work: Pool<Work<R, B>>,
}

/// A level that is not the coarsest.
struct Level<const R: usize, const B: usize> {
    matrix: BlockRows<R>,
    /// The inverses of the blocks on the diagonal.
    inverses: Vec<Block<R, R>>,
    prolongation: Prolongation<R, B>,
}

/// The vectors of a level.
struct Vectors<const R: usize> {
    residual: Vec<[f64; R]>,
    correction: Vec<[f64; R]>,
    /// The residual after the forward sweep.
    rest: Vec<[f64; R]>,
}

impl<const R: usize> Vectors<R> {
    fn new(rows: usize) -> Self {
        let vector = || vec![[0.0; R]; rows];
        Vectors { residual: vector(), correction: vector(), rest: vector() }
    }
}

/// The vectors of every level.
struct Work<const R: usize, const B: usize> {
    finest: Vectors<R>,
    /// The other levels, including the coarsest.
    others: Vec<Vectors<B>>,
    /// Work space of the factors of the coarsest level.
    solve: Vec<f64>,
}

impl<const R: usize, const B: usize> Hierarchy<R, B> {
    fn new(matrix: BlockRows<R>, modes: Vec<Block<R, B>>) -> Result<Self, ElasticityError> {
        let mut theta = if B == IN_SPACE { THETA_IN_SPACE } else { THETA };
        let (finest, mut matrix, mut modes) = Level::new(matrix, modes, theta);
        let mut others = Vec::new();
        theta *= 0.5;
        while matrix.rows() * B > COARSEST {
            let rows = matrix.rows();
            let (level, next, next_modes) = Level::new(matrix, modes, theta);
            (matrix, modes) = (next, next_modes);
            others.push(level);
            let stays = matrix.rows() == rows;
            if stays && theta == 0.0 {
                // Parts without connections do not merge.
                break;
            }
            theta = if stays { 0.0 } else { 0.5 * theta };
        }
        let coarsest = factor(&matrix)?;
        let work = Pool::new();
        Ok(Hierarchy { finest, others, coarsest, work })
    }

    fn work(&self) -> Work<R, B> {
        let rows = self.others.iter().map(|level| level.matrix.rows()).chain([self.coarsest.tree().positions.len()]);
        let finest = Vectors::new(self.finest.matrix.rows());
        Work { finest, others: rows.map(Vectors::new).collect(), solve: Vec::new() }
    }

    /// One V-cycle for the residual of the first of `levels`; the last entry of `work` belongs to the coarsest one.
    fn cycle(&self, levels: &[Level<B, B>], work: &mut [Vectors<B>], solve: &mut Vec<f64>) {
        let Some((vectors, below)) = work.split_first_mut() else { return };
        match levels.split_first() {
            None => {
                vectors.correction.copy_from_slice(&vectors.residual);
                self.coarsest.solve(vectors.correction.as_flattened_mut(), 1, solve);
            }
            Some((level, levels)) => {
                level.descend(vectors, &mut below[0].residual);
                self.cycle(levels, below, solve);
                level.ascend(&below[0].correction, vectors);
            }
        }
    }
}

impl<const R: usize, const B: usize> Cycle for Hierarchy<R, B> {
    fn apply(&self, x: &mut [f64]) {
        let mut work = self.work.take(|| self.work());
        let Work { finest, others, solve } = &mut work;
        finest.residual.as_flattened_mut().copy_from_slice(x);
        self.finest.descend(finest, &mut others[0].residual);
        self.cycle(&self.others, others, solve);
        self.finest.ascend(&others[0].correction, finest);
        x.copy_from_slice(finest.correction.as_flattened());
        self.work.give(work);
    }
    fn bytes(&self) -> usize {
        self.finest.bytes() + self.others.iter().map(Level::bytes).sum::<usize>() + self.coarsest.bytes()
    }
}

impl<const R: usize, const B: usize> Level<R, B> {
    /// The level of a matrix, and the matrix and near-kernel of the next level.
    fn new(matrix: BlockRows<R>, modes: Vec<Block<R, B>>, theta: f64) -> (Self, BlockRows<B>, Vec<Block<B, B>>) {
        let inverses: Vec<_> = (0..matrix.rows()).map(|row| inverse(&matrix.diagonal(row))).collect();
        let strong = strong_neighbours(&matrix, theta);
        let (aggregate, count) = aggregates(&strong);
        let (functions, coarse_modes) = tentative(&aggregate, count, modes);
        let filtered = Filtered { matrix: &matrix, strong: (B == IN_SPACE).then_some(&strong) };
        let mut prolongation = smoothed(&filtered, &inverses, &aggregate, &functions);
        drop((functions, strong));
        let (coarse, order) = prolongation.finish(&matrix, count);
        let coarse_modes = order.iter().map(|&node| coarse_modes[node]).collect();
        (Level { matrix, inverses, prolongation }, coarse, coarse_modes)
    }

    /// The forward sweep from zero, and the residual of the next level.
    fn descend(&self, Vectors { residual, correction, rest }: &mut Vectors<R>, coarse: &mut [[f64; B]]) {
        self.matrix.sweep(Direction::Forward, &self.inverses, residual, correction);
        self.matrix.residual_after_forward(correction, rest);
        self.prolongation.restrict(rest, coarse);
    }

    /// The correction of the next level, and the backward sweep.
    fn ascend(&self, coarse: &[[f64; B]], Vectors { residual, correction, .. }: &mut Vectors<R>) {
        self.prolongation.add_to(coarse, correction);
        self.matrix.sweep(Direction::Backward, &self.inverses, residual, correction);
    }

    fn bytes(&self) -> usize {
        self.matrix.bytes() + self.prolongation.bytes() + size_of_val(&self.inverses[..])
    }
}

fn factor<const R: usize>(matrix: &BlockRows<R>) -> Result<Factorisation<f64>, ElasticityError> {
    let neighbours = (0..matrix.rows()).map(|row| matrix.row(row).map(|(column, _)| column).collect()).collect();
    let mut symmetric = BlockMatrix::new(Kind::Cholesky, R, neighbours);
    for row in 0..matrix.rows() {
        matrix.row(row).for_each(|(column, block)| symmetric.add(row, column, |i, j| block[i][j]));
    }
    Ok(symmetric.factor(Arc::new(symmetric.elimination_tree()?))?)
}
