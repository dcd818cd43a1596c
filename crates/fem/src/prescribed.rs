//! Prescribed numbers at the points of a batch, evaluated lane by lane.

use crate::field::StateField;
use tensor::{Dual, Pack, WIDTH};

/// A field as a batch of cells or facets sees it.
pub struct Prescribed<'a, const D: usize, const M: usize> {
    /// The field.
    pub field: &'a dyn StateField<D, M>,
    /// Blocks of positions and data: 2 where the derivative along a motion of the points is asked for.
    pub blocks: usize,
    /// The points to which positions are relative.
    pub origins: [&'a [f64]; WIDTH],
}

impl<const D: usize, const M: usize> Prescribed<'_, D, M> {
    /// Fills `data[b][m][p]` with the field at the positions `x[b][d][p]` and time `t`; with two blocks also the derivative along the
    /// derivative of the position.
    pub fn fill(&self, t: f64, points: usize, x: &[Pack], data: &mut [Pack]) {
        for p in 0..points {
            for lane in 0..WIDTH {
                let position: [f64; D] = std::array::from_fn(|d| self.origins[lane][d] + x[d * points + p].0[lane]);
                if self.blocks == 1 {
                    let state = self.field.value(&position, t);
                    for m in 0..M {
                        data[m * points + p].0[lane] = state[m];
                    }
                } else {
                    let position = std::array::from_fn(|d| Dual::new(position[d], x[(D + d) * points + p].0[lane]));
                    let state = self.field.dual(&position, t);
                    for m in 0..M {
                        data[m * points + p].0[lane] = state[m].value;
                        data[(M + m) * points + p].0[lane] = state[m].derivative;
                    }
                }
            }
        }
    }
}
