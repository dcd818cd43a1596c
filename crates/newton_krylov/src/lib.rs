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
//!
//! The circle x^2 + y^2 = 2 meets the line x = y at (1, 1):
//!
//! ```
//! use newton_krylov::inner_product::{Euclidean, InnerProduct};
//! use newton_krylov::{newton, problem::{Field, Inadmissible, NonlinearProblem}};
//!
//! struct Circle([f64; 2], [Field; 1]);
//! impl NonlinearProblem for Circle {
//!     fn len(&self) -> usize { 2 }
//!     fn fields(&self) -> &[Field] { &self.1 }
//!     fn inner_product(&self) -> &dyn InnerProduct { &Euclidean }
//!     fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
//!         r.copy_from_slice(&[z[0] * z[0] + z[1] * z[1] - 2.0, z[0] - z[1]]);
//!         Ok(())
//!     }
//!     fn linearise(&mut self, z: &[f64], _: &[f64]) -> Result<(), Inadmissible> { Ok(self.0 = [z[0], z[1]]) }
//!     fn jacobian_product(&mut self, d: &[f64], out: &mut [f64]) {
//!         out.copy_from_slice(&[2.0 * (self.0[0] * d[0] + self.0[1] * d[1]), d[0] - d[1]]);
//!     }
//!     fn add_pseudo_time(&mut self, _: &[f64], _: &mut [f64]) {}
//!     fn precondition(&mut self, r: &[f64], out: &mut [f64]) { out.copy_from_slice(r) }
//!     fn largest_step(&mut self, _: &[f64], _: &[f64]) -> f64 { 1.0 }
//! }
//! let (mut circle, mut z) = (Circle([0.0; 2], [Field { name: "xy", range: 0..2 }]), [3.0, 0.5]);
//! newton::solve(&mut circle, &mut z, None, &newton::Settings::default(), &mut newton::Workspace::default())?;
//! assert!(z.iter().all(|x| (x - 1.0).abs() < 1e-7), "{z:?}");
//! # Ok::<(), newton_krylov::newton::Error>(())
//! ```

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
