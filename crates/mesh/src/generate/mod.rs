//! Meshes made from a few numbers.
//!
//! | module | mesh |
//! |---|---|
//! | `box_mesh`, `curving` | a box of cells, straight or curved |
//! | `box_regions` | regions of a box, and lines between its cells at their faces |
//! | `channel` | a box between two walls |
//! | `channel_cylinder` | a cylinder across a channel |
//! | `channel_flag` | a flag behind such a cylinder |
//! | `rotating_box` | a square with a square hole |
//! | `annulus`, `disc` | between two circles; within one |
//! | `closed_body` | between a closed curve through points and a circle |
//! | `ellipsoid` | between an ellipsoid and the far field, in three dimensions |
//! | `airfoil` | a C-mesh around a symmetric NACA airfoil |
//! | `profile`, `closed_curve`, `blade` | a row of turbine blades |
//! | `extrude` | extrusion of a two-dimensional mesh |
//! | `assembly`, `growth`, `smoothing` | shared parts: joined blocks, growing cells, smooth lines |

mod airfoil;
mod annulus;
mod assembly;
mod blade;
mod box_mesh;
mod box_regions;
mod channel;
mod channel_cylinder;
mod channel_flag;
mod closed_body;
mod closed_curve;
mod curving;
mod disc;
mod ellipsoid;
mod extrude;
mod growth;
mod profile;
mod rotating_box;
mod smoothing;

pub use airfoil::{AirfoilMesh, NearPart};
pub use annulus::AnnulusMesh;
pub use blade::{BladeCells, BladeMesh};
pub use box_mesh::{BOX_BOUNDARIES, BoxMesh, PositionMap};
pub use box_regions::{BoxRegion, Segment};
pub use channel::ChannelMesh;
pub use channel_cylinder::ChannelCylinderMesh;
pub use channel_flag::{ChannelFlagMesh, FlagCells};
pub use closed_body::ClosedBodyMesh;
pub use closed_curve::{ClosedCurve, signed_area};
pub use curving::Curving;
pub use disc::DiscMesh;
pub use ellipsoid::EllipsoidMesh;
pub use extrude::Extrusion;
pub use profile::low_pressure_turbine_profile;
pub use rotating_box::RotatingBoxMesh;
