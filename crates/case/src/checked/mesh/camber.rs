//! Airfoils with camber: the mesh around a symmetric one, moved up and down.
//!
//! Let sigma run along the contour (X, Y), with its foremost point at sigma_0. With x = (X - X_0) / (1 - X_0) and s = +-sqrt(x), positive above,
//! Y is a smooth function of s, and so is the ordinate y_b(s) of the symmetric airfoil. A point (x, y) of the mesh around that one moves to
//!
//! ```text
//! (x + w X_0 (1 - x),  y + w (c(x) + (r(x) - 1) b(y))),     c = (Y(s) + Y(-s)) / 2,     r = (Y(s) - Y(-s)) / (2 y_b(s))                  (camber)
//! ```
//!
//! with a weight w of 1 near the airfoil and 0 far from it, and b(y) = y up to the thickness of the airfoil, constant beyond, so that cells keep
//! their order. On the wall, where y = +-y_b, this is the contour itself. Before and behind the airfoil c goes on along its tangents.

use ::mesh::generate::AirfoilMesh;
use ::mesh::{Mesh, MeshError, Side};

/// Steps of a bisection: all digits of a double.
const BISECTIONS: usize = 60;

/// Closer than this to an end, in s, the ratio of thicknesses is that at this distance.
const END: f64 = 1e-5;

/// Up to the first distance from the chord the weight is 1, from the second on it is 0.
const NEAR_AND_FAR: [f64; 2] = [0.5, 3.0];

/// A contour from the trailing edge along the lower side to the nose, and along the upper side back.
pub(super) struct Contour<'a> {
    /// The position at a parameter.
    pub(super) position: Box<dyn Fn(f64) -> [f64; 2] + 'a>,
    /// The parameters of the lower trailing edge, the foremost point and the upper trailing edge.
    pub(super) ends: [f64; 3],
}

impl Contour<'_> {
    /// Y at s, where X = X_0 + (1 - X_0) s^2 on the upper (s > 0) or the lower side.
    fn ordinate(&self, s: f64) -> f64 {
        let [lower, nose, upper] = self.ends;
        let front = (self.position)(nose)[0];
        let x = front + (1.0 - front) * s * s;
        let (mut before, mut behind) = (nose, if s > 0.0 { upper } else { lower });
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + behind);
            if (self.position)(middle)[0] < x { before = middle } else { behind = middle }
        }
        (self.position)(0.5 * (before + behind))[1]
    }

    /// Where X does not increase from the nose to the trailing edge.
    pub(super) fn fold(&self) -> Option<[f64; 2]> {
        let [lower, nose, upper] = self.ends;
        const SAMPLES: usize = 400;
        [lower, upper].into_iter().find_map(|end| {
            let at = |k: usize| (self.position)(nose + (end - nose) * k as f64 / SAMPLES as f64);
            (0..SAMPLES).find(|&k| at(k + 1)[0] <= at(k)[0]).map(at)
        })
    }

    /// The largest distance between the two sides.
    pub(super) fn thickness(&self) -> f64 {
        let between = |k: usize| self.ordinate(0.01 * k as f64) - self.ordinate(-0.01 * k as f64);
        (1..100).map(between).fold(0.0, f64::max)
    }
}

/// The mesh around `contour`, made of that of the `symmetric` airfoil.
pub(super) fn cambered(symmetric: &AirfoilMesh, contour: &Contour<'_>) -> Result<Mesh<2>, MeshError> {
    let mesh = symmetric.build()?;
    let map = Map::new(symmetric, contour);
    let coordinates = mesh.coordinates().chunks_exact(2).flat_map(|x| map.position([x[0], x[1]])).collect();
    let corners = (0..mesh.n_cells()).flat_map(|cell| mesh.corners(cell).iter().copied()).collect();
    let sides = |boundary: usize| -> Vec<Side> {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
        facets.map(|facet| facet.side).collect()
    };
    let boundaries = mesh.boundary_names().iter().enumerate().map(|(b, name)| (name.clone(), sides(b))).collect();
    Mesh::new(mesh.order(), corners, coordinates, boundaries, Vec::new())
}

/// (camber)
struct Map<'a, 'b> {
    symmetric: &'a AirfoilMesh,
    contour: &'a Contour<'b>,
    /// X_0.
    front: f64,
    /// dc/dx at the nose and at the trailing edge.
    slopes: [f64; 2],
}

