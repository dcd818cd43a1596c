//! The diagonal of K.
//!
//! With the gradients g_a of the reference coordinates (the rows of G) the function of node k has grad phi_k = sum_a phi_k,a g_a, so
//!
//! ```text
//! K_(k i)(k i) = sum over a, b and points of  W block(g_a, g_b)[i][i] phi_k,a phi_k,b                          (diag K)
//! ```
//!
//! and phi_k,a phi_k,b is a product over the axes, so it is summed like a value.

use super::{LineTables, Operator};
use basis::{AllAxes, Matrix, apply_all_axes, scratch_length};
use fem::parallel::{self, Grain};
use std::array::from_fn;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Pack, WIDTH, zeroed};

/// One pair (a, b) of (diag K) in one batch.
struct Term<'a, const D: usize> {
    /// phi_k,a phi_k,b along each axis, `[node][point]`.
    functions: &'a [Matrix; D],
    /// W block(g_a, g_b)[i][i], `[component][point]`.
    coefficients: &'a [Pack],
    /// `[component][node]`, to which the term is added.
    diagonal: &'a mut [Pack],
}

impl<const D: usize> WithSimd for Term<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lines = self.functions.each_ref();
        let mut between = zeroed(scratch_length(&lines, D));
        let axes = AllAxes { matrices: &lines, components: D };
        apply_all_axes(simd, axes, self.coefficients, self.diagonal, &mut between, true);
    }
}

impl<const D: usize> Operator<D> {
    /// The diagonal of K, `[C0 node][component]`.
    pub(crate) fn diagonal(&self, out: &mut [f64]) {
        let functions: [[[Matrix; D]; D]; D] = from_fn(|a| from_fn(|b| products(&self.lines, a, b)));
        let mut field = zeroed(self.batches.field_length());
        parallel::for_each_chunk(&mut field, self.batches.cell_length(), Grain::Any, &|batch, diagonal| {
            for a in 0..D {
                for b in 0..D {
                    let coefficients = &self.coefficients(batch, a, b);
                    Arch::new().dispatch(Term { functions: &functions[a][b], coefficients, diagonal: &mut *diagonal });
                }
            }
        });
        self.batches.assemble(&field, out);
    }

    /// W block(g_a, g_b)[i][i] in one batch, `[component][point]`.
    fn coefficients(&self, batch: usize, a: usize, b: usize) -> Vec<Pack> {
        let points = self.lines.points::<D>();
        let mut coefficients = zeroed(D * points);
        for (point, entry) in self.batch_metric(batch).chunks_exact(1 + D * D).enumerate() {
            for lane in 0..WIDTH {
                let row = |a: usize| from_fn(|j| entry[1 + a * D + j].0[lane]);
                let block = self.lame.block::<D>(&row(a), &row(b));
                for i in 0..D {
                    coefficients[i * points + point].0[lane] = entry[0].0[lane] * block[i][i];
                }
            }
        }
        coefficients
    }
}

/// phi_k,a phi_k,b along each axis, `[node][point]`.
fn products<const D: usize>(lines: &LineTables, a: usize, b: usize) -> [Matrix; D] {
    let (values, derivatives) = (&lines.interpolate, &lines.differentiate.product(&lines.interpolate));
    from_fn(|axis| {
        let left = if axis == a { derivatives } else { values };
        let right = if axis == b { derivatives } else { values };
        Matrix::from_fn(values.cols(), values.rows(), |k, point| left[(point, k)] * right[(point, k)])
    })
}
