//! Parallelepipeds that contain cells.

use basis::{Lagrange, Matrix, gauss};
use std::array::from_fn;
use tensor::norm;

/// Enclosures are enlarged by this fraction of their extent, against rounding.
const MARGIN: f64 = 1e-6;

/// A box along the axes and a parallelepiped along the edges of a cell, both of which contain it.
///
/// ```text
/// x = c_0 + J xi + sum c_k P_k(xi)          the position in Legendre polynomials, k of higher degree than 1 in all
/// |x - c_0|_i <= sum |J_ij| + sum |c_k|_i                           (box)
/// |J^{-1} (x - c_0)|_i <= 1 + sum |J^{-1} c_k|_i         (parallelepiped)
/// ```
///
/// since no |xi_i| and no Legendre polynomial exceeds 1. Both are tight for a cell with straight parallel edges.
pub struct Enclosure<const D: usize> {
    /// c_0.
    centre: [f64; D],
    /// The right side of (box).
    extent: [f64; D],
    /// J^{-1} with the right side of (parallelepiped); `None` if J is singular.
    edges: Option<(Matrix, [f64; D])>,
}

impl<const D: usize> Enclosure<D> {
    /// Of a cell with the positions `nodal`, `[component][node]`.
    pub fn new(to_legendre: &Matrix, nodal: &[f64]) -> Self {
        let (nodes, order) = (nodal.len() / D, to_legendre.rows());
        let modes = |component: &[f64]| (0..D).fold(component.to_vec(), |c, axis| along_axis(to_legendre, &c, axis));
        let c: Vec<Vec<f64>> = nodal.chunks_exact(nodes).map(modes).collect();
        let linear: [usize; D] = std::array::from_fn(|axis| order.pow(axis as u32));
        let inverse = Matrix::from_fn(D, D, |i, j| c[i][linear[j]]).inverse();
        let higher: Vec<usize> = (1..nodes).filter(|k| !linear.contains(k)).collect();
        let reach = |inverse: &Matrix, i: usize| {
            let image = |k: &usize| inverse.row(i).iter().zip(&c).map(|(g, c)| g * c[*k]).sum::<f64>().abs();
            (1.0 + MARGIN) * (1.0 + higher.iter().map(image).sum::<f64>())
        };
        Enclosure {
            centre: std::array::from_fn(|i| c[i][0]),
            extent: std::array::from_fn(|i| (1.0 + MARGIN) * c[i][1..].iter().map(|c| c.abs()).sum::<f64>()),
            edges: inverse.map(|inverse| (inverse.clone(), std::array::from_fn(|i| reach(&inverse, i)))),
        }
    }

    /// Whether both contain `x`.
    pub fn contains(&self, x: &[f64; D]) -> bool {
        let d: [f64; D] = std::array::from_fn(|i| x[i] - self.centre[i]);
        (0..D).all(|i| d[i].abs() <= self.extent[i]) && self.edges.as_ref().is_none_or(|edges| is_between(edges, &d))
    }

    /// At most the distance of the cell from `x`; 0 inside both.
    pub fn distance(&self, x: &[f64; D]) -> f64 {
        let d: [f64; D] = from_fn(|i| x[i] - self.centre[i]);
        self.distance_of_box(&d).max(self.edges.as_ref().map_or(0.0, |edges| distance_from_planes(edges, &d)))
    }
}

/// The largest distance from the planes of the parallelepiped of the point at the distance `d` from its centre; 0 inside.
fn distance_from_planes<const D: usize>(edges: &(Matrix, [f64; D]), d: &[f64; D]) -> f64 {
    let length = |i: usize| norm(&from_fn::<f64, D, _>(|j| edges.0.row(i)[j]));
    (0..D).map(|i| beyond(edges, d, i) / length(i)).fold(0.0, f64::max)
}

/// How far the point at the distance `d` is beyond the planes of the parallelepiped along edge `i`, in its reference coordinate.
fn beyond<const D: usize>((inverse, reach): &(Matrix, [f64; D]), d: &[f64; D], i: usize) -> f64 {
    inverse.row(i).iter().zip(d).map(|(g, d)| g * d).sum::<f64>().abs() - reach[i]
}

