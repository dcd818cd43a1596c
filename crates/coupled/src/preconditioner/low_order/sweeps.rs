//! Products with (node blocks), and the two sweeps of (node ilu), over all modes at once.

use super::factor::Factor;
use super::matrix::{BEYOND, NodeBlocks};
use super::stencil::Step;
use super::vectors::{COLUMNS, Field, add_mode};
use super::walk::Walk;
use faer::c64;
use fem::parallel::{self, Grain};
use half::bf16;
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

/// Numbers of a node: of each of at most `C` columns a row, padded to `W`.
type Rows<const W: usize, const C: usize> = [[f32; W]; C];

/// A block, its columns padded to `W` rows.
type Block<const M: usize, const W: usize> = [[f32; W]; M];

/// Runs a kernel that is compiled for each small number of columns. More than four columns share one of [`COLUMNS`].
macro_rules! dispatch_columns {
    ($columns:expr, $kernel:ident::<$D:ident, $M:ident, $W:ident> $fields:tt) => {
        match $columns {
            1 => Arch::new().dispatch($kernel::<$D, $M, $W, 1> $fields),
            2 => Arch::new().dispatch($kernel::<$D, $M, $W, 2> $fields),
            3 => Arch::new().dispatch($kernel::<$D, $M, $W, 3> $fields),
            4 => Arch::new().dispatch($kernel::<$D, $M, $W, 4> $fields),
            _ => Arch::new().dispatch($kernel::<$D, $M, $W, COLUMNS> $fields),
        }
    };
}

impl<const D: usize, const M: usize, const W: usize> Operator<'_, D, M, W> {
    /// z = (node ilu)^-1 c.
    pub(super) fn sweep(&self, c: &Field, z: &Field) {
        let (cells, ordering) = (self.matrix.layout.cells, &self.walk.ordering);
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
            let (operator, neighbours, c, z) = (*self, &neighbours, &c[..], &mut z[..]);
            dispatch_columns!(self.columns(), SweepCell::<D, M, W> { operator, cell, forward, neighbours, c, z });
        });
    }

    /// w = (lambda + dt A) x.
    pub(super) fn multiply(&self, x: &Field, w: &Field) {
        parallel::for_each(self.matrix.layout.cells, Grain::AtLeast(4), &|cell| {
            let mut neighbours: Neighbours = Default::default();
            for (face, neighbour) in neighbours.iter_mut().enumerate().take(2 * D) {
                *neighbour = self.matrix.cell_across(cell, face).map(|other| x.read(other));
            }
            let (x, mut w) = (x.read(cell), w.write(cell));
            let (operator, neighbours, x, w) = (*self, &neighbours, &x[..], &mut w[..]);
            dispatch_columns!(self.columns(), MultiplyCell::<D, M, W> { operator, cell, neighbours, x, w });
        });
    }

    /// The faces and cells of the neighbours that come before `cell`, or after it.
    fn neighbours_on(&self, cell: usize, before: bool) -> impl Iterator<Item = (usize, usize)> {
        let (matrix, walk) = (self.matrix, self.walk);
        let other = move |face: usize| Some((face, matrix.cell_in_block(cell, face)?));
        (0..2 * D).filter_map(other).filter(move |(_, other)| walk.is_before(*other, cell) == before)
    }

    fn columns(&self) -> usize {
        self.matrix.layout.time_order
    }

    /// The numbers of `node` in the columns of a cell `x`.
    #[inline(always)]
    fn of_node<'x>(&self, x: &'x [f32], node: usize) -> NodeNumbers<'x> {
        NodeNumbers { x: &x[node * M..], column_len: self.matrix.layout.nodes * M }
    }

    /// y += sum over the faces for which `wanted` holds dt_0 A_ij x_j. The first axis comes last: its neighbour is the node just computed.
    #[inline(always)]
    fn add_couplings<const C: usize>(
        &self,
        (cell, node): (usize, usize),
        wanted: u8,
        x: &[f32],
        neighbours: &Neighbours,
        y: &mut Rows<W, C>,
    ) {
        let (nodes, columns) = (self.matrix.layout.nodes, count::<C>(self.columns()));
        let steps = self.matrix.stencil.of(node);
        for face in (0..2 * D).rev() {
            let across = match steps[face] {
                Step::Inside(other) if wanted >> face & 1 == 1 => Some((x, other as usize)),
                Step::Across(i) => neighbours[face].as_ref().map(|x| {
                    let other = self.matrix.across(cell, face)[i as usize] as usize % nodes;
                    (&x[..], other)
                }),
                Step::Inside(_) => None,
            };
            if let Some((x, other)) = across {
                let block = load::<M, W>(self.matrix.coupling(cell, node, face));
                add_product(&block, self.of_node(x, other), 0..columns, y);
            }
        }
    }

    /// Bits of the faces of `cell` whose inner nodes come before the node, or after it.
    fn inside_on(&self, cell: usize, before: bool) -> u8 {
        (0..2 * D).map(|face| u8::from(self.walk.is_earlier_inside(cell, face) == before) << face).sum()
    }
}

