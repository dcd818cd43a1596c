//! The report of a failed run: the folder `failure` in its output directory.
//!
//! | module | holds |
//! |---|---|
//! | `data` | the measurements, as plain numbers |
//! | `diagnosis` | from these data to causes in words, the likeliest first |
//! | `of_flow`, `of_mesh`, `of_structure` | the data of a run of mesh and flow, of the mesh, of a structure |
//! | `gas` | the gas: low density, steep gradients, disagreement with boundaries |
//! | `grid` | cells on a grid of points |
//! | `finding` | data, residuals and the worst cell |
//! | `picture` | that cell and its neighbours as SVG |
//! | `bundle` | the files |

mod bundle;
mod data;
mod diagnosis;
mod finding;
mod gas;
mod grid;
mod of_bodies;
mod of_flow;
mod of_mesh;
mod of_structure;
mod picture;

pub use bundle::{FailureReport, clear, tell};
pub use data::Mismatch;
pub use finding::Finding;
pub use gas::{Then, mismatch_at};
pub use grid::Grid;
pub use of_flow::{Failed, by_point};
pub use of_mesh::{examine as examine_mesh, examine_inverted};
pub use of_structure::examine as examine_structure;
