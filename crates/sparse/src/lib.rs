//! Direct solution of sparse linear systems with dense square blocks.
//!
//! 1. [`EliminationTree`]: the order of elimination, by minimum degree or by nested dissection of a mesh.
//! 2. [`Factorisation`]: A = L L^H or P A = L U along that tree, real or complex, in single or double precision.
//! 3. [`dependency_schedule`]: parallel work on fronts, or on the rows of an incomplete factorisation, each after those that it
//!    needs.
//!
//! The bits of a factorisation and of a solution do not depend on the number of threads.
//!
//! The deflection u of a loaded string, -u'' = 1, by second differences at n inner points with a distance of 1:
//!
//! ```
//! use sparse::{BlockMatrix, Kind};
//! use std::sync::Arc;
//!
//! let n = 9;
//! let neighbours = (0..n).map(|i: usize| vec![i.saturating_sub(1), (i + 1).min(n - 1)]).collect();
//! let mut matrix = BlockMatrix::new(Kind::Cholesky, 1, neighbours);
//! for i in 0..n {
//!     matrix.add(i, i, |_, _| 2.0);
//!     if i > 0 {
//!         matrix.add(i, i - 1, |_, _| -1.0);
//!     }
//! }
//! let factors = matrix.factor(Arc::new(matrix.elimination_tree()?))?;
//! let mut u = vec![1.0; n];
//! factors.solve(&mut u, 1, &mut Vec::new());
//! for (i, u) in u.iter().enumerate() {
//!     let exact = 0.5 * ((i + 1) * (n - i)) as f64;
//!     assert!((u - exact).abs() < 1e-12, "{u} at point {i}");
//! }
//! # Ok::<(), sparse::Error>(())
//! ```

mod block_matrix;
mod compiled;
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

use compiled::Compiled;
use faer::traits::ComplexField;
use std::ops::{AddAssign, Neg, SubAssign};

/// An entry of a matrix: f64, f32, or a complex number of either.
pub trait Scalar: Compiled + ComplexField + Copy + AddAssign + SubAssign + Neg<Output = Self> + Send + Sync {}

impl<T: Compiled + ComplexField + Copy + AddAssign + SubAssign + Neg<Output = T> + Send + Sync> Scalar for T {}

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
