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
//! | `geometry` | the reference mesh at points of its cells |
//! | `batches` | cells in SIMD lanes; their sum, in a fixed order |
//! | `operator` | K, matrix-free |
//! | `low_order` | its preconditioner: low-order elements on the Gauss-Lobatto nodes |
//! | `multigrid` | and what solves with those where a factor is too large |
//! | `condensation` | a direct solver: nodes eliminated inside cells, then along a tree of parts of the mesh |
//! | `cholesky` | sparse and dense factorisation, by faer on one thread |
//! | `solver` | which of them is taken |
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
mod multigrid;
mod operator;
mod pool;
mod slab;
mod solver;
mod stiffness;
#[cfg(test)]
mod testing;

pub use elastic_mesh::ElasticMesh;
pub use errors::ElasticityError;
pub use material::{Lame, Material};
pub use newton_krylov::cg::Report;
pub use slab::{ElasticSlab, MAX_TIME_ORDER, SlabMotion};
pub use solver::{Plan, Solver};
pub use stiffness::Stiffness;
