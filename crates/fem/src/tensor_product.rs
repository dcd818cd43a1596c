//! Values and gradients of tensor-product polynomials at quadrature points, and their transposes, in packs of cells.

use crate::tables::Shape1d;
use basis::{Matrix, contract};
use tensor::Pack;
use tensor::pulp::Simd;

/// Memory for the intermediate tensors of [`evaluate`] and [`integrate`].
#[derive(Default)]
pub struct Scratch {
    even: Vec<Pack>,
    odd: Vec<Pack>,
    /// The number of multiplications of packs so far, in all contractions with this scratch.
    pub multiplications: usize,
}

impl Scratch {
    /// Memory for `components` tensors with gradients in `dimension` directions, up to `n` entries per direction.
    pub fn new(dimension: usize, components: usize, n: usize) -> Self {
        let len = (dimension + 1) * components * n.pow(dimension as u32);
        Scratch { even: tensor::zeroed(len), odd: tensor::zeroed(len), multiplications: 0 }
    }

    /// [`basis::contract`], counted.
    #[inline(always)]
    pub(crate) fn contract<S: Simd>(
        &mut self,
        simd: S,
        matrix: &Matrix,
        outer: usize,
        inner: usize,
        input: &[Pack],
        output: &mut [Pack],
        add: bool,
    ) {
        self.multiplications += multiplications(matrix, outer, inner);
        contract(simd, matrix, outer, inner, input, output, add);
    }
}

/// Multiplications of packs in one contraction.
fn multiplications(matrix: &Matrix, outer: usize, inner: usize) -> usize {
    matrix.rows() * matrix.cols() * outer * inner
}

/// The quantities to evaluate or to integrate against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvaluationFlags {
    /// Values only.
    Values,
    /// Derivatives only.
    Gradients,
    /// Both.
    Both,
}

/// One-dimensional matrices along the axes of a tensor product.
///
/// The points may be part of a lattice: as many planes of it as fit into the cache. Then `last` holds the rows of the last
/// axis that belong to them.
#[derive(Clone, Copy)]
pub struct Lattice<'a> {
    /// Along all axes but the last.
    pub line: &'a Shape1d,
    /// Along the last axis.
    pub last: &'a Shape1d,
    /// Number of axes.
    pub dimension: usize,
}

impl<'a> Lattice<'a> {
    /// The same matrices along all axes.
    #[inline(always)]
    pub fn whole(line: &'a Shape1d, dimension: usize) -> Self {
        Lattice { line, last: line, dimension }
    }

    /// Nodes of a tensor.
    #[inline(always)]
    pub fn nodes(&self) -> usize {
        self.line.order.pow(self.dimension as u32)
    }

    /// The pass along `axis` for `components`: its matrices, the numbers of entries outside and inside the axis, and the
    /// packs before and after. Higher axes are already at the points, lower axes still at the nodes.
    #[inline(always)]
    fn pass(&self, axis: usize, components: usize) -> Pass<'a> {
        let (n, q) = (self.line.order, self.line.values.rows());
        let is_last = axis + 1 == self.dimension;
        let above = if is_last { 1 } else { self.last.values.rows() * q.pow((self.dimension - 2 - axis) as u32) };
        let line = if is_last { self.last } else { self.line };
        let (outer, inner) = (components * above, n.pow(axis as u32));
        Pass { line, outer, inner, nodal: outer * n * inner, at_points: outer * line.values.rows() * inner }
    }
}

struct Pass<'a> {
    line: &'a Shape1d,
    outer: usize,
    inner: usize,
    /// Packs of a tensor that is nodal along this axis.
    nodal: usize,
    /// Packs of a tensor that is at the points along this axis.
    at_points: usize,
}

