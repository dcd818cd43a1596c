//! A box between two walls.

use super::box_mesh::partition;
use super::{BoxMesh, Curving};
use crate::{Mesh, MeshError};
use std::array::from_fn;

/// A straight channel [0, L_0] x [0, L_1] (x [0, L_2]): walls "bottom" and "top" at both ends of axis 1, flow along
/// axis 0. In 3-D axis 2 is periodic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelMesh<const D: usize> {
    /// L, the extents.
    pub extent: [f64; D],
    /// Cells along each axis.
    pub cells: [usize; D],
    /// Height of the cells in the middle over the height of the cells at either wall; cells grow by a constant factor
    /// in between. 1 for equal cells.
    pub wall_ratio: f64,
    /// Whether the channel is periodic along axis 0; if not, its ends are "inflow" and "outflow".
    pub periodic: bool,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// Names of the six sides of the box; periodic sides are not named.
const NAMES: [&str; 6] = ["inflow", "outflow", "bottom", "top", "front", "back"];

impl<const D: usize> ChannelMesh<D> {
    /// The mesh.
    pub fn build(&self) -> Result<Mesh<D>, MeshError> {
        let frame = BoxMesh {
            lower: [0.0; D],
            upper: self.extent,
            cells: self.cells,
            order: self.order,
            curving: Curving::None,
            periodic: from_fn(|axis| axis == 2 || axis == 0 && self.periodic),
        };
        frame.check(&from_fn(|axis| if axis == 1 { self.wall_ratio } else { 1.0 }))?;
        let lengths = |axis: usize| match axis {
            1 => wall_cells(self.cells[1], self.wall_ratio),
            _ => vec![1.0; self.cells[axis]],
        };
        frame.build_on(&from_fn(|axis| partition(lengths(axis))), NAMES)
    }
}

/// The proportions of cells between two walls: symmetric, with the middle ones `ratio` times those at the walls.
fn wall_cells(cells: usize, ratio: f64) -> Vec<f64> {
    let from_wall = |i: usize| i.min(cells - 1 - i);
    let growth = match from_wall(cells / 2) {
        0 => 1.0,
        middle => ratio.powf(1.0 / middle as f64),
    };
    (0..cells).map(|i| growth.powi(from_wall(i) as i32)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn cells_at_both_walls_are_small() {
        assert_eq!(wall_cells(5, 16.0), [1.0, 4.0, 16.0, 4.0, 1.0]);
        assert_eq!(wall_cells(4, 3.0), [1.0, 3.0, 3.0, 1.0]);
        assert_eq!(wall_cells(2, 3.0), [1.0, 1.0]);
        assert_eq!(wall_cells(1, 3.0), [1.0]);
    }

    #[test]
    fn names_and_neighbours_in_two_and_three_dimensions() {
        let plane = ChannelMesh { extent: [4.0, 2.0], cells: [4, 6], wall_ratio: 4.0, periodic: false, order: 3 };
        let mesh = plane.build().unwrap();
        assert_eq!(mesh.boundary_names(), ["inflow", "outflow", "bottom", "top"]);
        assert!((mesh.volume() - 8.0).abs() < 1e-13);
        // 1 + 2 + 4 + 4 + 2 + 1 = 14 parts of the height 2.
        assert!((mesh.position(0, &[0.0, 1.0])[1] - 2.0 / 14.0).abs() < 1e-15);
        let mesh = ChannelMesh { periodic: true, ..plane }.build().unwrap();
        assert_eq!(mesh.boundary_names(), ["bottom", "top"]);
        let space =
            ChannelMesh { extent: [4.0, 2.0, 1.0], cells: [4, 6, 2], wall_ratio: 4.0, periodic: false, order: 2 };
        assert_eq!(space.build().unwrap().boundary_names(), ["inflow", "outflow", "bottom", "top"]);
        let mesh = ChannelMesh { periodic: true, ..space }.build().unwrap();
        assert_eq!(mesh.boundary_names(), ["bottom", "top"]);
        assert_eq!(mesh.boundary_facets().len(), 16);
    }

    #[test]
    fn impossible_channels_are_refused() {
        let channel = ChannelMesh { extent: [1.0, 1.0], cells: [2, 2], wall_ratio: 0.0, periodic: true, order: 2 };
        assert!(matches!(channel.build(), Err(MeshError::Box { quantity: "the size ratio", axis: 1, .. })));
        let channel = ChannelMesh { wall_ratio: 1.0, cells: [2, 0], ..channel };
        assert!(matches!(channel.build(), Err(MeshError::Box { quantity: "the number of cells", axis: 1, .. })));
    }
}