impl<'a, 'b> Map<'a, 'b> {
    fn new(symmetric: &'a AirfoilMesh, contour: &'a Contour<'b>) -> Self {
        let front = (contour.position)(contour.ends[1])[0];
        let mut map = Map { symmetric, contour, front, slopes: [0.0; 2] };
        // Differences of third order.
        let slope = |from: f64, step: f64| {
            let at = |k: f64| map.camber(from + k * step);
            (-11.0 * at(0.0) + 18.0 * at(1.0) - 9.0 * at(2.0) + 2.0 * at(3.0)) / (6.0 * step)
        };
        map.slopes = [slope(0.0, 1e-3), slope(1.0, -1e-3)];
        map
    }

    fn camber(&self, x: f64) -> f64 {
        let inside = x.clamp(0.0, 1.0);
        let s = inside.sqrt();
        let along = if x < 0.0 { self.slopes[0] * x } else { self.slopes[1] * (x - inside) };
        0.5 * (self.contour.ordinate(s) + self.contour.ordinate(-s)) + along
    }

    fn ratio(&self, x: f64) -> f64 {
        let s = x.clamp(0.0, 1.0).sqrt().clamp(END, 1.0 - END);
        (self.contour.ordinate(s) - self.contour.ordinate(-s)) / (2.0 * self.symmetric.profile(s)[1])
    }

    fn position(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let weight = weight(y.hypot(x - x.clamp(0.0, 1.0)));
        if weight == 0.0 {
            return [x, y];
        }
        let up = self.camber(x) + (self.ratio(x) - 1.0) * bounded(y, 0.5 * self.symmetric.thickness);
        [x + weight * self.front * (1.0 - x.clamp(0.0, 1.0)), y + weight * up]
    }
}

/// 1 near, 0 far, with three continuous derivatives.
fn weight(distance: f64) -> f64 {
    let [near, far] = NEAR_AND_FAR;
    let t = ((distance - near) / (far - near)).clamp(0.0, 1.0);
    1.0 - t.powi(4) * (35.0 - t * (84.0 - t * (70.0 - 20.0 * t)))
}

/// The distance over which b(y) becomes constant.
const BENDING: f64 = 0.5;

/// b(y): y up to |y| = `linear`, constant beyond that and [`BENDING`]. Its slope falls as [`weight`] does.
fn bounded(y: f64, linear: f64) -> f64 {
    if y.abs() <= linear {
        return y;
    }
    let t = ((y.abs() - linear) / BENDING).min(1.0);
    let bent = t - t.powi(5) * (7.0 - t * (14.0 - t * (10.0 - 2.5 * t)));
    (linear + BENDING * bent).copysign(y)
}

/// An airfoil NACA of four digits: camber m at the position p of the chord, and thickness.
///
/// ```text
/// y_c = m x (2 p - x) / p^2  up to p,     m (1 - 2 p + 2 p x - x^2) / (1 - p)^2  behind it,     X = x - y_t sin a,  Y = y_c + y_t cos a,  tan a = y_c'
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FourDigits {
    pub(super) camber: f64,
    pub(super) place: f64,
    pub(super) thickness: f64,
}

impl FourDigits {
    /// That of four digits, such as "2412"; None if there is no such airfoil.
    pub(super) fn of(digits: &str) -> Option<Self> {
        let numbers: Vec<u32> = digits.chars().map(|c| c.to_digit(10)).collect::<Option<_>>()?;
        let [m, p, tens, ones] = numbers[..] else { return None };
        let thickness = f64::from(10 * tens + ones) / 100.0;
        let (camber, place) = (f64::from(m) / 100.0, f64::from(p) / 10.0);
        let exists = (1..=50).contains(&(10 * tens + ones)) && (m == 0) == (p == 0);
        exists.then_some(FourDigits { camber, place, thickness })
    }

    /// The camber line and its slope.
    fn line(&self, x: f64) -> [f64; 2] {
        let FourDigits { camber: m, place: p, .. } = *self;
        if m == 0.0 {
            return [0.0; 2];
        }
        let (a, b) = if x < p { (0.0, p * p) } else { (1.0 - 2.0 * p, (1.0 - p).powi(2)) };
        [m * (a + x * (2.0 * p - x)) / b, m * (2.0 * p - 2.0 * x) / b]
    }

    /// The contour at sigma in [-1, 1], with x = sigma^2, the upper side positive. `profile` is the symmetric airfoil.
    pub(super) fn position(&self, profile: &AirfoilMesh, sigma: f64) -> [f64; 2] {
        let [x, half] = profile.profile(sigma.abs());
        let half = half * sigma.signum();
        let [middle, slope] = self.line(x);
        let length = slope.hypot(1.0);
        [x - half * slope / length, middle + half / length]
    }

