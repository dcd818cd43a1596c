//! Newton-Krylov on vectors: FGMRES, CG, inexact Newton, pseudo-transient continuation.
//!
//! This crate contains no mesh, physics or time. From the bottom up:
//!
//! * [`inner_product`]: every global reduction, in a fixed order, so that any number of threads gives the same bits;
//! * [`operator`]: the interface of linear systems A x = b;
//! * [`fgmres`], [`cg`]: the linear solvers;
//! * [`forcing`], [`line_search`], [`pseudo_time`]: the accuracy, length and damping of an inexact Newton step;
//! * [`problem`]: the interface of nonlinear problems R(z) = 0;
//! * [`newton`]: the driver;
//! * [`finite_difference`]: Jacobian products by differences of R, as a reference for tests and as a setting.
//!
//! Each solver has its `Settings`, its `Report` and its `Error`. Its `Workspace`, owned by the caller, is the memory kept
//! between solves.

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
