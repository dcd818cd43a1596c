//! The Jacobian of the operator of space in blocks, and the traces that its off-diagonal blocks act on.
//!
//! The residual of a cell depends on a neighbour only through the traces on their facet. So an off-diagonal block is A_ik
//! = T_f^T B T_g with the traces T_g of cell k and a small square matrix B. Its rows and columns are traces
//! `[kind][component][face node]`, each side in its own lattice.

use crate::traces::FaceMaps;
use std::ops::AddAssign;
use tensor::Arch;

/// How the entries of blocks are stored: in single precision for factors that are stored with fewer bits anyway, in double precision where
/// differences of entries count.
pub trait Stored: Copy + Default + Send + Sync + AddAssign + Into<f64> {
    /// `x`, rounded.
    fn of(x: f64) -> Self;
}

impl Stored for f32 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x as f32
    }
}

impl Stored for f64 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
}

/// The coupling of two cells across a facet.
#[derive(Clone)]
pub struct Coupling<T> {
    /// The cells on the minus and the plus side.
    pub cells: [usize; 2],
    /// Their faces.
    pub faces: [usize; 2],
    /// Row minus, column plus: `[column trace][row trace]`.
    pub minus_plus: Vec<T>,
    /// Row plus, column minus.
    pub plus_minus: Vec<T>,
}

/// The Jacobian A of the operator of space, and the mass matrix, at one time.
pub struct SpaceJacobian<T> {
    /// Unknowns of a cell at one time: components times nodes.
    pub block: usize,
    /// A_ii, `[cell][column][row]`.
    pub diagonal: Vec<T>,
    /// int w phi J, the same for every component, `[cell][column][row]` over nodes.
    pub mass: Vec<T>,
    /// Couplings across the interior facets.
    pub couplings: Vec<Coupling<T>>,
    /// The traces that couplings act on.
    pub traces: TraceSpace,
}

impl<T: Stored> SpaceJacobian<T> {
    /// The block A_ii of `cell`, by columns.
    pub fn block_of(&self, cell: usize) -> &[T] {
        let len = self.block * self.block;
        &self.diagonal[cell * len..(cell + 1) * len]
    }

    /// The mass matrix of `cell`, by columns.
    pub fn mass_of(&self, cell: usize) -> &[T] {
        let len = self.traces.nodes * self.traces.nodes;
        &self.mass[cell * len..(cell + 1) * len]
    }

    /// Bytes of all entries.
    pub fn bytes(&self) -> usize {
        let couplings: usize = self.couplings.iter().map(|c| c.minus_plus.len() + c.plus_minus.len()).sum();
        (self.diagonal.len() + self.mass.len() + couplings) * size_of::<T>()
    }
}

/// The traces of a cell on a face, as functionals of the cell's coefficients.
pub struct TraceSpace {
    kinds: usize,
    components: usize,
    /// Nodes of a face.
    pub face_nodes: usize,
    /// Nodes of a cell.
    pub nodes: usize,
    functionals: Vec<Vec<Vec<(usize, f64)>>>,
}

impl TraceSpace {
    pub(crate) fn new(maps: &FaceMaps, faces: usize, components: usize, nodes: usize, viscous: bool) -> Self {
        let functionals: Vec<_> = (0..faces).map(|face| maps.functionals(face, viscous)).collect();
        let kinds = if viscous { 2 } else { 1 };
        TraceSpace { kinds, components, face_nodes: functionals[0].len() / kinds, nodes, functionals }
    }

    /// Traces on one face: kinds times components times face nodes.
    pub fn len(&self) -> usize {
        self.kinds * self.components * self.face_nodes
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Trace number `trace` on `face` as a sum over coefficients of the cell: the offset of its component, and (node, weight).
    pub fn functional(&self, face: usize, trace: usize) -> (usize, &[(usize, f64)]) {
        let (tensor, i) = (trace / self.face_nodes, trace % self.face_nodes);
        let (kind, component) = (tensor / self.components, tensor % self.components);
        (component * self.nodes, &self.functionals[face][kind * self.face_nodes + i])
    }

    /// The kind of a trace, and its number among the traces of that kind.
    pub(crate) fn split(&self, trace: usize) -> (usize, usize) {
        let per_kind = self.components * self.face_nodes;
        (trace / per_kind, trace % per_kind)
    }

    /// The same trace in a lattice whose nodes are reordered by `permutation`.
    pub(crate) fn permuted(&self, trace: usize, permutation: &[usize]) -> usize {
        trace / self.face_nodes * self.face_nodes + permutation[trace % self.face_nodes]
    }

    /// Adds T_f^T B T_g to a square matrix over a cell's coefficients: B in traces of the faces f (rows) and g, both by columns.
    pub fn add_lifted<S: Stored, T: Stored>(&self, [rows, columns]: [usize; 2], b: &[S], matrix: &mut [T]) {
        let block = self.components * self.nodes;
        let mut lifted = vec![0.0; block];
        for (column, b) in b.chunks_exact(self.len()).enumerate() {
            lifted.fill(0.0);
            for (row, value) in b.iter().enumerate() {
                let ((offset, functional), value) = (self.functional(rows, row), (*value).into());
                functional.iter().for_each(|&(node, weight)| lifted[offset + node] += weight * value);
            }
            let (offset, functional) = self.functional(columns, column);
            Arch::new().dispatch(|| {
                for &(node, weight) in functional {
                    let start = (offset + node) * block;
                    matrix[start..start + block].iter_mut().zip(&lifted).for_each(|(a, l)| *a += T::of(weight * l));
                }
            });
        }
    }
}
