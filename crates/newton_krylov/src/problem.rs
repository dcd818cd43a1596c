//! The interface of nonlinear problems R(z) = 0.

use std::ops::Range;

use crate::inner_product::InnerProduct;

/// A named part of the unknown vector with its own convergence test and its own pseudo-time step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// The name used in reports and messages.
    pub name: &'static str,
    /// The entries of z, and of R, that belong to the field.
    pub range: Range<usize>,
}

/// A state without a residual: a negative density, an inverted cell.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("inadmissible state: {quantity} = {value:e} {location}")]
pub struct Inadmissible {
    /// The quantity out of range, for example "density".
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// The location, for example "in cell 12 at t = 0.25".
    pub location: String,
}

/// A nonlinear system R(z) = 0 with one or several fields.
///
/// The driver calls [`Self::linearise`] and then, for that point, [`Self::jacobian_product`], [`Self::add_pseudo_time`] and
/// [`Self::precondition`]. The Newton step is
///
/// ```text
/// (newton-step)   ( dR/dz + T_tau ) dz = -R(z),     T_tau = sum over fields k of (1/dtau_k) M_k
/// ```
pub trait NonlinearProblem {
    /// The length of z and of R.
    fn len(&self) -> usize;

    /// Whether there are no unknowns.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The fields; their ranges are disjoint and cover `0..len()` except padding.
    fn fields(&self) -> &[Field];

    /// The inner product of residuals, weighted so that fields are comparable. It must not change during a solve.
    fn inner_product(&self) -> &dyn InnerProduct;

    /// r := R(z); the point of linearisation does not change.
    ///
    /// # Errors
    /// [`Inadmissible`] if R is not defined at z; the content of `r` is then meaningless.
    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible>;

    /// Fixes the point of linearisation and 1/dtau_k of each field; may refresh the preconditioner.
    ///
    /// # Errors
    /// [`Inadmissible`] if dR/dz is not defined at z.
    fn linearise(&mut self, z: &[f64], inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible>;

    /// increment := a first guess of the solution of a system with the matrix of (newton-step) and the given right side. If the matrix is block
    /// triangular, the problem can solve the leading block here, exactly. Its part of all further directions is then zero. The default is zero.
    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        debug_assert_eq!(right_side.len(), increment.len());
        increment.fill(0.0);
    }

    /// out := dR/dz direction, without T_tau, at the point of linearisation.
    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]);

    /// out := out + T_tau direction, with the 1/dtau_k of the point of linearisation. Called only while some 1/dtau_k > 0.
    fn add_pseudo_time(&mut self, direction: &[f64], out: &mut [f64]);

    /// The norm in which the line search compares the residual `r` with others, for the point of linearisation. The default is that of the
    /// inner product. Problems with stiff and soft directions take |P^-1 r|, the size of an increment. There a Newton step that is good for
    /// the soft directions may enlarge |r| along the stiff ones until the next step.
    fn merit(&mut self, r: &[f64]) -> f64 {
        self.inner_product().norm(r)
    }

    /// out := P^-1 r, where P approximates dR/dz + T_tau.
    fn precondition(&mut self, r: &[f64], out: &mut [f64]);

    /// An estimate of the part of each |R_k| at `z` that rounding causes, at the cost of about one product; `None` if unknown. The
    /// point of linearisation is lost. The driver asks only after a step that made almost no progress.
    fn round_off(&mut self, z: &[f64]) -> Option<Vec<f64>> {
        debug_assert_eq!(z.len(), self.len());
        None
    }

    /// The largest a in (0, 1] for which z + a dz is known to be admissible; 1 if nothing is known.
    fn largest_step(&mut self, z: &[f64], increment: &[f64]) -> f64;
}
