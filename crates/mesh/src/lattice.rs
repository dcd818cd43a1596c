//! Arrays over tensor-product lattices, and one-dimensional matrices along their axes.

use basis::Matrix;

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
            for i in 0..rows {
                let target = &mut output[i * stride..(i + 1) * stride];
                for j in 0..columns {
                    let (factor, source) = (matrix[(i, j)], &input[j * stride..(j + 1) * stride]);
                    target.iter_mut().zip(source).for_each(|(t, s)| *t += factor * s);
                }
            }
        }
        Lattice { shape, values }
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
