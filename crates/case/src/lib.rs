//! Case files: TOML and formulas become a checked [`Case`].
//!
//! This crate is the only one that reads TOML. It computes nothing but the mesh at rest, and prints nothing.
//!
//! ```text
//! text + --set  ->  Document (every key and value with its place)  ->  raw::Case  ->  Case
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `input_file`, `mesh_file` | files that the user names, read whole; a mesh file, if it fits |
//! | `document` | the TOML document with places; `--set` |
//! | `brackets` | brackets of it that are not closed |
//! | `key` | the path of a key, `flow.boundary.left` |
//! | `error` | what can be wrong, and where |
//! | `magnitude` | which numbers the program can compute with |
//! | `raw` | the keys, their types, defaults and descriptions: the schema |
//! | `continuation` | which cases may continue each other's runs |
//! | `checked` | the case as the program needs it; no other code sees `raw` |
//! | `shape` | keys that there are not, lists that are too long, lists in the place of tables |
//! | `state` | a state prescribed by name or by formulas |
//! | `vector` | a displacement prescribed by formulas |
//! | `boundary_motion` | how a boundary moves |
//! | `expression` | formulas and tables |
//! | `any_mesh` | a mesh whose dimension is known only when it is read |
//! | `memory` | the memory that is there |
//! | `excerpt`, `nearest` | a piece of a line with carets below it; the name that was probably meant |

mod any_mesh;
mod boundary_motion;
mod brackets;
mod checked;
mod checker;
mod choices;
mod continuation;
mod document;
mod error;
mod excerpt;
pub mod expression;
pub mod input_file;
mod key;
mod magnitude;
pub mod memory;
pub mod mesh_file;
mod nearest;
mod raw;
mod shape;
mod state;
#[cfg(test)]
mod tests;
mod vector;

pub use any_mesh::AnyMesh;
pub use boundary_motion::{BoundaryMotion, DisplacementOf, NormalMotion, RigidMotion, RigidStep};
pub use checked::*;
pub use continuation::{Difference, Differences, differences};
pub use document::Document;
pub use error::{CaseError, Cause, Place};
pub use raw::schema;
pub use state::State;
pub use vector::Vector;
