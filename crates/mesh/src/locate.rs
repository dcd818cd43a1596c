//! The cell that contains a point.

use crate::Mesh;
use crate::geometry::{CellMap, bounding_box};
use crate::lattice::digit;
use basis::gauss_lobatto;
use std::array::from_fn;
use tensor::{cofactor, determinant, dot, norm};

/// Newton steps from the centre of a cell: in a usable cell fewer than ten are needed.
const MAX_STEPS: usize = 30;
/// Steps towards the nearest place: at a distance near the radius of a curved side each one removes a small part of the error only.
const MAX_NEAREST_STEPS: usize = 300;
/// Halvings of such a step; the last one is as small as round-off.
const MAX_HALVINGS: i32 = 30;
/// Positions agree if they differ by less than this fraction of the extent of the cell, reference coordinates by less than
/// this.
const TOLERANCE: f64 = 1e-10;

impl<const D: usize> Mesh<D> {
    /// The first cell that contains `x`, including its boundary, and the reference point xi there; `None` if no cell
    /// does.
    pub fn locate(&self, x: &[f64; D]) -> Option<(usize, [f64; D])> {
        let in_cell = |cell| Some((cell, locate_in_cell(self.order(), self.cell_coordinates(cell), x)?));
        (0..self.n_cells()).find_map(in_cell)
    }
}

/// The reference point xi at `x` in a cell of order `order` with the positions `nodes`, `[node][component]`, boundary included; `None` if
/// the cell does not contain it.
pub fn locate_in_cell<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D]) -> Option<[f64; D]> {
    let (lower, upper) = bounding_box::<D>(nodes);
    // The box is enlarged by a part of its extent, because curved sides may bulge.
    let is_near = |part: f64| {
        (0..D).all(|i| {
            let margin = part * (upper[i] - lower[i]);
            (lower[i] - margin..=upper[i] + margin).contains(&x[i])
        })
    };
    if !is_near(0.5) {
        return None;
    }
    let tolerance = TOLERANCE * norm(&from_fn::<f64, D, _>(|i| upper[i] - lower[i]));
    // In a bent cell the way from the centre may lead out of it. The nearest place is at x if the cell contains x.
    let nearest = || Some(nearest_in_cell(order, nodes, x)).filter(|(_, distance)| *distance <= tolerance);
    invert(order, nodes, x, tolerance).or_else(|| is_near(0.1).then(nearest).flatten().map(|(xi, _)| xi))
}

/// The nearest place to `x` in a cell, as its reference point and its distance; arguments as in [`locate_in_cell`].
///
/// ```text
/// minimise f = |r|^2 / 2,  r = x(xi) - x,   |xi_a| <= 1:     xi := P( xi - t s ),   A s = J^T r                          (nearest)
/// ```
///
/// A = J^T J without the axes on whose bounds xi stays, P clamps, and t is halved until f falls. The searches start at the nearest nodes: one alone
/// may stay where f is stationary and not least, as above the middle of a hollow side.
pub fn nearest_in_cell<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D]) -> ([f64; D], f64) {
    let starts = nearest_nodes(order, nodes, x).into_iter().take(D + 1);
    let found = starts.map(|xi| nearest_from(xi, order, nodes, x));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(([0.0; D], f64::INFINITY))
}

/// (nearest) from the start `xi`.
fn nearest_from<const D: usize>(mut xi: [f64; D], order: usize, nodes: &[f64], x: &[f64; D]) -> ([f64; D], f64) {
    let distance_at = |xi: &[f64; D]| norm(&difference(order, nodes, x, xi).0);
    let mut distance = distance_at(&xi);
    for _ in 0..MAX_NEAREST_STEPS {
        let (r, jacobian) = difference(order, nodes, x, &xi);
        let gradient = from_fn(|a| dot(&from_fn(|i| jacobian[i][a]), &r));
        let s = step_within(&xi, &jacobian, &gradient);
        let moved = |halvings: i32| from_fn(|a| (xi[a] - 0.5_f64.powi(halvings) * s[a]).clamp(-1.0, 1.0));
        let mut tried = (0..MAX_HALVINGS).map(moved).map(|next| (next, distance_at(&next)));
        let Some(better) = tried.find(|(_, nearer)| *nearer < distance) else { break };
        (xi, distance) = better;
    }
    (xi, distance)
}

/// The reference points of the nodes, the nearest to `x` first.
fn nearest_nodes<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D]) -> Vec<[f64; D]> {
    let points = gauss_lobatto(order).points;
    let distance = |k: usize| norm(&from_fn::<f64, D, _>(|i| nodes[k * D + i] - x[i]));
    let mut ordered: Vec<usize> = (0..order.pow(D as u32)).collect();
    ordered.sort_by(|&k, &l| distance(k).total_cmp(&distance(l)));
    ordered.into_iter().map(|k| from_fn(|axis| points[digit(k, order, axis)])).collect()
}

