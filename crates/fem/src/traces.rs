//! Traces of cell coefficients on faces, and the transposed map.

use crate::batches::{BATCHES_PER_TASK, cells_of};
use crate::gather::{gather, scatter};
use crate::per_thread::PerThread;
use crate::tables::Shape1d;
use basis::{AlongAxis, Matrix, contract};
use mesh::{Side, axis_and_side, face_nodes};
use rayon::prelude::*;
use std::ops::Range;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, WIDTH, zeroed};

/// The layout of the traces of a set of cell coefficients, `[slot][component][face node]` for each kind.
///
/// Kind 0 is values on the face's lattice: they are the coefficients of nodes. Kind 1 is derivatives along the reference axis that leaves
/// the face; only viscous laws and the mesh need them. Slots are time nodes of the flow, or bottom position and velocities of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct TraceLayout {
    /// Faces of a cell, 2 D.
    pub faces: usize,
    /// Kinds in use, 1 or 2.
    pub kinds: usize,
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
    /// The layout of `kinds` of traces of nodal coefficients of `order` in `D` dimensions.
    pub fn new<const D: usize>(kinds: usize, [slots, components]: [usize; 2], order: usize) -> Self {
        let (nodes, face_nodes) = (order.pow(D as u32), order.pow(D as u32 - 1));
        TraceLayout { faces: 2 * D, kinds, slots, components, nodes, face_nodes }
    }
    /// Length of one kind on one face.
    pub fn kind_len(&self) -> usize {
        self.slots * self.components * self.face_nodes
    }
    /// Length of all kinds in use on one face.
    pub fn face_len(&self) -> usize {
        self.kinds * self.kind_len()
    }
    /// Length of the derivatives on all faces of one cell; zero if the layout has none.
    pub fn derivatives_len(&self) -> usize {
        (self.kinds - 1) * self.faces * self.kind_len()
    }
    /// Number of coefficients of one cell.
    pub fn coefficients(&self) -> usize {
        self.slots * self.components * self.nodes
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

    /// The derivatives of the tensors `coefficients[slot and component][node]` on all faces, `[face][slot and component][face node]`.
    pub fn derivatives(&self, tensors: usize, coefficients: &[Pack], derivatives: &mut [Pack]) {
        self.arch.dispatch(Derivatives { maps: self, tensors, coefficients, derivatives });
    }

    /// The transpose of the traces on all faces: adds terms tested with traces, `[face][kind][slot and component][face node]`, to terms
    /// tested with cell functions.
    pub fn lift(&self, tensors: usize, terms: &[Pack], kinds: usize, coefficients: &mut [Pack]) {
        self.arch.dispatch(Lift { maps: self, tensors, kinds, terms, coefficients });
    }

    fn face(&self, face: usize, tensors: usize) -> Face<'_> {
        let (axis, side) = axis_and_side(face);
        let (n, inner) = (self.order, self.order.pow(axis as u32));
        let outer = tensors * n.pow((self.dimension - 1 - axis) as u32);
        let kind_len = outer * inner;
        let end = if side == 0 { 0 } else { n - 1 };
        Face { n, end, outer, inner, kind_len, row: &self.rows[side], column: &self.columns[side] }
    }
}

/// One face and the lines of a cell's tensors that leave it: `outer` times `inner` lines of `n` nodes.
struct Face<'a> {
    n: usize,
    /// The end of the lines at the face.
    end: usize,
    outer: usize,
    inner: usize,
    /// The number of traces of a kind.
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

struct Derivatives<'a> {
    maps: &'a FaceMaps,
    tensors: usize,
    coefficients: &'a [Pack],
    derivatives: &'a mut [Pack],
}

impl WithSimd for Derivatives<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for number in 0..2 * self.maps.dimension {
            let face = self.maps.face(number, self.tensors);
            let derivatives = &mut self.derivatives[number * face.kind_len..(number + 1) * face.kind_len];
            contract(simd, face.along(face.row), self.coefficients, derivatives, false);
        }
    }
}

struct Lift<'a> {
    maps: &'a FaceMaps,
    tensors: usize,
    kinds: usize,
    terms: &'a [Pack],
    coefficients: &'a mut [Pack],
}

