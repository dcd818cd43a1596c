//! Meshes made from a few numbers.
//!
//! | module | mesh |
//! |---|---|
//! | `box_mesh`, `curving` | a box of cells, straight or curved |
//! | `channel` | a box between two walls |
//! | `rotating_box` | a square with a square hole |
//! | `annulus`, `disc` | between two circles; within one |
//! | `airfoil` | a C-mesh around a symmetric NACA airfoil |
//! | `profile`, `closed_curve`, `blade` | a row of turbine blades |
//! | `extrude` | a plane mesh as the cross-section of a mesh in space |
//! | `assembly`, `growth` | what they share: blocks that are joined, cells that grow |

mod annulus;
mod assembly;
mod box_mesh;
mod channel;
mod curving;
mod disc;
mod extrude;
mod growth;
mod rotating_box;

pub use annulus::AnnulusMesh;
pub use box_mesh::{BOX_BOUNDARIES, BoxMesh};
pub use channel::ChannelMesh;
pub use curving::Curving;
pub use disc::DiscMesh;
pub use extrude::Extrusion;
pub use rotating_box::RotatingBoxMesh;
