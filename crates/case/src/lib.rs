//! Case files: TOML and formulas become a checked [`Case`].
//!
//! No crate but this and `case_keys` reads TOML. The only thing that it computes is the mesh at rest. It prints nothing.
//!
//! ```text
//! text + --set  ->  Document (every key and value with its place)  ->  case_keys::Case  ->  Case
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `input_file`, `mesh_file` | input files, read as a whole; whether a mesh file fits into memory |
//! | `document`, `tree` | the TOML document with places; `--set`; changes of its tables |
//! | `brackets` | unclosed brackets in it |
//! | `key` | the path of a key, `flow.boundary.left` |
//! | `error`, `cause` | errors, their places and their causes |
//! | `checker`, `choices` | checks that name the key of an error; what the schema offers at a key |
//! | `magnitude` | which numbers the program can compute with |
//! | `continuation`, `continued_tables` | conditions for continuing the run of another case; longer tables |
//! | `checked` | the checked case; no other code uses the keys, `case_keys` |
//! | `reading` | from the document to the raw case: all errors of keys and types; formulas where numbers are needed |
//! | `consequences` | which errors may only follow from other ones |
//! | `shape` | unknown keys, lists that are too long, lists in the place of tables |
//! | `state` | a state prescribed by name or by formulas |
//! | `vector` | a displacement prescribed by formulas |
//! | `point_data` | data of boundary conditions and of sources by formulas |
//! | `boundary_motion` | the motion of a boundary |
//! | `expression` | formulas and tables |
//! | `fields` | components of fields, formulas in them |
//! | `any_mesh` | a mesh whose dimension is known only after it is read |
//! | `memory` | available memory |
//! | `names_in_use` | constants and tables that formulas contain |
//! | `excerpt`, `nearest` | a piece of a line with carets below it; the name that was probably meant |
//!
//! A case in memory. An error names the key and its value:
//!
//! ```
//! use case::{AnyCase, Document};
//!
//! let text = r#"
//!     mesh = { order = 2, generate.box = { lower = [0, 0], upper = [3, 1], cells = [3, 2], periodic = ["x", "y"] } }
//!     flow = { order = 4, initial.uniform = { velocity = ["1 / 2", 0], pressure = 1 } }
//!     time = { order = 1, end = 0.2, slabs = 2 }
//! "#;
//! let parse = |settings: &[String]| Document::parse("stream.toml".as_ref(), text.to_owned(), settings);
//! let AnyCase::Plane(case) = AnyCase::check(&parse(&[])?)? else { return Err("not in the plane".into()) };
//! assert_eq!((case.mesh.n_cells(), case.mesh.volume()), (6, 3.0));
//!
//! let Err(error) = AnyCase::check(&parse(&["flow.order=99".to_owned()])?) else { return Err("accepted".into()) };
//! assert_eq!((error.key.as_str(), error.value.as_deref()), ("flow.order", Some("99")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod any_mesh;
mod boundary_motion;
mod brackets;
mod cause;
mod checked;
mod checker;
mod choices;
mod consequences;
mod continuation;
mod continued_tables;
mod document;
mod error;
mod excerpt;
pub mod expression;
mod fields;
pub mod input_file;
mod key;
mod magnitude;
pub mod memory;
pub mod mesh_file;
mod names_in_use;
mod nearest;
mod point_data;
mod reading;
mod shape;
mod state;
#[cfg(test)]
mod tests;
mod tree;
mod vector;

pub use any_mesh::{AnyMesh, MeshFileError};
pub use boundary_motion::{BoundaryMotion, DisplacementOf, NormalMotion, RigidMotion, RigidStep};
pub(crate) use case_keys as raw;
pub use case_keys::{editor_schema, schema};
pub use cause::Cause;
pub use checked::*;
pub use continuation::{Difference, Differences, cut, differences, differences_after, lasting_of, values};
pub use coupled::rounded_time;
pub use document::Document;
pub use error::{CaseError, Place};
pub use fields::FieldFormula;
pub use point_data::PointData;
pub use state::State;
pub use vector::Vector;
