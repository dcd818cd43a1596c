//! Regions of a box, and lines between its cells at their faces.

use super::BOX_BOUNDARIES;
use super::box_mesh::{PositionMap, graded};
use crate::{BoxMesh, Mesh, MeshError, Region};
use std::array::from_fn;

/// A piece of the box along one axis, with cells whose sizes form a geometric sequence. It begins where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The coordinate at which it ends.
    pub end: f64,
    /// Its cells.
    pub cells: usize,
    /// The size of the last cell over that of the first.
    pub ratio: f64,
}

/// A box in the box, before curving: the cells in it.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxRegion<const D: usize> {
    /// The name of the region.
    pub name: String,
    /// The corner with the smallest coordinates.
    pub lower: [f64; D],
    /// The corner with the largest coordinates.
    pub upper: [f64; D],
}

/// A face of a region lies between cells, and segments end with the box, if they are off by less than this part of the extent of the box.
const TOLERANCE: f64 = 1e-9;

impl<const D: usize> BoxMesh<D> {
    /// The mesh with `segments[a]` along axis a and with `regions`. The cells of the segments add up to `cells[a]`. Faces of regions lie
    /// between cells. `map` then moves the nodes. Periodic sides of the mapped box must be translates of each other; they may coincide.
    ///
    /// # Errors
    /// [`MeshError::Segments`] or [`MeshError::Unaligned`], and those of [`Self::build`].
    pub fn build_in_regions(
        &self,
        segments: &[Vec<Segment>; D],
        regions: &[BoxRegion<D>],
        map: PositionMap<'_, D>,
    ) -> Result<Mesh<D>, MeshError> {
        self.check(&[1.0; D])?;
        (0..D).try_for_each(|axis| self.check_segments(axis, &segments[axis]))?;
        let breakpoints = from_fn(|axis| self.breakpoints(axis, &segments[axis]));
        let regions = regions.iter().map(|region| self.region(&breakpoints, region)).collect::<Result<_, _>>()?;
        let mesh = self.build_regions_on(&breakpoints, BOX_BOUNDARIES, regions, map)?;
        mesh.region_of_cells()?;
        Ok(mesh)
    }

    /// The ends of segments must grow up to the end of the box, and their cells must add up to the cells of the box.
    fn check_segments(&self, axis: usize, segments: &[Segment]) -> Result<(), MeshError> {
        let (mut start, round_off) = (self.lower[axis], TOLERANCE * (self.upper[axis] - self.lower[axis]));
        let wrong = |segment, problem| Err(MeshError::Segments { axis, segment, problem });
        for (index, Segment { end, cells, ratio }) in segments.iter().enumerate() {
            if !(*end > start && *end <= self.upper[axis] + round_off) {
                let upper = self.upper[axis];
                return wrong(
                    index,
                    format!("ends at {end}, expected more than {start} and at most {upper}, `upper` of the box"),
                );
            }
            if *cells == 0 || !(*ratio > 0.0 && ratio.is_finite()) {
                return wrong(index, format!("has {cells} cells and the ratio {ratio}, expected positive numbers"));
            }
            start = *end;
        }
        let cells: usize = segments.iter().map(|segment| segment.cells).sum();
        if (start - self.upper[axis]).abs() > round_off || cells != self.cells[axis] {
            let (upper, expected) = (self.upper[axis], self.cells[axis]);
            let problem = format!(
                "ends at {start} after {cells} cells, expected {upper} after {expected} cells, `upper` and `cells`"
            );
            return wrong(segments.len().saturating_sub(1), problem);
        }
        Ok(())
    }