/// The number of columns: known to the compiler if there are few.
#[inline(always)]
const fn count<const C: usize>(columns: usize) -> usize {
    if C < COLUMNS { C } else { columns }
}

/// The numbers of a node: those of column c begin at `c * column_len`.
#[derive(Clone, Copy)]
struct NodeNumbers<'a> {
    x: &'a [f32],
    column_len: usize,
}

/// A block `[column][row]`, which may be read beyond its end.
#[inline(always)]
pub(super) fn load<const M: usize, const W: usize>(stored: &[bf16]) -> Block<M, W> {
    let (stored, mut block) = (&stored[..M * M + BEYOND], [[0.0; W]; M]);
    for (j, column) in block.iter_mut().enumerate() {
        let stored = &stored[j * M..j * M + W];
        for i in 0..W {
            column[i] = f32::from_bits(u32::from(stored[i].to_bits()) << 16);
        }
    }
    block
}

/// Block number `part` of some that are sums of `terms` stored ones.
#[inline(always)]
pub(super) fn load_terms<const M: usize, const W: usize>(stored: &[bf16], terms: usize, part: usize) -> Block<M, W> {
    let mut block = load::<M, W>(&stored[part * terms * M * M..]);
    for term in 1..terms {
        let lacking = load::<M, W>(&stored[(part * terms + term) * M * M..]);
        for (column, lacking) in block.iter_mut().zip(&lacking) {
            (0..W).for_each(|i| column[i] += lacking[i]);
        }
    }
    block
}

/// The same of a block in single precision.
#[inline(always)]
fn load_single<const M: usize, const W: usize>(stored: &[f32]) -> Block<M, W> {
    let (stored, mut block) = (&stored[..M * M + BEYOND], [[0.0; W]; M]);
    for (j, column) in block.iter_mut().enumerate() {
        column.copy_from_slice(&stored[j * M..j * M + W]);
    }
    block
}

/// y += B x
#[inline(always)]
pub(super) fn add_column<const M: usize, const W: usize>(block: &Block<M, W>, x: &[f32], y: &mut [f32; W]) {
    for (column, x) in block.iter().zip(x) {
        for i in 0..W {
            y[i] = column[i].mul_add(*x, y[i]);
        }
    }
}

/// y += B x for some columns of a node.
#[inline(always)]
fn add_product<const M: usize, const W: usize, const C: usize>(
    block: &Block<M, W>,
    node: NodeNumbers,
    columns: Range<usize>,
    y: &mut Rows<W, C>,
) {
    for c in columns {
        add_column(block, &node.x[c * node.column_len..][..M], &mut y[c]);
    }
}

/// y += D_i^-1 x for all modes. Two columns are those of one complex mode.
#[inline(always)]
fn add_inverse<const M: usize, const W: usize, const C: usize>(
    (inverse, terms): (&[bf16], usize),
    modes: &[Range<usize>],
    x: &Rows<W, C>,
    y: &mut Rows<W, C>,
) {
    if C == 2 {
        return add_complex_inverse::<M, W, C>((inverse, terms), 0, x, y);
    }
    for columns in modes {
        let c = columns.start;
        match columns.len() {
            1 => add_column(&load_terms::<M, W>(inverse, terms, c), &x[c][..M], &mut y[c]),
            _ => add_complex_inverse::<M, W, C>((inverse, terms), c, x, y),
        }
    }
}

