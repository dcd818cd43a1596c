//! What a run that has failed leaves behind: the folder `failure` in its output directory.
//!
//! | module | holds |
//! |---|---|
//! | `data` | what was measured, as plain numbers |
//! | `diagnosis` | from evidence to causes in words, the likeliest first |
//! | `of_flow`, `of_mesh`, `of_structure` | the evidence of a run of mesh and flow, of the mesh, of a structure |
//! | `gas` | how the gas stands: thin, steep, at odds with its boundaries |
//! | `grid` | cells seen from points |
//! | `finding` | evidence, residuals and the worst cell |
//! | `picture` | that cell and its neighbours as SVG |
//! | `bundle` | the files |

mod bundle;
mod data;
mod diagnosis;
mod finding;
mod gas;
mod grid;
mod of_flow;
mod of_mesh;
mod of_structure;
mod picture;

pub use bundle::{FailureReport, clear, tell};
pub use finding::Finding;
pub use gas::Then;
pub use grid::Grid;
pub use of_flow::{Failed, by_point};
pub use of_mesh::{examine as examine_mesh, examine_inverted};
pub use of_structure::examine as examine_structure;
