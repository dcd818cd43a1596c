//! An airfoil by points of its contour.

use super::camber::{Contour, foremost};
use super::point_file;
use crate::cause::Cause;
use crate::expression::{Ends, Table};
use mesh::generate::signed_area;
use std::path::Path;

/// What a file of points must hold.
pub(super) const POINTS: &str = "points from the trailing edge over the upper side and the nose back to it, with x increasing from the nose to the trailing edge on both sides";

/// The fewest points that define an airfoil.
const FEWEST: usize = 7;

/// Points closer than this part of the chord are one.
const SAME: f64 = 1e-9;

/// Cubic splines through points, in the length of the polygon from the lower trailing edge over the nose to the upper one.
pub(super) struct Points {
    x: Table,
    y: Table,
    ends: [f64; 3],
}

impl Points {
    /// Reads a file. The chord is scaled to 1, and the trailing edge closed at (1, 0).
    ///
    /// # Errors
    /// A file that cannot be read. The inner result has the error of its points.
    pub(super) fn read(path: &Path) -> Result<Result<Self, String>, Box<Cause>> {
        Ok(Self::through(in_order(point_file::read(path)?)))
    }

    /// The airfoil through points, or their error.
    pub(super) fn through(mut points: Vec<[f64; 2]>) -> Result<Self, String> {
        let extent = points.iter().fold(0.0, |extent: f64, x| extent.max((x[0] - points[0][0]).abs()));
        points.dedup_by(|a, b| (a[0] - b[0]).hypot(a[1] - b[1]) <= SAME * extent);
        if points.len() < FEWEST {
            return Err(format!("{} points define no airfoil", points.len()));
        }
        // From below, as the parameter of the contour runs: clockwise.
        if signed_area(&points) > 0.0 {
            points.reverse();
        }
        let points = normalised(&points)?;
        let mut length = vec![0.0];
        for pair in points.windows(2) {
            length.push(length[length.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        }
        let spline = |i: usize| Table::new(length.clone(), points.iter().map(|x| x[i]).collect(), Ends::Free);
        let (x, y) = (spline(0).map_err(|e| e.to_string())?, spline(1).map_err(|e| e.to_string())?);
        let (last, front) =
            (length.len() - 1, (0..points.len()).min_by(|a, b| points[*a][0].total_cmp(&points[*b][0])));
        let front = front.unwrap_or(0);
        if front == 0 || front == last {
            return Err("the nose is an end of the list".to_owned());
        }
        let nose = foremost(&|t| x.evaluate(t), [length[front - 1], length[front + 1]]);
        let airfoil = Points { ends: [0.0, nose, length[last]], x, y };
        let fold = airfoil.contour().fold();
        match fold {
            Some([x, y]) => Err(format!("x does not increase towards the trailing edge at ({x:.4}, {y:.4})")),
            None => Ok(airfoil),
        }
    }

    /// The contour.
    pub(super) fn contour(&self) -> Contour<'_> {
        Contour { position: Box::new(|t| [self.x.evaluate(t), self.y.evaluate(t)]), ends: self.ends }
    }
}

/// The points in the order around the airfoil. A file in the format of Lednicer begins with the numbers of points on both sides, each of which
/// then runs from the nose to the trailing edge.
fn in_order(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let Some(&[upper, lower]) = points.first() else { return points };
    let is_count = |number: f64| number >= 2.0 && number.fract() == 0.0;
    if !is_count(upper) || !is_count(lower) || upper + lower != (points.len() - 1) as f64 {
        return points;
    }
    let (upper, lower) = points[1..].split_at(upper as usize);
    // Both sides begin with the nose, which is then one point twice.
    upper.iter().rev().chain(lower).copied().collect()
}

/// The points with the nose at x = 0 and the trailing edge closed at (1, 0).
fn normalised(points: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, String> {
    let [first, last] = [points[0], points[points.len() - 1]];
    let front = points.iter().map(|x| x[0]).fold(f64::INFINITY, f64::min);
    let chord = 0.5 * (first[0] + last[0]) - front;
    if !(chord > 0.0 && (first[0] - last[0]).abs() < 0.05 * chord && (first[1] - last[1]).abs() < 0.1 * chord) {
        return Err("the first and the last point are not the trailing edge".to_owned());
    }
    let nose = points.iter().position(|x| x[0] == front).unwrap_or(0);
    let scaled = |(k, x): (usize, &[f64; 2])| {
        let end = if k <= nose { first } else { last };
        // Each side is sheared until it ends at (1, 0).
        let part = ((x[0] - front) / (end[0] - front)).clamp(0.0, 1.0);
        let level = if k == nose { 0.5 * (first[1] + last[1]) } else { end[1] };
        let middle = 0.5 * (first[1] + last[1]);
        [part, (x[1] - middle - part * (level - middle)) / chord]
    };
    Ok(points.iter().enumerate().map(scaled).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::camber::{FourDigits, cambered};
    use super::*;
    use ::mesh::generate::AirfoilMesh;

    /// Points of the NACA 4412, clustered at both ends.
    fn points(count: usize, blunt: f64) -> Vec<[f64; 2]> {
        let (airfoil, symmetric) = (FourDigits::of("4412").unwrap(), AirfoilMesh::naca0012(3));
        let point = |k: usize| {
            let sigma = (std::f64::consts::PI * k as f64 / count as f64).cos();
            let [x, y] = airfoil.position(&symmetric, sigma);
            [3.0 + 2.0 * x, 2.0 * (y + x * blunt * sigma.signum()) + 0.7]
        };
        (0..=count).map(point).collect()
    }

    /// Scaled, moved, blunt, in either order: the same airfoil, closed.
    #[test]
    fn a_spline_through_points_of_an_airfoil_is_that_airfoil() {
        let (airfoil, symmetric) = (FourDigits::of("4412").unwrap(), AirfoilMesh::naca0012(3));
        for (blunt, reversed) in [(0.0, false), (0.0, true), (0.002, false)] {
            let mut points = points(160, blunt);
            if reversed {
                points.reverse();
            }
            let found = Points::through(points).unwrap();
            for sigma in [-0.9, -0.5, -0.2, 0.3, 0.6, 0.95] {
                let exact = airfoil.position(&symmetric, sigma);
                let off = |t: f64| (found.x.evaluate(t) - exact[0]).hypot(found.y.evaluate(t) - exact[1]);
                let [first, _, last] = found.ends;
                let all = (0..=2000).map(|k| off(first + (last - first) * f64::from(k) / 2000.0));
                let nearest = all.fold(f64::INFINITY, f64::min);
                // The foremost point lies at x = 0, slightly before the nose of the camber line.
                assert!(nearest < 1.5e-3, "{sigma}: {nearest:e}");
            }
            let thickness = found.contour().thickness();
            assert!((thickness - 0.12).abs() < 2e-3, "{thickness}");
            let mesh = cambered(&AirfoilMesh { thickness, ..AirfoilMesh::naca0012(4) }, &found.contour());
            assert_eq!(mesh.unwrap().n_cells(), 528);
        }
    }

    /// The format of Lednicer: the counts, then each side from the nose.
    #[test]
    fn sides_that_both_begin_at_the_nose_are_joined() {
        let around = points(40, 0.0);
        let sides = around[..=20].iter().rev().chain(&around[20..]);
        let file: Vec<[f64; 2]> = std::iter::once(&[21.0, 21.0]).chain(sides).copied().collect();
        let mut joined = in_order(file);
        joined.dedup();
        assert_eq!(joined, around);
        assert_eq!(in_order(around.clone()), around);
    }

    #[test]
    fn what_is_no_airfoil_is_refused() {
        let refused = |points: Vec<[f64; 2]>| Points::through(points).err().unwrap();
        assert!(refused(points(4, 0.0)).contains("5 points"));
        assert!(refused(points(40, 0.0)[..30].to_vec()).contains("trailing edge"));
        let mut wavy = points(40, 0.0);
        wavy[10][0] += 0.4;
        assert!(refused(wavy).contains("x does not increase"));
    }

    /// A defect that was: of a thin airfoil with more points at one side both sides were exchanged, and the thickness was 0.
    #[test]
    fn points_may_be_closer_on_one_side() {
        let (airfoil, symmetric) =
            (FourDigits::of("9502").unwrap(), AirfoilMesh { thickness: 0.02, ..AirfoilMesh::naca0012(3) });
        let above = (0..=40).map(|k| (0.5 * std::f64::consts::PI * f64::from(k) / 40.0).cos());
        let below = (1..=40).map(|k| -(f64::from(k) / 40.0).sqrt());
        let mut points: Vec<[f64; 2]> = above.chain(below).map(|sigma| airfoil.position(&symmetric, sigma)).collect();
        for _ in 0..2 {
            points.reverse();
            let thickness = Points::through(points.clone()).unwrap().contour().thickness();
            assert!((thickness - 0.02).abs() < 2e-3, "{thickness}");
        }
    }
}