/// s of (nearest): no component along an axis on whose bound xi would leave the cell.
fn step_within<const D: usize>(xi: &[f64; D], jacobian: &[[f64; D]; D], gradient: &[f64; D]) -> [f64; D] {
    let column = |a: usize| from_fn::<f64, D, _>(|i| jacobian[i][a]);
    let leaves = |a: usize, s: &[f64; D]| xi[a].abs() == 1.0 && xi[a] * s[a] < 0.0;
    let mut stays: [bool; D] = from_fn(|a| leaves(a, gradient));
    loop {
        let entry = |a: usize, b: usize| match stays[a] || stays[b] {
            true => f64::from(u8::from(a == b)),
            false => dot(&column(a), &column(b)),
        };
        let normal: [[f64; D]; D] = from_fn(|a| from_fn(|b| entry(a, b)));
        let right: [f64; D] = from_fn(|a| if stays[a] { 0.0 } else { gradient[a] });
        let cofactor = cofactor(&normal);
        let determinant = determinant(&normal, &cofactor);
        let s: [f64; D] = from_fn(|a| dot(&cofactor[a], &right) / determinant);
        let Some(a) = (0..D).find(|&a| leaves(a, &s)) else { return s };
        stays[a] = true;
    }
}

/// Solves x(xi) = `x` to the accuracy `tolerance` by Newton's method: xi := xi - J^{-1} (x(xi) - x).
fn invert<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D], tolerance: f64) -> Option<[f64; D]> {
    let (mut xi, mut before) = ([0.0; D], [f64::NAN; D]);
    for _ in 0..MAX_STEPS {
        let (difference, next) = step(order, nodes, x, &xi);
        if norm(&difference) <= tolerance && xi.iter().all(|xi| xi.abs() <= 1.0 + TOLERANCE) {
            return Some(xi.map(|xi| xi.clamp(-1.0, 1.0)));
        }
        // Far outside a cell its map is meaningless.
        let next = next.map(|xi| xi.clamp(-1.5, 1.5));
        // Outside of the cell steps end at the clamp, or go back and forth between two points, for ever.
        if next == xi || next == before {
            return None;
        }
        (before, xi) = (xi, next);
    }
    None
}

/// x(xi) - `x`, and a step of Newton's method from `xi`.
fn step<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D], xi: &[f64; D]) -> ([f64; D], [f64; D]) {
    let (difference, jacobian) = difference(order, nodes, x, xi);
    let cofactor = cofactor(&jacobian);
    let determinant = determinant(&jacobian, &cofactor);
    // cofactor / det is J^{-T}.
    let next = from_fn(|a| {
        let column = from_fn(|i| cofactor[i][a]);
        xi[a] - dot(&column, &difference) / determinant
    });
    (difference, next)
}

