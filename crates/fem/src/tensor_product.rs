//! Values and gradients of tensor-product polynomials at quadrature points, and their transposes, in packs of cells.
//!
//! Kernels and plain code may call these functions: their loops enter the instruction set of `simd` by themselves. They are compiled once and
//! not into every kernel, whose compilation would take much longer.

use crate::tables::Shape1d;
use basis::{AlongAxis, Matrix, contract};
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack};

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

    /// [`basis::contract`], counted. The identity costs a copy.
    pub(crate) fn contract<S: Simd>(
        &mut self,
        simd: S,
        along: AlongAxis,
        input: &[Pack],
        output: &mut [Pack],
        add: bool,
    ) {
        let AlongAxis { matrix, outer, inner } = along;
        if is_identity(matrix) {
            return add_or_set(simd, &input[..outer * matrix.rows() * inner], output, add);
        }
        self.multiplications += multiplications(along);
        contract(simd, along, input, output, add);
    }
}

/// Whether a matrix is the identity: the map to points that are nodes.
fn is_identity(matrix: &Matrix) -> bool {
    let n = matrix.rows();
    let entries = || matrix.values().iter().enumerate();
    n == matrix.cols() && entries().all(|(k, value)| *value == if k % (n + 1) == 0 { 1.0 } else { 0.0 })
}

/// Multiplications of packs in one contraction.
fn multiplications(AlongAxis { matrix, outer, inner }: AlongAxis) -> usize {
    matrix.rows() * matrix.cols() * outer * inner
}

/// Fields at the quadrature points: `values[component][point]`, `gradients[direction][component][point]`, or both. A kernel reads or
/// writes no others.
pub enum AtPoints<P> {
    /// Values only.
    Values(P),
    /// Derivatives along the reference axes only.
    Gradients(P),
    /// Values and gradients.
    Both(P, P),
}

impl<P: Default> AtPoints<P> {
    /// Values, and gradients if `with_gradients`.
    #[inline(always)]
    pub fn new(values: P, gradients: P, with_gradients: bool) -> Self {
        if with_gradients { AtPoints::Both(values, gradients) } else { AtPoints::Values(values) }
    }

    /// Whether there are values and gradients, then these.
    #[inline(always)]
    fn parts(self) -> ([bool; 2], P, P) {
        match self {
            AtPoints::Values(values) => ([true, false], values, P::default()),
            AtPoints::Gradients(gradients) => ([false, true], P::default(), gradients),
            AtPoints::Both(values, gradients) => ([true, true], values, gradients),
        }
    }
}

/// One-dimensional matrices along the axes of a tensor product, for fields of some components.
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
    /// Components of a field.
    pub components: usize,
}

impl<'a> Lattice<'a> {
    /// The same matrices along all axes.
    #[inline(always)]
    pub fn whole(line: &'a Shape1d, dimension: usize, components: usize) -> Self {
        Lattice { line, last: line, dimension, components }
    }

    /// Coefficients of a field.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.components * self.line.order.pow(self.dimension as u32)
    }

    /// Whether the points are the nodes.
    #[inline(always)]
    fn is_nodal(&self) -> bool {
        self.line.is_nodal && self.last.is_nodal
    }

    /// A matrix along `axis` of fields whose points are the nodes.
    #[inline(always)]
    pub(crate) fn along<'m>(&self, axis: usize, matrix: &'m Matrix) -> AlongAxis<'m> {
        let n = self.line.order;
        let outer = self.components * n.pow((self.dimension - 1 - axis) as u32);
        AlongAxis { matrix, outer, inner: n.pow(axis as u32) }
    }

    /// The pass along `axis`: its matrices, entries outside and inside of the axis, packs before and after. Axes above are at the points
    /// already, axes below at the nodes still.
    #[inline(always)]
    fn pass(&self, axis: usize) -> Pass<'a> {
        let (n, q) = (self.line.order, self.line.values.rows());
        let is_last = axis + 1 == self.dimension;
        let above = if is_last { 1 } else { self.last.values.rows() * q.pow((self.dimension - 2 - axis) as u32) };
        let line = if is_last { self.last } else { self.line };
        let (outer, inner) = (self.components * above, n.pow(axis as u32));
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

