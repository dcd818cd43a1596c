//! Boxes in space.

use crate::pictures::snapshot::Snapshot;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// The corner with the smallest coordinates.
    pub lower: [f64; 3],
    /// The corner with the largest coordinates.
    pub upper: [f64; 3],
}

impl Cuboid {
    /// The empty box; every point extends it.
    pub const EMPTY: Cuboid = Cuboid { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };

    /// The box of some points.
    pub fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let with = |all: Cuboid, x: [f64; 3]| Cuboid {
            lower: std::array::from_fn(|i| all.lower[i].min(x[i])),
            upper: std::array::from_fn(|i| all.upper[i].max(x[i])),
        };
        points.into_iter().fold(Self::EMPTY, with)
    }

    /// The box around the nodes of a cell.
    pub fn of_cell<const D: usize>(snapshot: &Snapshot<D>, cell: usize) -> Self {
        Self::of(snapshot.cell_box(cell).iter().map(in_space))
    }

    /// The smallest box that contains both.
    pub fn union(self, other: Self) -> Self {
        Cuboid {
            lower: std::array::from_fn(|i| self.lower[i].min(other.lower[i])),
            upper: std::array::from_fn(|i| self.upper[i].max(other.upper[i])),
        }
    }

    /// The intersection of both.
    pub fn intersection(self, other: Self) -> Self {
        Cuboid {
            lower: std::array::from_fn(|i| self.lower[i].max(other.lower[i])),
            upper: std::array::from_fn(|i| self.upper[i].min(other.upper[i])),
        }
    }

    /// Whether there is no point in it.
    pub fn is_empty(&self) -> bool {
        !(0..3).all(|i| self.lower[i] <= self.upper[i])
    }

    /// Whether a point lies in it.
    pub fn contains(&self, x: &[f64; 3]) -> bool {
        (0..3).all(|i| self.lower[i] <= x[i] && x[i] <= self.upper[i])
    }

    /// The longest edge.
    pub fn length(&self) -> f64 {
        (0..3).map(|i| self.upper[i] - self.lower[i]).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The box with a margin added on every side.
    pub fn grown(self, margin: f64) -> Self {
        Cuboid { lower: self.lower.map(|x| x - margin), upper: self.upper.map(|x| x + margin) }
    }

    /// The corners.
    pub fn corners(&self) -> impl Iterator<Item = [f64; 3]> {
        let (lower, upper) = (self.lower, self.upper);
        (0..8).map(move |k| std::array::from_fn(|i| if k >> i & 1 == 0 { lower[i] } else { upper[i] }))
    }
}

/// A point with three coordinates.
pub fn in_space<const D: usize>(x: &[f64; D]) -> [f64; 3] {
    std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0))
}
