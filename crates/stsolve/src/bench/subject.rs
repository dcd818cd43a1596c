//! The measured kernels, and their amount of work.

use clap::ValueEnum;

/// Kernels that are measured together, in turns.
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
    /// Whether messages are counted, not seconds measured.
    pub(super) fn is_counted(self) -> bool {
        self == Group::Messages
    }
    /// As on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Group::Elasticity => "elasticity",
            Group::Flow => "flow",
            Group::Preconditioner => "preconditioner",
            Group::Vectors => "vectors",
            Group::Messages => "messages",
        }
    }
}

/// A kernel and the work of one call.
#[derive(Clone, Debug)]
pub(super) struct Work {
    /// Its name.
    pub(super) kernel: &'static str,
    /// The number of unknowns.
    pub(super) unknowns: f64,
    /// Floating-point operations, a fused multiply-add counting two; None if they are not counted.
    pub(super) flops: Option<f64>,
    /// Bytes that must be read from and written to memory, with every number once.
    pub(super) bytes: f64,
}

/// Bytes of `numbers` in double precision.
pub(super) fn bytes(numbers: usize) -> f64 {
    8.0 * numbers as f64
}

/// The largest number of nodes per direction in 3-D, for the memory of a small machine.
const MOST_SPACE_NODES: usize = 64;

/// The requested size of a subject.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Directions of space.
    pub(super) dimension: usize,
    /// N, nodes per direction of a cell.
    pub(super) order: usize,
    /// The same of the mesh under a flow.
    pub(super) mesh_order: usize,
    /// The rule of the flow.
    pub(super) quadrature: fem::Quadrature,
    /// Nodes per direction of the mesh, if the user gives a number.
    pub(super) nodes: Option<usize>,
}

impl Size {
    /// Cells per direction, an even number so that packs are full, for about the requested number of nodes per
    /// direction.
    pub(super) fn even_cells(&self, plane: usize, space: usize) -> usize {
        let nodes = self.nodes(plane, space);
        2 * ((nodes as f64 / (2 * self.order) as f64).round() as usize).max(1)
    }
    /// Nodes per direction: as requested, or else `plane` or `space` by the dimension.
    pub(super) fn nodes(&self, plane: usize, space: usize) -> usize {
        match self.dimension {
            2 => self.nodes.unwrap_or(plane),
            _ => self.nodes.unwrap_or(space).min(MOST_SPACE_NODES),
        }
    }
}

/// A set of kernels to be measured, in one pool of threads.
pub(super) trait Subject: Send {
    /// The kernels.
    fn work(&self) -> Vec<Work>;
    /// Calls kernel number `number`.
    fn run(&mut self, number: usize);
}

/// A subject that can be set up for any order.
pub(super) trait Build: Subject + Sized {
    /// The subject of that size; `None` if it would take too much memory.
    ///
    /// # Errors
    /// The errors of its parts.
    fn build(size: Size) -> anyhow::Result<Option<Self>>;
}
