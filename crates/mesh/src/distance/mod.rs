//! The Euclidean distance of points to curved boundaries.
//!
//! A tree of boxes finds the facets that may be nearest ([`BoundaryDistance`]); each facet finds its nearest point
//! (`patch`).

mod patch;
#[cfg(test)]
mod tests;

use crate::Mesh;
use patch::{Patch, Tables};

/// Facets of some boundaries, in a tree for the search of the nearest.
///
/// Distances refer to the curved facets themselves, polynomials of degree N - 1, not to a polygon through their nodes.
#[derive(Clone, Debug)]
pub struct BoundaryDistance<const D: usize> {
    tables: Tables,
    tree: Option<Tree<D>>,
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame<const D: usize> {
    lower: [f64; D],
    upper: [f64; D],
}

/// Half of the facets, and the other half; each in a box.
#[derive(Clone, Debug)]
enum Tree<const D: usize> {
    Leaf(Patch<D>),
    Branch(Frame<D>, Box<[Tree<D>; 2]>),
}

impl<const D: usize> BoundaryDistance<D> {
    /// For the boundaries of `mesh` with the indices `boundaries`.
    pub fn new(mesh: &Mesh<D>, boundaries: &[usize]) -> Self {
        let tables = Tables::new(mesh.order());
        let facets = mesh.boundary_facets().iter().filter(|facet| boundaries.contains(&facet.boundary));
        let patches: Vec<_> = facets.map(|facet| Patch::new(&tables, mesh.face_positions(facet.side))).collect();
        BoundaryDistance { tables, tree: Tree::new(patches) }
    }

    /// The distance of `x` to the nearest point of the boundaries, to round-off; infinite if there are none.
    pub fn at(&self, x: &[f64; D]) -> f64 {
        let mut nearest = f64::INFINITY;
        if let Some(tree) = &self.tree {
            tree.search(&self.tables, x, &mut nearest);
        }
        nearest
    }
}

impl<const D: usize> Tree<D> {
    fn new(mut patches: Vec<Patch<D>>) -> Option<Self> {
        if patches.len() <= 1 {
            return patches.pop().map(Tree::Leaf);
        }
        let frame = patches.iter().map(|patch| patch.frame).reduce(Frame::around)?;
        let axis = (0..D).max_by(|&a, &b| frame.extent(a).total_cmp(&frame.extent(b))).unwrap_or(0);
        patches.sort_by(|a, b| a.frame.middle(axis).total_cmp(&b.frame.middle(axis)));
        let upper = patches.split_off(patches.len() / 2);
        Some(Tree::Branch(frame, Box::new([Tree::new(patches)?, Tree::new(upper)?])))
    }

    fn frame(&self) -> &Frame<D> {
        match self {
            Tree::Leaf(patch) => &patch.frame,
            Tree::Branch(frame, _) => frame,
        }
    }

    /// Lowers `nearest` to the distance of the nearest facet; boxes that are further away are skipped.
    fn search(&self, tables: &Tables, x: &[f64; D], nearest: &mut f64) {
        match self {
            Tree::Leaf(patch) => *nearest = patch.distance(tables, x, *nearest),
            Tree::Branch(_, halves) => {
                let distances = [0, 1].map(|half: usize| halves[half].frame().distance(x));
                let first = usize::from(distances[1] < distances[0]);
                for half in [first, 1 - first] {
                    if distances[half] < *nearest {
                        halves[half].search(tables, x, nearest);
                    }
                }
            }
        }
    }
}

impl<const D: usize> Frame<D> {
    /// The box around two.
    fn around(self, other: Self) -> Self {
        Frame {
            lower: std::array::from_fn(|i| self.lower[i].min(other.lower[i])),
            upper: std::array::from_fn(|i| self.upper[i].max(other.upper[i])),
        }
    }

    fn extent(&self, axis: usize) -> f64 {
        self.upper[axis] - self.lower[axis]
    }

    fn middle(&self, axis: usize) -> f64 {
        0.5 * (self.upper[axis] + self.lower[axis])
    }

    /// The distance of `x` to the box; 0 inside.
    fn distance(&self, x: &[f64; D]) -> f64 {
        tensor::norm(&std::array::from_fn::<f64, D, _>(|i| (self.lower[i] - x[i]).max(x[i] - self.upper[i]).max(0.0)))
    }
}
