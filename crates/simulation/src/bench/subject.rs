//! The measured kernels, and their amount of work.

/// A kernel and the work of one call.
#[derive(Clone, Debug)]
pub struct Work {
    /// Its name.
    pub kernel: &'static str,
    /// The number of unknowns.
    pub unknowns: f64,
    /// Floating-point operations, a fused multiply-add counting two; None if they are not counted.
    pub flops: Option<f64>,
    /// Bytes that must be read from and written to memory, with every number once.
    pub bytes: f64,
}

/// Bytes of `numbers` in double precision.
pub fn bytes(numbers: usize) -> f64 {
    8.0 * numbers as f64
}

/// The largest number of nodes per direction in 3-D, for the memory of a small machine.
const MOST_SPACE_NODES: usize = 64;

/// The requested size of a subject.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Directions of space.
    pub dimension: usize,
    /// N, nodes per direction of a cell.
    pub order: usize,
    /// The same of the mesh under a flow.
    pub mesh_order: usize,
    /// The rule of the flow.
    pub quadrature: fem::Quadrature,
    /// Nodes per direction of the mesh, if the user gives a number.
    pub nodes: Option<usize>,
}

impl Size {
    /// Cells per direction, an even number so that packs are full, for about the requested number of nodes per
    /// direction.
    pub fn even_cells(&self, plane: usize, space: usize) -> usize {
        let nodes = self.nodes(plane, space);
        2 * ((nodes as f64 / (2 * self.order) as f64).round() as usize).max(1)
    }
    /// Nodes per direction: as requested, or else `plane` or `space` by the dimension.
    pub fn nodes(&self, plane: usize, space: usize) -> usize {
        match self.dimension {
            2 => self.nodes.unwrap_or(plane),
            _ => self.nodes.unwrap_or(space).min(MOST_SPACE_NODES),
        }
    }
}

/// A set of kernels to be measured, in one pool of threads.
pub trait Subject: Send {
    /// The kernels.
    fn work(&self) -> Vec<Work>;
    /// Calls kernel number `number`.
    fn run(&mut self, number: usize);
}

/// A subject that can be set up for any order.
pub trait Build: Subject + Sized + 'static {
    /// The subject of that size; `None` if it would take too much memory.
    ///
    /// # Errors
    /// The errors of its parts.
    fn build(size: Size) -> anyhow::Result<Option<Self>>;

    /// The same, of any kind.
    ///
    /// # Errors
    /// As [`Build::build`].
    fn boxed(size: Size) -> anyhow::Result<Option<Box<dyn Subject>>> {
        Ok(Self::build(size)?.map(|subject| Box::new(subject) as Box<dyn Subject>))
    }
}
