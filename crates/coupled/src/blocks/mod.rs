//! The blocks: bodies, the mesh, the flow.

pub mod elastic_body;
mod flow;
mod mesh_motion;
pub mod rigid_body;
mod slab_times;

pub use elastic_body::ElasticBody;
pub(crate) use flow::inadmissible;
pub(crate) use flow::totals_at;
pub use flow::{Counts, FlowBlock, totals};
pub use mesh_motion::MeshBlock;
pub use rigid_body::RigidBody;
pub use slab_times::SlabTimes;
pub(crate) use slab_times::{jump, last_digits};

/// The first a of 1, 1/2, 1/4, ... for which z + a dz `is_admissible`. After so many `halvings` it is not tested: the residual of that step tells
/// what is wrong.
fn first_admissible_step(z: &[f64], dz: &[f64], halvings: i32, mut is_admissible: impl FnMut(&[f64]) -> bool) -> f64 {
    let mut trial = vec![0.0; z.len()];
    let mut is_good = |a: &f64| {
        trial.iter_mut().zip(z.iter().zip(dz)).for_each(|(trial, (z, dz))| *trial = z + a * dz);
        is_admissible(&trial)
    };
    (0..halvings).map(|k| 0.5_f64.powi(k)).find(|a| is_good(a)).unwrap_or(0.5_f64.powi(halvings))
}
