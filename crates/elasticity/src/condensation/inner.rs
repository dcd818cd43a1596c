//! The nodes inside cells, eliminated in SIMD lanes: one cell per lane.
//!
//! With the unknowns of a cell ordered as inner ones (i), then those of the skeleton (s), the first columns of its Cholesky factor and
//! what they leave,
//!
//! ```text
//! K_ii = L_ii L_ii^T,      L_si = K_si L_ii^{-T},      S = K_ss - L_si L_si^T                                    (inner)
//! ```
//!
//! come from one rule, row j and column k <= j: L_jk = (K_jk - sum_{r<k} L_jr L_kr) / L_kk, where r is an inner unknown.

use crate::ElasticityError;
use crate::batches::Batches;
use faer::Mat;
use rayon::prelude::*;
use std::ops::Range;
use tensor::pulp::{Arch, Simd, WithSimd};
use tensor::{Lanes, Pack, Real, WIDTH, zeroed};

/// Columns that are factored together, and rows and columns of the blocks in which products are subtracted.
const BLOCK: usize = 4;

/// L_ii and L_si of all cells: `[batch]`, then row by row, of row j its first min(j + 1, inner) entries.
pub(crate) struct InnerFactor(Vec<Vec<Pack>>);

/// The order of the unknowns of a cell: numbers `[component][node]`, inner ones first, by nodes.
pub(crate) struct CellUnknowns {
    numbers: Vec<usize>,
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
    fn count(&self) -> usize {
        self.numbers.len()
    }
    /// The nodes of a cell on the skeleton, in the order of the rows of S.
    pub(crate) fn skeleton_nodes(&self, dimension: usize) -> impl Iterator<Item = usize> {
        self.numbers[self.inner..].iter().step_by(dimension).copied()
    }
    /// Packs of the rows of one batch.
    pub(crate) fn factor_length(&self) -> usize {
        self.inner * (self.inner + 1) / 2 + self.inner * (self.count() - self.inner)
    }
}

impl InnerFactor {
    /// Eliminates the inner nodes of all cells; returns the factor and, for each cell, S with rows `[node][component]` of its skeleton.
    ///
    /// `matrices(batch)` are the matrices of the cells of a batch, `[column][row]`, both of them `[component][node]`. A constrained
    /// node inside a cell keeps its place, with the row and the column of the identity.
    pub(crate) fn new<const D: usize>(
        unknowns: &CellUnknowns,
        batches: &Batches<D>,
        constrained: &[bool],
        matrices: impl Fn(usize) -> Vec<Pack> + Sync,
    ) -> Result<(Self, Vec<Mat<f64>>), ElasticityError> {
        let nodes = unknowns.count() / D;
        let eliminate = |batch: usize| {
            let mut matrix = unknowns.sorted(&matrices(batch));
            let held = |node, lane| constrained[batches.cell_node(batches.cell(batch, lane), node)];
            unknowns.hold(&mut matrix, nodes, held);
            Arch::new().dispatch(Eliminate { matrix: &mut matrix, count: unknowns.count(), inner: unknowns.inner });
            let lanes = batches.cells().saturating_sub(batch * WIDTH).min(WIDTH);
            let schur: Vec<_> = (0..lanes).map(|lane| unknowns.schur(&matrix, lane)).collect();
            unknowns.factor_rows(&matrix).map(|rows| (rows, schur))
        };
        let eliminated: Vec<_> = (0..batches.count()).into_par_iter().map(eliminate).collect();
        let (rows, schur) = eliminated.into_iter().collect::<Result<(Vec<_>, Vec<_>), _>>()?;
        Ok((InnerFactor(rows), schur.into_iter().flatten().collect()))
    }

    /// For every right-hand side: out = L_ii^{-1} b_i at inner nodes, and -L_si L_ii^{-1} b_i at those of the skeleton.
    pub(crate) fn forward<const D: usize>(
        &self,
        unknowns: &CellUnknowns,
        batches: &Batches<D>,
        b: &[f64],
        out: &mut [f64],
        work: &mut SweepWork,
    ) {
        self.sweep(unknowns, batches, true, b, out, work);
    }

    /// For every right-hand side: out = L_ii^{-T} (z_i - L_si^T d_s) at inner nodes, and 0 at those of the skeleton, for z and d in
    /// the vector `z`.
    pub(crate) fn backward<const D: usize>(
        &self,
        unknowns: &CellUnknowns,
        batches: &Batches<D>,
        z: &[f64],
        out: &mut [f64],
        work: &mut SweepWork,
    ) {
        self.sweep(unknowns, batches, false, z, out, work);
    }

    /// All right-hand sides while the factor of a batch is in the cache.
    fn sweep<const D: usize>(
        &self,
        unknowns: &CellUnknowns,
        batches: &Batches<D>,
        forward: bool,
        from: &[f64],
        out: &mut [f64],
        work: &mut SweepWork,
    ) {
        let (length, nodal) = (batches.cell_length(), batches.nodal_length());
        let count = from.len() / nodal;
        let SweepWork { field, sorted } = work;
        sorted.resize(count * field.len(), Pack::ZERO);
        let cells = field.par_chunks_mut(length).zip(sorted.par_chunks_mut(count * length)).zip(&self.0);
        cells.enumerate().for_each(|(batch, ((cell, sorted), rows))| {
            for (from, x) in from.chunks_exact(nodal).zip(sorted.chunks_exact_mut(length)) {
                batches.gather(batch, from, cell);
                x.iter_mut().zip(&unknowns.numbers).for_each(|(x, &number)| *x = cell[number]);
                Arch::new().dispatch(Sweep { rows, inner: unknowns.inner, forward, x });
            }
        });
        for (side, out) in out.chunks_exact_mut(nodal).enumerate() {
            let cells = field.par_chunks_mut(length).zip(sorted.par_chunks(count * length));
            cells.for_each(|(cell, sorted)| {
                let x = &sorted[side * length..][..length];
                x.iter().zip(&unknowns.numbers).for_each(|(x, &number)| cell[number] = *x);
            });
            batches.assemble(field, out);
        }
    }
}

