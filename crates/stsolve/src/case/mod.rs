//! The case file: from the text of the user to the checked case.
//!
//! ```text
//! text + --set  ->  Document (every key and value with its place)  ->  raw::Case  ->  Case
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `document` | the TOML document with places; `--set` |
//! | `brackets` | unclosed brackets in it |
//! | `key` | the path of a key, `flow.boundary.left` |
//! | `error` | errors and their places |
//! | `raw` | the keys, their types, defaults and descriptions: the schema |
//! | `continuation` | conditions for continuing the run of another case |
//! | `checked` | the checked case; no other code uses `raw` |
//! | `shape` | unknown keys, lists that are too long, lists in the place of tables |
//! | `state` | a state prescribed by name or by formulas |
//! | `vector` | a displacement prescribed by formulas |
//! | `boundary_motion` | the motion of a boundary |

mod boundary_motion;
mod brackets;
mod checked;
mod checker;
mod choices;
mod continuation;
mod document;
mod error;
mod key;
mod raw;
mod shape;
mod state;
#[cfg(test)]
mod tests;
mod vector;

pub use boundary_motion::{BoundaryMotion, DisplacementOf, NormalMotion, RigidMotion, RigidStep};
pub use checked::*;
pub use continuation::{Difference, Differences, differences};
pub use document::Document;
pub use error::{CaseError, Cause, Place};
pub use raw::schema;
pub use state::State;
pub use vector::Vector;