/// x(xi) - `x`, accurate far from the origin, and J there.
fn difference<const D: usize>(order: usize, nodes: &[f64], x: &[f64; D], xi: &[f64; D]) -> ([f64; D], [[f64; D]; D]) {
    let map = CellMap::at(order, xi);
    let (relative, jacobian) = (map.relative_positions(nodes)[0], map.jacobians(nodes)[0]);
    (from_fn(|i| relative[i] - (x[i] - nodes[i])), jacobian)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::random::SplitMix64;
    use crate::{BoxMesh, Curving};

    fn curved<const D: usize>() -> Mesh<D> {
        let curving = Curving::Wavy { amplitude: 0.03 };
        let mesh = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [3; D], order: 4, curving, periodic: [false; D] };
        mesh.build().unwrap().scrambled(4)
    }

    fn finds_what_it_maps<const D: usize>() {
        let (mesh, mut random) = (curved::<D>(), SplitMix64::new(7));
        for cell in 0..mesh.n_cells() {
            for _ in 0..5 {
                let xi: [f64; D] = from_fn(|_| 0.999 * random.symmetric());
                let (found, back) = mesh.locate(&mesh.position(cell, &xi)).unwrap();
                assert_eq!(found, cell);
                assert!((0..D).all(|a| (back[a] - xi[a]).abs() < 1e-8), "{xi:?}, {back:?}");
            }
        }
    }

    #[test]
    fn points_inside_are_found() {
        finds_what_it_maps::<2>();
        finds_what_it_maps::<3>();
    }

    /// A valid cell of random nodes: Newton's method from the centre went around for ever for some points near a corner.
    #[test]
    fn points_near_the_corners_of_a_bent_cell_are_found() {
        let nodes = [
            [-1.1044253810824518, -1.2480561725017865],
            [0.14246870420977664, -0.7184492510276848],
            [0.8466310114959641, -0.9692819575373673],
            [-0.8049157222817673, -0.1557188653458406],
            [0.19079298859668448, 0.13348095588126707],
            [1.185668672687149, 0.07391537132184028],
            [-0.9759244712069857, 1.217481741796434],
            [-0.023720254351616565, 0.8147725351721598],
            [1.1399435100296704, 0.9366847918710018],
        ]
        .concat();
        let mut random = SplitMix64::new(3);
        for xi in std::iter::once([-0.9915, -0.9782]).chain((0..2000).map(|_| from_fn(|_| random.symmetric()))) {
            let x = CellMap::<2>::at(3, &xi).positions(&nodes)[0];
            let found = locate_in_cell(3, &nodes, &x);
            assert!(found.is_some_and(|found| (0..2).all(|a| (found[a] - xi[a]).abs() < 1e-6)), "{xi:?}: {found:?}");
        }
    }

    /// The tolerance is below the spacing of numbers there; positions relative to the cell reach it.
    #[test]
    fn points_are_found_far_from_the_origin() {
        let curving = Curving::None;
        let (lower, upper) = ([1e6, 0.0], [1e6 + 1.0, 0.05]);
        let mesh = BoxMesh { lower, upper, cells: [12, 1], order: 5, curving, periodic: [false; 2] }.build().unwrap();
        assert!(mesh.locate(&[1e6 + 1.0, 0.025]).is_some());
        assert!((0..10).all(|k| mesh.locate(&[1e6 + 0.1 * f64::from(k) + 0.013, 0.01]).is_some()));
    }

    /// A parallelogram with an angle of 18 degrees.
    #[test]
    fn the_nearest_place_of_a_skewed_cell_is_the_foot_of_the_perpendicular() {
        let nodes = [0.0, 0.0, 1.0, 0.0, 3.0, 1.0, 4.0, 1.0];
        for (x, foot) in
            [([0.5, -1.0], [0.5, 0.0]), ([-2.0, -1.0], [0.0, 0.0]), ([1.2, 1.4], [1.5, 0.5]), ([3.0, 0.0], [2.8, 0.6])]
        {
            let (xi, distance) = nearest_in_cell(2, &nodes, &x);
            let place = CellMap::<2>::at(2, &xi).positions(&nodes)[0];
            assert!((0..2).all(|i| (place[i] - foot[i]).abs() < 1e-9), "{x:?}: {place:?} for {foot:?}");
            assert!((distance - norm(&[x[0] - foot[0], x[1] - foot[1]])).abs() < 1e-12);
        }
    }

    /// The side at eta = 1 is a parabola of radius 1 at its vertex: Gauss-Newton steps for a point at this distance converge slowly, and 30 of them
    /// ended 1.5e-5 too far. Above the vertex a search from its node stays there, where the distance has a maximum along the side.
    #[test]
    fn the_nearest_place_is_found_at_the_radius_of_a_curved_side() {
        let points = gauss_lobatto(3).points;
        let place = |xi: f64, eta: f64| [0.6 * xi, 0.5 * (1.0 + eta) * (1.0 + 0.18 * xi * xi) - 1.0];
        let nodes: Vec<f64> =
            points.iter().flat_map(|&eta| points.iter().flat_map(move |&xi| place(xi, eta))).collect();
        for (distance, across) in
            [(0.5, 0.0), (0.9, 0.1), (0.99, 0.02), (1.0, 0.01), (1.5, 0.3), (1.05, 0.0), (1.5, 0.0)]
        {
            let x = [across, distance];
            let (_, found) = nearest_in_cell(3, &nodes, &x);
            let along = (0..=200_000).map(|k| 1e-5 * f64::from(k) - 1.0).map(|xi| place(xi, 1.0));
            let least = along.map(|y| norm(&[y[0] - x[0], y[1] - x[1]])).fold(f64::MAX, f64::min);
            assert!((found - least).abs() < 1e-9, "{x:?}: {found} for {least}");
        }
    }

    #[test]
    fn corners_belong_to_the_first_cell_and_points_outside_to_none() {
        let mesh = curved::<2>();
        for cell in 0..mesh.n_cells() {
            for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]] {
                let x = mesh.position(cell, &corner);
                let (found, xi) = mesh.locate(&x).unwrap();
                assert!(found <= cell && norm(&from_fn::<f64, 2, _>(|i| mesh.position(found, &xi)[i] - x[i])) < 1e-9);
            }
        }
        assert_eq!(mesh.locate(&[1.2, 0.5]), None);
        assert_eq!(mesh.locate(&[-3.0, f64::NAN]), None);
    }
}