    /// The foremost point: dX/dsigma = 0, which is close to the nose.
    pub(super) fn foremost(&self, profile: &AirfoilMesh) -> f64 {
        foremost(&|sigma| self.position(profile, sigma)[0], [-0.3, 0.3])
    }
}

/// The parameter at which `x` is smallest between two ends, by golden sections.
pub(super) fn foremost(x: &dyn Fn(f64) -> f64, [mut a, mut b]: [f64; 2]) -> f64 {
    let part = 0.5 * (3.0 - 5.0_f64.sqrt());
    for _ in 0..100 {
        let [c, d] = [a + part * (b - a), b - part * (b - a)];
        if x(c) < x(d) { b = d } else { a = c }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn mesh(digits: &str, order: usize) -> (FourDigits, AirfoilMesh, Mesh<2>) {
        let airfoil = FourDigits::of(digits).unwrap();
        let symmetric = AirfoilMesh { thickness: airfoil.thickness, ..AirfoilMesh::naca0012(order) };
        let position = |sigma: f64| airfoil.position(&symmetric, sigma);
        let contour = Contour { position: Box::new(position), ends: [-1.0, airfoil.foremost(&symmetric), 1.0] };
        let mesh = cambered(&symmetric, &contour).unwrap();
        (airfoil, symmetric, mesh)
    }

    /// The nodes of the wall.
    fn wall(mesh: &Mesh<2>) -> Vec<[f64; 2]> {
        let wall = mesh.boundary_names().iter().position(|name| name == "airfoil").unwrap();
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == wall);
        let nodes = |facet: &::mesh::BoundaryFacet| -> Vec<[f64; 2]> {
            let x = mesh.cell_coordinates(facet.side.cell);
            let nodes = ::mesh::face_nodes(2, mesh.order(), facet.side.face);
            nodes.into_iter().map(|k| [x[2 * k], x[2 * k + 1]]).collect()
        };
        facets.flat_map(nodes).collect()
    }

    /// The distance of x from the contour: from the nearest of many samples by Newton's method, with tangents by differences.
    fn distance(position: &dyn Fn(f64) -> [f64; 2], x: [f64; 2]) -> f64 {
        let offset = |sigma: f64| {
            let at = position(sigma);
            [x[0] - at[0], x[1] - at[1]]
        };
        let off = |sigma: f64| offset(sigma)[0].hypot(offset(sigma)[1]);
        let samples = (-1000..=1000).map(|k| 1e-3 * f64::from(k));
        let nearest = samples.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap();
        // The two sides are close to each other at the trailing edge: one start on each.
        let from = |mut sigma: f64| {
            for _ in 0..20 {
                let (low, high) = ((sigma - 1e-6).max(-1.0), (sigma + 1e-6).min(1.0));
                let (a, b, d) = (position(low), position(high), offset(sigma));
                let tangent = [0, 1].map(|i| (b[i] - a[i]) / (high - low));
                let step = (d[0] * tangent[0] + d[1] * tangent[1]) / (tangent[0].powi(2) + tangent[1].powi(2));
                sigma = (sigma + step).clamp(-1.0, 1.0);
            }
            off(sigma)
        };
        from(nearest).min(from(-nearest))
    }

    /// On the contour, at every order, with every cell proved valid.
    #[test]
    fn nodes_of_the_wall_lie_on_the_airfoil() {
        for digits in ["2412", "4412", "6409", "0012", "9520"] {
            for order in 2..=6 {
                let (airfoil, symmetric, mesh) = mesh(digits, order);
                let position = |sigma: f64| airfoil.position(&symmetric, sigma);
                let nodes = wall(&mesh);
                assert_eq!((nodes.len(), mesh.n_cells()), (24 * order, 528));
                let worst = nodes.into_iter().map(|x| distance(&position, x)).fold(0.0, f64::max);
                assert!(worst < 1e-12, "{digits} {order}: {worst:e}");
                let check = ::mesh::ValidityCheck::<2>::new(order, &[0.0]);
                let cells =
                    check.decide_cells(mesh.n_cells(), |cell, x| x.copy_from_slice(mesh.cell_coordinates(cell)));
                let worst = cells.iter().map(|cell| cell.bound().scaled_jacobian()).fold(1.0, f64::min);
                assert!(worst > 0.01, "{digits} {order}: {worst}");
            }
        }
    }

    /// With wrong digits the nodes are off, so the distance is one.
    #[test]
    fn nodes_of_another_airfoil_are_off() {
        let (_, symmetric, mesh) = mesh("2412", 3);
        let other = FourDigits::of("2512").unwrap();
        let position = |sigma: f64| other.position(&symmetric, sigma);
        let worst = wall(&mesh).into_iter().map(|x| distance(&position, x)).fold(0.0, f64::max);
        assert!(worst > 1e-3, "{worst:e}");
    }

    /// The formulas of NACA Report 460 at stations, with the last coefficient of a sharp trailing edge:
    ///
    /// ```text
    /// y_t = t / 0.2 (0.2969 sqrt(x) - 0.126 x - 0.3516 x^2 + 0.2843 x^3 - 0.1036 x^4), normal to the camber line
    /// y_c = m / p^2 (2 p x - x^2)  up to p,     m / (1 - p)^2 (1 - 2 p + 2 p x - x^2)  behind it
    /// ```
    #[test]
    fn thickness_and_camber_follow_the_published_formulas() {
        for (digits, m, p, t) in [("2412", 0.02, 0.4, 0.12), ("4412", 0.04, 0.4, 0.12), ("6409", 0.06, 0.4, 0.09)] {
            let airfoil = FourDigits::of(digits).unwrap();
            let symmetric = AirfoilMesh { thickness: t, ..AirfoilMesh::naca0012(3) };
            for x in [0.0125_f64, 0.05, 0.1, 0.3, 0.4, 0.5, 0.7, 0.9, 0.95, 1.0] {
                let polynomial =
                    0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4);
                let (half, front) = (t / 0.2 * polynomial, x < p);
                let scale = if front { m / (p * p) } else { m / ((1.0 - p) * (1.0 - p)) };
                let line = scale * (if front { 0.0 } else { 1.0 - 2.0 * p } + 2.0 * p * x - x * x);
                let angle = (scale * (2.0 * p - 2.0 * x)).atan();
                for side in [1.0, -1.0] {
                    let expected = [x - side * half * angle.sin(), line + side * half * angle.cos()];
                    let found = airfoil.position(&symmetric, side * x.sqrt());
                    let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
                    assert!(off < 1e-14, "{digits} at {x}: {found:?} {expected:?}");
                }
            }
        }
    }

    /// Published ordinates of the NACA 2412 at x = 0.3 of the camber line: y_c = 0.01875, y_t = 0.06003 (closed trailing edge: 0.06002).
    #[test]
    fn the_camber_line_has_its_height() {
        let airfoil = FourDigits::of("2412").unwrap();
        assert!((airfoil.line(0.3)[0] - 0.01875).abs() < 1e-15 && airfoil.line(0.4) == [0.02, 0.0]);
        assert!(airfoil.line(1.0)[0].abs() < 1e-16 && airfoil.line(0.0)[0] == 0.0);
        let symmetric = AirfoilMesh::naca0012(3);
        let [upper, lower] = [1.0, -1.0].map(|side| airfoil.position(&symmetric, side * 0.4_f64.sqrt())[1]);
        assert!((0.5 * (upper + lower) - 0.02).abs() < 1e-15 && (0.5 * (upper - lower) - 0.058).abs() < 1e-4);
    }

    #[test]
    fn the_bound_is_smooth_and_increases() {
        let slope = |y: f64| (bounded(y + 1e-6, 0.1) - bounded(y - 1e-6, 0.1)) / 2e-6;
        assert!((slope(0.05) - 1.0).abs() < 1e-9 && (slope(0.1) - 1.0).abs() < 1e-9 && slope(0.601).abs() < 1e-9);
        assert!((0..200).all(|k| slope(0.01 * f64::from(k)) >= -1e-9));
        assert!((bounded(-3.0, 0.1) + 0.35).abs() < 1e-15);
    }

    #[test]
    fn the_far_field_stays() {
        let (_, symmetric, mesh) = mesh("4412", 3);
        let plain = symmetric.build().unwrap();
        let moved = |x: &[f64]| x[0].hypot(x[1]) > 4.1;
        for (a, b) in mesh.coordinates().chunks_exact(2).zip(plain.coordinates().chunks_exact(2)) {
            assert!(!moved(b) || a == b, "{a:?} {b:?}");
        }
        // The hole has about the area of the symmetric airfoil.
        assert!((mesh.volume() - plain.volume()).abs() < 2e-3, "{}", mesh.volume() - plain.volume());
    }

    #[test]
    fn what_are_no_four_digits_is_no_airfoil() {
        for digits in ["241", "24120", "24a2", "2012", "0412", "2400", "2460"] {
            assert_eq!(FourDigits::of(digits), None, "{digits}");
        }
    }
}
