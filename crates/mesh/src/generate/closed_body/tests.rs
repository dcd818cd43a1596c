#![allow(clippy::unwrap_used)]
use super::*;
use crate::ValidityCheck;
use crate::generate::AnnulusMesh;
use crate::generate::closed_curve::distance;
use std::f64::consts::TAU;

/// A body by its polar radius about (0.3, -0.2), in `count` points.
fn polar(count: usize, radius: impl Fn(f64) -> f64) -> ClosedCurve {
    let angles = (0..count).map(|k| TAU * k as f64 / count as f64);
    let points = angles.map(|a| [0.3 + radius(a) * a.cos(), radius(a) * a.sin() - 0.2]);
    ClosedCurve::through(&points.collect::<Vec<_>>()).unwrap()
}

/// Semi-axes 2 and 0.5, at equal steps of the eccentric angle.
fn ellipse(count: usize) -> ClosedCurve {
    let angles = (0..count).map(|k| TAU * k as f64 / count as f64);
    let points = angles.map(|a| [2.0 * a.cos() + 0.3, 0.5 * a.sin() - 0.2]);
    ClosedCurve::through(&points.collect::<Vec<_>>()).unwrap()
}

/// x^8 + y^8 = 1.
fn square() -> ClosedCurve {
    polar(400, |a| (a.cos().powi(8) + a.sin().powi(8)).powf(-0.125))
}

/// Concave at the top.
fn bean() -> ClosedCurve {
    polar(400, |a| 1.0 + 0.3 * (2.0 * a).cos() - 0.15 * a.sin())
}

fn around(body: ClosedCurve, order: usize) -> ClosedBodyMesh {
    ClosedBodyMesh { body, outer_radius: 20.0, first_cell: 0.02, cells: [40, 14], order }
}

fn scaled_jacobian(mesh: &Mesh<2>, order: usize) -> f64 {
    let check = ValidityCheck::<2>::new(order, &[0.0]);
    let answers = check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
    answers.iter().map(|answer| answer.bound().scaled_jacobian()).fold(1.0, f64::min)
}

/// The point of a cell at reference coordinates, relative to the centroid of its body.
fn radius(mesh: &Mesh<2>, cell: usize, xi: [f64; 2], centre: [f64; 2]) -> f64 {
    let x = mesh.position(cell, &xi);
    (x[0] - centre[0]).hypot(x[1] - centre[1])
}

#[test]
fn nodes_lie_on_the_body_and_on_the_circle_around_its_centroid() {
    for body in [ellipse(200), square(), bean()] {
        for order in [2, 4, 6] {
            let mesh = around(body.clone(), order).build().unwrap();
            let centre = Outline::new(&body).centre;
            assert_eq!((mesh.n_cells(), mesh.boundary_names()), (560, &["wall".to_owned(), "far".to_owned()][..]));
            assert_eq!((mesh.boundary_facets().len(), mesh.interior_facets().len()), (80, 40 * 14 + 40 * 13));
            for facet in mesh.boundary_facets() {
                for x in mesh.face_positions(facet.side) {
                    let off = match facet.boundary {
                        0 => distance(&body, x),
                        _ => (x[0] - centre[0]).hypot(x[1] - centre[1]) / 20.0 - 1.0,
                    };
                    assert!(off.abs() < 1e-12, "{off:e} at {x:?}");
                }
            }
        }
    }
}

/// The ellipse has the slenderness 4. The dent of the bean has the radius of curvature 0.38; its largest distance from the centroid is 1.3.
#[test]
fn every_cell_is_proved_valid_at_every_order() {
    for (name, body) in [("ellipse", ellipse(200)), ("square", square()), ("bean", bean())] {
        for (outer_radius, first_cell, cells) in [(20.0, 0.02, [40, 14]), (200.0, 1e-4, [80, 30]), (3.0, 0.05, [40, 8])]
        {
            for order in 2..=6 {
                let body = ClosedBodyMesh { outer_radius, first_cell, cells, ..around(body.clone(), order) };
                let worst = scaled_jacobian(&body.build().unwrap(), order);
                assert!(worst > 0.05, "{name} {outer_radius} {order}: {worst}");
            }
        }
    }
}

