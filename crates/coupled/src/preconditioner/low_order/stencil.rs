//! Who neighbours a node of a cell.

/// Across a face of a node's control volume.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// Another node of the cell.
    Inside(u32),
    /// The neighbour's node, by its number on the face of the cell.
    Across(u32),
}

/// What lies across every face of the nodes of a cell.
pub(super) struct Stencil {
    /// `[node][face]`
    steps: Vec<Step>,
    faces: usize,
}

impl Stencil {
    /// Of cells with `n` nodes per line in `D` dimensions.
    pub(super) fn new<const D: usize>(n: usize) -> Self {
        let faces = 2 * D;
        let step = |number: usize| {
            let (node, face) = (number / faces, number % faces);
            let stride = n.pow(face as u32 / 2);
            if node / stride % n == face % 2 * (n - 1) {
                Step::Across((node % stride + node / stride / n * stride) as u32)
            } else {
                Step::Inside(if face % 2 == 1 { node + stride } else { node - stride } as u32)
            }
        };
        Stencil { steps: (0..n.pow(D as u32) * faces).map(step).collect(), faces }
    }

    /// The steps across the faces of `node`.
    #[inline(always)]
    pub(super) fn of(&self, node: usize) -> &[Step] {
        &self.steps[node * self.faces..(node + 1) * self.faces]
    }
}
