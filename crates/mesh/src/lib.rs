//! Topology and curved geometry of quadrilateral and hexahedral meshes.
//!
//! A [`Mesh`] is a list of cells. Each cell has the numbers of its 2^D vertices, which define its neighbours, and the
//! positions of its N^D Gauss-Lobatto nodes. Everything else follows: facets with the [`Orientation`] of the two
//! lattices, the C0 [`NodeNumbering`] of nodes of any order, the map of a cell ([`CellMap`]), and a proof that the map
//! is invertible.
//!
//! | module | holds |
//! |---|---|
//! | `facet` | faces of a cell, their lattices and signs; orientation of two lattices |
//! | `mesh` | the mesh |
//! | `region`, `part` | named sets of cells; the mesh that some of them make, and the nodes that two such meshes share |
//! | `subset` | some cells of a mesh, for a rank that works on these alone |
//! | `topology` | facets from vertex numbers and names |
//! | `periodic` | boundaries that are translates of each other |
//! | `scramble`, `random` | the same mesh with turned reference cells, for tests of orientation; reproducible random numbers |
//! | `numbering` | C0 numbering of nodes |
//! | `geometry` | x(xi), its Jacobian, volumes |
//! | `distance` | distances to curved boundaries |
//! | `arcs` | arc lengths along closed curves and walls that are extruded ones |
//! | `boundary` | normals at the nodes of a boundary |
//! | `blocks` | the partition into blocks |
//! | `cross_section` | cells that lie behind each other along some axes |
//! | `lattice` | arrays over tensor-product lattices |
//! | `parallel` | loops in parallel |
//! | `locate` | the cell that contains a point |
//! | `validity` | lower bounds of det J over a cell and a slab |
//! | `generate` | meshes made from a few numbers |
//! | `errors` | errors of meshes |
//! | `gmsh` | meshes from files of Gmsh and SU2, and from lists of nodes and elements |
//!
//! An annulus of curved cells. Its area is exact to the error of the interpolated circles, and each cell is proved to be valid:
//!
//! ```
//! use mesh::ValidityCheck;
//! use mesh::generate::AnnulusMesh;
//! use std::f64::consts::PI;
//!
//! let circles = AnnulusMesh { inner_radius: 1.0, outer_radius: 2.0, first_cell: 0.2, cells: [12, 4], order: 6 };
//! let mesh = circles.build()?;
//! assert_eq!(mesh.n_cells(), 48);
//! assert_eq!(mesh.boundary_names(), ["wall", "far"]);
//! assert!((mesh.volume() - 3.0 * PI).abs() < 1e-8);
//!
//! let check = ValidityCheck::<2>::new(mesh.order(), &[0.0]);
//! assert!((0..48).all(|cell| check.decide(mesh.cell_coordinates(cell)).is_valid()));
//! let mirrored: Vec<f64> = mesh.cell_coordinates(0).chunks(2).flat_map(|x| [-x[0], x[1]]).collect();
//! assert!(!check.decide(&mirrored).is_valid());
//! # Ok::<(), mesh::MeshError>(())
//! ```

mod arcs;
mod blocks;
mod boundary;
mod cross_section;
mod distance;
mod errors;
mod facet;
pub mod generate;
mod geometry;
mod gmsh;
mod lattice;
mod locate;
mod mesh;
mod numbering;
pub mod parallel;
mod part;
mod periodic;
mod random;
mod region;
mod scramble;
mod subset;
mod topology;
mod validity;

pub use arcs::{Strip, curve_order, first_node};
pub use blocks::blocks;
pub use boundary::outward_area;
pub use cross_section::{CrossSection, LineNode, Stack, clusters};
pub use distance::BoundaryDistance;
pub use errors::MeshError;
pub use facet::{
    BoundaryFacet, InteriorFacet, Orientation, Side, axis_and_side, corner_node, face_nodes, outward_sign, tangent_sign,
};
pub use generate::{BoxMesh, Curving};
pub use geometry::{CellMap, bounding_box};
pub use gmsh::{FilePosition, GmshError, ListedElement, MeshLists, Numbers, Shape, Simplices, Span, is_su2};
pub use locate::{locate_in_cell, nearest_in_cell};
pub use mesh::{Mesh, ORDERS};
pub use numbering::NodeNumbering;
pub use part::Part;
pub use periodic::PeriodicPair;
pub use region::{REST, Region};
pub use subset::Subset;
pub use validity::{Bound, MotionCheck, SlabPoint, Validity, ValidityCheck};