/// The area of the ellipse with semi-axes 2 and 1, and the centroid of a half disc, 4 / (3 pi) from its diameter.
#[test]
fn area_and_centroid_are_those_of_the_body() {
    let angles = (0..400).map(|k| TAU * f64::from(k) / 400.0);
    let points: Vec<[f64; 2]> = angles.map(|a| [2.0 * a.cos() + 0.3, a.sin() - 0.2]).collect();
    let (area, centre) = Outline::new(&ClosedCurve::through(&points).unwrap()).area_and_centroid();
    assert!((area - TAU).abs() < 1e-7, "{area}");
    assert!((centre[0] - 0.3).abs() < 1e-12 && (centre[1] + 0.2).abs() < 1e-12, "{centre:?}");
    // r = 1 + e cos a about (5, 0) has the centroid (e + e^3 / 4) / (1 + e^2 / 2) to the right.
    let e: f64 = 0.3;
    let points = (0..600).map(|k| TAU * f64::from(k) / 600.0).map(|a| {
        let r = 1.0 + e * a.cos();
        [5.0 + r * a.cos(), r * a.sin()]
    });
    let centre = Outline::new(&ClosedCurve::through(&points.collect::<Vec<_>>()).unwrap()).centre;
    let exact = 5.0 + (e + 0.25 * e.powi(3)) / (1.0 + 0.5 * e * e);
    assert!((centre[0] - exact).abs() < 1e-7 && centre[1].abs() < 1e-12, "{centre:?} {exact}");
}

/// The area within the edges of the wall. Their nodes lie close to those of Gauss and Lobatto, so the area gains twice the degree.
#[test]
fn the_area_within_the_wall_converges_with_the_order() {
    let angles = (0..800).map(|k| TAU * f64::from(k) / 800.0);
    let body = ClosedCurve::through(&angles.map(|a| [2.0 * a.cos(), a.sin()]).collect::<Vec<_>>()).unwrap();
    let exact = Outline::new(&body).area_and_centroid().0;
    let error = |order: usize, around: usize| {
        // The far edges bound this times the square of the radius.
        let annulus = AnnulusMesh { inner_radius: 1.0, outer_radius: 2.0, first_cell: 0.2, cells: [around, 3], order };
        let circle = annulus.build().unwrap().volume() / 3.0;
        let mesh = ClosedBodyMesh { body: body.clone(), outer_radius: 4.0, first_cell: 0.1, cells: [around, 6], order };
        (16.0 * circle - mesh.build().unwrap().volume() - exact).abs()
    };
    for order in 2..=4 {
        let [coarse, fine] = [24, 48].map(|around| error(order, around));
        let rate = (coarse / fine).log2();
        assert!(rate > 2.0 * order as f64 - 2.8, "{order}: {coarse:e} {fine:e} {rate}");
    }
}

#[test]
fn lines_leave_the_wall_at_right_angles_with_the_height_of_the_first_cell() {
    for body in [ellipse(200), square(), bean()] {
        let mesh = ClosedBodyMesh { first_cell: 1e-3, cells: [60, 24], ..around(body.clone(), 5) }.build().unwrap();
        for cell in 0..60 {
            let m = mesh.jacobian(cell, &[0.2, -1.0]);
            let across = m[0][1].hypot(m[1][1]);
            let cosine = (m[0][0] * m[0][1] + m[1][0] * m[1][1]) / (m[0][0].hypot(m[1][0]) * across);
            assert!(cosine.abs() < 0.01, "{cell} {cosine}");
            let height = distance(&body, mesh.position(cell, &[-1.0, 1.0]));
            assert!((height / 1e-3 - 1.0).abs() < 0.01, "{cell} {height}");
        }
    }
}

