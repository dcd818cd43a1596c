//! The coarse matrix: rows of own aggregates, joined on all ranks, and its factors for every mode.

use super::{CoarseLevel, CoupledImage, traces_of};
use crate::preconditioner::coarse_modes::{CoarseMode, Entry};
use basis::is_real;
use faer::{Mat, c64};
use fem::parallel::{self, Grain};
use fem::{Share, TraceSpace};
use sparse::{BlockMatrix, Kind, Scalar};

impl<T: Entry> CoarseLevel<T> {
    /// The numbers of the functions of an aggregate: all components, and one.
    fn functions(&self) -> (usize, usize) {
        (self.block, self.prolongations.first().map_or(0, Mat::ncols))
    }

    /// The [`Self::rows_of`] all aggregates, one after the other. A collective call.
    pub(super) fn all_rows(&self, traces: &TraceSpace, share: &Share) -> Vec<T> {
        let aggregates = self.aggregates.own();
        let own = parallel::map(aggregates.len(), Grain::Any, &|k| self.rows_of(traces, aggregates.start + k));
        self.joined(share, own.concat(), |aggregate| self.rows_len(aggregate))
    }

    /// The length of [`Self::rows_of`] an aggregate.
    fn rows_len(&self, aggregate: usize) -> usize {
        let (block, functions) = self.functions();
        self.columns[aggregate].len() * block * block + functions * functions
    }

    /// dt P^T A P in the rows of an own aggregate, block by block in the order of its columns, and then P^T M P of one component.
    fn rows_of(&self, traces: &TraceSpace, aggregate: usize) -> Vec<T> {
        let ((block, functions), columns) = (self.functions(), &self.columns[aggregate]);
        let mut rows = vec![Mat::<T>::zeros(block, block); columns.len()];
        let mut mass = Mat::<T>::zeros(functions, functions);
        let place = |aggregate: usize| columns.partition_point(|&column| column < aggregate);
        for &cell in self.aggregates.own_cells(aggregate) {
            let p = self.over_components(cell);
            rows[place(aggregate)] += p.transpose() * &self.images[cell];
            mass += self.prolongations[cell].transpose() * &self.masses[cell];
            for CoupledImage { link, image } in &self.coupled[cell] {
                rows[place(self.aggregates.of_cell[link.cell])] += traces_of(traces, link.face, &p).transpose() * image;
            }
        }
        let columns_of = |matrix: &Mat<T>| (0..matrix.ncols()).flat_map(|j| matrix.col_as_slice(j).to_vec()).collect();
        rows.iter().chain([&mass]).flat_map(|matrix| -> Vec<T> { columns_of(matrix) }).collect()
    }

    /// The factors of a mode, from the `rows` of all aggregates; None if its matrix is singular or memory runs out.
    pub(super) fn factored(&self, rows: &[T], lambda: c64) -> Option<CoarseMode<T>> {
        let tree = self.tree.clone();
        let (re, im) = (T::of(lambda.re), T::of(lambda.im));
        Some(if is_real(lambda) {
            let matrix = self.assemble(rows, |a, m| a + re * m);
            CoarseMode::Real(matrix.factor(tree).ok()?, Vec::new())
        } else {
            let matrix = self.assemble(rows, |a, m| T::pair(a + re * m, im * m));
            CoarseMode::Complex(matrix.factor(tree).ok()?, Default::default())
        })
    }

    /// P^T B P from the `rows` of all aggregates, with `entry`(dt P^T A P, P^T M P).
    fn assemble<E: Scalar>(&self, mut rows: &[T], entry: impl Fn(T, T) -> E) -> BlockMatrix<E> {
        let (block, functions) = self.functions();
        let mut matrix = BlockMatrix::new(Kind::Lu, block, self.columns.clone());
        for (aggregate, columns) in self.columns.iter().enumerate() {
            let (own, others) = rows.split_at(self.rows_len(aggregate));
            let (a, mass) = own.split_at(columns.len() * block * block);
            for (a, &column) in a.chunks_exact(block * block).zip(columns) {
                let has_mass = |i, j| column == aggregate && i / functions == j / functions;
                let mass = |i, j| mass[j % functions * functions + i % functions];
                let mass = |i, j| if has_mass(i, j) { mass(i, j) } else { T::default() };
                matrix.add(aggregate, column, |i, j| entry(a[j * block + i], mass(i, j)));
            }
            rows = others;
        }
        matrix
    }
}