/// The same for the complex mode of column c and the next one.
#[inline(always)]
fn add_complex_inverse<const M: usize, const W: usize, const C: usize>(
    (inverse, terms): (&[bf16], usize),
    c: usize,
    x: &Rows<W, C>,
    y: &mut Rows<W, C>,
) {
    let [re, im] = [c, c + 1].map(|part| load_terms::<M, W>(inverse, terms, part));
    let mut turned = [[0.0; W]; 2];
    for k in 0..2 {
        add_column(&re, &x[c + k][..M], &mut y[c + k]);
        add_column(&im, &x[c + k][..M], &mut turned[k]);
    }
    for i in 0..W {
        y[c][i] -= turned[1][i];
        y[c + 1][i] += turned[0][i];
    }
}

/// A cell in one of the two sweeps:
///
/// ```text
/// z_i = D_i^-1 (c_i - sum_(j before i) dt A_ij z_j),   z_i -= D_i^-1 sum_(j after i) dt A_ij z_j
/// ```
struct SweepCell<'a, const D: usize, const M: usize, const W: usize, const C: usize> {
    operator: Operator<'a, D, M, W>,
    cell: usize,
    forward: bool,
    neighbours: &'a Neighbours<'a>,
    c: &'a [f32],
    z: &'a mut [f32],
}

impl<const D: usize, const M: usize, const W: usize, const C: usize> WithSimd for SweepCell<'_, D, M, W, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let SweepCell { operator, cell, forward, neighbours, c, z } = self;
        let Operator { matrix, walk, factor } = operator;
        let (columns, order) = (count::<C>(operator.columns()), walk.nodes(cell));
        let (column_len, ratio) = (matrix.layout.nodes * M, factor.ratio as f32);
        let (wanted, inverses) = (operator.inside_on(cell, forward), factor.read(cell));
        for number in 0..order.len() {
            let node = order[if forward { number } else { order.len() - 1 - number }] as usize;
            let mut rows: Rows<W, C> = [[0.0; W]; C];
            operator.add_couplings((cell, node), wanted, z, neighbours, &mut rows);
            for column in 0..columns {
                let c = &c[column * column_len + node * M..][..M];
                for i in 0..M {
                    let given = if forward { c[i] } else { 0.0 };
                    rows[column][i] = given - ratio * rows[column][i];
                }
            }
            let mut images: Rows<W, C> = [[0.0; W]; C];
            let inverse = (factor.of_node::<M>(&inverses, node), factor.terms);
            add_inverse::<M, W, C>(inverse, &factor.columns, &rows, &mut images);
            for column in 0..columns {
                let z = &mut z[column * column_len + node * M..][..M];
                for i in 0..M {
                    z[i] = if forward { images[column][i] } else { z[i] + images[column][i] };
                }
            }
        }
    }
}

/// A cell of w = (lambda + dt A) x.
struct MultiplyCell<'a, const D: usize, const M: usize, const W: usize, const C: usize> {
    operator: Operator<'a, D, M, W>,
    cell: usize,
    neighbours: &'a Neighbours<'a>,
    x: &'a [f32],
    w: &'a mut [f32],
}

impl<const D: usize, const M: usize, const W: usize, const C: usize> WithSimd for MultiplyCell<'_, D, M, W, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let MultiplyCell { operator, cell, neighbours, x, w } = self;
        let Operator { matrix, factor, .. } = operator;
        let (columns, ratio) = (count::<C>(operator.columns()), factor.ratio as f32);
        let column_len = matrix.layout.nodes * M;
        for node in 0..matrix.layout.nodes {
            let mut rows: Rows<W, C> = [[0.0; W]; C];
            operator.add_couplings((cell, node), u8::MAX, x, neighbours, &mut rows);
            let diagonal = load_single::<M, W>(matrix.diagonal(cell, node));
            add_product(&diagonal, operator.of_node(x, node), 0..columns, &mut rows);
            for column in 0..columns {
                let w = &mut w[column * column_len + node * M..][..M];
                for i in 0..M {
                    w[i] = ratio * rows[column][i];
                }
            }
        }
        shift(factor, column_len, x, w);
    }
}

/// w += lambda x, mode by mode.
#[inline(always)]
fn shift(factor: &Factor, len: usize, x: &[f32], w: &mut [f32]) {
    for (c64 { re, im }, columns) in factor.shifts.iter().zip(&factor.columns) {
        let range = columns.start * len..columns.end * len;
        add_mode([*re as f32, *im as f32], columns.len() == 2, &x[range.clone()], &mut w[range]);
    }
}
