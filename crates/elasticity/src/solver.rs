//! Which method solves with K.

use crate::condensation::Condensation;
use crate::low_order::LowOrder;

/// How K_ff d_f = b_f is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// What is cheapest for the size of the mesh.
    #[default]
    Automatic,
    /// Elimination of the nodes along a tree of parts of the mesh; no iterations.
    Direct,
    /// Conjugate gradients, preconditioned by a factored low-order refinement.
    ConjugateGradients,
}

/// Bytes up to which a direct factor is taken.
const MAX_DIRECT_BYTES: usize = 1 << 30;

impl Solver {
    /// What is meant for a mesh whose direct factor needs `direct_bytes`.
    pub(crate) fn chosen(self, direct_bytes: usize) -> Solver {
        match self {
            Solver::Automatic if direct_bytes <= MAX_DIRECT_BYTES => Solver::Direct,
            Solver::Automatic => Solver::ConjugateGradients,
            _ => self,
        }
    }
}

/// K_ff^{-1}, or something near it, prepared.
pub(crate) enum Inverse<const D: usize> {
    Direct(Box<Condensation<D>>),
    LowOrder(Box<LowOrder<D>>),
}
