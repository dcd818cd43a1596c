//! One matrix along one axis of a batched tensor: the primitive of every operator.

use crate::Matrix;
use pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real};

/// A matrix along one axis of a batched tensor, `[outer][axis][inner]` with the last index fastest.
#[derive(Clone, Copy, Debug)]
pub struct AlongAxis<'a> {
    /// The matrix. Its columns belong to the entries of the input along the axis, its rows to those of the output.
    pub matrix: &'a Matrix,
    /// The number of entries outside of the axis: components and slower axes.
    pub outer: usize,
    /// The number of entries inside of the axis: faster axes.
    pub inner: usize,
}

impl<'a> AlongAxis<'a> {
    /// `matrix` along `axis` of a tensor of `components`. `extents` are the extents of the input, axis 0 first; along `axis` the
    /// extent is the number of columns.
    pub fn new(matrix: &'a Matrix, axis: usize, extents: &[usize], components: usize) -> Self {
        let outer = components * extents[axis + 1..].iter().product::<usize>();
        AlongAxis { matrix, outer, inner: extents[..axis].iter().product() }
    }
}

/// `output[o][r][i] = sum_c matrix[r][c] input[o][c][i]` for o < `outer`, i < `inner`, with i fastest. With `add` the sum is added to
/// `output`.
///
/// `input` holds at least outer * cols * inner packs, `output` outer * rows * inner. Kernels and plain code may call it: it enters the
/// instruction set of `simd` by itself, and one compiled function serves every size.
pub fn contract<S: Simd>(simd: S, along: AlongAxis<'_>, input: &[Pack], output: &mut [Pack], add: bool) {
    simd.vectorize(Contraction { along, input, output, add });
}

struct Contraction<'a> {
    along: AlongAxis<'a>,
    input: &'a [Pack],
    output: &'a mut [Pack],
    add: bool,
}

impl WithSimd for Contraction<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Contraction { along: AlongAxis { matrix, outer, inner }, input, output, add } = self;
        if inner == 1 {
            strips::<S, true>(simd, LineBlocks { matrix, blocks: 1, count: outer, add }, input, output);
        } else {
            strips::<S, false>(simd, LineBlocks { matrix, blocks: outer, count: inner, add }, input, output);
        }
    }
}

/// The lines of a tensor along the contracted axis, in blocks, and the matrix.
///
/// In the fastest axis (`IN_LINE` below) the lines of a block lie one after another, and there is one block. In the other axes they lie
/// side by side.
#[derive(Clone, Copy)]
struct LineBlocks<'a> {
    matrix: &'a Matrix,
    blocks: usize,
    /// Lines of a block.
    count: usize,
    add: bool,
}

/// Distributes the rows of the matrix equally over strips of at most five rows. H rows are multiplied with B lines at a time. H and B
/// are chosen such that H B sums, H entries of the matrix and B entries of the lines fit into registers. Then there are few loads and
/// the arithmetic units are busy.
#[inline(always)]
fn strips<S: Simd, const IN_LINE: bool>(simd: S, lines: LineBlocks<'_>, input: &[Pack], output: &mut [Pack]) {
    let many_registers = S::REGISTER_COUNT > 16;
    let rows = lines.matrix.rows();
    let shares = rows.div_ceil(if many_registers { 5 } else { 2 });
    let mut first = 0;
    for share in 0..shares {
        let height = (rows - first).div_ceil(shares - share);
        match (many_registers, height) {
            (true, 5) => strip::<S, IN_LINE, 5, 4>(simd, lines, first, input, output),
            (true, 4) => strip::<S, IN_LINE, 4, 5>(simd, lines, first, input, output),
            (true, 3) => strip::<S, IN_LINE, 3, 6>(simd, lines, first, input, output),
            (true, 2) => strip::<S, IN_LINE, 2, 8>(simd, lines, first, input, output),
            (true, _) => strip::<S, IN_LINE, 1, 8>(simd, lines, first, input, output),
            (false, 2) => strip::<S, IN_LINE, 2, 4>(simd, lines, first, input, output),
            (false, _) => strip::<S, IN_LINE, 1, 4>(simd, lines, first, input, output),
        }
        first += height;
    }
}

