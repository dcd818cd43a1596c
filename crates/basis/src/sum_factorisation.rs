//! One matrix along one axis of a batched tensor: the primitive of every operator.

use crate::Matrix;
use pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real};

/// `output[o][r][i] = sum_c matrix[r][c] input[o][c][i]` for o < `outer`, i < `inner`, with i fastest.
///
/// `input` holds at least outer * cols * inner packs, `output` outer * rows * inner. Called from a kernel or from plain
/// code alike: it enters the instruction set of `simd` by itself, and each number of columns is compiled once.
pub fn contract<S: Simd>(simd: S, matrix: &Matrix, outer: usize, inner: usize, input: &[Pack], output: &mut [Pack]) {
    in_shares(simd, matrix, outer, inner, input, output, false);
}

/// As [`contract`], but added to `output`.
pub fn contract_add<S: Simd>(
    simd: S,
    matrix: &Matrix,
    outer: usize,
    inner: usize,
    input: &[Pack],
    output: &mut [Pack],
) {
    in_shares(simd, matrix, outer, inner, input, output, true);
}

/// The most columns whose input is kept in registers.
const MOST_COLUMNS: usize = 16;

/// Takes more columns than that in equal shares: the first as asked, the others added.
#[inline]
fn in_shares<S: Simd>(
    simd: S,
    matrix: &Matrix,
    outer: usize,
    inner: usize,
    input: &[Pack],
    output: &mut [Pack],
    add: bool,
) {
    let whole = Shape { matrix, first: 0, outer, inner, add };
    if matrix.cols() <= MOST_COLUMNS {
        return contract_columns(simd, matrix.cols(), whole, input, output);
    }
    let shares = matrix.cols().div_ceil(MOST_COLUMNS);
    for share in 0..shares {
        let first = share * matrix.cols() / shares;
        let columns = (share + 1) * matrix.cols() / shares - first;
        contract_columns(simd, columns, Shape { first, add: add || share > 0, ..whole }, input, output);
    }
}

/// What is contracted with what, apart from the data.
#[derive(Clone, Copy)]
struct Shape<'a> {
    matrix: &'a Matrix,
    /// The first of the columns that are taken.
    first: usize,
    outer: usize,
    inner: usize,
    /// Whether to add to the output. No type, or every kernel would be compiled twice.
    add: bool,
}

#[inline]
fn contract_columns<S: Simd>(simd: S, columns: usize, shape: Shape<'_>, input: &[Pack], output: &mut [Pack]) {
    macro_rules! kernel_of {
        ($($n:literal)*) => {
            match columns {
                $($n => simd.vectorize(Kernel::<$n> { shape, input, output }),)*
                _ => unreachable!("a share has at most {MOST_COLUMNS} columns"),
            }
        };
    }
    kernel_of!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
}

/// The contraction over N columns, compiled for one instruction set.
struct Kernel<'a, const N: usize> {
    shape: Shape<'a>,
    input: &'a [Pack],
    output: &'a mut [Pack],
}

impl<const N: usize> WithSimd for Kernel<'_, N> {
    type Output = ();
    /// As many lines at a time as leave registers for their sums and an entry of the matrix, which is then read once for all.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Kernel { shape, input, output } = self;
        let registers = S::REGISTER_COUNT;
        if 8 * (N + 1) < registers {
            lines::<S, N, 8>(simd, shape, input, output);
        } else if 4 * (N + 1) < registers {
            lines::<S, N, 4>(simd, shape, input, output);
        } else if 3 * (N + 1) < registers {
            lines::<S, N, 3>(simd, shape, input, output);
        } else if 2 * (N + 1) < registers {
            lines::<S, N, 2>(simd, shape, input, output);
        } else {
            lines::<S, N, 1>(simd, shape, input, output);
        }
    }
}

/// All lines along the contracted axis, B at a time: neighbours in i, and where i has fewer values than that, neighbours in o.
#[inline(always)]
fn lines<S: Simd, const N: usize, const B: usize>(simd: S, shape: Shape<'_>, input: &[Pack], output: &mut [Pack]) {
    let Shape { matrix, first, outer, inner, .. } = shape;
    let (rows, cols) = (matrix.rows(), matrix.cols());
    let (length_in, length_out) = (cols * inner, rows * inner);
    let together = if inner < B { outer - outer % B } else { 0 };
    for o in (0..together).step_by(B) {
        for i in 0..inner {
            let (input, output) = (&input[o * length_in + first * inner..], &mut output[o * length_out..]);
            multiply::<S, N, B>(simd, shape, i, input, length_in, output, length_out);
        }
    }
    for o in together..outer {
        let input = &input[o * length_in + first * inner..];
        let output = &mut output[o * length_out..];
        let whole = inner - inner % B;
        for i in (0..whole).step_by(B) {
            multiply::<S, N, B>(simd, shape, i, input, 1, output, 1);
        }
        for i in whole..inner {
            multiply::<S, N, 1>(simd, shape, i, input, 1, output, 1);
        }
    }
}

