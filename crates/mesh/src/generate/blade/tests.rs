#![allow(clippy::unwrap_used)]
use super::*;
use crate::ValidityCheck;
use crate::generate::Extrusion;
use crate::generate::closed_curve::distance;

#[test]
fn every_node_of_the_wall_lies_on_the_profile() {
    for order in [2, 3, 4, 8] {
        let blade = BladeMesh::low_pressure_turbine(order).unwrap();
        let mesh = blade.build().unwrap();
        // 64 around in 4 rings, and the frame of 46 x 14 cells without the 26 x 6 of the hole.
        assert_eq!(mesh.n_cells(), 64 * 4 + 46 * 14 - 26 * 6);
        assert_eq!(mesh.boundary_names(), ["blade", "inflow", "outflow"]);
        assert_eq!(mesh.boundary_facets().len(), 64 + 2 * 14);
        assert_eq!(mesh.interior_facets().iter().filter(|facet| facet.periodic).count(), 46);
        for facet in mesh.boundary_facets().iter().filter(|facet| facet.boundary == 0) {
            for x in mesh.face_positions(facet.side) {
                assert!(distance(&blade.profile, x) < 1e-12);
            }
        }
    }
}

/// The passage has the area axial length times pitch, minus the blade: by the spline, and by the mesh's wall.
#[test]
fn the_area_is_that_of_the_passage_without_the_blade() {
    let blade = BladeMesh::low_pressure_turbine(5).unwrap();
    let mesh = blade.build().unwrap();
    let curve = &blade.profile;
    // int y dx along the clockwise curve, by the trapezoidal rule, which is accurate for periodic functions.
    let (steps, mut area) = (100_000, 0.0);
    for k in 0..steps {
        let u = curve.length() * f64::from(k) / f64::from(steps);
        area += curve.position(u)[1] * curve.tangent(u)[0] * curve.length() / f64::from(steps);
    }
    let x = |boundary: usize| {
        let facet = mesh.boundary_facets().iter().find(|facet| facet.boundary == boundary).unwrap();
        mesh.face_centre(facet.side)[0]
    };
    let whole = blade.pitch * (x(2) - x(1));
    assert!(area > 0.05 && (mesh.volume() - whole + area).abs() < 1e-6, "{} {}", mesh.volume(), whole - area);
}

#[test]
fn lines_leave_the_blade_at_right_angles() {
    let blade = BladeMesh::low_pressure_turbine(5).unwrap();
    let mesh = blade.build().unwrap();
    for cell in 0..64 {
        let m = mesh.jacobian(cell, &[0.2, -1.0]);
        let along = m[0][0].hypot(m[1][0]);
        let across = m[0][1].hypot(m[1][1]);
        let cosine = (m[0][0] * m[0][1] + m[1][0] * m[1][1]) / (along * across);
        assert!(cosine.abs() < 0.02, "{cell} {cosine}");
    }
}

#[test]
fn no_cell_is_strongly_deformed_and_space_is_as_valid() {
    let mesh = BladeMesh::low_pressure_turbine(4).unwrap().build().unwrap();
    let check = ValidityCheck::<2>::new(4, &[0.0]);
    let answers = check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
    let worst = answers.iter().map(|answer| answer.bound().scaled_jacobian()).fold(1.0, f64::min);
    assert!(worst > 0.03, "{worst}");
    let space = mesh.extruded(&Extrusion { lower: 0.0, depth: 0.2, layers: 2, periodic: true }).unwrap();
    assert!((space.volume() - 0.2 * mesh.volume()).abs() < 1e-12);
}

#[test]
fn a_blade_from_a_table_of_points() {
    // An ellipse, thick enough for a round O-block.
    let point = |k: i32| (0.1 * f64::from(k)).sin_cos();
    let points: Vec<[f64; 2]> = (0..62).map(point).map(|(s, c)| [0.5 * c, 0.15 * s]).collect();
    let blade = BladeMesh {
        profile: ClosedCurve::through(&points).unwrap(),
        pitch: 1.2,
        slopes: [0.3, -0.3],
        ..BladeMesh::low_pressure_turbine(4).unwrap()
    };
    assert!(blade.build().is_ok());
}

#[test]
fn impossible_blades_are_refused() {
    let blade = BladeMesh::low_pressure_turbine(3).unwrap();
    let refused = |spoil: fn(&mut BladeMesh)| {
        let mut blade = blade.clone();
        spoil(&mut blade);
        blade.build().unwrap_err().to_string()
    };
    assert!(refused(|b| b.pitch = f64::NAN).contains("the pitch is NaN"));
    assert!(refused(|b| b.cells.gap = 0).contains("beside the O-block is 0"));
    assert!(refused(|b| b.slopes[1] = f64::INFINITY).contains("slope of the flow"));
    assert!(refused(|b| b.first_cell = 1.0).contains("less than the layer"));
    // The next blade overlaps.
    assert!(refused(|b| b.pitch = 0.1).contains("inverted"));
}
