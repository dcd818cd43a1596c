//! The triangular solves inside cells, in SIMD lanes.

use super::inner::{CellUnknowns, InnerFactor};
use fem::NodalBatches;
use fem::parallel::{self, Grain};
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real, zeroed};

/// The factor inside of all cells, and where their unknowns lie.
pub(crate) struct CellSweeps<'a, const D: usize> {
    pub(crate) factor: &'a InnerFactor,
    pub(crate) unknowns: &'a CellUnknowns,
    pub(crate) batches: &'a NodalBatches<D>,
}

impl<const D: usize> CellSweeps<'_, D> {
    /// For every right-hand side: out = L_ii^{-1} b_i at inner nodes, and -L_si L_ii^{-1} b_i at nodes of the skeleton.
    pub(crate) fn forward(&self, b: &[f64], out: &mut [f64], work: &mut SweepWork) {
        self.sweep(true, b, out, work);
    }

    /// For every right-hand side: out = L_ii^{-T} (z_i - L_si^T d_s) at inner nodes, and 0 at nodes of the skeleton; the vector `z`
    /// holds z and d.
    pub(crate) fn backward(&self, z: &[f64], out: &mut [f64], work: &mut SweepWork) {
        self.sweep(false, z, out, work);
    }

    /// All right-hand sides while the factor of a batch is in the cache.
    fn sweep(&self, forward: bool, from: &[f64], out: &mut [f64], work: &mut SweepWork) {
        let CellSweeps { factor, unknowns, batches } = *self;
        let (length, nodal) = (batches.cell_length(), batches.nodal_length());
        let count = from.len() / nodal;
        let SweepWork { field, sorted } = work;
        sorted.resize(count * field.len(), Pack::ZERO);
        let (cells, of_cells) = ((&mut field[..], length), (&mut sorted[..], count * length));
        parallel::for_each_pair(cells, of_cells, Grain::Any, &|batch, cell, sorted| {
            let rows = &factor.0[batch];
            for (from, x) in from.chunks_exact(nodal).zip(sorted.chunks_exact_mut(length)) {
                batches.gather(batch, from, cell);
                x.iter_mut().zip(&unknowns.numbers).for_each(|(x, &number)| *x = cell[number]);
                Arch::new().dispatch(Sweep { rows, inner: unknowns.inner(), forward, x });
            }
        });
        for (side, out) in out.chunks_exact_mut(nodal).enumerate() {
            parallel::for_each_chunk(field, length, Grain::Any, &|batch, cell| {
                let x = &sorted[(batch * count + side) * length..][..length];
                x.iter().zip(&unknowns.numbers).for_each(|(x, &number)| cell[number] = *x);
            });
            batches.assemble(field, out);
        }
    }
}

/// Work space of the sweeps.
#[derive(Default)]
pub(crate) struct SweepWork {
    /// A cell field.
    field: Vec<Pack>,
    /// `[batch][right-hand side][unknown]`, in the order of [`CellUnknowns`].
    sorted: Vec<Pack>,
}

impl SweepWork {
    pub(crate) fn new<const D: usize>(batches: &NodalBatches<D>) -> Self {
        SweepWork { field: zeroed(batches.field_length()), sorted: Vec::new() }
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

    /// sum_r L_jr x_r, in two independent halves.
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