/// Values and reference derivatives at the quadrature points.
///
/// `nodal[component][node]` gives `values[component][point]` and `gradients[direction][component][point]`. A slice that `parts`
/// leaves out is not touched and may be empty.
#[inline(always)]
pub fn evaluate<S: Simd>(
    simd: S,
    lattice: Lattice,
    components: usize,
    parts: EvaluationFlags,
    nodal: &[Pack],
    values: &mut [Pack],
    gradients: &mut [Pack],
    scratch: &mut Scratch,
) {
    let (dimension, with_gradients) = (lattice.dimension, parts != EvaluationFlags::Values);
    // Number 0 of the present tensors holds values, the others hold derivatives; the derivative along the axis just
    // passed is the last.
    let Scratch { even: from, odd: to, multiplications: count } = scratch;
    let (mut from, mut to) = (from, to);
    for axis in (0..dimension).rev() {
        let Pass { line, outer, inner, nodal: size_in, at_points: size_out } = lattice.pass(axis, components);
        let (passed, last) = (dimension - 1 - axis, axis == 0);
        for tensor in 0..=(if with_gradients { passed + 1 } else { 0 }) {
            let differentiated = tensor == passed + 1;
            let source = if differentiated { 0 } else { tensor };
            let matrix = if differentiated { &line.derivatives } else { &line.values };
            if last && tensor == 0 && parts == EvaluationFlags::Gradients {
                continue;
            }
            let input = if passed == 0 { &nodal[..size_in] } else { &from[source * size_in..(source + 1) * size_in] };
            let output = match (last, tensor) {
                (false, _) => &mut to[tensor * size_out..(tensor + 1) * size_out],
                (true, 0) => &mut values[..size_out],
                // Tensor t is differentiated along axis D - t.
                (true, _) => &mut gradients[(dimension - tensor) * size_out..(dimension - tensor + 1) * size_out],
            };
            *count += multiplications(matrix, outer, inner);
            contract(simd, matrix, outer, inner, input, output, false);
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// The transpose of [`evaluate`]: `nodal[component][node]` is a sum over points. Its terms are `values[component][point]` times the
/// test function, and `gradients[direction][component][point]` times its reference derivative in that direction. With `add` the sum is
/// added to `nodal`.
#[inline(always)]
pub fn integrate<S: Simd>(
    simd: S,
    lattice: Lattice,
    components: usize,
    parts: EvaluationFlags,
    values: &[Pack],
    gradients: &[Pack],
    nodal: &mut [Pack],
    scratch: &mut Scratch,
    add: bool,
) {
    let (dimension, with_gradients) = (lattice.dimension, parts != EvaluationFlags::Values);
    let Scratch { even: from, odd: to, multiplications: count } = scratch;
    let (mut from, mut to) = (from, to);
    // From the first axis to the last: derivative tensors of higher axes stay separate; the derivative along `axis` is added
    // to the values.
    for axis in 0..dimension {
        let Pass { line, outer, inner, nodal: size_out, at_points: size_in } = lattice.pass(axis, components);
        let (first, last) = (axis == 0, axis + 1 == dimension);
        let derivative = |tensor: usize| &gradients[(axis + tensor) * size_in..(axis + tensor + 1) * size_in];
        for tensor in 0..=(if with_gradients { dimension - 1 - axis } else { 0 }) {
            let output =
                if last { &mut nodal[..size_out] } else { &mut to[tensor * size_out..(tensor + 1) * size_out] };
            let mut joins = last && add;
            if !(first && tensor == 0 && parts == EvaluationFlags::Gradients) {
                let input = match (first, tensor) {
                    (true, 0) => &values[..size_in],
                    (true, _) => derivative(tensor),
                    // Tensor 1 before the pass along the axis below was added to tensor 0 there.
                    (false, 0) => &from[..size_in],
                    (false, _) => &from[(tensor + 1) * size_in..(tensor + 2) * size_in],
                };
                *count += multiplications(&line.values_transposed, outer, inner);
                contract(simd, &line.values_transposed, outer, inner, input, output, joins);
                joins = true;
            }
            if tensor == 0 && with_gradients {
                let input = if first { derivative(0) } else { &from[size_in..2 * size_in] };
                *count += multiplications(&line.derivatives_transposed, outer, inner);
                contract(simd, &line.derivatives_transposed, outer, inner, input, output, joins);
            }
        }
        std::mem::swap(&mut from, &mut to);
    }
}
