//! What can be measured.

use clap::ValueEnum;
use simulation::bench::Kernels;

/// A group of kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Group {
    /// The stiffness operator of the mesh, the set-up of its solver, and a solve.
    Elasticity,
    /// Residual and exact Jacobian products of the flow.
    Flow,
    /// Set-up and application of the preconditioner of the flow, and of each solver of the mesh.
    Preconditioner,
    /// The work of FGMRES on vectors.
    Vectors,
    /// What ranks send each other for a flow, beside a model: counts, not seconds.
    Messages,
}

impl Group {
    /// The kernels that are measured in seconds, if any.
    pub(super) fn timed(self) -> Option<Kernels> {
        match self {
            Group::Elasticity => Some(Kernels::Elasticity),
            Group::Flow => Some(Kernels::Flow),
            Group::Preconditioner => Some(Kernels::Preconditioner),
            Group::Vectors => Some(Kernels::Vectors),
            Group::Messages => None,
        }
    }
}
