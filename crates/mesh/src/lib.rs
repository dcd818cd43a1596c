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
//! | `topology` | facets from vertex numbers and names |
//! | `periodic` | boundaries that are translates of each other |
//! | `scramble` | the same mesh with turned reference cells, for tests of orientation |
//! | `numbering` | C0 numbering of nodes |
//! | `geometry` | x(xi), its Jacobian, volumes |
//! | `distance` | distances to curved boundaries |
//! | `boundary` | normals and arc lengths at the nodes of a boundary |
//! | `blocks` | the partition into blocks, and colours of the cells at its cuts |
//! | `locate` | the cell that contains a point |
//! | `validity` | lower bounds of det J over a cell and a slab |
//! | `generate` | meshes made from a few numbers |
//! | `gmsh` | meshes from Gmsh files |

mod blocks;
mod boundary;
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
mod part;
mod periodic;
mod random;
mod region;
mod scramble;
mod topology;
mod validity;

pub use blocks::{blocks, colours};
pub use boundary::outward_area;
pub use distance::BoundaryDistance;
pub use errors::MeshError;
pub use facet::{
    BoundaryFacet, InteriorFacet, Orientation, Side, axis_and_side, corner_node, face_nodes, outward_sign, tangent_sign,
};
pub use generate::{BoxMesh, Curving};
pub use geometry::CellMap;
pub use gmsh::{GmshError, Place, Simplices};
pub use locate::locate_in_cell;
pub use mesh::{Mesh, ORDERS};
pub use numbering::NodeNumbering;
pub use part::Part;
pub use periodic::PeriodicPair;
pub use region::{REST, Region};
pub use validity::{Bound, MotionCheck, SlabPoint, Validity, ValidityCheck};
