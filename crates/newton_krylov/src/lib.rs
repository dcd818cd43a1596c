//! Newton-Krylov on vectors: FGMRES, CG, inexact Newton, pseudo-transient continuation.
//!
//! Nothing here knows a mesh, a physics or time. From the bottom up:
//!
//! * [`inner_product`] — every global reduction, in a fixed order: same bits for any number of threads;
//! * [`operator`] — what a linear solver needs to know of A x = b;
//! * [`fgmres`], [`cg`] — the linear solvers;
//! * [`forcing`], [`line_search`], [`pseudo_time`] — the three rules of an inexact Newton step: how exactly to solve, how far
//!   to go, and how much to damp;
//! * [`problem`] — what the driver needs to know of R(z) = 0;
//! * [`newton`] — the driver;
//! * [`finite_difference`] — the Jacobian action by differences of R: an oracle for tests, and a setting.
//!
//! Each solver has its `Settings`, its `Report` and its `Error`; the memory that it keeps from one solve to the next is its
//! `Workspace`, owned by the caller.

pub mod cg;
pub mod fgmres;
pub mod finite_difference;
pub mod forcing;
pub mod inner_product;
pub mod line_search;
pub mod newton;
pub mod operator;
pub mod problem;
pub mod pseudo_time;

#[cfg(test)]
mod test_problems;