impl WithSimd for Lift<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for number in 0..2 * self.maps.dimension {
            let face = self.maps.face(number, self.tensors);
            let len = self.kinds * face.kind_len;
            let (values, derivatives) = self.terms[number * len..(number + 1) * len].split_at(face.kind_len);
            for o in 0..face.outer {
                for i in 0..face.inner {
                    let node = &mut self.coefficients[(o * face.n + face.end) * face.inner + i];
                    for part in 0..Lanes::<S>::PARTS {
                        let sum = Lanes::read(simd, node, part) + Lanes::read(simd, &values[o * face.inner + i], part);
                        sum.write(node, part);
                    }
                }
            }
            if self.kinds > 1 {
                contract(simd, face.along(face.column), derivatives, self.coefficients, true);
            }
        }
    }
}

/// The traces of a set of cell coefficients that are not among its coefficients: the derivatives.
pub struct Traces {
    /// Their layout.
    pub layout: TraceLayout,
    /// `[cell][face][slot][component][face node]`.
    derivatives: Vec<f64>,
    /// Coefficients and derivatives of one batch.
    scratch: PerThread<[Vec<Pack>; 2]>,
}

impl Traces {
    /// Memory for the traces of `cells` cells.
    pub fn new(layout: TraceLayout, cells: usize) -> Self {
        let scratch = match layout.kinds {
            1 => PerThread::new(Default::default),
            _ => PerThread::new(|| [zeroed(layout.coefficients()), zeroed(layout.derivatives_len())]),
        };
        Traces { layout, derivatives: vec![0.0; cells * layout.derivatives_len()], scratch }
    }

    /// Computes the derivatives of `coefficients[cell][slot][component][node]`, if the layout has any. If the coefficients are those of
    /// the first cells alone, the derivatives of the others are without meaning.
    pub fn take(&mut self, maps: &FaceMaps, coefficients: &[f64]) {
        let Traces { layout, ref mut derivatives, ref scratch } = *self;
        let (len, derivatives_len) = (layout.coefficients(), layout.derivatives_len());
        if derivatives_len == 0 {
            return;
        }
        let cells = coefficients.len() / len;
        let batches = derivatives.par_chunks_mut(WIDTH * derivatives_len).take(cells.div_ceil(WIDTH)).enumerate();
        batches.with_max_len(BATCHES_PER_TASK).for_each(|(batch, out)| {
            scratch.with(|[packs, derivatives]| {
                gather(cells_of(batch, cells).map(|cell| &coefficients[cell * len..(cell + 1) * len]), packs);
                maps.derivatives(layout.slots * layout.components, packs, derivatives);
                scatter(derivatives, derivatives_len, out);
            });
        });
    }

    /// The derivatives on one face, `[slot][component][face node]`; empty if the layout has none.
    pub fn derivatives_on(&self, side: Side) -> &[f64] {
        &self.derivatives[self.range_of(side)]
    }

    /// The same, to be written.
    pub fn derivatives_on_mut(&mut self, side: Side) -> &mut [f64] {
        let range = self.range_of(side);
        &mut self.derivatives[range]
    }

    fn range_of(&self, side: Side) -> Range<usize> {
        let len = (self.layout.kinds - 1) * self.layout.kind_len();
        let start = side.cell * self.layout.derivatives_len() + side.face * len;
        start..start + len
    }
}

/// Coefficients with their traces.
#[derive(Clone, Copy)]
pub struct Traced<'a> {
    /// Those of own cells, perhaps followed by those of ghosts, `[cell][slot][component][node]`.
    pub coefficients: &'a [f64],
    /// Those of ghosts that do not follow there.
    pub ghosts: &'a [f64],
    /// The derivatives.
    pub traces: &'a Traces,
}

impl<'a> Traced<'a> {
    /// The coefficients of a cell, `[slot][component][node]`.
    pub fn cell(&self, cell: usize) -> &'a [f64] {
        let len = self.traces.layout.coefficients();
        let own = self.coefficients.len() / len;
        match cell < own {
            true => &self.coefficients[cell * len..(cell + 1) * len],
            false => &self.ghosts[(cell - own) * len..(cell - own + 1) * len],
        }
    }

    /// The coefficients of `nodes` of a cell, `[slot][component][number of the node]`.
    pub fn values_on(&self, cell: usize, nodes: &'a [usize]) -> impl Iterator<Item = f64> {
        let tensors = self.cell(cell).chunks_exact(self.traces.layout.nodes);
        tensors.flat_map(move |tensor| nodes.iter().map(move |&node| tensor[node]))
    }
}
