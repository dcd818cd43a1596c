//! Algebraic multigrid on the low-order matrix: smoothed aggregation with the rigid motions as near-kernel.
//!
//! On every level a V-cycle does one forward sweep of block Gauss-Seidel, the correction from the next level with A_c = P^T A P, and
//! one backward sweep. It is symmetric, so it preconditions CG. Couplings above a threshold are strong, so that aggregates follow the
//! short sides of stretched cells. Without the threshold boundary layers take hundreds of iterations.

mod aggregation;
mod blocks;

use crate::ElasticityError;
use crate::pool::Pool;
use aggregation::{aggregates, filtered, smoothed, strong_neighbours, tentative};
use blocks::{Block, BlockRows, add_block_vector, inverse};
use newton_krylov::inner_product;
use sparse::{BlockMatrix, Factorisation, Kind};
use std::array::from_fn;
use std::borrow::Cow;
use std::sync::Arc;

/// The threshold of strong couplings on the finest level; it is halved on each coarser level.
const THETA: f64 = 0.08;

/// The rigid motions in three dimensions. There (filtered) smooths the functions: in the boundary layer of a blade the iterations stay the
/// same, and the levels take a tenth of the time. In two dimensions A itself keeps levels sparse, and takes fewer iterations up to order 8.
const IN_SPACE: usize = 6;

/// A level with fewer unknowns than this is factored.
const COARSEST: usize = 1500;

/// A preconditioner on vectors of free nodes, `[node][component]`.
pub(crate) trait Cycle: Send + Sync {
    /// x = P^{-1} x.
    fn apply(&self, x: &mut [f64]);
    /// Memory of all matrices.
    fn bytes(&self) -> usize;
}

