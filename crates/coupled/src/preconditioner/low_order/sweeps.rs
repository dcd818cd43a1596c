//! Products with (node blocks), and the two sweeps of (node ilu), over all modes at once.

use super::factor::Factor;
use super::matrix::{BEYOND, NodeBlocks};
use super::stencil::Step;
use super::vectors::{COLUMNS, Field};
use super::walk::Walk;
use faer::c64;
use half::bf16;
use rayon::prelude::*;
use sparse::dependency_schedule;
use std::ops::Range;
use std::sync::RwLockReadGuard;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// lambda + dt A and its factors.
#[derive(Clone, Copy)]
pub(super) struct Operator<'a, const D: usize, const M: usize, const W: usize> {
    pub(super) matrix: &'a NodeBlocks<D, M>,
    pub(super) walk: &'a Walk,
    pub(super) factor: &'a Factor,
}

/// The neighbours of a cell that are read, by face.
pub(super) type Neighbours<'a> = [Option<RwLockReadGuard<'a, Vec<f32>>>; 6];

/// Columns of a node, each padded to `W` numbers.
type Rows<const W: usize> = [[f32; W]; COLUMNS];

impl<const D: usize, const M: usize, const W: usize> Operator<'_, D, M, W> {
    /// z = (node ilu)^-1 c.
    pub(super) fn sweep(&self, c: &Field, z: &Field) {
        let (cells, ordering, arch) = (self.matrix.layout.cells, &self.walk.ordering, Arch::new());
        // Number k is position k of the forward sweep, or position 2 `cells` - 1 - k of the backward sweep.
        let place = |k: usize| if k < cells { k } else { 2 * cells - 1 - k };
        let number = |cell: usize, forward: bool| {
            let position = ordering.positions[cell];
            if forward { position } else { 2 * cells - 1 - position }
        };
        let needs = |k: usize| {
            let (cell, forward) = (ordering.cells[place(k)], k < cells);
            let own = (!forward).then(|| number(cell, true));
            let others = self.neighbours_on(cell, forward).map(move |(_, other)| number(other, forward));
            others.chain(own)
        };
        dependency_schedule(2 * cells, ordering.widest_level(), needs, |k| {
            let (cell, forward) = (ordering.cells[place(k)], k < cells);
            let mut neighbours: Neighbours = Default::default();
            self.neighbours_on(cell, forward).for_each(|(face, other)| neighbours[face] = Some(z.read(other)));
            let (c, mut z) = (c.read(cell), z.write(cell));
            let (operator, neighbours) = (*self, &neighbours);
            arch.dispatch(SweepCell { operator, cell, forward, neighbours, c: &c, z: &mut z });
        });
    }

    /// w = (lambda + dt A) x.
    pub(super) fn multiply(&self, x: &Field, w: &Field) {
        let arch = Arch::new();
        (0..self.matrix.layout.cells).into_par_iter().with_min_len(4).for_each(|cell| {
            let mut neighbours: Neighbours = Default::default();
            for (face, neighbour) in neighbours.iter_mut().enumerate().take(2 * D) {
                *neighbour = self.matrix.cell_across(cell, face).map(|other| x.read(other));
            }
            let (x, mut w) = (x.read(cell), w.write(cell));
            arch.dispatch(MultiplyCell { operator: *self, cell, neighbours: &neighbours, x: &x, w: &mut w });
        });
    }

    /// The faces and cells of the neighbours that come before `cell`, or after it.
    fn neighbours_on(&self, cell: usize, before: bool) -> impl Iterator<Item = (usize, usize)> {
        let (matrix, walk) = (self.matrix, self.walk);
        let other = move |face: usize| Some((face, matrix.cell_in_block(cell, face)?));
        (0..2 * D).filter_map(other).filter(move |(_, other)| walk.is_before(*other, cell) == before)
    }

    /// y += sum over the faces for which `wanted` holds dt_0 A_ij x_j.
    #[inline(always)]
    fn add_couplings(
        &self,
        (cell, node): (usize, usize),
        wanted: u8,
        x: &[f32],
        neighbours: &Neighbours,
        y: &mut [[f32; W]],
    ) {
        let (nodes, len) = (self.matrix.layout.nodes, y.len() * M);
        for (face, step) in self.matrix.stencil.of(node).iter().enumerate() {
            let block = self.matrix.coupling(cell, node, face);
            match *step {
                Step::Inside(other) if wanted >> face & 1 == 1 => {
                    add_product::<M, W>(block, &x[other as usize * len..][..len], y);
                }
                Step::Across(i) => {
                    if let Some(x) = &neighbours[face] {
                        let other = self.matrix.across(cell, face)[i as usize] as usize % nodes;
                        add_product::<M, W>(block, &x[other * len..][..len], y);
                    }
                }
                Step::Inside(_) => {}
            }
        }
    }

    /// Bits of the faces of `cell` whose inner nodes come before the node, or after it.
    fn inside_on(&self, cell: usize, before: bool) -> u8 {
        (0..2 * D).map(|face| u8::from(self.walk.is_earlier_inside(cell, face) == before) << face).sum()
    }
}

