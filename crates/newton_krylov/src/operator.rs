//! The interface of linear systems A x = b.

use crate::inner_product::{InnerProduct, copy};

/// A linear map, known by its action.
pub trait LinearOperator {
    /// y := A x
    fn apply(&mut self, x: &[f64], y: &mut [f64]);
}

/// An approximate inverse of a linear map, known by its action. With FGMRES it may change from one call to the next, with
/// CG it may not.
pub trait Preconditioner {
    /// z := P^-1 r
    fn apply(&mut self, r: &[f64], z: &mut [f64]);
}

/// The identity: no preconditioning.
#[derive(Clone, Copy, Debug, Default)]
pub struct Identity;

impl Preconditioner for Identity {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        copy(r, z);
    }
}

/// An operator with its preconditioner and the inner product in which residuals are measured.
///
/// One trait, not three arguments, because operator and preconditioner are often one object: a linearised problem.
pub trait LinearSystem {
    /// y := A x
    fn multiply(&mut self, x: &[f64], y: &mut [f64]);
    /// z := P^-1 r
    fn precondition(&mut self, r: &[f64], z: &mut [f64]);
    /// The inner product of residuals.
    fn inner_product(&self) -> &dyn InnerProduct;
}

/// A [`LinearSystem`] composed of its parts.
pub struct Preconditioned<'a> {
    /// A
    pub operator: &'a mut dyn LinearOperator,
    /// P^-1
    pub preconditioner: &'a mut dyn Preconditioner,
    /// The inner product of residuals.
    pub inner_product: &'a dyn InnerProduct,
}

impl LinearSystem for Preconditioned<'_> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        self.operator.apply(x, y);
    }

    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        self.preconditioner.apply(r, z);
    }

    fn inner_product(&self) -> &dyn InnerProduct {
        self.inner_product
    }
}
