//! The coarse level: what ILU(0) takes many sweeps to carry across the mesh, a direct solver carries at once.
//!
//! ```text
//! x_1 = P (P^T B P)^{-1} P^T c,     x = x_1 + S^{-1} (c - B x_1),     B = lambda M + dt A                         (two-level)
//! ```
//!
//! for every mode, with the sweeps S of its factors. The coarse space consists of the polynomials of degree 1 in every direction on
//! [`Aggregates`] of cells, and P has their values at the nodes. There are so few aggregates that their direct solver costs less than the
//! sweeps; on small meshes every cell is one. B P is kept, so that a product with B costs no more than the few columns of P.
//!
//! Every rank makes P and B P of its own cells. The coarse matrix and its right-hand sides are joined on all ranks, and each solves for all
//! coarse unknowns: a message for each application, and the same bits on any number of ranks.

mod matrix;

use super::aggregates::{Aggregates, Neighbourhood, functions_per_direction};
use super::blocks::{Link, coupling_block};
use super::coarse_modes::{CoarseMode, Entry, products_with, solve_modes};
use super::ilu::BlockIlu;
use super::panel::padded;
use basis::TemporalModes;
use faer::{Mat, c64};
use fem::parallel::{self, Grain};
use fem::{Layout, Share, SlabOperator, TraceSpace};
use rayon::prelude::*;
use sparse::{BlockMatrix, EliminationTree, Kind};
use std::sync::Arc;

/// The part of B P that a link brings to its cell: rows traces of the cell, columns functions of the aggregate of the neighbour.
struct CoupledImage<T> {
    link: Link,
    image: Mat<T>,
}

/// The coarse level of all modes.
pub struct CoarseLevel<T: Entry> {
    layout: Layout,
    aggregates: Aggregates,
    /// Coarse unknowns of an aggregate.
    block: usize,
    /// P of every own cell and ghost, one component: `[node][function]`.
    prolongations: Vec<Mat<T>>,
    /// dt sum_k A_ik P_k of every own cell i over the cells k of its aggregate.
    images: Vec<Mat<T>>,
    /// M_i P_i of every own cell, one component.
    masses: Vec<Mat<T>>,
    /// dt A_ik P_k of every own cell i and its neighbours k in other aggregates.
    coupled: Vec<Vec<CoupledImage<T>>>,
    /// Every aggregate with those beside it: the columns of its rows in the coarse matrix.
    columns: Vec<Vec<usize>>,
    tree: Arc<EliminationTree>,
    /// The factors for every mode.
    modes: Vec<CoarseMode<T>>,
    /// See [`products_with`].
    shifted: Vec<Vec<(usize, f64)>>,
    /// Right-hand sides and solutions, `[column][aggregate][component][function]`.
    coefficients: Vec<T>,
}

