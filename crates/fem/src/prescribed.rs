//! Prescribed states at the points of a batch, evaluated lane by lane.

use crate::field::StateField;
use tensor::{Dual, Pack, WIDTH};

/// Fills `data[b][m][p]` with `field` at positions `x[b][d][p]`, relative to the origins `origins[lane]`, and time `t`. With two
/// blocks the derivative along the derivative of the position is filled too.
pub fn fill<const D: usize, const M: usize>(
    field: &dyn StateField<D, M>,
    blocks: usize,
    t: f64,
    points: usize,
    origins: [&[f64]; WIDTH],
    x: &[Pack],
    data: &mut [Pack],
) {
    for p in 0..points {
        for lane in 0..WIDTH {
            let position: [f64; D] = std::array::from_fn(|d| origins[lane][d] + x[d * points + p].0[lane]);
            if blocks == 1 {
                let state = field.value(&position, t);
                for m in 0..M {
                    data[m * points + p].0[lane] = state[m];
                }
            } else {
                let position = std::array::from_fn(|d| Dual::new(position[d], x[(D + d) * points + p].0[lane]));
                let state = field.dual(&position, t);
                for m in 0..M {
                    data[m * points + p].0[lane] = state[m].value;
                    data[(M + m) * points + p].0[lane] = state[m].derivative;
                }
            }
        }
    }
}
