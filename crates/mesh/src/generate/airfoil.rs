//! A C-mesh around a symmetric NACA airfoil with a closed trailing edge.
//!
//! Consider the plane of w = sqrt(z - z_0), with z = x + i y and z_0 half the nose radius behind the leading edge. There
//! the airfoil is a smooth bump over the real axis, because the square root unrolls it. The wake is the rest of the
//! axis, and lines of constant Im w are parabolas around z_0. A mesh in that plane, sheared so that it starts on the
//! bump, is a C-mesh in the plane of z:
//!
//! ```text
//! z(s, g) = z_wall(s) + 2 i w(s) g - g^2,    w(s) = sqrt(z_wall(s) - z_0),    z = z_0 + (w + i g)^2     (parabolic)
//! ```
//!
//! with g = 0 on the wall and in the wake, growing by a constant factor from cell to cell outwards. The map is analytic
//! in every cell, and on the wall z = z_wall(s) to the bit.

use super::assembly::Assembly;
use super::growth::{Check, PiecewiseGrowth};
use crate::{Mesh, MeshError};
use std::f64::consts::PI;

/// A C-mesh around a NACA 00xx airfoil of chord 1 with its leading edge at the origin. Axis 0 of the cells runs from
/// the lower side of the wake around the nose to its upper side, axis 1 outwards. Boundaries are "airfoil" and "far".
/// The far boundary is a parabola in front, above and below, and another one behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirfoilMesh {
    /// Largest thickness as a fraction of the chord: 0.12 for the NACA 0012.
    pub thickness: f64,
    /// Smallest distance of the far field, in chords.
    pub far_field: f64,
    /// Height of the cells at the wall, in chords.
    pub first_cell: f64,
    /// Length of the last cell before the trailing edge along the chord. The others follow smoothly.
    pub trailing_edge_cell: f64,
    /// Cells along one side of the airfoil.
    pub surface_cells: usize,
    /// Cells along the wake, up to the far field.
    pub wake_cells: usize,
    /// The near wake behind the trailing edge, with finer cells.
    pub near_wake: Option<NearPart>,
    /// Cells from the wall to the far field.
    pub normal_cells: usize,
    /// The near part at the wall, with finer cells.
    pub near_wall: Option<NearPart>,
    /// N, nodes per direction of the geometry.
    pub order: usize,
}

/// A part of the mesh with finer cells. Within it cells grow by one constant factor, from there to the far field by
/// another; without it by one factor all the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPart {
    /// Its extent, in chords.
    pub extent: f64,
    /// Its cells, fewer than those up to the far field.
    pub cells: usize,
}

impl AirfoilMesh {
    /// 528 cells around the NACA 0012: 44 around and along the wake times 12 outwards, the first 0.015 chords high,
    /// far field at 100 chords.
    pub fn naca0012(order: usize) -> Self {
        AirfoilMesh {
            thickness: 0.12,
            far_field: 100.0,
            first_cell: 0.015,
            trailing_edge_cell: 0.02,
            surface_cells: 12,
            wake_cells: 10,
            near_wake: None,
            normal_cells: 12,
            near_wall: None,
            order,
        }
    }

    /// The mesh.
    pub fn build(&self) -> Result<Mesh<2>, MeshError> {
        let lines = self.lines()?;
        let (surface, wake) = (self.surface_cells, self.wake_cells);
        let mut assembly = Assembly::new(self.order)?;
        let mut add = |first: f64, cells: usize, names| {
            assembly.add([cells, self.normal_cells], names, |[s, t]| lines.position(first + s, t));
        };
        let far = Some("far");
        add(-((surface + wake) as f64), wake, [far, None, None, far]);
        add(-(surface as f64), 2 * surface, [None, None, Some("airfoil"), far]);
        add(surface as f64, wake, [None, far, None, far]);
        assembly.build(&[])
    }