#[test]
fn edges_along_the_wall_have_equal_lengths() {
    let body = ellipse(200);
    let outline = Outline::new(&body);
    let parameters = outline.divided(40);
    // By the midpoint rule, which knows nothing of the pieces of the spline.
    let length = |low: f64, high: f64| -> f64 {
        let speed = |k: u32| body.tangent(low + (high - low) * (f64::from(k) + 0.5) / 5000.0);
        (0..5000).map(|k| speed(k)[0].hypot(speed(k)[1])).sum::<f64>() * (high - low) / 5000.0
    };
    for ends in parameters.windows(2) {
        assert!((40.0 * length(ends[0], ends[1]) / outline.length() - 1.0).abs() < 1e-6);
    }
    // The perimeter of the ellipse by Ramanujan's second formula, whose error is below 1e-4 for this one.
    assert!((outline.length() / 8.5784 - 1.0).abs() < 1e-3, "{}", outline.length());
}

/// Around a circle, (body) is the annulus.
#[test]
fn around_a_circle_all_nodes_lie_on_circles() {
    let circle = polar(400, |_| 0.5);
    let mesh = ClosedBodyMesh { outer_radius: 50.0, cells: [24, 14], ..around(circle, 4) }.build().unwrap();
    let annulus = AnnulusMesh { inner_radius: 0.5, outer_radius: 50.0, first_cell: 0.02, cells: [24, 14], order: 4 };
    let annulus = annulus.build().unwrap();
    for cell in 0..mesh.n_cells() {
        for xi in [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            let [found, expected] = [radius(&mesh, cell, xi, [0.3, -0.2]), radius(&annulus, cell, xi, [0.0; 2])];
            assert!((found - expected).abs() < 1e-7 * expected, "{found} {expected}");
        }
    }
}

#[test]
fn impossible_meshes_are_refused() {
    let fine = around(bean(), 3);
    let refused = |spoil: fn(&mut ClosedBodyMesh)| {
        let mut mesh = fine.clone();
        spoil(&mut mesh);
        mesh.build().unwrap_err().to_string()
    };
    assert!(refused(|m| m.outer_radius = 1.0).contains("largest distance of the wall"));
    assert!(refused(|m| m.outer_radius = f64::INFINITY).contains("far field is inf"));
    assert!(refused(|m| m.first_cell = f64::NAN).contains("first cell is NaN"));
    assert!(refused(|m| m.first_cell = 19.9).contains("less than the radius"));
    assert!(refused(|m| m.cells = [2, 5]).contains("around is 2"));
    assert!(refused(|m| m.cells = [20, 0]).contains("outwards is 0"));
    assert!(refused(|m| m.order = 1).contains("order"));
    // A curve that encloses as much area clockwise as counter-clockwise, and one that crosses itself.
    assert!(refused(|m| m.body = lemniscate(1.0)).contains("the area within the points"));
    assert!(refused(|m| m.body = lemniscate(0.6)).contains("inverted"));
    // The letter C: lines of the inside meet.
    assert!(refused(|m| m.body = letter()).contains("inverted"));
}

/// A figure of eight, whose left part is smaller by a factor.
fn lemniscate(left: f64) -> ClosedCurve {
    let angles = (0..100).map(|k| TAU * (f64::from(k) + 0.5) / 100.0);
    let scale = |x: f64| if x < 0.0 { left } else { 1.0 };
    let points = angles.map(|a| [scale(a.cos()) * a.cos(), scale(a.cos()) * (2.0 * a).sin()]);
    ClosedCurve::through(&points.collect::<Vec<_>>()).unwrap()
}

/// Three quarters of a ring between the radii 0.7 and 1.
fn letter() -> ClosedCurve {
    let arc =
        |r: f64, k: i32| [r * (0.75 * TAU * f64::from(k) / 60.0).cos(), r * (0.75 * TAU * f64::from(k) / 60.0).sin()];
    let points = (0..=60).map(|k| arc(1.0, k)).chain((0..=60).rev().map(|k| arc(0.7, k)));
    ClosedCurve::through(&points.collect::<Vec<_>>()).unwrap()
}
