//! Linear elasticity that moves the mesh.
//!
//! The displacement d of the reference mesh x0 is that of an elastic body whose boundary follows the prescribed motion:
//! div sigma(d) = 0 with sigma = 2 mu eps + lambda tr(eps) I, in 2-D in plane strain. The space is that of the C0 nodes of order N; its
//! basis here is nodal, at Gauss-Lobatto points. K is constant over a run, so it is prepared once.
//!
//! | module | mathematics |
//! |---|---|
//! | `material` | the law at a point |
//! | `stiffness` | where the mesh is stiff |
//! | `wall_distance` | stiffness by the distance to moving and resting boundaries |
//! | `geometry` | the reference mesh at points of its cells |
//! | `batches` | cells in SIMD lanes; their sum, in a fixed order |
//! | `operator` | K, matrix-free |
//! | `low_order` | its preconditioner: low-order elements on the Gauss-Lobatto nodes |
//! | `condensation` | a direct solver: inner nodes eliminated, sparse Cholesky on the skeleton |
//! | `cholesky` | sparse and dense factorisation, by faer on one thread |
//! | `elastic_mesh` | equilibrium and extension from the boundary |
//! | `slab` | motion and equilibrium in a time slab |
//!
//! Invariants: nothing here knows the fluid, or where the boundary motion comes from. Results have the same bits for any number of
//! threads. After a first call [`ElasticMesh::apply`] and [`ElasticSlab::residual`] allocate nothing.

mod batches;
mod cholesky;
mod condensation;
mod elastic_mesh;
mod errors;
mod geometry;
mod low_order;
mod material;
mod operator;
mod pool;
mod slab;
mod stiffness;
#[cfg(test)]
mod testing;
mod wall_distance;

pub use condensation::Condensation;
pub use elastic_mesh::ElasticMesh;
pub use errors::ElasticityError;
pub use material::{Lame, Material};
pub use newton_krylov::cg::Report;
pub use slab::{ElasticSlab, MAX_TIME_ORDER, SlabMotion};
pub use stiffness::Stiffness;
pub use wall_distance::WallDistance;
