//! The kernels of a run, to be measured by `stsolve bench`.
//!
//! They stand here because this crate compiles the solver for two and for three dimensions. Elsewhere it would be compiled once more. The
//! command line is compiled without optimisation: nothing that is timed stands there.
//!
//! | module | holds |
//! |---|---|
//! | `subject` | a set of measured kernels, and their amount of work |
//! | `elastic`, `elastic_solvers`, `flow`, `preconditioner`, `vectors` | the subjects |
//! | `arithmetic` | the work that tells the peak of the machine |
//! | `messages` | what ranks send each other, beside a model |

mod arithmetic;
mod elastic;
mod elastic_solvers;
mod flow;
mod messages;
mod preconditioner;
mod subject;
mod vectors;

pub use arithmetic::multiply_and_add;
use elastic::Elastic;
use elastic_solvers::ElasticSolvers;
use flow::Flow;
pub use messages::MessageCount;
use preconditioner::{ByLines, Preconditioned};
use subject::Build;
pub use subject::{Size, Subject, Work, bytes};
use vectors::Vectors;

/// Kernels that are measured together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernels {
    /// The stiffness operator of the mesh, the set-up of its solver, and a solve.
    Elasticity,
    /// Residual and exact Jacobian products of the flow.
    Flow,
    /// Set-up and application of the preconditioners of the flow, and of each solver of the mesh.
    Preconditioner,
    /// The work of FGMRES on vectors.
    Vectors,
}

impl Kernels {
    /// Their name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Kernels::Elasticity => "elasticity",
            Kernels::Flow => "flow",
            Kernels::Preconditioner => "preconditioner",
            Kernels::Vectors => "vectors",
        }
    }
}

/// Sets up a subject of that size; `None` if it would take too much memory.
pub type Builder = fn(Size) -> anyhow::Result<Option<Box<dyn Subject>>>;

/// The subjects of `kernels` in `dimension` 2 or 3.
pub fn builders(kernels: Kernels, dimension: usize) -> Vec<Builder> {
    match (kernels, dimension) {
        (Kernels::Elasticity, 2) => vec![Elastic::<2>::boxed],
        (Kernels::Elasticity, _) => vec![Elastic::<3>::boxed],
        (Kernels::Flow, 2) => vec![Flow::<2, 4>::boxed],
        (Kernels::Flow, _) => vec![Flow::<3, 5>::boxed],
        (Kernels::Preconditioner, 2) => {
            vec![Preconditioned::<2, 4>::boxed, ByLines::<2, 4>::boxed, ElasticSolvers::<2>::boxed]
        }
        (Kernels::Preconditioner, _) => {
            vec![Preconditioned::<3, 5>::boxed, ByLines::<3, 5>::boxed, ElasticSolvers::<3>::boxed]
        }
        (Kernels::Vectors, _) => vec![Vectors::boxed],
    }
}

/// Counts what ranks send each other, at the orders and in the dimension of `size`.
///
/// # Errors
/// Those of the mesh.
pub fn count_messages(size: Size) -> anyhow::Result<Vec<MessageCount>> {
    if size.dimension == 2 { messages::count::<2, 4>(size) } else { messages::count::<3, 5>(size) }
}