/// Work space of the sweeps.
pub(crate) struct SweepWork {
    /// A cell field.
    field: Vec<Pack>,
    /// `[batch][right-hand side][unknown]`, in the order of [`CellUnknowns`].
    sorted: Vec<Pack>,
}

impl SweepWork {
    pub(crate) fn new<const D: usize>(batches: &Batches<D>) -> Self {
        SweepWork { field: zeroed(batches.field_length()), sorted: Vec::new() }
    }
}

impl CellUnknowns {
    /// The matrix with rows and columns in this order, from one that is symmetric.
    fn sorted(&self, matrix: &[Pack]) -> Vec<Pack> {
        let rows = self.numbers.iter().map(|row| &matrix[row * self.count()..][..self.count()]);
        rows.flat_map(|row| self.numbers.iter().map(move |&column| row[column])).collect()
    }

    /// Gives the inner nodes that are `held` in a lane the rows and columns of the identity.
    fn hold(&self, matrix: &mut [Pack], nodes: usize, held: impl Fn(usize, usize) -> bool) {
        for k in 0..self.inner {
            for lane in (0..WIDTH).filter(|&lane| held(self.numbers[k] % nodes, lane)) {
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
        let (inner, size) = (self.inner, self.count() - self.inner);
        let entry = |j: usize, k: usize| matrix[(inner + j.max(k)) * self.count() + inner + j.min(k)].0[lane];
        Mat::from_fn(size, size, entry)
    }
}

/// The first `inner` columns of the Cholesky factor in place of a matrix, `[row][column]`, and S in place of the rest. The upper
/// triangle is lost. A pivot that is not positive leaves a diagonal entry that is not a number.
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

    /// L_jk = (K_jk - sum L_jr L_kr) / L_kk for the columns k from `start` to `end`; r runs through those between `start` and k.
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

/// One of the two triangular solves in the cells of a batch, in place of `x`.
struct Sweep<'a> {
    /// As in [`InnerFactor`].
    rows: &'a [Pack],
    inner: usize,
    forward: bool,
    x: &'a mut [Pack],
}

impl WithSimd for Sweep<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for part in 0..Lanes::<S>::PARTS {
            let mut lanes = SweepLanes { simd, part, rows: self.rows, inner: self.inner, x: &mut *self.x };
            if self.forward { lanes.forward() } else { lanes.backward() }
        }
    }
}

/// Some lanes of a [`Sweep`].
struct SweepLanes<'a, S: Simd> {
    simd: S,
    part: usize,
    rows: &'a [Pack],
    inner: usize,
    x: &'a mut [Pack],
}

impl<'a, S: Simd> SweepLanes<'a, S> {
    /// x_j = (x_j - sum_{r<j} L_jr x_r) / L_jj for inner unknowns, x_j = -sum_r L_jr x_r for the others.
    #[inline(always)]
    fn forward(&mut self) {
        for j in 0..self.x.len() {
            let row = self.row(j);
            let start = if j < self.inner { self.read(j) } else { Lanes::splat(self.simd, 0.0) };
            let rest = start - self.sum(&row[..j.min(self.inner)]);
            let x_j = if j < self.inner { rest / Lanes::read(self.simd, &row[j], self.part) } else { rest };
            x_j.write(&mut self.x[j], self.part);
        }
    }

    /// x_r = (x_r - sum_{j>r} L_jr x_j) / L_rr for inner unknowns, subtracted row by row; x_j = 0 for the others.
    #[inline(always)]
    fn backward(&mut self) {
        for j in (0..self.x.len()).rev() {
            let row = self.row(j);
            let mut x_j = self.read(j);
            if j < self.inner {
                x_j = x_j / Lanes::read(self.simd, &row[j], self.part);
            }
            for (r, l_jr) in row[..j.min(self.inner)].iter().enumerate() {
                let rest = self.read(r) - Lanes::read(self.simd, l_jr, self.part) * x_j;
                rest.write(&mut self.x[r], self.part);
            }
            let x_j = if j < self.inner { x_j } else { Lanes::splat(self.simd, 0.0) };
            x_j.write(&mut self.x[j], self.part);
        }
    }

    /// sum_r L_jr x_r, in two halves that do not wait for each other.
    #[inline(always)]
    fn sum(&self, row: &[Pack]) -> Lanes<S> {
        let mut sums = [Lanes::splat(self.simd, 0.0); 2];
        for (r, l_jr) in row.iter().enumerate() {
            sums[r % 2] = Lanes::read(self.simd, l_jr, self.part).mul_add(self.read(r), sums[r % 2]);
        }
        sums[0] + sums[1]
    }

    /// Row j of L.
    #[inline(always)]
    fn row(&self, j: usize) -> &'a [Pack] {
        let full = j.min(self.inner);
        let start = full * (full + 1) / 2 + (j - full) * self.inner;
        &self.rows[start..][..(j + 1).min(self.inner)]
    }
    #[inline(always)]
    fn read(&self, j: usize) -> Lanes<S> {
        Lanes::read(self.simd, &self.x[j], self.part)
    }
}
