//! Arrays over tensor-product lattices, and one-dimensional matrices along their axes.

use basis::Matrix;

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
        for (input, output) in self.values.chunks_exact(stride * columns).zip(values.chunks_exact_mut(stride * rows)) {
            match stride {
                1 => matrix.apply(input, output),
                _ => apply_to_rows(matrix, stride, input, output),
            }
        }
        Lattice { shape, values }
    }

    /// `matrix(axis)` applied along every axis, the last first: that is the cheapest order where lattices shrink.
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

/// output[i] = sum_j matrix[i][j] input[j] for rows of `stride` numbers.
fn apply_to_rows(matrix: &Matrix, stride: usize, input: &[f64], output: &mut [f64]) {
    for (i, target) in output.chunks_exact_mut(stride).enumerate() {
        for (factor, source) in matrix.row(i).iter().zip(input.chunks_exact(stride)) {
            target.iter_mut().zip(source).for_each(|(t, s)| *t += factor * s);
        }
    }
}
