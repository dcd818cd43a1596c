//! The metric of a mesh that has moved.
//!
//! With the deformation gradient F = I + grad d of the move, its determinant j, and a stiffness that contains the (-chi)th power of
//! det J,
//!
//! ```text
//! G_n = G F^{-1},      det J_n = j det J,      W_n = omega det J_n E_Y,n = W j^{1 - chi}                               (updated)
//! ```

use super::Operator;
use super::kernel::{GradientLayout, Scratch, read_metric};
use crate::Inversion;
use crate::law::plus_identity;
use fem::parallel;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real, WIDTH, cofactor, determinant};

/// (updated) in one batch.
struct MoveBatch<'a, const D: usize> {
    operator: &'a Operator<D>,
    batch: usize,
    displacement: &'a [f64],
    /// 1 - chi
    power: f64,
    /// W and G, replaced by W_n and G_n.
    metric: &'a mut [Pack],
}

impl<const D: usize> WithSimd for MoveBatch<'_, D> {
    /// The smallest j of every cell.
    type Output = Pack;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Pack {
        let MoveBatch { operator, batch, displacement, power, metric } = self;
        let points = operator.lines.points::<D>();
        let mut scratch = Scratch::new::<D>(&operator.lines, 1);
        let gradients = operator.gradients_of(simd, batch, displacement, &mut scratch);
        let mut smallest = Pack([f64::MAX; WIDTH]);
        let layout = GradientLayout::of_one(D, points);
        for point in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let (weight, g) = read_metric::<S, D>(simd, metric, point, part);
                let gradient = layout.physical::<S, Lanes<S>, D>(simd, gradients, 0, (point, part), &g);
                let f = plus_identity(&gradient);
                let cofactor = cofactor(&f);
                let j = determinant(&f, &cofactor);
                let least = Lanes::read(simd, &smallest, part);
                // A minimum forgets a NaN; the products keep it.
                (least.min(j) + (least + j) * 0.0).write(&mut smallest, part);
                let entry = &mut metric[point * (1 + D * D)..][..1 + D * D];
                (weight * j.powf(power)).write(&mut entry[0], part);
                for a in 0..D {
                    for k in 0..D {
                        // F^{-1} = cof(F)^T / j
                        (tensor::dot(&g[a], &cofactor[k]) / j).write(&mut entry[1 + a * D + k], part);
                    }
                }
            }
        }
        smallest
    }
}

impl<const D: usize> Operator<D> {
    /// The metric after the move `displacement` of the mesh, from the metric `before`; chi is the power of `stiffness`.
    pub(crate) fn moved_metric(&self, before: &[Pack], displacement: &[f64], chi: f64) -> Result<Vec<Pack>, Inversion> {
        let mut metric = before.to_vec();
        let length = self.metric_length();
        let move_batch = |batch: usize, metric: &mut [Pack]| {
            Arch::new().dispatch(MoveBatch { operator: self, batch, displacement, power: 1.0 - chi, metric })
        };
        let smallest = parallel::map_chunks(&mut metric, length, &move_batch);
        self.check_inversion(&smallest)?;
        Ok(metric)
    }
}