/// The hierarchy for a matrix in D dimensions with nodes at `coordinates`, whose `fixed` components are coupled with nothing: coarse
/// functions leave them alone.
pub(crate) fn hierarchy<const D: usize>(
    matrix: &BlockMatrix<f64>,
    coordinates: &[[f64; D]],
    fixed: &[[bool; D]],
) -> Result<Box<dyn Cycle>, ElasticityError> {
    let along = |axis: usize| coordinates.iter().map(|x| x[axis]).collect::<Vec<f64>>();
    let centre: [f64; D] = from_fn(|axis| inner_product::sum(&along(axis)) / coordinates.len() as f64);
    let from_centre = |x: &[f64; D]| from_fn(|i| x[i] - centre[i]);
    if D == 2 {
        let modes =
            coordinates.iter().zip(fixed).map(|(x, fixed)| rigid_motions::<D, 3>(&from_centre(x), fixed)).collect();
        Ok(Box::new(Hierarchy::new(block_rows(matrix), modes)?))
    } else {
        let modes =
            coordinates.iter().zip(fixed).map(|(x, fixed)| rigid_motions::<D, 6>(&from_centre(x), fixed)).collect();
        Ok(Box::new(Hierarchy::new(block_rows(matrix), modes)?))
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

/// Both triangles of a matrix.
fn block_rows<const D: usize>(matrix: &BlockMatrix<f64>) -> BlockRows<D, D> {
    let mut lower = BlockRows::new();
    for node in 0..matrix.nodes() {
        lower
            .push_row(matrix.column(node).map(|(row, block)| (row as u32, from_fn(|i| from_fn(|j| block[j * D + i])))));
    }
    // The blocks of a column on and below the diagonal, transposed, are the blocks of a row on and right of it.
    let upper = lower.transpose(matrix.nodes());
    let mut rows = BlockRows::new();
    for node in 0..matrix.nodes() {
        let left = upper
            .row(node)
            .filter(|(column, _)| *column < node)
            .map(|(c, block)| (c as u32, blocks::transposed(block)));
        let right = lower.row(node).map(|(c, block)| (c as u32, blocks::transposed(block)));
        rows.push_row(left.chain(right));
    }
    rows
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
    matrix: BlockRows<R, R>,
    /// The inverses of the blocks on the diagonal.
    inverses: Vec<Block<R, R>>,
    prolongation: BlockRows<R, B>,
}

/// The residual and the correction of every level.
struct Work<const R: usize, const B: usize> {
    finest: [Vec<[f64; R]>; 2],
    /// The other levels, including the coarsest.
    others: Vec<[Vec<[f64; B]>; 2]>,
    /// Work space of the factors of the coarsest level.
    solve: Vec<f64>,
}

impl<const R: usize, const B: usize> Hierarchy<R, B> {
    fn new(matrix: BlockRows<R, R>, modes: Vec<Block<R, B>>) -> Result<Self, ElasticityError> {
        let (finest, mut matrix, mut modes) = Level::new(matrix, &modes, THETA);
        let (mut others, mut theta) = (Vec::new(), 0.5 * THETA);
        while matrix.rows() * B > COARSEST {
            let rows = matrix.rows();
            let (level, next, next_modes) = Level::new(matrix, &modes, theta);
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
        let vectors = |rows: usize| [vec![[0.0; B]; rows], vec![[0.0; B]; rows]];
        let rows = self.others.iter().map(|level| level.matrix.rows()).chain([self.coarsest.tree().positions.len()]);
        let finest = self.finest.matrix.rows();
        Work {
            finest: [vec![[0.0; R]; finest], vec![[0.0; R]; finest]],
            others: rows.map(vectors).collect(),
            solve: Vec::new(),
        }
    }

    /// One V-cycle for the residual of the first of `levels`; the last entry of `work` belongs to the coarsest one.
    fn cycle(&self, levels: &[Level<B, B>], work: &mut [[Vec<[f64; B]>; 2]], solve: &mut Vec<f64>) {
        let Some(([residual, correction], below)) = work.split_first_mut() else { return };
        match levels.split_first() {
            None => {
                correction.copy_from_slice(residual);
                self.coarsest.solve(correction.as_flattened_mut(), 1, solve);
            }
            Some((level, levels)) => {
                level.smooth_forward(residual, correction);
                level.restrict(correction, &mut below[0][0]);
                self.cycle(levels, below, solve);
                level.prolongation.add_product(1.0, &below[0][1], correction);
                level.smooth_backward(residual, correction);
            }
        }
    }
}

impl<const R: usize, const B: usize> Cycle for Hierarchy<R, B> {
    fn apply(&self, x: &mut [f64]) {
        let mut work = self.work.take(|| self.work());
        let Work { finest: [residual, correction], others, solve } = &mut work;
        residual.as_flattened_mut().copy_from_slice(x);
        self.finest.smooth_forward(residual, correction);
        self.finest.restrict(correction, &mut others[0][0]);
        self.cycle(&self.others, others, solve);
        self.finest.prolongation.add_product(1.0, &others[0][1], correction);
        self.finest.smooth_backward(residual, correction);
        x.copy_from_slice(correction.as_flattened());
        self.work.give(work);
    }
    fn bytes(&self) -> usize {
        self.finest.bytes() + self.others.iter().map(Level::bytes).sum::<usize>() + self.coarsest.bytes()
    }
}

impl<const R: usize, const B: usize> Level<R, B> {
    /// The level of a matrix, and the matrix and near-kernel of the next level.
    fn new(matrix: BlockRows<R, R>, modes: &[Block<R, B>], theta: f64) -> (Self, BlockRows<B, B>, Vec<Block<B, B>>) {
        let inverses: Vec<_> = (0..matrix.rows()).map(|row| inverse(&diagonal(&matrix, row))).collect();
        let strong = strong_neighbours(&matrix, theta);
        let (aggregate, count) = aggregates(&strong);
        let (functions, coarse_modes) = tentative(&aggregate, count, modes);
        let smoother = if B == IN_SPACE { Cow::Owned(filtered(&matrix, &strong)) } else { Cow::Borrowed(&matrix) };
        let prolongation = smoothed(&smoother, &inverses, &functions, count);
        let coarse = prolongation.transpose(count).product(&matrix.product(&prolongation, count), count);
        (Level { matrix, inverses, prolongation }, regular(coarse), coarse_modes)
    }

    /// x = (D + L)^{-1} r: a sweep of Gauss-Seidel from x = 0.
    fn smooth_forward(&self, r: &[[f64; R]], x: &mut [[f64; R]]) {
        for row in 0..x.len() {
            let mut rest = r[row];
            let before = self.matrix.row(row).take_while(|(column, _)| *column < row);
            before.for_each(|(column, block)| subtract(block, &x[column], &mut rest));
            x[row] = times(&self.inverses[row], &rest);
        }
    }

    /// A sweep of Gauss-Seidel in the opposite direction.
    fn smooth_backward(&self, r: &[[f64; R]], x: &mut [[f64; R]]) {
        for row in (0..x.len()).rev() {
            let mut rest = r[row];
            let others = self.matrix.row(row).filter(|(column, _)| *column != row);
            others.for_each(|(column, block)| subtract(block, &x[column], &mut rest));
            x[row] = times(&self.inverses[row], &rest);
        }
    }

    /// coarse = P^T (r - A x) for the x after [`Self::smooth_forward`]: r - A x = -U x.
    fn restrict(&self, x: &[[f64; R]], coarse: &mut [[f64; B]]) {
        coarse.fill([0.0; B]);
        for row in 0..x.len() {
            let mut rest = [0.0; R];
            let behind = self.matrix.row(row).skip_while(|(column, _)| *column <= row);
            behind.for_each(|(column, block)| subtract(block, &x[column], &mut rest));
            for (aggregate, block) in self.prolongation.row(row) {
                for (block, rest) in block.iter().zip(&rest) {
                    (0..B).for_each(|k| coarse[aggregate][k] += block[k] * rest);
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        self.matrix.bytes() + self.prolongation.bytes() + size_of_val(&self.inverses[..])
    }
}

/// A x
#[inline(always)]
fn times<const R: usize>(block: &Block<R, R>, x: &[f64; R]) -> [f64; R] {
    let mut product = [0.0; R];
    add_block_vector(block, x, &mut product);
    product
}

/// y = y - A x
#[inline(always)]
fn subtract<const R: usize>(block: &Block<R, R>, x: &[f64; R], y: &mut [f64; R]) {
    let product = times(block, x);
    (0..R).for_each(|i| y[i] -= product[i]);
}

fn diagonal<const R: usize>(matrix: &BlockRows<R, R>, row: usize) -> Block<R, R> {
    matrix.row(row).find(|(column, _)| *column == row).map_or([[0.0; R]; R], |(_, block)| *block)
}

/// Sets ones on the diagonal for modes that vanish on an aggregate: their rows and columns are zero.
fn regular<const R: usize>(mut matrix: BlockRows<R, R>) -> BlockRows<R, R> {
    for row in 0..matrix.rows() {
        for place in matrix.starts[row]..matrix.starts[row + 1] {
            if matrix.columns[place] as usize == row {
                let block = &mut matrix.blocks[place];
                (0..R).filter(|&k| block[k][k] == 0.0).collect::<Vec<_>>().into_iter().for_each(|k| block[k][k] = 1.0);
            }
        }
    }
    matrix
}

fn factor<const R: usize>(matrix: &BlockRows<R, R>) -> Result<Factorisation<f64>, ElasticityError> {
    let neighbours = (0..matrix.rows()).map(|row| matrix.row(row).map(|(column, _)| column).collect()).collect();
    let mut symmetric = BlockMatrix::new(Kind::Cholesky, R, neighbours);
    for row in 0..matrix.rows() {
        matrix.row(row).for_each(|(column, block)| symmetric.add(row, column, |i, j| block[i][j]));
    }
    Ok(symmetric.factor(Arc::new(symmetric.elimination_tree()?))?)
}
