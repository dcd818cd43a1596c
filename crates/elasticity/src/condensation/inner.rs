//! Elimination of the nodes inside cells in SIMD lanes: one cell per lane.
//!
//! Order the unknowns of a cell: inner ones (i) first, then those of the skeleton (s). Then the first columns of its Cholesky factor
//! and the Schur complement,
//!
//! ```text
//! K_ii = L_ii L_ii^T,      L_si = K_si L_ii^{-T},      S = K_ss - L_si L_si^T                                    (inner)
//! ```
//!
//! follow from one rule, row j and column k <= j: L_jk = (K_jk - sum_{r<k} L_jr L_kr) / L_kk, where r is an inner
//! unknown.

use crate::ElasticityError;
use faer::Mat;
use fem::NodalBatches;
use fem::parallel::{self, Grain};
use std::ops::Range;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real, WIDTH};

/// The matrices of the cells of a batch, `[column][row]`, both `[component][node]`, by the number of the batch.
pub(crate) type BatchMatrices<'a> = dyn Fn(usize) -> Vec<Pack> + Sync + 'a;

/// The number of columns that are factored together, and the size of the blocks in which products are subtracted.
const BLOCK: usize = 4;

/// L_ii and L_si of all cells: `[batch]`, then row by row; row j has its first min(j + 1, inner) entries.
pub(crate) struct InnerFactor(pub(super) Vec<Vec<Pack>>);

/// The order of the unknowns of a cell: numbers `[component][node]`, inner ones first, by nodes.
pub(crate) struct CellUnknowns {
    pub(super) numbers: Vec<usize>,
    inner: usize,
}

impl CellUnknowns {
    /// For cells of the given order; nodes on the surface of a cell belong to the skeleton.
    pub(crate) fn new(dimension: usize, order: usize) -> Self {
        let nodes = order.pow(dimension as u32);
        let digit = |node: usize, axis: u32| node / order.pow(axis) % order;
        let is_inner = |&node: &usize| (0..dimension as u32).all(|a| (1..order - 1).contains(&digit(node, a)));
        let (inner, skeleton): (Vec<_>, Vec<_>) = (0..nodes).partition(is_inner);
        let numbers = inner.iter().chain(&skeleton).flat_map(|node| (0..dimension).map(move |i| i * nodes + node));
        CellUnknowns { numbers: numbers.collect(), inner: inner.len() * dimension }
    }
    /// The unknowns of a cell.
    pub(crate) fn count(&self) -> usize {
        self.numbers.len()
    }
    /// The number of inner unknowns.
    pub(crate) fn inner(&self) -> usize {
        self.inner
    }
    /// The number of unknowns on the skeleton.
    pub(crate) fn skeleton(&self) -> usize {
        self.count() - self.inner
    }
    /// The nodes of a cell on the skeleton, in the order of the rows of S.
    pub(crate) fn skeleton_nodes(&self, dimension: usize) -> impl Iterator<Item = usize> {
        self.numbers[self.inner..].iter().step_by(dimension).copied()
    }
    /// Packs of the rows of one batch.
    pub(crate) fn factor_length(&self) -> usize {
        self.inner * (self.inner + 1) / 2 + self.inner * self.skeleton()
    }
}

impl InnerFactor {
    /// Eliminates the inner nodes of all cells. Returns the factor and, for each cell, S with rows `[node][component]` of its skeleton.
    ///
    /// A constrained entry keeps its place, with the row and the column of the identity in every cell.
    pub(crate) fn new<const D: usize>(
        unknowns: &CellUnknowns,
        batches: &NodalBatches<D>,
        constrained: &[[bool; D]],
        matrices: &BatchMatrices<'_>,
    ) -> Result<(Self, Vec<Mat<f64>>), ElasticityError> {
        let nodes = unknowns.count() / D;
        let eliminate = |batch: usize| {
            let mut matrix = unknowns.sorted(&matrices(batch));
            let held = |unknown: usize, lane| {
                constrained[batches.cell_node(batches.cell(batch, lane), unknown % nodes)][unknown / nodes]
            };
            unknowns.hold(&mut matrix, held);
            Arch::new().dispatch(Eliminate { matrix: &mut matrix, count: unknowns.count(), inner: unknowns.inner });
            let lanes = batches.cells().saturating_sub(batch * WIDTH).min(WIDTH);
            let schur: Vec<_> = (0..lanes).map(|lane| unknowns.schur(&matrix, lane)).collect();
            unknowns.factor_rows(&matrix).map(|rows| (rows, schur))
        };
        let eliminated = parallel::map(batches.count(), Grain::Any, &eliminate);
        let (rows, schur) = eliminated.into_iter().collect::<Result<(Vec<_>, Vec<_>), _>>()?;
        Ok((InnerFactor(rows), schur.into_iter().flatten().collect()))
    }

    /// Memory of the factor.
    pub(crate) fn bytes(&self) -> usize {
        self.0.iter().map(|rows| size_of_val(&rows[..])).sum()
    }
}

impl CellUnknowns {
    /// The rows and columns of a symmetric matrix in this order.
    fn sorted(&self, matrix: &[Pack]) -> Vec<Pack> {
        let mut sorted = Vec::with_capacity(matrix.len());
        for row in &self.numbers {
            let row = &matrix[row * self.count()..][..self.count()];
            sorted.extend(self.numbers.iter().map(|&column| row[column]));
        }
        sorted
    }

