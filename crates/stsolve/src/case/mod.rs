//! The case file: what the user wrote, and what the program needs.
//!
//! ```text
//! text + --set  ->  Document (every key and value with its place)  ->  raw::Case  ->  Case
//! ```
//!
//! | module | holds |
//! |---|---|
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

mod boundary_motion;
mod brackets;
mod checked;
mod checker;
mod choices;
mod continuation;
mod document;
mod error;
mod key;
mod magnitude;
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
