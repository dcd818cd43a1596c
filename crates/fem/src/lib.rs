//! Space-time slab spaces and the kernels of a conservation law on a moving mesh.

mod conservation_law;
mod field;

pub use conservation_law::ConservationLaw;
pub use field::{StateField, VectorField};