    /// The ends of cells along `axis`, a partition of [0, 1].
    fn breakpoints(&self, axis: usize, segments: &[Segment]) -> Vec<f64> {
        let extent = self.upper[axis] - self.lower[axis];
        let mut ends = vec![0.0];
        for (index, segment) in segments.iter().enumerate() {
            let (from, last) = (ends[ends.len() - 1], index + 1 == segments.len());
            let to = if last { 1.0 } else { (segment.end - self.lower[axis]) / extent };
            let inside = graded(segment.cells, segment.ratio);
            ends.extend(inside[1..].iter().map(|r| from * (1.0 - r) + to * r));
        }
        ends
    }

    fn region(&self, breakpoints: &[Vec<f64>; D], region: &BoxRegion<D>) -> Result<Region, MeshError> {
        let mut layers = [[0; 2]; D];
        for axis in 0..D {
            for (side, x) in [region.lower[axis], region.upper[axis]].into_iter().enumerate() {
                layers[axis][side] = self.layer(axis, &breakpoints[axis], x, &region.name)?;
            }
        }
        let inside = |cell: &usize| {
            let place = self.place(*cell);
            (0..D).all(|axis| (layers[axis][0]..layers[axis][1]).contains(&place[axis]))
        };
        Ok(Region { name: region.name.clone(), cells: (0..self.n_cells()).filter(inside).collect() })
    }