    /// The upper side of the profile at x = s^2, s in [0, 1], for thickness d:
    ///
    /// ```text
    /// y = 5 d (0.2969 s - 0.1260 x - 0.3516 x^2 + 0.2843 x^3 - 0.1036 x^4)                                   (naca)
    /// ```
    ///
    /// The last coefficient closes the trailing edge: y = 0 at x = 1.
    pub fn profile(&self, s: f64) -> [f64; 2] {
        let x = s * s;
        [x, 5.0 * self.thickness * (0.2969 * s - x * (0.1260 + x * (0.3516 - x * (0.2843 - 0.1036 * x))))]
    }

    fn lines(&self) -> Result<AirfoilLines<'_>, MeshError> {
        self.check()?;
        // By (naca) the nose has the radius (5 d 0.2969)^2 / 2.
        let focus = 0.25 * (5.0 * self.thickness * 0.2969).powi(2);
        let trailing_edge = (1.0 - focus).sqrt();
        let clustering = self.clustering()?;
        let last_s = surface_parameter(1.0 - 1.0 / self.surface_cells as f64, clustering);
        let last_cell = trailing_edge - unrolled(self.profile(last_s), focus)[0];
        let near = self.near_wake.map(|near| (near.cells, (1.0 + near.extent - focus).sqrt() - trailing_edge));
        let wake = PiecewiseGrowth::new(near, self.wake_cells, last_cell, self.far_field.sqrt() - trailing_edge);
        Ok(AirfoilLines { mesh: self, focus, trailing_edge, clustering, wake })
    }

    fn check(&self) -> Result<(), MeshError> {
        let check = Check { mesh: "airfoil" };
        let thickness = self.thickness;
        check.that(thickness > 0.0 && thickness <= 0.5, "the thickness", thickness, "more than 0, at most 0.5")?;
        check.that(self.far_field >= 2.0, "the distance of the far field", self.far_field, "at least 2 chords")?;
        check.that(self.far_field <= 1e6, "the distance of the far field", self.far_field, "at most 10^6 chords")?;
        check.that(
            self.surface_cells >= 2,
            "the number of cells along a side",
            self.surface_cells as f64,
            "2 or more",
        )?;
        check.count("the number of cells along a side", self.surface_cells)?;
        check.count("the number of cells along the wake", self.wake_cells)?;
        check.count("the number of cells outwards", self.normal_cells)?;
        self.check_near(check, self.near_wake, (self.wake_cells, self.trailing_edge_cell), NEAR_WAKE)?;
        self.check_near(check, self.near_wall, (self.normal_cells, self.first_cell), NEAR_WALL)?;
        let h = self.first_cell;
        check.that((1e-8..=0.2).contains(&h), "the height of the first cell", h, "1e-8 to 0.2 chords")
    }

    fn check_near(
        &self,
        check: Check,
        near: Option<NearPart>,
        (all, first_cell): (usize, f64),
        [extent_of, cells_of]: [&'static str; 2],
    ) -> Result<(), MeshError> {
        let Some(NearPart { extent, cells }) = near else { return Ok(()) };
        let inside = extent > 0.0 && extent <= 0.5 * self.far_field;
        check.that(inside, extent_of, extent, "more than 0, at most half the distance of the far field")?;
        let is_wider = cells == 1 || extent > first_cell;
        check.that(is_wider, extent_of, extent, "more than the size of the first of its cells")?;
        check.that((1..all).contains(&cells), cells_of, cells as f64, "1 or more, fewer than those up to the far field")
    }

    /// c of (surface) such that the last cell has the requested length.
    fn clustering(&self) -> Result<f64, MeshError> {
        let length = self.trailing_edge_cell;
        let tau = 1.0 - 1.0 / self.surface_cells as f64;
        let clustering = ((1.0 - length).sqrt() - tau) * PI / (PI * tau).sin();
        let accepted =
            "a length that a smooth distribution can reach (for n cells from 0.02 / n + 3.3 / n^3 to about 3 / n)";
        let fine = (-0.8..=0.99).contains(&clustering);
        Check { mesh: "airfoil" }.that(fine, "the length of the cell at the trailing edge", length, accepted)?;
        Ok(clustering)
    }
}

