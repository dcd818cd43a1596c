//! Traces of cell coefficients on faces, and the transposed map.

use crate::batches::{BATCHES_PER_TASK, cells_of};
use crate::gather::{gather, scatter};
use crate::per_thread::PerThread;
use crate::tables::Shape1d;
use basis::{AlongAxis, Matrix, contract};
use mesh::{Side, axis_and_side, face_nodes};
use rayon::prelude::*;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, WIDTH, zeroed};

/// The layout of the traces of a set of cell coefficients: `[cell][face][kind][slot][component][face node]`.
///
/// Kind 0 is values on the face's lattice, kind 1 derivatives along the reference axis that leaves the face. Slots are
/// time nodes of the flow, or bottom position and velocities of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct TraceLayout {
    /// Faces of a cell, 2 D.
    pub faces: usize,
    /// Slots.
    pub slots: usize,
    /// Components.
    pub components: usize,
    /// Nodes of a cell.
    pub nodes: usize,
    /// Nodes of a face.
    pub face_nodes: usize,
}

impl TraceLayout {
    /// Length of one kind on one face.
    pub fn kind_len(&self) -> usize {
        self.slots * self.components * self.face_nodes
    }
    /// Length of one face.
    pub fn face_len(&self) -> usize {
        2 * self.kind_len()
    }
    /// Length of one cell.
    pub fn cell_len(&self) -> usize {
        self.faces * self.face_len()
    }
    /// Number of coefficients of one cell.
    pub fn coefficients(&self) -> usize {
        self.slots * self.components * self.nodes
    }
    /// The start of a kind on a face of a cell.
    pub fn start(&self, cell: usize, face: usize, kind: usize) -> usize {
        cell * self.cell_len() + face * self.face_len() + kind * self.kind_len()
    }
}

/// The map from the nodes of a cell to its traces, for one order and dimension.
///
/// The trace on face 2 axis + side is a contraction along that axis, with the unit vector of the end, or with the derivatives
/// of the nodal polynomials there.
pub struct FaceMaps {
    dimension: usize,
    order: usize,
    /// Derivatives at the low and the high end as rows, and as columns.
    rows: [Matrix; 2],
    columns: [Matrix; 2],
    arch: Arch,
}

impl FaceMaps {
    /// Maps for the polynomials of `line` in `dimension` directions.
    pub fn new(line: &Shape1d, dimension: usize) -> Self {
        let row = |end: &Vec<f64>| Matrix::from_fn(1, line.order, |_, k| end[k]);
        let rows = line.end_derivatives.each_ref().map(row);
        let columns = rows.each_ref().map(Matrix::transpose);
        FaceMaps { dimension, order: line.order, rows, columns, arch: Arch::new() }
    }

    /// The functionals on the nodal values of one component whose values are the traces on `face`: kind 0 then kind 1, each
    /// in the order of the face's lattice. A functional is a list of (cell node, weight).
    pub fn functionals(&self, face: usize, both: bool) -> Vec<Vec<(usize, f64)>> {
        let (axis, side) = axis_and_side(face);
        let stride = self.order.pow(axis as u32);
        let values = face_nodes(self.dimension, self.order, face).into_iter().map(|node| vec![(node, 1.0)]);
        let line =
            |start: usize| self.rows[side].values().iter().enumerate().map(|(k, &w)| (start + k * stride, w)).collect();
        let derivatives = face_nodes(self.dimension, self.order, 2 * axis).into_iter().map(line);
        if both { values.chain(derivatives).collect() } else { values.collect() }
    }

    /// The traces of the tensors `coefficients[slot and component][node]` on all faces, `[face][kind][slot and component][face
    /// node]`; kind 1 only if `both`.
    pub fn extract(&self, tensors: usize, coefficients: &[Pack], both: bool, traces: &mut [Pack]) {
        self.arch.dispatch(Extract { maps: self, tensors, both, coefficients, traces });
    }

    /// The transpose of [`FaceMaps::extract`]: adds terms tested with traces to terms tested with cell functions.
    pub fn lift(&self, tensors: usize, terms: &[Pack], both: bool, coefficients: &mut [Pack]) {
        self.arch.dispatch(Lift { maps: self, tensors, both, terms, coefficients });
    }

    fn face(&self, face: usize, tensors: usize) -> Face<'_> {
        let (axis, side) = axis_and_side(face);
        let (n, inner) = (self.order, self.order.pow(axis as u32));
        let outer = tensors * n.pow((self.dimension - 1 - axis) as u32);
        let kind_len = outer * inner;
        let start = 2 * face * kind_len;
        let end = if side == 0 { 0 } else { n - 1 };
        Face { n, end, outer, inner, start, kind_len, row: &self.rows[side], column: &self.columns[side] }
    }
}

/// One face and the lines of a cell's tensors that leave it: `outer` times `inner` lines of `n` nodes.
struct Face<'a> {
    n: usize,
    /// The end of the lines at the face.
    end: usize,
    outer: usize,
    inner: usize,
    /// The start of its traces, and the number of traces of a kind.
    start: usize,
    kind_len: usize,
    row: &'a Matrix,
    column: &'a Matrix,
}

