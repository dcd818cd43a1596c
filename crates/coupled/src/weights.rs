//! Weights that make residuals of mesh and flow comparable.
//!
//! ```text
//! |R_f|^2 = (1 / N_t |Omega|) sum (R / scale_m)^2 / int phi_i J        an error of the state, relative to its scales
//! |R_e|^2 = (1 / n) sum (R_i / (K_ii h_i))^2                           an error of position, relative to the node spacing  (norm)
//! ```

use crate::mesh_mover::MeshMover;
use crate::motion::MeshMotion;
use fem::{SlabEnd, SlabOperator};
use newton_krylov::inner_product;

/// Weights of the flow's residual in a slab.
pub fn flow<const D: usize, const M: usize>(operator: &SlabOperator<D, M>) -> Vec<f64> {
    let (layout, scales) = (operator.layout, operator.problem.kernels.scales());
    let one = layout.at_one_time();
    let mut masses = vec![0.0; one.len()];
    operator.mass_product(&vec![1.0; one.len()], SlabEnd::Bottom, &mut masses);
    let share = &operator.share;
    let volume: f64 = inner_product::sum_over_blocks(&masses, &share.ends, &share.sums) / M as f64;
    let mut weights = vec![0.0; layout.len()];
    for cell in 0..layout.cells {
        let mean = masses[one.cell(cell)].iter().sum::<f64>() / one.cell_len() as f64;
        for a in 0..layout.time_order {
            for (m, scale) in scales.iter().enumerate() {
                for i in 0..layout.nodes {
                    // A strongly curved cell may have a node of vanishing mass: it gets a share of the mean.
                    let mass = masses[one.index(cell, 0, m, i)].max(1e-2 * mean);
                    weights[layout.index(cell, a, m, i)] =
                        1.0 / (scale * scale * mass * volume * layout.time_order as f64);
                }
            }
        }
    }
    weights
}

/// Weights of the mesh equations in a slab of `time_order` nodes; empty unless the mesh is elastic.
pub fn mesh<const D: usize>(mover: &MeshMover<D>, time_order: usize) -> Vec<f64> {
    let MeshMotion::Elastic { mesh: elastic, .. } = &mover.motion else { return Vec::new() };
    elastic.position_weights(time_order)
}