/// s as a function of the fraction tau of the cells between nose and trailing edge. Equal steps of s are already fine
/// at the nose because x = s^2; c in (-1, 1) makes them finer at the trailing edge:
///
/// ```text
/// s = tau + c sin(pi tau) / pi                                                                             (surface)
/// ```
fn surface_parameter(tau: f64, clustering: f64) -> f64 {
    tau + clustering * (PI * tau).sin() / PI
}

/// w = sqrt(z - z_0) for a point in the upper half plane: real and imaginary part, neither negative.
fn unrolled([x, y]: [f64; 2], focus: f64) -> [f64; 2] {
    let a = x - focus;
    let r = a.hypot(y);
    // The larger part from the sum without cancellation, the other from 2 Re w Im w = y.
    let larger = (0.5 * (r + a.abs())).sqrt();
    let smaller = 0.5 * y / larger;
    if a >= 0.0 { [larger, smaller] } else { [smaller, larger] }
}

/// Names of the extent and the cells of the near parts in errors.
const NEAR_WAKE: [&str; 2] = ["the extent of the near wake", "the number of cells of the near wake"];
const NEAR_WALL: [&str; 2] = ["the extent of the cells near the wall", "the number of cells near the wall"];

/// The distance behind the trailing edge, in w, at which cells of the wake begin to open.
const WAKE_OPENING: f64 = 0.3;

/// The two families of lines of the mesh.
struct AirfoilLines<'a> {
    mesh: &'a AirfoilMesh,
    /// z_0.
    focus: f64,
    /// w at the trailing edge.
    trailing_edge: f64,
    /// c of (surface).
    clustering: f64,
    /// Cells along the wake, in w.
    wake: PiecewiseGrowth,
}

