//! Direct solution of sparse linear systems with dense square blocks.
//!
//! 1. [`EliminationTree`]: the order of elimination, by minimum degree or by nested dissection of a mesh.
//! 2. [`Factorisation`]: A = L L^H or P A = L U along that tree, real or complex, in single or double precision.
//! 3. [`dependency_schedule`]: parallel work on fronts, or on the rows of an incomplete factorisation, each after those that it
//!    needs.
//!
//! The bits of a factorisation and of a solution do not depend on the number of threads.

mod block_matrix;
mod dependency_schedule;
mod dissection;
mod elimination_tree;
mod factorisation;
mod front;
mod minimum_degree;

pub use block_matrix::BlockMatrix;
pub use dependency_schedule::dependency_schedule;
pub use elimination_tree::{EliminationTree, Front, eliminations};
pub use factorisation::{Factorisation, FrontMatrix};
pub use front::Kind;

use faer::traits::ComplexField;
use std::ops::{AddAssign, Neg, SubAssign};

/// An entry of a matrix: f64, f32, or a complex number of either.
pub trait Scalar: ComplexField + Copy + AddAssign + SubAssign + Neg<Output = Self> + Send + Sync {}

impl<T: ComplexField + Copy + AddAssign + SubAssign + Neg<Output = T> + Send + Sync> Scalar for T {}

/// Why a factorisation fails.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A pivot of a Cholesky factorisation is not positive, or is at round-off of its diagonal entry.
    #[error("the matrix is not positive definite: {cause}")]
    NotDefinite {
        /// The pivot.
        cause: String,
    },
    /// An LU factorisation has entries that are not finite.
    #[error("the matrix is singular")]
    Singular,
    /// The ordering needs more memory than is available.
    #[error("the memory does not suffice to order the matrix")]
    OutOfMemory,
}