/// y += B x for all columns. B is `[column][row]` and may be read beyond its end.
#[inline(always)]
pub(super) fn add_product<const M: usize, const W: usize>(block: &[bf16], x: &[f32], y: &mut [[f32; W]]) {
    let block = &block[..M * M + BEYOND];
    for j in 0..M {
        let stored = &block[j * M..j * M + W];
        let mut column = [0.0; W];
        for i in 0..W {
            column[i] = f32::from_bits(u32::from(stored[i].to_bits()) << 16);
        }
        for (x, y) in x.chunks_exact(M).zip(y.iter_mut()) {
            for i in 0..W {
                y[i] += column[i] * x[j];
            }
        }
    }
}

/// y += D_i^-1 x for all modes.
#[inline(always)]
fn add_inverse<const M: usize, const W: usize>(
    mut inverse: &[bf16],
    modes: &[Range<usize>],
    x: &[f32],
    y: &mut [[f32; W]],
) {
    for columns in modes {
        let x = &x[columns.start * M..columns.end * M];
        add_product::<M, W>(inverse, x, &mut y[columns.clone()]);
        inverse = &inverse[M * M..];
        if columns.len() == 2 {
            let mut turned = [[0.0; W]; 2];
            add_product::<M, W>(inverse, x, &mut turned);
            for i in 0..W {
                y[columns.start][i] -= turned[1][i];
                y[columns.start + 1][i] += turned[0][i];
            }
            inverse = &inverse[M * M..];
        }
    }
}

/// A cell in one of the two sweeps:
///
/// ```text
/// z_i = D_i^-1 (c_i - sum_(j before i) dt A_ij z_j),   z_i -= D_i^-1 sum_(j after i) dt A_ij z_j
/// ```
struct SweepCell<'a, const D: usize, const M: usize, const W: usize> {
    operator: Operator<'a, D, M, W>,
    cell: usize,
    forward: bool,
    neighbours: &'a Neighbours<'a>,
    c: &'a [f32],
    z: &'a mut [f32],
}

impl<const D: usize, const M: usize, const W: usize> WithSimd for SweepCell<'_, D, M, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let SweepCell { operator, cell, forward, neighbours, c, z } = self;
        let Operator { matrix, walk, factor } = operator;
        let (columns, order) = (matrix.layout.time_order, walk.nodes(cell));
        let (len, ratio, wanted) = (columns * M, factor.ratio as f32, operator.inside_on(cell, forward));
        let (mut rows, mut images): (Rows<W>, Rows<W>) = ([[0.0; W]; COLUMNS], [[0.0; W]; COLUMNS]);
        let mut right_side = [0.0_f32; COLUMNS * 8];
        let inverses = factor.read(cell);
        for number in 0..order.len() {
            let node = order[if forward { number } else { order.len() - 1 - number }] as usize;
            let rows = &mut rows[..columns];
            rows.fill([0.0; W]);
            operator.add_couplings((cell, node), wanted, z, neighbours, rows);
            for (k, right_side) in right_side[..len].iter_mut().enumerate() {
                let coupled = ratio * rows[k / M][k % M];
                *right_side = if forward { c[node * len + k] - coupled } else { -coupled };
            }
            let images = &mut images[..columns];
            images.fill([0.0; W]);
            add_inverse::<M, W>(factor.of_node::<M>(&inverses, node), &factor.columns, &right_side[..len], images);
            for (k, z) in z[node * len..(node + 1) * len].iter_mut().enumerate() {
                let image = images[k / M][k % M];
                *z = if forward { image } else { *z + image };
            }
        }
    }
}

/// A cell of w = (lambda + dt A) x.
struct MultiplyCell<'a, const D: usize, const M: usize, const W: usize> {
    operator: Operator<'a, D, M, W>,
    cell: usize,
    neighbours: &'a Neighbours<'a>,
    x: &'a [f32],
    w: &'a mut [f32],
}

impl<const D: usize, const M: usize, const W: usize> WithSimd for MultiplyCell<'_, D, M, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let MultiplyCell { operator, cell, neighbours, x, w } = self;
        let Operator { matrix, factor, .. } = operator;
        let (columns, ratio) = (matrix.layout.time_order, factor.ratio as f32);
        let (len, mut rows): (usize, Rows<W>) = (columns * M, [[0.0; W]; COLUMNS]);
        for node in 0..matrix.layout.nodes {
            let rows = &mut rows[..columns];
            rows.fill([0.0; W]);
            operator.add_couplings((cell, node), u8::MAX, x, neighbours, rows);
            let x = &x[node * len..(node + 1) * len];
            let diagonal = matrix.diagonal(cell, node);
            for (x, rows) in x.chunks_exact(M).zip(rows.iter_mut()) {
                for (x, column) in x.iter().zip(diagonal.chunks_exact(M)) {
                    rows.iter_mut().zip(column).for_each(|(y, a)| *y += a * x);
                }
            }
            for (k, w) in w[node * len..(node + 1) * len].iter_mut().enumerate() {
                *w = ratio * rows[k / M][k % M];
            }
            shift::<M>(factor, x, &mut w[node * len..(node + 1) * len]);
        }
    }
}

/// w += lambda x, mode by mode.
#[inline(always)]
fn shift<const M: usize>(factor: &Factor, x: &[f32], w: &mut [f32]) {
    for (c64 { re, im }, columns) in factor.shifts.iter().zip(&factor.columns) {
        let (re, im, first) = (*re as f32, *im as f32, columns.start * M);
        for i in first..first + M {
            w[i] += re * x[i];
            if columns.len() == 2 {
                w[i] -= im * x[i + M];
                w[i + M] += im * x[i] + re * x[i + M];
            }
        }
    }
}