    /// Replaces the rows and columns of the unknowns `[component][node]` that are `held` in a lane by those of the identity.
    fn hold(&self, matrix: &mut [Pack], held: impl Fn(usize, usize) -> bool) {
        for (k, &unknown) in self.numbers.iter().enumerate() {
            for lane in (0..WIDTH).filter(|&lane| held(unknown, lane)) {
                for j in 0..self.count() {
                    matrix[j * self.count() + k].0[lane] = 0.0;
                    matrix[k * self.count() + j].0[lane] = 0.0;
                }
                matrix[k * self.count() + k].0[lane] = 1.0;
            }
        }
    }

    /// The rows of L_ii and L_si of a matrix after [`Eliminate`].
    fn factor_rows(&self, matrix: &[Pack]) -> Result<Vec<Pack>, ElasticityError> {
        let mut rows = Vec::with_capacity(self.factor_length());
        for (j, row) in matrix.chunks_exact(self.count()).enumerate() {
            rows.extend_from_slice(&row[..(j + 1).min(self.inner)]);
        }
        let diagonal = (0..self.inner).flat_map(|k| matrix[k * (self.count() + 1)].0);
        match diagonal.clone().find(|pivot| !(*pivot > 0.0 && pivot.is_finite())) {
            None => Ok(rows),
            Some(pivot) => Err(ElasticityError::NotDefinite { cause: format!("a pivot inside a cell is {pivot}") }),
        }
    }

    /// Both triangles of S of the cell in `lane` of a matrix after [`Eliminate`].
    fn schur(&self, matrix: &[Pack], lane: usize) -> Mat<f64> {
        let (inner, size) = (self.inner, self.skeleton());
        let entry = |j: usize, k: usize| matrix[(inner + j.max(k)) * self.count() + inner + j.min(k)].0[lane];
        Mat::from_fn(size, size, entry)
    }
}

/// Replaces a matrix, `[row][column]`, by the first `inner` columns of its Cholesky factor and by S. The upper triangle is lost.
/// A pivot that is not positive leaves a diagonal entry that is not a number.
struct Eliminate<'a> {
    matrix: &'a mut [Pack],
    count: usize,
    inner: usize,
}

impl WithSimd for Eliminate<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Eliminate { matrix, count, inner } = self;
        for part in 0..Lanes::<S>::PARTS {
            let mut lanes = MatrixLanes { simd, part, matrix: &mut *matrix, count };
            for k in (0..inner).step_by(BLOCK) {
                let end = inner.min(k + BLOCK);
                lanes.subtract_products(k..count, k..end, k);
                lanes.factor_columns(k, end);
            }
            lanes.subtract_products(inner..count, inner..count, inner);
        }
    }
}

/// Some lanes of a matrix of packs, `[row][column]`.
struct MatrixLanes<'a, S: Simd> {
    simd: S,
    part: usize,
    matrix: &'a mut [Pack],
    count: usize,
}

impl<S: Simd> MatrixLanes<'_, S> {
    /// K_jk -= sum_{r < length} L_jr L_kr in the lower triangle of the given rows and columns.
    #[inline(always)]
    fn subtract_products(&mut self, rows: Range<usize>, columns: Range<usize>, length: usize) {
        for j in rows.clone().step_by(BLOCK) {
            for k in columns.clone().step_by(BLOCK) {
                if k >= j + BLOCK {
                    break;
                }
                if j + BLOCK <= rows.end && k + BLOCK <= columns.end {
                    self.subtract_block::<BLOCK>(j, k, length);
                } else {
                    for j in j..rows.end.min(j + BLOCK) {
                        for k in k..columns.end.min(k + BLOCK) {
                            self.subtract_block::<1>(j, k, length);
                        }
                    }
                }
            }
        }
    }

    /// K_jk -= sum_{r < length} L_jr L_kr for B rows from `row` and B columns from `column`.
    #[inline(always)]
    fn subtract_block<const B: usize>(&mut self, row: usize, column: usize, length: usize) {
        let mut sums = [[Lanes::splat(self.simd, 0.0); B]; B];
        let (mut left, mut right) = ([&self.matrix[..0]; B], [&self.matrix[..0]; B]);
        for b in 0..B {
            left[b] = &self.matrix[(row + b) * self.count..][..length];
            right[b] = &self.matrix[(column + b) * self.count..][..length];
        }
        for r in 0..length {
            for j in 0..B {
                let l_jr = Lanes::read(self.simd, &left[j][r], self.part);
                for k in 0..B {
                    sums[j][k] = l_jr.mul_add(Lanes::read(self.simd, &right[k][r], self.part), sums[j][k]);
                }
            }
        }
        for j in 0..B {
            for k in 0..B {
                let entry = self.read(row + j, column + k) - sums[j][k];
                self.write(entry, row + j, column + k);
            }
        }
    }

    /// L_jk = (K_jk - sum L_jr L_kr) / L_kk for the columns k from `start` to `end`; r runs from `start` to k.
    #[inline(always)]
    fn factor_columns(&mut self, start: usize, end: usize) {
        for k in start..end {
            for j in k..self.count {
                let mut entry = self.read(j, k);
                for r in start..k {
                    entry -= self.read(j, r) * self.read(k, r);
                }
                let entry = if j == k { entry.sqrt() } else { entry / self.read(k, k) };
                self.write(entry, j, k);
            }
        }
    }

    #[inline(always)]
    fn read(&self, row: usize, column: usize) -> Lanes<S> {
        Lanes::read(self.simd, &self.matrix[row * self.count + column], self.part)
    }
    #[inline(always)]
    fn write(&mut self, entry: Lanes<S>, row: usize, column: usize) {
        entry.write(&mut self.matrix[row * self.count + column], self.part);
    }
}
