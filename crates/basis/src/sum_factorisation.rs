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
fn in_shares<S: Simd>(
    simd: S,
    matrix: &Matrix,
    outer: usize,
    inner: usize,
    input: &[Pack],
    output: &mut [Pack],
    add: bool,
) {
    let shares = matrix.cols().div_ceil(MOST_COLUMNS).max(1);
    for share in 0..shares {
        let first = share * matrix.cols() / shares;
        let columns = (share + 1) * matrix.cols() / shares - first;
        let shape = Shape { matrix, first, outer, inner };
        if add || share > 0 {
            contract_columns::<S, true>(simd, columns, shape, input, output);
        } else {
            contract_columns::<S, false>(simd, columns, shape, input, output);
        }
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
}

fn contract_columns<S: Simd, const ADD: bool>(
    simd: S,
    columns: usize,
    shape: Shape<'_>,
    input: &[Pack],
    output: &mut [Pack],
) {
    macro_rules! kernel_of {
        ($($n:literal)*) => {
            match columns {
                $($n => simd.vectorize(Kernel::<$n, ADD> { shape, input, output }),)*
                _ => unreachable!("a share has at most {MOST_COLUMNS} columns"),
            }
        };
    }
    kernel_of!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
}

/// The contraction over N columns, compiled for one instruction set.
struct Kernel<'a, const N: usize, const ADD: bool> {
    shape: Shape<'a>,
    input: &'a [Pack],
    output: &'a mut [Pack],
}

impl<const N: usize, const ADD: bool> WithSimd for Kernel<'_, N, ADD> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Shape { matrix, first, outer, inner } = self.shape;
        for o in 0..outer {
            let input = &self.input[(o * matrix.cols() + first) * inner..][..N * inner];
            let output = &mut self.output[o * matrix.rows() * inner..][..matrix.rows() * inner];
            for i in 0..inner {
                for part in 0..Lanes::<S>::PARTS {
                    multiply::<S, N, ADD>(simd, self.shape, input, output, i, part);
                }
            }
        }
    }
}

/// `output[r][i] = sum_c matrix[r][c] x[c]`, where `x[c] = input[c][i]` stays in registers. The rows are independent of each
/// other: the processor overlaps them by itself, and taking several at once only crowds the registers.
#[inline(always)]
fn multiply<S: Simd, const N: usize, const ADD: bool>(
    simd: S,
    shape: Shape<'_>,
    input: &[Pack],
    output: &mut [Pack],
    i: usize,
    part: usize,
) {
    let Shape { matrix, first, inner, .. } = shape;
    let mut x = [Lanes::splat(simd, 0.0); N];
    for c in 0..N {
        x[c] = Lanes::read(simd, &input[c * inner + i], part);
    }
    for r in 0..matrix.rows() {
        let row = &matrix.values()[r * matrix.cols() + first..][..N];
        let output = &mut output[r * inner + i];
        let mut sum = if ADD { Lanes::read(simd, output, part) } else { Lanes::splat(simd, 0.0) };
        for c in 0..N {
            sum = Lanes::splat(simd, row[c]).mul_add(x[c], sum);
        }
        sum.write(output, part);
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