/// `output[r] = sum_c matrix[r][c] x[c]` for B lines from line `i`, `apart_in` and `apart_out` from each other, whose x stay in registers. The
/// rows are independent of each other: the processor overlaps them by itself.
#[inline(always)]
fn multiply<S: Simd, const N: usize, const B: usize>(
    simd: S,
    shape: Shape<'_>,
    i: usize,
    input: &[Pack],
    apart_in: usize,
    output: &mut [Pack],
    apart_out: usize,
) {
    let Shape { matrix, first, inner, add, .. } = shape;
    for part in 0..Lanes::<S>::PARTS {
        let zero = Lanes::splat(simd, 0.0);
        let mut x = [[zero; B]; N];
        for c in 0..N {
            for b in 0..B {
                x[c][b] = Lanes::read(simd, &input[i + c * inner + b * apart_in], part);
            }
        }
        for r in 0..matrix.rows() {
            let (row, output) = (&matrix.values()[r * matrix.cols() + first..][..N], &mut output[i + r * inner..]);
            let mut sums = [zero; B];
            if add {
                for b in 0..B {
                    sums[b] = Lanes::read(simd, &output[b * apart_out], part);
                }
            }
            for c in 0..N {
                let entry = Lanes::splat(simd, row[c]);
                for b in 0..B {
                    sums[b] = entry.mul_add(x[c][b], sums[b]);
                }
            }
            for b in 0..B {
                sums[b].write(&mut output[b * apart_out], part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{self, OnEveryMachine};
    use tensor::WIDTH;

    /// The definition, number by number.
    fn reference(matrix: &Matrix, outer: usize, inner: usize, input: &[Pack], output: &mut [Pack]) {
        for (o, r, i) in testing::triples(outer, matrix.rows(), inner) {
            for lane in 0..WIDTH {
                let term = |c: usize| matrix[(r, c)] * input[(o * matrix.cols() + c) * inner + i].0[lane];
                output[(o * matrix.rows() + r) * inner + i].0[lane] += (0..matrix.cols()).map(term).sum::<f64>();
            }
        }
    }

    struct Both<'a> {
        matrix: &'a Matrix,
        outer: usize,
        inner: usize,
        input: &'a [Pack],
    }

    impl OnEveryMachine for Both<'_> {
        /// Over stale output, and added to it.
        fn run<S: Simd>(&self, simd: S) -> Vec<Pack> {
            let start = testing::packs(self.outer * self.matrix.rows() * self.inner, 7);
            let (mut fresh, mut added) = (start.clone(), start);
            contract(simd, self.matrix, self.outer, self.inner, self.input, &mut fresh);
            contract_add(simd, self.matrix, self.outer, self.inner, self.input, &mut added);
            [fresh, added].concat()
        }
    }

    fn expected(case: &Both<'_>) -> Vec<Pack> {
        let length = case.outer * case.matrix.rows() * case.inner;
        let (mut fresh, mut added) = (tensor::zeroed(length), testing::packs(length, 7));
        reference(case.matrix, case.outer, case.inner, case.input, &mut fresh);
        reference(case.matrix, case.outer, case.inner, case.input, &mut added);
        [fresh, added].concat()
    }

    #[test]
    fn every_size_agrees_with_the_definition_on_every_instruction_set() {
        for (rows, cols) in (0..=34).flat_map(|rows| (0..=34).map(move |cols| (rows, cols))) {
            let matrix = Matrix::from_fn(rows, cols, |r, c| ((r + 3 * c) as f64).sin());
            for (outer, inner) in [(1, 1), (3, 1), (1, 4), (2, 3)] {
                let input = testing::packs(outer * cols * inner, 1);
                let case = Both { matrix: &matrix, outer, inner, input: &input };
                testing::on_every_machine(&case, &expected(&case), 1e-13);
            }
        }
    }
}
