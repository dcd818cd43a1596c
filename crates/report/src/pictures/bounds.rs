//! Boxes along the axes.

use super::snapshot::Snapshot;
use std::array::from_fn;

/// A box along the axes of the plane or of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// The corner with the smallest coordinates.
    pub lower: [f64; D],
    /// The corner with the largest coordinates.
    pub upper: [f64; D],
}

/// A box in the plane.
pub type Extent = Bounds<2>;

/// A box in space.
pub type Cuboid = Bounds<3>;

impl<const D: usize> Bounds<D> {
    /// The empty box; every point extends it.
    pub const EMPTY: Self = Bounds { lower: [f64::INFINITY; D], upper: [f64::NEG_INFINITY; D] };

    /// The smallest box that contains also the point `x`.
    pub fn with(self, x: [f64; D]) -> Self {
        Bounds { lower: from_fn(|i| self.lower[i].min(x[i])), upper: from_fn(|i| self.upper[i].max(x[i])) }
    }

    /// The box of some points.
    pub fn of(points: impl IntoIterator<Item = [f64; D]>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        if other.is_empty() { self } else { self.with(other.lower).with(other.upper) }
    }

    /// The intersection of both.
    pub fn intersection(self, other: Self) -> Self {
        let (lower, upper) =
            (|i: usize| self.lower[i].max(other.lower[i]), |i: usize| self.upper[i].min(other.upper[i]));
        Bounds { lower: from_fn(lower), upper: from_fn(upper) }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        !(0..D).all(|i| self.lower[i] <= self.upper[i])
    }

    /// Whether a point lies in it.
    pub fn contains(&self, x: &[f64; D]) -> bool {
        (0..D).all(|i| self.lower[i] <= x[i] && x[i] <= self.upper[i])
    }

    /// Lengths of the edges.
    pub fn size(&self) -> [f64; D] {
        from_fn(|i| self.upper[i] - self.lower[i])
    }

    /// The longest edge.
    pub fn length(&self) -> f64 {
        self.size().into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The point in the middle.
    pub fn centre(&self) -> [f64; D] {
        from_fn(|i| 0.5 * (self.lower[i] + self.upper[i]))
    }

    /// The box with a margin added on every side, one per axis.
    pub fn grown(self, by: [f64; D]) -> Self {
        Bounds { lower: from_fn(|i| self.lower[i] - by[i]), upper: from_fn(|i| self.upper[i] + by[i]) }
    }

    /// The same box elsewhere.
    pub fn shifted(self, by: [f64; D]) -> Self {
        Bounds { lower: from_fn(|i| self.lower[i] + by[i]), upper: from_fn(|i| self.upper[i] + by[i]) }
    }

    /// The corners.
    pub fn corners(&self) -> impl Iterator<Item = [f64; D]> {
        let (lower, upper) = (self.lower, self.upper);
        (0..1 << D).map(move |k| from_fn(|i| if k >> i & 1 == 0 { lower[i] } else { upper[i] }))
    }
}

impl Cuboid {
    /// The box around the nodes of a cell.
    pub fn of_cell<const D: usize>(snapshot: &Snapshot<D>, cell: usize) -> Self {
        Self::of(snapshot.cell_box(cell).iter().map(in_space))
    }
}

/// A point with three coordinates.
pub fn in_space<const D: usize>(x: &[f64; D]) -> [f64; 3] {
    from_fn(|i| x.get(i).copied().unwrap_or(0.0))
}