impl AirfoilLines<'_> {
    /// (parabolic) after s cells from the nose, positive above and negative below, and t cells outwards.
    fn position(&self, s: f64, t: f64) -> [f64; 2] {
        let (z, w) = self.wall(s.abs());
        let g = self.outwards(w).size(t);
        let y = z[1] + 2.0 * w[0] * g;
        [z[0] - 2.0 * w[1] * g - g * g, if s < 0.0 { -y } else { y }]
    }

    /// z and w on the upper side of wall and wake after s cells from the nose.
    fn wall(&self, s: f64) -> ([f64; 2], [f64; 2]) {
        let surface = self.mesh.surface_cells as f64;
        if s <= surface {
            let z = self.mesh.profile(surface_parameter(s / surface, self.clustering));
            return (z, unrolled(z, self.focus));
        }
        let w = self.trailing_edge + self.wake.size(s - surface);
        ([self.focus + w * w, 0.0], [w, 0.0])
    }

    /// g along the line that leaves the wall at w, up to Im w = sqrt(far field). Along the wake the steps soon become constant,
    /// so that cells widen like the wake.
    fn outwards(&self, w: [f64; 2]) -> PiecewiseGrowth {
        let beyond = w[0] - self.trailing_edge;
        let size = match beyond > 0.0 {
            true => self.trailing_edge + WAKE_OPENING * (beyond / WAKE_OPENING).tanh(),
            false => w[0].hypot(w[1]),
        };
        // |2 i w g - g^2| = h, exactly at the nose and approximately if |w|^2 >> h.
        let step = |h: f64| h / ((size * size + h).sqrt() + size);
        let near = self.mesh.near_wall.map(|near| (near.cells, step(near.extent)));
        let total = self.mesh.far_field.sqrt() - w[1];
        PiecewiseGrowth::new(near, self.mesh.normal_cells, step(self.mesh.first_cell), total)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::ValidityCheck;

    /// The distance of x from the profile, by its formula, and whether x lies between its ends.
    fn off_profile(mesh: &AirfoilMesh, x: [f64; 2]) -> f64 {
        assert!((-1e-15..=1.0 + 1e-15).contains(&x[0]), "{x:?}");
        (mesh.profile(x[0].clamp(0.0, 1.0).sqrt())[1] - x[1].abs()).abs()
    }

    fn facets<'a>(mesh: &'a Mesh<2>, name: &str) -> impl Iterator<Item = crate::Side> + 'a {
        let boundary = mesh.boundary_names().iter().position(|other| other == name).unwrap();
        mesh.boundary_facets().iter().filter(move |facet| facet.boundary == boundary).map(|facet| facet.side)
    }

    #[test]
    fn every_node_of_the_wall_lies_on_the_profile() {
        for order in 2..=8 {
            let airfoil = AirfoilMesh::naca0012(order);
            let mesh = airfoil.build().unwrap();
            assert_eq!((mesh.n_cells(), mesh.boundary_facets().len()), (528, 24 + 44 + 24));
            // Along the lines, across them, and the cut.
            assert_eq!(mesh.interior_facets().len(), 43 * 12 + 44 * 11 + 10);
            let mut names = mesh.boundary_names().to_vec();
            names.sort();
            assert_eq!(names, ["airfoil", "far"]);
            for side in facets(&mesh, "airfoil") {
                for x in mesh.face_positions(side) {
                    // At the nose y = 5 d 0.2969 sqrt(x) amplifies a rounding of x to its square root.
                    let tolerance = if x[0] < 1e-12 { 1e-9 } else { 1e-12 };
                    assert!(off_profile(&airfoil, x) < tolerance, "{x:?}");
                }
            }
            for side in facets(&mesh, "far") {
                assert!(mesh.face_positions(side).iter().all(|x| x[0].hypot(x[1]) > 99.0));
            }
        }
    }

    /// The hole in the mesh is the airfoil: its area is 2 int y dx = 2 int 2 s y ds.
    #[test]
    fn the_hole_has_the_area_of_the_airfoil() {
        let d = 0.12;
        let area = 10.0 * d * (0.2969 / 1.5 - 0.1260 / 2.0 - 0.3516 / 3.0 + 0.2843 / 4.0 - 0.1036 / 5.0);
        let airfoil = AirfoilMesh { far_field: 4.0, surface_cells: 16, ..AirfoilMesh::naca0012(8) };
        // Far field R: |Re w|, Im w <= sqrt(R), and int |dz/dw|^2 = int 4 |w|^2 = (16/3) R^2.
        let whole = 16.0 / 3.0 * 4.0 * 4.0;
        let error = |order| (AirfoilMesh { order, ..airfoil }.build().unwrap().volume() + area - whole).abs();
        assert!(error(8) < 1e-8 && error(4) < 1e-4, "{:e} {:e}", error(8), error(4));
    }

    #[test]
    fn cells_at_the_wall_have_their_height_and_length() {
        let airfoil = AirfoilMesh { first_cell: 1e-3, ..AirfoilMesh::naca0012(5) };
        let mesh = airfoil.build().unwrap();
        let sides: Vec<_> = facets(&mesh, "airfoil").collect();
        for &side in &sides {
            let (low, high) = (mesh.position(side.cell, &[0.0, -1.0]), mesh.position(side.cell, &[0.0, 1.0]));
            let height = (high[0] - low[0]).hypot(high[1] - low[1]);
            assert!((0.9e-3..1.1e-3).contains(&height), "{height}");
        }
        let end = mesh.position(sides[23].cell, &[-1.0, -1.0]);
        assert!((1.0 - end[0] - 0.02).abs() < 1e-14);
    }

    /// A cell ends `length` behind the trailing edge, with one factor on either side of it.
    #[test]
    fn the_near_wake_has_its_length_and_its_cells() {
        let near_wake = Some(NearPart { extent: 2.5, cells: 7 });
        let airfoil = AirfoilMesh { near_wake, ..AirfoilMesh::naca0012(4) };
        let mesh = airfoil.build().unwrap();
        // Cells of the lower wake come first, each row from the far field to the trailing edge.
        let start = |cell: usize| mesh.position(cell, &[-1.0, -1.0])[0];
        assert!((start(3) - 3.5).abs() < 1e-12 && (start(0) - 100.0).abs() < 1.0, "{} {}", start(3), start(0));
        let size = |cell: usize| start(cell).sqrt() - mesh.position(cell, &[1.0, -1.0])[0].sqrt();
        let factors: Vec<_> = (1..7).map(|cell| size(cell - 1) / size(cell)).collect();
        let equal = |a: f64, b: f64| (a / b - 1.0).abs() < 0.02;
        assert!(factors[2..].windows(2).all(|pair| equal(pair[0], pair[1])), "{factors:?}");
        assert!(equal(factors[0], factors[1]) && !equal(factors[1], factors[2]), "{factors:?}");
    }

    /// Eight cells above the middle of the airfoil end at about half a chord.
    #[test]
    fn cells_near_the_wall_fill_their_extent() {
        let near_wall = Some(NearPart { extent: 0.5, cells: 8 });
        let mesh = AirfoilMesh { near_wall, ..AirfoilMesh::naca0012(5) }.build().unwrap();
        let wall = facets(&mesh, "airfoil").nth(18).unwrap().cell;
        // Rows of 24 cells around the airfoil.
        let [low, high] = [mesh.position(wall, &[0.0, -1.0]), mesh.position(wall + 7 * 24, &[0.0, 1.0])];
        let height = (high[0] - low[0]).hypot(high[1] - low[1]);
        assert!((0.4..0.6).contains(&height), "{height}");
    }

    #[test]
    fn thin_cells_of_every_order_are_valid_and_hardly_deformed() {
        for order in 2..=8 {
            let thin = AirfoilMesh {
                first_cell: 2e-5,
                normal_cells: 24,
                trailing_edge_cell: 0.01,
                ..AirfoilMesh::naca0012(order)
            };
            let mesh = thin.build().unwrap();
            let check = ValidityCheck::<2>::new(order, &[0.0]);
            let answers = check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
            let worst = answers.iter().map(|answer| answer.bound().scaled_jacobian()).fold(1.0, f64::min);
            assert!(worst > 0.02, "{order} {worst}");
            let aspect = aspect_ratio(&mesh, facets(&mesh, "airfoil").nth(12).unwrap().cell);
            assert!(aspect > 1e3, "{aspect}");
        }
    }

    /// Length over height of a cell at its centre.
    fn aspect_ratio(mesh: &Mesh<2>, cell: usize) -> f64 {
        let m = mesh.jacobian(cell, &[0.0; 2]);
        m[0][0].hypot(m[1][0]) / m[0][1].hypot(m[1][1])
    }

    #[test]
    fn impossible_airfoils_are_refused() {
        let airfoil = AirfoilMesh::naca0012(3);
        let refused = |mesh: AirfoilMesh| mesh.build().unwrap_err().to_string();
        assert!(refused(AirfoilMesh { thickness: f64::NAN, ..airfoil }).contains("thickness is NaN"));
        assert!(refused(AirfoilMesh { far_field: 1.0, ..airfoil }).contains("at least 2 chords"));
        assert!(refused(AirfoilMesh { first_cell: 0.0, ..airfoil }).contains("first cell is 0"));
        assert!(refused(AirfoilMesh { surface_cells: 1, ..airfoil }).contains("along a side is 1"));
        assert!(refused(AirfoilMesh { wake_cells: 0, ..airfoil }).contains("wake is 0"));
        let near_wake = |extent, cells| AirfoilMesh { near_wake: Some(NearPart { extent, cells }), ..airfoil };
        assert!(refused(near_wake(f64::NAN, 5)).contains("extent of the near wake is NaN"));
        assert!(refused(near_wake(51.0, 5)).contains("half the distance of the far field"));
        assert!(refused(near_wake(2.0, 10)).contains("near wake is 10"));
        assert!(refused(near_wake(2.0, 0)).contains("near wake is 0"));
        let near_wall = Some(NearPart { extent: 0.5, cells: 12 });
        assert!(refused(AirfoilMesh { near_wall, ..airfoil }).contains("near the wall is 12"));
        for trailing_edge_cell in [0.0, 0.9, -1.0, f64::NAN] {
            assert!(refused(AirfoilMesh { trailing_edge_cell, ..airfoil }).contains("smooth distribution"));
        }
    }
}