impl<'a> Face<'a> {
    #[inline(always)]
    fn along(&self, matrix: &'a Matrix) -> AlongAxis<'a> {
        AlongAxis { matrix, outer: self.outer, inner: self.inner }
    }
}

struct Extract<'a> {
    maps: &'a FaceMaps,
    tensors: usize,
    both: bool,
    coefficients: &'a [Pack],
    traces: &'a mut [Pack],
}

impl WithSimd for Extract<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for number in 0..2 * self.maps.dimension {
            let face = self.maps.face(number, self.tensors);
            let (values, derivatives) =
                self.traces[face.start..face.start + 2 * face.kind_len].split_at_mut(face.kind_len);
            for o in 0..face.outer {
                let from = (o * face.n + face.end) * face.inner;
                values[o * face.inner..(o + 1) * face.inner]
                    .copy_from_slice(&self.coefficients[from..from + face.inner]);
            }
            if self.both {
                contract(simd, face.along(face.row), self.coefficients, derivatives, false);
            }
        }
    }
}

struct Lift<'a> {
    maps: &'a FaceMaps,
    tensors: usize,
    both: bool,
    terms: &'a [Pack],
    coefficients: &'a mut [Pack],
}

impl WithSimd for Lift<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for number in 0..2 * self.maps.dimension {
            let face = self.maps.face(number, self.tensors);
            let (values, derivatives) = self.terms[face.start..face.start + 2 * face.kind_len].split_at(face.kind_len);
            for o in 0..face.outer {
                for i in 0..face.inner {
                    let node = &mut self.coefficients[(o * face.n + face.end) * face.inner + i];
                    for part in 0..Lanes::<S>::PARTS {
                        let sum = Lanes::read(simd, node, part) + Lanes::read(simd, &values[o * face.inner + i], part);
                        sum.write(node, part);
                    }
                }
            }
            if self.both {
                contract(simd, face.along(face.column), derivatives, self.coefficients, true);
            }
        }
    }
}

/// Traces of all cells for one set of coefficients.
pub struct Traces {
    /// Their layout.
    pub layout: TraceLayout,
    /// The numbers.
    pub data: Vec<f64>,
    /// The coefficients, `[batch][slot][component][node]`.
    packs: Vec<Pack>,
    /// Traces of one batch.
    scratch: PerThread<Vec<Pack>>,
}

impl Traces {
    /// Memory for the traces of `cells` cells.
    pub fn new(layout: TraceLayout, cells: usize) -> Self {
        let packs = zeroed(cells.div_ceil(WIDTH) * layout.coefficients());
        let scratch = PerThread::new(|| zeroed(layout.cell_len()));
        Traces { layout, data: vec![0.0; cells * layout.cell_len()], packs, scratch }
    }

    /// Computes the traces of `coefficients[cell][slot][component][node]`; derivatives only if `both`. If the coefficients are those of the
    /// first cells alone, the traces of the others are without meaning.
    pub fn take(&mut self, maps: &FaceMaps, coefficients: &[f64], both: bool) {
        let Traces { layout, ref mut data, ref mut packs, ref scratch, .. } = *self;
        let len = layout.coefficients();
        let cells = coefficients.len() / len;
        let batches = data.par_chunks_mut(WIDTH * layout.cell_len()).zip(packs.par_chunks_mut(len));
        batches.take(cells.div_ceil(WIDTH)).enumerate().with_max_len(BATCHES_PER_TASK).for_each(
            |(batch, (data, packs))| {
                scratch.with(|traces| {
                    gather(cells_of(batch, cells).map(|cell| &coefficients[cell * len..(cell + 1) * len]), packs);
                    maps.extract(layout.slots * layout.components, packs, both, traces);
                    scatter(traces, layout.cell_len(), data);
                });
            },
        );
    }

    /// The coefficients of a batch of cells, `[slot][component][node]`.
    pub fn coefficients(&self, batch: usize) -> &[Pack] {
        let len = self.layout.coefficients();
        &self.packs[batch * len..(batch + 1) * len]
    }

    /// The coefficients of a cell, `[slot][component][node]`.
    pub fn coefficients_of(&self, cell: usize) -> impl Iterator<Item = f64> {
        self.coefficients(cell / WIDTH).iter().map(move |pack| pack.0[cell % WIDTH])
    }

    /// All traces on one face, derivatives only if `both`.
    pub fn on_face(&self, side: Side, both: bool) -> &[f64] {
        let start = self.layout.start(side.cell, side.face, 0);
        &self.data[start..start + self.layout.kind_len() * if both { 2 } else { 1 }]
    }

    /// The same, to be written.
    pub fn on_face_mut(&mut self, side: Side, both: bool) -> &mut [f64] {
        let start = self.layout.start(side.cell, side.face, 0);
        &mut self.data[start..start + self.layout.kind_len() * if both { 2 } else { 1 }]
    }

    /// One kind on one face.
    pub fn of(&self, cell: usize, face: usize, kind: usize) -> &[f64] {
        let start = self.layout.start(cell, face, kind);
        &self.data[start..start + self.layout.kind_len()]
    }
}
