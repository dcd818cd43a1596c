//! Smoothing of the cells inside a block structure.

use basis::{Lagrange, Matrix, gauss_lobatto};

/// Moves nodes so that the map from the cells' reference squares is harmonic. With given fixed nodes it minimises
///
/// ```text
/// sum_cells int |dx/dxi|^2 dxi,    so    sum_cells (K (x) W + W (x) K) x = 0 at every free node           (harmonic)
/// ```
///
/// with the Gauss-Lobatto weights W and K = D^T W D for the derivative D. Lines of cells then cross block boundaries
/// without a kink.
pub(super) struct Harmonic {
    /// N.
    n: usize,
    stiffness: Matrix,
    weights: Vec<f64>,
    /// The number of each node of each cell that has a free node; equal if nodes coincide.
    numbers: Vec<usize>,
    /// Which numbers may move.
    free: Vec<bool>,
}

/// The factor of reduction of the residuals. Smoothness matters, not the last digit, so more is not needed.
const REDUCTION: f64 = 1e-7;

impl Harmonic {
    /// For cells of order n with nodes `numbers`, `[cell][node]`; `free` tells for each number whether it may change.
    pub(super) fn new(n: usize, numbers: &[usize], free: Vec<bool>) -> Self {
        let rule = gauss_lobatto(n);
        let derivative = Lagrange::gauss_lobatto(n).derivative_matrix(&rule.points);
        let entry = |i, j| (0..n).map(|q| rule.weights[q] * derivative[(q, i)] * derivative[(q, j)]).sum();
        let moves = |nodes: &&[usize]| nodes.iter().any(|&node| free[node]);
        let numbers = numbers.chunks_exact(n * n).filter(moves).flatten().copied().collect();
        Harmonic { n, stiffness: Matrix::from_fn(n, n, entry), weights: rule.weights, numbers, free }
    }

    /// Solves (harmonic) by conjugate gradients, preconditioned by the diagonal, from one coordinate `x` of all nodes.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let diagonal = self.diagonal();
        let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
        let mut residual: Vec<f64> = self.apply(x).iter().map(|r| -r).collect();
        let mut direction = scaled(&residual);
        let mut square = dot(&residual, &direction);
        let target = square * REDUCTION * REDUCTION;
        // One step per unknown suffices in exact arithmetic; far fewer are needed.
        for _ in 0..x.len() {
            if square <= target {
                break;
            }
            let image = self.apply(&direction);
            let step = square / dot(&direction, &image);
            add(x, step, &direction);
            add(&mut residual, -step, &image);
            let preconditioned = scaled(&residual);
            let next = dot(&residual, &preconditioned);
            let share = next / square;
            direction.iter_mut().zip(&preconditioned).for_each(|(p, z)| *p = z + share * *p);
            square = next;
        }
    }

    /// The left side of (harmonic) at free nodes, 0 at the others.
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut y = vec![0.0; x.len()];
        for nodes in self.numbers.chunks_exact(n * n) {
            let local: Vec<f64> = nodes.iter().map(|&node| x[node]).collect();
            for j in 0..n {
                for i in 0..n {
                    let along: f64 = (0..n).map(|l| self.stiffness.row(i)[l] * local[l + n * j]).sum();
                    let across: f64 = (0..n).map(|l| self.stiffness.row(j)[l] * local[i + n * l]).sum();
                    y[nodes[i + n * j]] += along * self.weights[j] + across * self.weights[i];
                }
            }
        }
        y.iter_mut().zip(&self.free).filter(|(_, free)| !**free).for_each(|(y, _)| *y = 0.0);
        y
    }

    fn diagonal(&self) -> Vec<f64> {
        let n = self.n;
        let mut diagonal = vec![0.0; self.free.len()];
        for (k, &node) in self.numbers.iter().enumerate() {
            let (i, j) = (k % (n * n) % n, k % (n * n) / n);
            diagonal[node] += self.stiffness[(i, i)] * self.weights[j] + self.stiffness[(j, j)] * self.weights[i];
        }
        // Nodes of no such cell have a zero residual.
        diagonal.iter_mut().filter(|d| **d == 0.0).for_each(|d| *d = 1.0);
        diagonal
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// x += factor y
fn add(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One cell between fixed sides: the harmonic function of degree N - 1 with these values.
    #[test]
    fn harmonic_polynomials_are_found() {
        let n = 5;
        let nodes = gauss_lobatto(n).points;
        let exact = |k: usize| {
            let (x, y) = (nodes[k % n], nodes[k / n]);
            x.powi(3) - 3.0 * x * y * y + x * y + 2.0
        };
        let inside = |k: usize| (1..n - 1).contains(&(k % n)) && (1..n - 1).contains(&(k / n));
        let harmonic = Harmonic::new(n, &Vec::from_iter(0..n * n), (0..n * n).map(inside).collect());
        let mut x: Vec<f64> = (0..n * n).map(|k| if inside(k) { 0.0 } else { exact(k) }).collect();
        harmonic.solve(&mut x);
        for (k, x) in x.iter().enumerate() {
            assert!((x - exact(k)).abs() < 1e-6, "{k} {x} {}", exact(k));
        }
    }

    /// Two cells with a kink between them.
    #[test]
    fn kinks_disappear() {
        // Nodes 0 1 2 of cell 0 and 1 2 .. share the line x = 1; order 2: lattice 3 x 2.
        let numbers = [0, 1, 3, 4, 1, 2, 4, 5];
        let free = [1, 4].map(|k| (0..6).map(move |node| node == k));
        let free: Vec<bool> = free[0].clone().zip(free[1].clone()).map(|(a, b)| a || b).collect();
        let mut x = vec![0.0, 0.3, 2.0, 0.0, 1.9, 2.0];
        Harmonic::new(2, &numbers, free).solve(&mut x);
        assert!((x[1] - 1.0).abs() < 1e-9 && (x[4] - 1.0).abs() < 1e-9, "{x:?}");
    }
}