impl<T: Entry> CoarseLevel<T> {
    /// The coarse level of the modes of `sweeps`, which precondition the flow of `operator`; `damping` is added to all lambda. There are at most
    /// `most` aggregates if pairing gets there. None if a coarse matrix is singular, or memory runs out on a rank. A collective call.
    pub fn new<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        sweeps: &BlockIlu<T>,
        damping: f64,
        most: usize,
    ) -> Option<Self> {
        let (layout, share, order) = (sweeps.layout, &sweeps.share, operator.tables.orders.flow);
        let per_direction = functions_per_direction(order);
        let aggregates = Neighbourhood::new(operator, sweeps).aggregates(most);
        let prolongation = |cell| aggregates.prolongation(cell, order, D, per_direction);
        let block = M * per_direction.pow(D as u32);
        let columns = aggregates.neighbourhoods(sweeps.links(), share);
        let tree = BlockMatrix::<T>::new(Kind::Lu, block, columns.clone()).elimination_tree().ok();
        let coarse = CoarseLevel {
            layout,
            block,
            prolongations: (0..share.cells().count()).map(|cell| entries(&prolongation(cell))).collect(),
            images: Vec::new(),
            masses: Vec::new(),
            coupled: Vec::new(),
            columns,
            tree: Arc::new(on_all_ranks(share, tree)?),
            modes: Vec::new(),
            shifted: Vec::new(),
            coefficients: vec![T::default(); sweeps.modes.forward.rows() * aggregates.count() * block],
            aggregates,
        };
        coarse.updated(sweeps, damping)
    }

    /// The same with the dt and the A that `sweeps` have now; None if a coarse matrix is singular, or memory runs out on a rank. A collective
    /// call.
    pub fn updated(mut self, sweeps: &BlockIlu<T>, damping: f64) -> Option<Self> {
        // The memory of old factors is free before new ones are made.
        self.modes = Vec::new();
        let mass = |cell| scaled(1.0, sweeps.jacobian.mass_of(cell), self.layout.nodes) * &self.prolongations[cell];
        self.masses = parallel::map(self.layout.cells, Grain::Any, &mass);
        let images = parallel::map(self.layout.cells, Grain::Any, &|cell| self.images_of(sweeps, cell));
        (self.images, self.coupled) = images.into_iter().unzip();
        let rows = self.all_rows(&sweeps.jacobian.traces, &sweeps.share);
        let shifts: Vec<c64> = sweeps.modes.eigenvalues.iter().map(|lambda| lambda + damping).collect();
        let modes = shifts.iter().map(|lambda| self.factored(&rows, *lambda)).collect();
        self.modes = on_all_ranks(&sweeps.share, modes)?;
        self.shifted = products_with(&shifts);
        Some(self)
    }

    /// dt A P in the rows of `cell`.
    fn images_of(&self, sweeps: &BlockIlu<T>, cell: usize) -> (Mat<T>, Vec<CoupledImage<T>>) {
        let (dt, jacobian, of_cell) = (sweeps.dt, &sweeps.jacobian, &self.aggregates.of_cell);
        let traces = &jacobian.traces;
        let mut own = scaled(dt, jacobian.block_of(cell), jacobian.block) * self.over_components(cell);
        let mut coupled = Vec::new();
        for link in &sweeps.links()[cell] {
            let block = scaled(dt, coupling_block(jacobian, *link), traces.len());
            let image = block * traces_of(traces, link.other_face, &self.over_components(link.cell));
            if of_cell[link.cell] == of_cell[cell] {
                for j in 0..self.block {
                    add_lifted(traces, link.face, image.col_as_slice(j), own.col_as_slice_mut(j));
                }
            } else {
                coupled.push(CoupledImage { link: *link, image });
            }
        }
        (own, coupled)
    }

    /// P of all components of a cell: one block for each.
    fn over_components(&self, cell: usize) -> Mat<T> {
        let p = &self.prolongations[cell];
        let (nodes, functions) = (p.nrows(), p.ncols());
        Mat::from_fn(self.block / functions * nodes, self.block, |i, j| {
            if i / nodes == j / functions { p[(i % nodes, j % functions)] } else { T::default() }
        })
    }

    /// The numbers of all aggregates from those of `own` ones, `len` of each. A collective call.
    fn joined(&self, share: &Share, own: Vec<T>, len: impl Fn(usize) -> usize) -> Vec<T> {
        if !share.is_distributed() {
            return own;
        }
        let mut first = 0;
        let lengths = self.aggregates.of_ranks.iter().map(|count| {
            first += count;
            (first - count..first).map(&len).sum()
        });
        let (own, lengths): (Vec<f64>, Vec<usize>) = (own.into_iter().map(Into::into).collect(), lengths.collect());
        share.sums.communicator().all_gather_known(&own, &lengths).into_iter().map(T::of).collect()
    }

    /// Bytes of B P and of the factors.
    pub fn bytes(&self) -> usize {
        let images = self.images.iter().chain(&self.masses).chain(&self.prolongations);
        let images = images.chain(self.coupled.iter().flatten().map(|coupled| &coupled.image));
        let factors: usize = self.modes.iter().map(CoarseMode::bytes).sum();
        images.map(|image| image.nrows() * image.ncols() * size_of::<T>()).sum::<usize>() + factors
    }

    /// The steps of (two-level) before the sweeps: x_1, and the right-hand sides c - B x_1, with c of r / `scale`.
    pub(super) fn solve(&mut self, sweeps: &mut BlockIlu<T>, r: &[f64], scale: f64) {
        self.restrict(&sweeps.modes, r, scale);
        self.join_coefficients(&sweeps.share);
        solve_modes(&mut self.modes, self.aggregates.count() * self.block, &mut self.coefficients);
        self.subtract_images(sweeps, r, scale);
    }

    /// P^T c of own aggregates. It is made of r itself: if the coarse matrix is nearly singular, rounded sides would excite its null space.
    fn restrict(&mut self, modes: &TemporalModes, r: &[f64], scale: f64) {
        let (layout, aggregates, prolongations) = (self.layout, &self.aggregates, &self.prolongations);
        let count = aggregates.count();
        parallel::for_each_chunk(&mut self.coefficients, self.block, Grain::AtLeast(16), &|k, coarse| {
            let column = k / count;
            coarse.fill(T::default());
            for &cell in aggregates.own_cells(k % count) {
                let p = &prolongations[cell];
                for a in 0..layout.time_order {
                    let weight = modes.forward[(column, a)] / scale;
                    let r = r[layout.cell_at(cell, a)].chunks_exact(layout.nodes);
                    for (coarse, r) in coarse.chunks_exact_mut(p.ncols()).zip(r) {
                        for (j, x) in coarse.iter_mut().enumerate() {
                            let p = p.col_as_slice(j).iter().map(|&p| p.into());
                            *x += T::of(weight * p.zip(r).map(|(p, r): (f64, &f64)| p * r).sum::<f64>());
                        }
                    }
                }
            }
        });
    }

    /// Joins P^T c of all ranks. A collective call.
    fn join_coefficients(&mut self, share: &Share) {
        if !share.is_distributed() {
            return;
        }
        let (block, count, own) = (self.block, self.aggregates.count(), self.aggregates.own());
        let columns = self.coefficients.len() / (count * block);
        // All columns of an aggregate travel together.
        let of_aggregate = |k: usize| (0..columns).map(move |column| (column * count + k) * block);
        let packed = own.flat_map(of_aggregate).flat_map(|first| self.coefficients[first..first + block].to_vec());
        let all = self.joined(share, packed.collect(), |_| columns * block);
        for (first, part) in (0..count).flat_map(of_aggregate).zip(all.chunks_exact(block)) {
            self.coefficients[first..first + block].copy_from_slice(part);
        }
    }

    /// x of the aggregate of a cell in a column.
    fn x(&self, column: usize, cell: usize) -> &[T] {
        let first = (column * self.aggregates.count() + self.aggregates.of_cell[cell]) * self.block;
        &self.coefficients[first..first + self.block]
    }

    /// The right-hand sides c - B P x of the sweeps. c is made of r itself: what is left may be much smaller.
    fn subtract_images(&self, sweeps: &mut BlockIlu<T>, r: &[f64], scale: f64) {
        let (rows, n) = (padded(sweeps.jacobian.block), sweeps.jacobian.block);
        let (traces, modes) = (&sweeps.jacobian.traces, &sweeps.modes);
        let cells = sweeps.swept.par_iter_mut().zip(&sweeps.ordering.cells).with_min_len(16);
        let own = cells.filter(|(_, cell)| **cell < self.layout.cells);
        own.for_each_init(
            || (vec![T::default(); n], vec![T::default(); traces.len()]),
            |(rest, sent), (swept, &cell)| {
                for (column, c) in swept.get().right_side.chunks_exact_mut(rows).enumerate() {
                    self.write_negative(modes, (column, cell), (r, scale), rest);
                    add_product(&self.images[cell], self.x(column, cell), rest);
                    self.add_mass_product(column, cell, rest);
                    for coupled in &self.coupled[cell] {
                        sent.fill(T::default());
                        add_product(&coupled.image, self.x(column, coupled.link.cell), sent);
                        add_lifted(traces, coupled.link.face, sent, rest);
                    }
                    let (c, padding) = c.split_at_mut(n);
                    c.iter_mut().zip(&*rest).for_each(|(c, rest)| *c = -Into::<f64>::into(*rest) as f32);
                    padding.fill(0.0);
                }
            },
        );
    }

    /// -c of a cell in a column.
    fn write_negative(
        &self,
        modes: &TemporalModes,
        (column, cell): (usize, usize),
        (r, scale): (&[f64], f64),
        out: &mut [T],
    ) {
        out.fill(T::default());
        for a in 0..self.layout.time_order {
            let weight = -modes.forward[(column, a)] / scale;
            out.iter_mut().zip(&r[self.layout.cell_at(cell, a)]).for_each(|(out, r)| *out += T::of(weight * r));
        }
    }

    /// image += lambda M P x in a column.
    fn add_mass_product(&self, column: usize, cell: usize, image: &mut [T]) {
        let mass = &self.masses[cell];
        for &(other, factor) in &self.shifted[column] {
            let x = self.x(other, cell).chunks_exact(mass.ncols());
            for (image, x) in image.chunks_exact_mut(mass.nrows()).zip(x) {
                for (j, x) in x.iter().enumerate() {
                    let x = T::of(factor) * *x;
                    image.iter_mut().zip(mass.col_as_slice(j)).for_each(|(image, m)| *image += *m * x);
                }
            }
        }
    }

    /// z += (Q (x) P) x, times `scale`: in double precision, as x_1 may be much larger than what the sweeps add.
    pub(super) fn add_prolonged(&self, modes: &TemporalModes, scale: f64, z: &mut [f64]) {
        let layout = self.layout;
        parallel::for_each_chunk(z, layout.cell_len(), Grain::AtLeast(16), &|cell, z| {
            let p = &self.prolongations[cell];
            for (a, z) in z.chunks_exact_mut(layout.time_len()).enumerate() {
                for column in 0..modes.backward.cols() {
                    let weight = modes.backward[(a, column)] * scale;
                    let coarse = self.x(column, cell).chunks_exact(p.ncols());
                    for (z, coarse) in z.chunks_exact_mut(layout.nodes).zip(coarse) {
                        for (j, &x) in coarse.iter().enumerate() {
                            let x = weight * x.into();
                            z.iter_mut().zip(p.col_as_slice(j)).for_each(|(z, &p)| *z += x * p.into());
                        }
                    }
                }
            }
        });
    }
}