    /// The number of the end of a cell along `axis` that lies at `x`.
    fn layer(&self, axis: usize, ends: &[f64], x: f64, name: &str) -> Result<usize, MeshError> {
        let extent = self.upper[axis] - self.lower[axis];
        let distance = |k: &usize| (self.lower[axis] + extent * ends[*k] - x).abs();
        let nearest = (0..ends.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        if distance(&nearest) <= TOLERANCE * extent {
            return Ok(nearest);
        }
        let nearest = self.lower[axis] + extent * ends[nearest];
        Err(MeshError::Unaligned { name: name.to_owned(), axis, value: x, nearest })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Curving, REST};
    use std::f64::consts::PI;
    use tensor::norm;

    fn segment(end: f64, cells: usize, ratio: f64) -> Segment {
        Segment { end, cells, ratio }
    }

    /// A flap of 0.1 x 1 on the bottom of a channel of 6 x 4.
    fn flap(curving: Curving) -> (BoxMesh<2>, [Vec<Segment>; 2], [BoxRegion<2>; 1]) {
        let mesh =
            BoxMesh { lower: [0.0; 2], upper: [6.0, 4.0], cells: [22, 13], order: 3, curving, periodic: [false; 2] };
        let x = vec![segment(2.95, 10, 0.1), segment(3.05, 2, 1.0), segment(6.0, 10, 10.0)];
        let y = vec![segment(1.0, 6, 1.0), segment(4.0, 7, 8.0)];
        (mesh, [x, y], [BoxRegion { name: "flap".to_owned(), lower: [2.95, 0.0], upper: [3.05, 1.0] }])
    }

    #[test]
    fn regions_are_the_cells_in_their_boxes() {
        let (mesh, segments, regions) = flap(Curving::None);
        let mesh = mesh.build_in_regions(&segments, &regions, &|x| *x).unwrap();
        let (flap, fluid) = (mesh.part(&["flap"]).unwrap(), mesh.part_without(&["flap"]).unwrap());
        assert_eq!((flap.mesh.n_cells(), fluid.mesh.n_cells()), (12, 22 * 13 - 12));
        assert!((flap.mesh.volume() - 0.1).abs() < 1e-13 && (fluid.mesh.volume() - 23.9).abs() < 1e-12);
        assert_eq!(flap.mesh.boundary_names(), ["bottom", REST]);
        assert_eq!(mesh.interface(&flap, &fluid, 3).unwrap().len(), 2 * (6 + 2 + 6) + 1);
        // Cells grow from the flap on, by a constant factor.
        let width = |cell: usize| mesh.cell_coordinates(cell)[4] - mesh.cell_coordinates(cell)[0];
        assert!((width(12) / width(9) - 1.0).abs() < 1e-12 && (width(21) / width(12) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn regions_of_a_curved_box_are_those_before_curving() {
        let (mesh, segments, regions) = flap(Curving::Smooth { amplitude: 1e-3 });
        let mesh = mesh.build_in_regions(&segments, &regions, &|x| *x).unwrap();
        assert_eq!(mesh.part(&["flap"]).unwrap().cells.len(), 12);
    }

    #[test]
    fn impossible_regions_and_segments_are_refused() {
        let refused = |spoil: fn(&mut [Vec<Segment>; 2], &mut [BoxRegion<2>; 1])| {
            let (mesh, mut segments, mut regions) = flap(Curving::None);
            spoil(&mut segments, &mut regions);
            mesh.build_in_regions(&segments, &regions, &|x| *x).unwrap_err()
        };
        let error = refused(|_, regions| regions[0].upper[1] = 0.95);
        assert_eq!(error, MeshError::Unaligned { name: "flap".to_owned(), axis: 1, value: 0.95, nearest: 1.0 });
        assert!(matches!(refused(|_, regions| regions[0].upper[0] = 7.0), MeshError::Unaligned { axis: 0, .. }));
        assert!(matches!(refused(|_, regions| regions[0].upper[0] = f64::NAN), MeshError::Unaligned { axis: 0, .. }));
        // Upside down: no cells.
        assert!(matches!(refused(|_, regions| regions[0].upper[0] = 0.0), MeshError::EmptyRegion { .. }));
        for spoil in [
            (|segments, _| segments[0][1].end = 2.0) as fn(&mut [Vec<Segment>; 2], &mut [BoxRegion<2>; 1]),
            |segments, _| segments[0][1].cells = 0,
            |segments, _| segments[0][1].cells = 3,
            |segments, _| segments[0][1].ratio = -1.0,
            |segments, _| segments[0][2].end = 5.0,
            |segments, _| segments[0].clear(),
        ] {
            assert!(matches!(refused(spoil), MeshError::Segments { axis: 0, .. }));
        }
        let (mesh, segments, [flap]) = flap(Curving::None);
        let twin = BoxRegion { name: "twin".to_owned(), ..flap.clone() };
        assert!(matches!(mesh.build_in_regions(&segments, &[flap, twin], &|x| *x), Err(MeshError::TwoRegions { .. })));
    }

    /// x = r cos(phi), y = r sin(phi): rings between the radii 1 and 2.
    fn ring(x: &[f64; 2]) -> [f64; 2] {
        [x[0] * x[1].cos(), x[0] * x[1].sin()]
    }

    fn mapped(upper: f64, periodic: bool) -> Mesh<2> {
        let mesh = BoxMesh {
            lower: [1.0, 0.0],
            upper: [2.0, upper],
            cells: [3, 8],
            order: 9,
            curving: Curving::None,
            periodic: [false, periodic],
        };
        let segments = from_fn(|axis| vec![Segment { end: mesh.upper[axis], cells: mesh.cells[axis], ratio: 1.0 }]);
        mesh.build_in_regions(&segments, &[], &ring).unwrap()
    }

    #[test]
    fn a_map_makes_half_a_ring_of_a_box() {
        let mesh = mapped(PI, false);
        assert!((mesh.volume() - 1.5 * PI).abs() < 1e-12);
        assert_eq!(mesh.boundary_names(), ["left", "right", "bottom", "top"]);
        for facet in mesh.boundary_facets().iter().filter(|facet| facet.boundary == 0) {
            assert!(mesh.face_positions(facet.side).iter().all(|x| (norm(x) - 1.0).abs() < 1e-15));
        }
    }

    #[test]
    fn sides_that_coincide_after_the_map_are_joined() {
        let mesh = mapped(2.0 * PI, true);
        assert!((mesh.volume() - 3.0 * PI).abs() < 1e-10);
        assert_eq!(mesh.boundary_names(), ["left", "right"]);
        assert_eq!(mesh.interior_facets().len(), 3 * 8 + 2 * 8);
    }
}