/// Values and reference derivatives at the quadrature points, of `nodal[component][node]`.
pub fn evaluate<S: Simd>(simd: S, lattice: Lattice, nodal: &[Pack], to: AtPoints<&mut [Pack]>, scratch: &mut Scratch) {
    let dimension = lattice.dimension;
    let ([with_values, with_gradients], values, gradients) = to.parts();
    if lattice.is_nodal() {
        let len = lattice.len();
        if with_values {
            values[..len].copy_from_slice(&nodal[..len]);
        }
        for axis in 0..(if with_gradients { dimension } else { 0 }) {
            let derivatives = lattice.along(axis, &lattice.line.derivatives);
            scratch.contract(simd, derivatives, nodal, &mut gradients[axis * len..], false);
        }
        return;
    }
    // Number 0 of the present tensors holds values, the others hold derivatives; the derivative along the axis just
    // passed is the last.
    let Scratch { even: from, odd: to, multiplications: count } = scratch;
    let (mut from, mut to) = (from, to);
    for axis in (0..dimension).rev() {
        let Pass { line, outer, inner, nodal: size_in, at_points: size_out } = lattice.pass(axis);
        let (passed, last) = (dimension - 1 - axis, axis == 0);
        for tensor in 0..=(if with_gradients { passed + 1 } else { 0 }) {
            let differentiated = tensor == passed + 1;
            let source = if differentiated { 0 } else { tensor };
            let matrix = if differentiated { &line.derivatives } else { &line.values };
            if last && tensor == 0 && !with_values {
                continue;
            }
            let input = if passed == 0 { &nodal[..size_in] } else { &from[source * size_in..(source + 1) * size_in] };
            let output = match (last, tensor) {
                (false, _) => &mut to[tensor * size_out..(tensor + 1) * size_out],
                (true, 0) => &mut values[..size_out],
                // Tensor t is differentiated along axis D - t.
                (true, _) => &mut gradients[(dimension - tensor) * size_out..(dimension - tensor + 1) * size_out],
            };
            let along = AlongAxis { matrix, outer, inner };
            *count += multiplications(along);
            contract(simd, along, input, output, false);
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// The transpose of [`evaluate`]: `nodal[component][node]` is the sum over points of the values times the test function and of the
/// gradients times its reference derivatives; with `add`, that is added to it.
pub fn integrate<S: Simd>(
    simd: S,
    lattice: Lattice,
    from: AtPoints<&[Pack]>,
    nodal: &mut [Pack],
    scratch: &mut Scratch,
    add: bool,
) {
    let dimension = lattice.dimension;
    let ([with_values, with_gradients], values, gradients) = from.parts();
    if lattice.is_nodal() {
        let len = lattice.len();
        if with_values {
            add_or_set(simd, &values[..len], nodal, add);
        }
        for axis in 0..(if with_gradients { dimension } else { 0 }) {
            let derivatives = lattice.along(axis, &lattice.line.derivatives_transposed);
            scratch.contract(simd, derivatives, &gradients[axis * len..], nodal, add || with_values || axis > 0);
        }
        return;
    }
    let Scratch { even: from, odd: to, multiplications: count } = scratch;
    let (mut from, mut to) = (from, to);
    // From the first axis to the last: derivative tensors of higher axes stay separate; the derivative along `axis` is added
    // to the values.
    for axis in 0..dimension {
        let Pass { line, outer, inner, nodal: size_out, at_points: size_in } = lattice.pass(axis);
        let (first, last) = (axis == 0, axis + 1 == dimension);
        let derivative = |tensor: usize| &gradients[(axis + tensor) * size_in..(axis + tensor + 1) * size_in];
        for tensor in 0..=(if with_gradients { dimension - 1 - axis } else { 0 }) {
            let output =
                if last { &mut nodal[..size_out] } else { &mut to[tensor * size_out..(tensor + 1) * size_out] };
            let mut joins = last && add;
            if !first || tensor > 0 || with_values {
                let input = match (first, tensor) {
                    (true, 0) => &values[..size_in],
                    (true, _) => derivative(tensor),
                    // Tensor 1 before the pass along the axis below was added to tensor 0 there.
                    (false, 0) => &from[..size_in],
                    (false, _) => &from[(tensor + 1) * size_in..(tensor + 2) * size_in],
                };
                let along = AlongAxis { matrix: &line.values_transposed, outer, inner };
                *count += multiplications(along);
                contract(simd, along, input, output, joins);
                joins = true;
            }
            if tensor == 0 && with_gradients {
                let input = if first { derivative(0) } else { &from[size_in..2 * size_in] };
                let along = AlongAxis { matrix: &line.derivatives_transposed, outer, inner };
                *count += multiplications(along);
                contract(simd, along, input, output, joins);
            }
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// out += values or out := values
fn add_or_set<S: Simd>(simd: S, values: &[Pack], out: &mut [Pack], add: bool) {
    if add { simd.vectorize(Add { values, out }) } else { out[..values.len()].copy_from_slice(values) }
}

struct Add<'a> {
    values: &'a [Pack],
    out: &'a mut [Pack],
}

impl WithSimd for Add<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for (out, value) in self.out.iter_mut().zip(self.values) {
            for part in 0..Lanes::<S>::PARTS {
                (Lanes::read(simd, out, part) + Lanes::read(simd, value, part)).write(out, part);
            }
        }
    }
}
