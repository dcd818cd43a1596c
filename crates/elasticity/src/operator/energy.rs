//! The energy of a displacement.
//!
//! ```text
//! sum over cells and points of  W  Psi(H G),     psi . R(d) = its derivative along psi                           (energy of cells)
//! ```

use super::Operator;
use super::kernel::{GradientLayout, Scratch, read_metric};
use crate::law::Hyperelastic;
use fem::parallel::{self, Grain};
use newton_krylov::inner_product;
use tensor::Arch;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, WIDTH};

/// The energies of the cells of one batch.
struct BatchEnergy<'a, const D: usize, L> {
    operator: &'a Operator<D>,
    law: L,
    batch: usize,
    displacement: &'a [f64],
}

impl<const D: usize, L: Hyperelastic> WithSimd for BatchEnergy<'_, D, L> {
    type Output = Pack;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Pack {
        let BatchEnergy { operator, law, batch, displacement } = self;
        let points = operator.lines.points::<D>();
        let mut scratch = Scratch::new::<D>(&operator.lines, 1);
        let gradients = operator.gradients_of(simd, batch, displacement, &mut scratch);
        let mut energies = Pack::ZERO;
        let layout = GradientLayout::of_one(D, points);
        for point in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let (weight, g) = read_metric::<S, D>(simd, operator.batch_metric(batch), point, part);
                let gradient = layout.physical::<S, Lanes<S>, D>(simd, gradients, 0, (point, part), &g);
                let sum = Lanes::read(simd, &energies, part) + law.energy(&gradient) * weight;
                sum.write(&mut energies, part);
            }
        }
        energies
    }
}

impl<const D: usize> Operator<D> {
    /// (energy of cells)
    pub(super) fn energy_by<L: Hyperelastic>(&self, law: L, displacement: &[f64]) -> f64 {
        let energy = |batch| Arch::new().dispatch(BatchEnergy { operator: self, law, batch, displacement });
        let energies = parallel::map(self.batches.count(), Grain::Any, &energy);
        let of_cells: Vec<f64> = (0..self.batches.cells()).map(|cell| energies[cell / WIDTH].0[cell % WIDTH]).collect();
        inner_product::sum(&of_cells)
    }
}
