//! Elasticity, for the motion of the mesh and for structures.
//!
//! The displacement d of the reference mesh x0 is the displacement of an elastic body whose boundary follows the prescribed motion:
//! div P(grad d) = 0. The stress P is linear or neo-Hookean, in 2-D in plane strain. The space consists of the C0 nodes of order N;
//! its basis here is nodal, at Gauss-Lobatto points. K of the linear law is constant over a run, so it is prepared once.
//!
//! | module | mathematics |
//! |---|---|
//! | `material` | Lame's constants, and the linear stress |
//! | `law` | the laws at a point |
//! | `stiffness` | variation of the stiffness over the mesh |
//! | `wall_distance` | stiffness by the distance to moving and resting boundaries |
//! | `geometry` | the reference mesh at points of its cells |
//! | `operator` | the forces and their derivative K, matrix-free |
//! | `low_order` | its preconditioner: low-order elements on the Gauss-Lobatto nodes |
//! | `multigrid` | its approximate inverse where a factor is too large |
//! | `condensation` | a direct solver: nodes eliminated inside cells, then along a tree of parts of the mesh |
//! | `substructures` | the same on blocks of the mesh, which ranks share; BDDC |
//! | `solver` | the choice among them |
//! | `elastic_mesh` | equilibrium and extension from the boundary |
//! | `slab` | motion and mesh equations in a time slab |
//! | `equilibrium` | their solution |
//! | `nonlinear` | the one nonlinear problem, for meshes and structures |
//! | `structure` | a body with mass, loads and supports |
//! | `mass`, `loads` | the mass matrix; body force and traction |
//! | `cauchy` | the stress of a body in its current shape |
//! | `solid` | the material of a structure, point by point |
//! | `structure_slab` | the equations of a structure in a time slab |
//! | `modal` | their systems, by temporal modes, with the mass of a fluid |
//! | `corrections` | the solution of linear equations to round-off |
//! | `large_displacement` | Newton's method for laws that are not linear |
//! | `dynamics`, `statics` | the motion of a structure, with and without inertia |
//! | `shifted` | systems with K + m M, real and complex |
//! | `modes`, `ritz` | natural frequencies and shapes, by the method of Rayleigh and Ritz |
//! | `pool`, `errors` | work space that outlives a call; errors |
//!
//! Invariants: this crate contains no fluid and no source of the boundary motion. Results have the same bits for any number of
//! threads. After a first call [`ElasticMesh::apply`] and [`ElasticSlab::residual`] allocate nothing.
//!
//! Waves in a unit square between frictionless walls. With mu = lambda = rho = 1 the slowest is a shear wave, omega = pi sqrt(2). Pressure
//! waves along both axes follow, omega = pi sqrt(3):
//!
//! ```
//! use elasticity::{Material, Structure, natural_modes};
//! use mesh::{BoxMesh, Curving, NodeNumbering};
//! use std::f64::consts::PI;
//!
//! let (lower, upper, curving) = ([0.0; 2], [1.0; 2], Curving::None);
//! let square = BoxMesh { lower, upper, cells: [1; 2], order: 6, curving, periodic: [false; 2] };
//! let mesh = square.build()?;
//! let nodes = NodeNumbering::new(&mesh, mesh.order());
//! let on_wall = |x: f64| x == 0.0 || x == 1.0;
//! let fixed = nodes.positions(&mesh).iter().map(|x| x.map(on_wall)).collect();
//! let body = Structure::new(mesh, nodes, Material::new(2.5, 0.25)?, 1.0, fixed)?;
//! for (mode, exact) in natural_modes(&body, 3)?.iter().zip([2.0_f64, 3.0, 3.0]) {
//!     assert!((mode.angular_frequency / (PI * exact.sqrt()) - 1.0).abs() < 1e-4, "{}", mode.angular_frequency);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cauchy;
mod condensation;
mod corrections;
mod dynamics;
mod elastic_mesh;
mod equilibrium;
mod errors;
mod geometry;
mod large_displacement;
mod law;
mod loads;
mod low_order;
mod mass;
mod material;
mod modal;
mod modes;
mod multigrid;
mod nonlinear;
mod operator;
mod pool;
mod ritz;
mod shifted;
mod slab;
mod solid;
mod solver;
mod statics;
mod stiffness;
mod structure;
mod structure_slab;
mod substructures;
#[cfg(test)]
mod testing;
mod wall_distance;

pub use cauchy::{Stress, principal, von_mises};
pub use dynamics::{Dynamics, DynamicsReport};
pub use elastic_mesh::ElasticMesh;
pub use equilibrium::{Accuracy, Guard, Work};
pub use errors::{ElasticityError, Inversion, VOLUME_RATIO};
pub use geometry::just_inside;
pub use law::Law;
pub use loads::{BodyForce, Loads, Pressure, SurfacePoint, Traction};
pub use material::{Lame, Material, NEARLY_INCOMPRESSIBLE, Plane};
pub use modal::{FluidLayer, ModalSolver, SlabSystems, nominal_length};
pub use modes::{NaturalMode, natural_modes};
pub use newton_krylov::cg::Report;
pub use slab::{ElasticSlab, MAX_TIME_ORDER, SlabMotion};
pub use solid::{Field, MaterialProperty, Solid};
pub use solver::{Plan, Solver, factor_bytes};
pub use statics::{Stability, Statics};
pub use stiffness::Stiffness;
pub use structure::{Damping, Structure};
pub use structure_slab::{SlabBottom, SlabWork, StructureSlab};
pub use substructures::{Partition, SolverOnBlocks};
pub use wall_distance::WallDistance;