/// The box alone.
impl<const D: usize> Enclosure<D> {
    /// Its distance from the point that is `d` away from its centre; 0 inside.
    fn distance_of_box(&self, d: &[f64; D]) -> f64 {
        norm(&from_fn::<f64, D, _>(|i| (d[i].abs() - self.extent[i]).max(0.0)))
    }

    /// Whether it meets the box from `lower` to `upper`.
    pub fn meets(&self, lower: &[f64; D], upper: &[f64; D]) -> bool {
        let [centre, extent] = [&self.centre, &self.extent];
        (0..D).all(|i| lower[i] <= centre[i] + extent[i] && upper[i] >= centre[i] - extent[i])
    }

    /// Its diagonal.
    pub fn diagonal(&self) -> f64 {
        2.0 * norm(&self.extent)
    }
}

/// Whether the parallelepiped contains the point at the distance `d` from its centre.
fn is_between<const D: usize>(edges: &(Matrix, [f64; D]), d: &[f64; D]) -> bool {
    (0..D).all(|i| beyond(edges, d, i) <= 0.0)
}

/// Applies a square matrix along an axis of a lattice of values, axis 0 fastest.
fn along_axis(matrix: &Matrix, values: &[f64], axis: usize) -> Vec<f64> {
    let (n, stride) = (matrix.rows(), matrix.rows().pow(axis as u32));
    let entry = |i: usize| {
        let row = i / stride % n;
        let first = i - row * stride;
        matrix.row(row).iter().enumerate().map(|(k, m)| m * values[first + k * stride]).sum()
    };
    (0..values.len()).map(entry).collect()
}

/// From values at Gauss-Lobatto nodes to Legendre coefficients, `[k][node]`: (2 k + 1) / 2 int l_node P_k, by a rule that is exact.
pub fn to_legendre(order: usize) -> Matrix {
    let rule = gauss(order);
    let values = Lagrange::gauss_lobatto(order).value_matrix(&rule.points);
    let legendre: Vec<Vec<f64>> = rule.points.iter().map(|&x| legendre_polynomials(order, x)).collect();
    Matrix::from_fn(order, order, |k, node| {
        let at = |q: usize| rule.weights[q] * legendre[q][k] * values.row(q)[node];
        (k as f64 + 0.5) * (0..order).map(at).sum::<f64>()
    })
}

/// P_0(x), P_1(x), ... by (k + 1) P_{k+1} = (2 k + 1) x P_k - k P_{k-1}.
fn legendre_polynomials(count: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..count.max(2) - 1 {
        let k_ = k as f64;
        p.push(((2.0 * k_ + 1.0) * x * p[k] - k_ * p[k - 1]) / (k_ + 1.0));
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thin oblique cell fills little of its box: all cells with such boxes were searched for a point in them.
    #[test]
    fn a_point_in_the_box_is_away_from_an_oblique_cell() {
        let (order, thin) = (2, 0.1);
        let corner = |k: usize| [(k % 2) as f64 + thin * (k / 2) as f64, (k % 2) as f64];
        let nodal: Vec<f64> = (0..2).flat_map(|i| (0..4).map(move |k| corner(k)[i])).collect();
        let enclosure = Enclosure::<2>::new(&to_legendre(order), &nodal);
        let away = enclosure.distance(&[0.1, 0.9]);
        // The line x = y is the side of the cell.
        assert!((away - 0.8 / 2.0_f64.sqrt()).abs() < 1e-5, "{away}");
        assert_eq!(enclosure.distance(&[0.55, 0.5]), 0.0);
    }

    #[test]
    fn coefficients_of_a_polynomial_are_found() {
        let nodes = basis::gauss_lobatto(4).points;
        let values: Vec<f64> = nodes.iter().map(|x| 2.0 - x + 0.5 * (5.0 * x * x * x - 3.0 * x)).collect();
        let found = along_axis(&to_legendre(4), &values, 0);
        let expected = [2.0, -1.0, 0.0, 1.0];
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-14), "{found:?}");
    }
}
