//! Arrays over tensor-product lattices, and one-dimensional matrices along their axes.

use basis::Matrix;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};

/// The index along `axis` of node `index` of a lattice with `n` nodes along every axis.
pub(crate) fn digit(index: usize, n: usize, axis: usize) -> usize {
    index / n.pow(axis as u32) % n
}

/// Values on a lattice with `shape[a]` nodes along axis a, axis 0 fastest. Components count as an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl Lattice {
    pub(crate) fn new(shape: Vec<usize>, values: Vec<f64>) -> Self {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        Lattice { shape, values }
    }

    /// `matrix` applied along `axis`: out[.., i, ..] = sum_j matrix[i][j] self[.., j, ..].
    pub(crate) fn apply(&self, axis: usize, matrix: &Matrix) -> Lattice {
        let (rows, columns) = (matrix.rows(), matrix.cols());
        debug_assert_eq!(columns, self.shape[axis]);
        let stride: usize = self.shape[..axis].iter().product();
        let mut shape = self.shape.clone();
        shape[axis] = rows;
        let mut values = vec![0.0; shape.iter().product()];
        let (input, output) = (&self.values, &mut values);
        match stride {
            1 => Arch::new().dispatch(ApplyToLines { transposed: &matrix.transpose(), input, output }),
            _ => Arch::new().dispatch(ApplyToRows { matrix, stride, input, output }),
        }
        Lattice { shape, values }
    }

    /// `matrix(axis)` applied along every axis, the last first, which is the cheapest order for lattices that shrink.
    pub(crate) fn apply_each<'a>(&self, matrix: impl Fn(usize) -> &'a Matrix) -> Lattice {
        let last = self.shape.len() - 1;
        (0..last).rev().fold(self.apply(last, matrix(last)), |lattice, axis| lattice.apply(axis, matrix(axis)))
    }

    /// The digits of `index`, one per axis.
    pub(crate) fn digits(&self, mut index: usize) -> Vec<usize> {
        let mut digit = |&n: &usize| {
            let digit = index % n;
            index /= n;
            digit
        };
        self.shape.iter().map(&mut digit).collect()
    }
}

/// output[i] = sum_j matrix[i][j] input[j] in consecutive lines.
struct ApplyToLines<'a> {
    transposed: &'a Matrix,
    input: &'a [f64],
    output: &'a mut [f64],
}

impl WithSimd for ApplyToLines<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (columns, rows) = (self.transposed.rows(), self.transposed.cols());
        for (input, output) in self.input.chunks_exact(columns).zip(self.output.chunks_exact_mut(rows)) {
            for j in 0..columns {
                add_multiple(input[j], self.transposed.row(j), output);
            }
        }
    }
}

/// output[i] = sum_j matrix[i][j] input[j] for rows of `stride` numbers.
struct ApplyToRows<'a> {
    matrix: &'a Matrix,
    stride: usize,
    input: &'a [f64],
    output: &'a mut [f64],
}

impl WithSimd for ApplyToRows<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let ApplyToRows { matrix, stride, input, output } = self;
        let (columns, rows) = (matrix.cols(), matrix.rows());
        for (input, output) in input.chunks_exact(stride * columns).zip(output.chunks_exact_mut(stride * rows)) {
            for (i, target) in output.chunks_exact_mut(stride).enumerate() {
                for (j, source) in input.chunks_exact(stride).enumerate() {
                    add_multiple(matrix[(i, j)], source, target);
                }
            }
        }
    }
}

/// y = y + a x
#[inline(always)]
fn add_multiple(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}
