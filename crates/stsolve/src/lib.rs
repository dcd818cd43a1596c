//! The stsolve command: case files, progress, reports.
//!
//! This crate is the only one that reads TOML, prints or exits; it holds no numerics.

pub mod case;
pub mod expression;
mod nearest;
