//! Values and gradients of tensor-product polynomials at quadrature points, and their transposes, in packs of cells.

use crate::tables::Line;
use basis::{contract, contract_add};
use tensor::Pack;
use tensor::pulp::Simd;

/// Room for the intermediate tensors of [`evaluate`] and [`integrate`].
#[derive(Default)]
pub struct Scratch {
    even: Vec<Pack>,
    odd: Vec<Pack>,
}

impl Scratch {
    /// Room for `components` tensors with gradients in `dimension` directions, up to `n` entries per direction.
    pub fn new(dimension: usize, components: usize, n: usize) -> Self {
        let len = (dimension + 1) * components * n.pow(dimension as u32);
        Scratch { even: tensor::zeroed(len), odd: tensor::zeroed(len) }
    }
}

/// What to evaluate or to integrate against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// Values only.
    Values,
    /// Derivatives only.
    Gradients,
    /// Both.
    Both,
}

/// Values and reference derivatives at the quadrature points.
///
/// `nodal[component][node]` in `dimension` directions gives `values[component][point]` and
/// `gradients[direction][component][point]`; a slice that `parts` leaves out is not touched and may be empty.
#[inline(always)]
pub fn evaluate<S: Simd>(
    simd: S,
    line: &Line,
    dimension: usize,
    components: usize,
    parts: Parts,
    nodal: &[Pack],
    values: &mut [Pack],
    gradients: &mut [Pack],
    scratch: &mut Scratch,
) {
    let (n, q) = (line.order, line.values.rows());
    // Tensors so far: number 0 holds values, number j the derivative in direction j - 1.
    let Scratch { even: from, odd: to } = scratch;
    let (mut from, mut to) = (from, to);
    let with_gradients = parts != Parts::Values;
    for axis in 0..dimension {
        let inner = q.pow(axis as u32);
        let outer = components * n.pow((dimension - 1 - axis) as u32);
        let (size_in, size_out) = (outer * n * inner, outer * q * inner);
        let last = axis + 1 == dimension;
        for tensor in 0..=(if with_gradients { axis + 1 } else { 0 }) {
            let source = if tensor == axis + 1 { 0 } else { tensor };
            let matrix = if tensor == axis + 1 { &line.derivatives } else { &line.values };
            if last && tensor == 0 && parts == Parts::Gradients {
                continue;
            }
            let input = if axis == 0 { &nodal[..size_in] } else { &from[source * size_in..(source + 1) * size_in] };
            let output = match (last, tensor) {
                (false, _) => &mut to[tensor * size_out..(tensor + 1) * size_out],
                (true, 0) => &mut values[..size_out],
                (true, _) => &mut gradients[(tensor - 1) * size_out..tensor * size_out],
            };
            contract(simd, matrix, outer, inner, input, output);
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// The transpose of [`evaluate`]: adds to `nodal[component][node]` the sum over points of `values[component][point]` times
/// the test function and of `gradients[direction][component][point]` times its reference derivative in that direction.
#[inline(always)]
pub fn integrate<S: Simd>(
    simd: S,
    line: &Line,
    dimension: usize,
    components: usize,
    parts: Parts,
    values: &[Pack],
    gradients: &[Pack],
    nodal: &mut [Pack],
    scratch: &mut Scratch,
) {
    let (n, q) = (line.order, line.values.rows());
    let Scratch { even: from, odd: to } = scratch;
    let (mut from, mut to) = (from, to);
    // From the last axis to the first: derivative tensors of the directions before `axis` stay apart, the one of `axis`
    // joins the values.
    for axis in (0..dimension).rev() {
        let inner = q.pow(axis as u32);
        let outer = components * n.pow((dimension - 1 - axis) as u32);
        let (size_in, size_out) = (outer * q * inner, outer * n * inner);
        let first_pass = axis + 1 == dimension;
        let with_gradients = parts != Parts::Values;
        for tensor in 0..=(if with_gradients { axis } else { 0 }) {
            let output =
                if axis == 0 { &mut nodal[..size_out] } else { &mut to[tensor * size_out..(tensor + 1) * size_out] };
            let mut fresh = axis > 0;
            let missing = first_pass && tensor == 0 && parts == Parts::Gradients;
            if !missing {
                let input = match (first_pass, tensor) {
                    (true, 0) => &values[..size_in],
                    (true, _) => &gradients[(tensor - 1) * size_in..tensor * size_in],
                    (false, _) => &from[tensor * size_in..(tensor + 1) * size_in],
                };
                send(simd, &line.values_transposed, outer, inner, input, output, fresh);
                fresh = false;
            }
            if tensor == 0 && with_gradients {
                let input = if first_pass {
                    &gradients[axis * size_in..(axis + 1) * size_in]
                } else {
                    &from[(axis + 1) * size_in..(axis + 2) * size_in]
                };
                send(simd, &line.derivatives_transposed, outer, inner, input, output, fresh);
            }
        }
        std::mem::swap(&mut from, &mut to);
    }
}

/// Contracts into `output`, overwriting it when it is fresh.
#[inline(always)]
fn send<S: Simd>(
    simd: S,
    matrix: &basis::Matrix,
    outer: usize,
    inner: usize,
    input: &[Pack],
    output: &mut [Pack],
    fresh: bool,
) {
    if fresh {
        contract(simd, matrix, outer, inner, input, output);
    } else {
        contract_add(simd, matrix, outer, inner, input, output);
    }
}