/// `result`, if all ranks have one. A collective call.
fn on_all_ranks<R>(share: &Share, result: Option<R>) -> Option<R> {
    ranks::agree(&**share.sums.communicator(), result.ok_or(()), |()| Vec::new(), |_| ()).ok()
}

/// factor A for a square matrix of n rows, by columns.
fn scaled<T: Entry>(factor: f64, a: &[T], n: usize) -> Mat<T> {
    Mat::from_fn(n, n, |i, j| T::of(factor * a[j * n + i].into()))
}

/// `matrix` in numbers of type `T`.
fn entries<T: Entry>(matrix: &Mat<f64>) -> Mat<T> {
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| T::of(matrix[(i, j)]))
}

/// y += A x, column by column.
fn add_product<T: Entry>(matrix: &Mat<T>, x: &[T], y: &mut [T]) {
    for (j, x) in x.iter().enumerate() {
        y.iter_mut().zip(matrix.col_as_slice(j)).for_each(|(y, a)| *y += *a * *x);
    }
}

/// image += T_f^T sent.
fn add_lifted<T: Entry>(traces: &TraceSpace, face: usize, sent: &[T], image: &mut [T]) {
    for (trace, sent) in sent.iter().enumerate() {
        let (offset, functional) = traces.functional(face, trace);
        functional.iter().for_each(|&(node, weight)| image[offset + node] += T::of(weight) * *sent);
    }
}

/// T_f P: the traces of the coarse functions on `face`.
fn traces_of<T: Entry>(traces: &TraceSpace, face: usize, p: &Mat<T>) -> Mat<T> {
    Mat::from_fn(traces.len(), p.ncols(), |trace, column| {
        let (offset, functional) = traces.functional(face, trace);
        let mut sum = T::default();
        functional.iter().for_each(|&(node, weight)| sum += T::of(weight) * p[(offset + node, column)]);
        sum
    })
}
