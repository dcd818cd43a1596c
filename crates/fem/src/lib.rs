//! Space-time slab spaces and the kernels of a conservation law on a moving mesh.
//!
//! | module | holds |
//! |---|---|
//! | `conservation_law` | the interface of a physics to the kernels |
//! | `field`, `prescribed` | prescribed functions of position and time, and their values in packs |
//! | `layout`, `time_points` | the layout of unknowns; the times of a slab at which kernels evaluate |
//! | `tables` | one-dimensional matrices, quadrature that conserves |
//! | `tensor_product` | values and gradients at points, and their transposes |
//! | `mode`, `counted_mode` | the choice of derivatives; the same with numbers that count operations |
//! | `cell`, `volume_terms`, `facet`, `facet_evaluation`, `slope`, `boundary`, `point` | the kernels |
//! | `cell_geometry`, `facet_geometry`, `slab_geometry`, `fields` | the geometry at the points, and where it is kept |
//! | `collocation`, `nodal_geometry`, `facet_area` | the metric of collocated rules |
//! | `artificial_viscosity`, `entropy_viscosity` | artificial viscosities: of shocks, of cells that would lose entropy |
//! | `split_form` | inviscid volume terms of collocated rules with two-point fluxes |
//! | `scratch`, `per_thread`, `gather` | their packs, one piece of them per thread, and the copies from and to vectors |
//! | `violation`, `work` | where a state is inadmissible; the number of operations |
//! | `kernels` | the kernels of a law behind one object |
//! | `traces`, `mesh_traces`, `batches`, `moving_mesh` | cells, facets and the mesh in packs |
//! | `nodal_batches` | C0 fields in packs of cells, and their sum in a fixed order |
//! | `share` | the cells of a rank, and what ranks exchange |
//! | `operator` | the residual of a slab and its derivatives |
//! | `boundary_flux` | fluxes through boundaries: forces, power |
//! | `wall_loads` | nodal forces on walls that respond to the flow |
//! | `sampler` | values in cells on any grid of points: output, errors |
//! | `linearisation`, `space_jacobian`, `line_jacobian` | blocks of the Jacobian of space, for preconditioners |
//! | `low_order`, `sub_cells`, `two_point` | the operator of space on the control volumes of the nodes, for preconditioners |
//!
//! The values and the gradient of x y on a sheared cell of order 2, from the coefficients at the nine nodes of order 3:
//!
//! ```
//! use basis::{Lagrange, gauss};
//! use fem::Sampler;
//!
//! let x = |xi: f64, eta: f64| [2.0 * xi + 0.5 * eta, eta];
//! let corners = [x(-1.0, -1.0), x(1.0, -1.0), x(-1.0, 1.0), x(1.0, 1.0)];
//! let nodal: Vec<f64> = (0..2).flat_map(|i| corners.map(|corner| corner[i])).collect();
//! let nodes = Lagrange::gauss_lobatto(3).nodes().to_vec();
//! let at_node = |j: usize| x(nodes[j % 3], nodes[j / 3]);
//! let u: Vec<f64> = (0..9).map(at_node).map(|[x, y]| x * y).collect();
//!
//! let sampler = Sampler::<2>::new(3, 2, &gauss(4).points);
//! let (positions, gradient) = (sampler.positions(&nodal), sampler.gradients(&u, &nodal));
//! let (x, y) = positions.split_at(sampler.points());
//! for (q, u) in sampler.state(&u).into_iter().enumerate() {
//!     assert!((u - x[q] * y[q]).abs() < 1e-13);
//!     assert!((gradient[0][q] - y[q]).abs() < 1e-13 && (gradient[1][q] - x[q]).abs() < 1e-13);
//! }
//! ```

mod artificial_viscosity;
mod batches;
mod boundary;
mod boundary_flux;
mod cell;
mod cell_geometry;
mod collocation;
mod conservation_law;
#[cfg(feature = "operation-counts")]
mod counted_mode;
mod entropy_viscosity;
mod facet;
mod facet_area;
mod facet_evaluation;
mod facet_geometry;
mod field;
mod fields;
mod gather;
mod kernels;
mod layout;
mod line_jacobian;
mod linearisation;
mod low_order;
mod mesh_traces;
mod mode;
mod moving_mesh;
mod nodal_batches;
mod nodal_geometry;
mod operator;
mod per_thread;
mod point;
mod prescribed;
mod sampler;
mod scratch;
mod share;
mod slab_geometry;
mod slope;
mod space_jacobian;
mod split_form;
mod sub_cells;
mod tables;
mod tensor_product;
mod time_points;
mod traces;
mod two_point;
mod violation;
mod volume_terms;
mod wall_loads;
mod work;

pub use artificial_viscosity::node_grid;
pub use boundary::{Inside, PointFlux};
pub use boundary_flux::{BoundaryFlux, FluxPart, FluxesAt, left_during_slab};
pub use conservation_law::{BoundaryPoint, ConservationLaw, Imposed};
pub use facet::penalty;
pub use field::{StateField, VectorField};
pub use kernels::{Differentiate, Kernels, LawKernels};
pub use layout::Layout;
pub use line_jacobian::LineJacobian;
pub use low_order::{LowOrder, LowOrderRows, NO_NEIGHBOUR, Neighbours};
pub use mesh::parallel;
pub use moving_mesh::MovingMesh;
pub use nodal_batches::NodalBatches;
pub use operator::{Bottom, Problem, SlabOperator, Violation};
pub use per_thread::PerThread;
pub use sampler::{Sampler, functions_at, squared_errors, squared_errors_of_cells};
pub use share::{Blocks, Share};
pub use slab_geometry::{SlabEnd, kept_geometry_bytes};
pub use space_jacobian::{Coupling, SpaceJacobian, Stored, TraceSpace};
pub use tables::{Orders, PointFamily, Quadrature, Shape1d, Tables};
pub use time_points::{Clock, InTime, TimePoint};
pub use two_point::FacePairs;

#[cfg(test)]
mod tests;