/// H rows of the matrix from `first` on, times all lines.
#[inline(always)]
fn strip<S: Simd, const IN_LINE: bool, const H: usize, const B: usize>(
    simd: S,
    lines: LineBlocks<'_>,
    first: usize,
    input: &[Pack],
    output: &mut [Pack],
) {
    let LineBlocks { matrix, blocks, count, .. } = lines;
    let mut rows = [matrix.row(first); H];
    for h in 1..H {
        rows[h] = matrix.row(first + h);
    }
    // Tiles of equal width: in a narrow tile the sums would wait for each other.
    let tiles = count.div_ceil(B);
    for block in 0..blocks {
        let input = &input[block * matrix.cols() * count..][..matrix.cols() * count];
        let output = &mut output[block * matrix.rows() * count..][..matrix.rows() * count];
        let mut line = 0;
        for tile in 0..tiles {
            let width = (count - line).div_ceil(tiles - tile);
            macro_rules! of_width {
                ($($width:literal)*) => {
                    match width {
                        $($width => self::tile::<S, IN_LINE, H, $width>(simd, lines, &rows, [first, line], input, output),)*
                        _ => self::tile::<S, IN_LINE, H, B>(simd, lines, &rows, [first, line], input, output),
                    }
                };
            }
            of_width!(1 2 3 4 5 6 7);
            line += width;
        }
    }
}

/// `rows` of the matrix times B lines, `first` naming the first of both.
#[inline(always)]
fn tile<S: Simd, const IN_LINE: bool, const H: usize, const B: usize>(
    simd: S,
    lines: LineBlocks<'_>,
    rows: &[&[f64]; H],
    first: [usize; 2],
    input: &[Pack],
    output: &mut [Pack],
) {
    for part in 0..Lanes::<S>::PARTS {
        let sums = multiply::<S, IN_LINE, H, B>(simd, lines, rows, first[1], input, part);
        store::<S, IN_LINE, H, B>(simd, lines, &sums, first, output, part);
    }
}

/// sums[h][b] = sum_c rows[h][c] x_b[c], where x_b are the B lines from `line` on.
#[inline(always)]
fn multiply<S: Simd, const IN_LINE: bool, const H: usize, const B: usize>(
    simd: S,
    LineBlocks { matrix, count, .. }: LineBlocks<'_>,
    rows: &[&[f64]; H],
    line: usize,
    input: &[Pack],
    part: usize,
) -> [[Lanes<S>; B]; H] {
    let (cols, zero) = (matrix.cols(), Lanes::splat(simd, 0.0));
    let mut along = [input; B];
    if IN_LINE {
        for b in 0..B {
            along[b] = &input[(line + b) * cols..][..cols];
        }
    }
    let mut sums = [[zero; B]; H];
    for c in 0..cols {
        let mut x = [zero; B];
        let beside = if IN_LINE { input } else { &input[c * count + line..][..B] };
        for b in 0..B {
            x[b] = Lanes::read(simd, if IN_LINE { &along[b][c] } else { &beside[b] }, part);
        }
        for h in 0..H {
            let entry = Lanes::splat(simd, rows[h][c]);
            for b in 0..B {
                sums[h][b] = entry.mul_add(x[b], sums[h][b]);
            }
        }
    }
    sums
}

/// Writes the sums of a tile, or adds them to the output.
#[inline(always)]
fn store<S: Simd, const IN_LINE: bool, const H: usize, const B: usize>(
    simd: S,
    LineBlocks { matrix, count, add, .. }: LineBlocks<'_>,
    sums: &[[Lanes<S>; B]; H],
    [row, line]: [usize; 2],
    output: &mut [Pack],
    part: usize,
) {
    let (outer, inner) = if IN_LINE { (B, H) } else { (H, B) };
    for k in 0..outer {
        let start = if IN_LINE { (line + k) * matrix.rows() + row } else { (row + k) * count + line };
        let output = &mut output[start..][..inner];
        for l in 0..inner {
            let sum = if IN_LINE { sums[l][k] } else { sums[k][l] };
            let sum = if add { sum + Lanes::read(simd, &output[l], part) } else { sum };
            sum.write(&mut output[l], part);
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
            let along = AlongAxis { matrix: self.matrix, outer: self.outer, inner: self.inner };
            contract(simd, along, self.input, &mut fresh, false);
            contract(simd, along, self.input, &mut added, true);
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
            for (outer, inner) in [(1, 1), (7, 1), (1, 4), (2, 3), (1, 15)] {
                let input = testing::packs(outer * cols * inner, 1);
                let case = Both { matrix: &matrix, outer, inner, input: &input };
                testing::on_every_machine(&case, &expected(&case), 1e-13);
            }
        }
    }
}
