//! The eigenvectors of the time matrix: they decouple a slab into problems in space.

use crate::{Matrix, RadauTime};
use faer::{Mat, c64};

/// W^{-1} T = Q L Q^{-1}, complex pairs counted once.
pub struct TemporalModes {
    /// The real eigenvalues, and of each complex pair the one above the real axis.
    pub eigenvalues: Vec<c64>,
    /// Maps residuals at the time nodes to the modes, `[column][time node]`: Q^{-1} W^{-1}. A real mode takes one column,
    /// a complex mode two: real and imaginary part.
    pub forward: Matrix,
    /// Maps modes back to increments at the time nodes, `[time node][column]`: Q, complex pairs summed.
    pub backward: Matrix,
}

impl TemporalModes {
    /// The modes of the basis of a slab.
    pub fn new(time: &RadauTime) -> Self {
        let (n, w) = (time.order(), time.weights());
        let matrix = Mat::from_fn(n, n, |a, b| time.slab_matrix()[(a, b)] / w[a]);
        let eigen = matrix.eigen().expect("the time matrix has distinct eigenvalues");
        let (values, q) = (eigen.S().column_vector(), eigen.U());
        let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&q.partial_piv_lu());
        let modes: Vec<usize> = (0..n).filter(|&k| values[k].im > -1e-10).collect();
        let parts: Vec<(usize, bool)> = (modes.iter())
            .flat_map(|&k| if is_real(values[k]) { vec![(k, true)] } else { vec![(k, true), (k, false)] })
            .collect();
        let part = |z: c64, real: bool| if real { z.re } else { z.im };
        TemporalModes {
            eigenvalues: modes
                .iter()
                .map(|&k| if is_real(values[k]) { c64::new(values[k].re, 0.0) } else { values[k] })
                .collect(),
            forward: Matrix::from_fn(n, n, |column, a| part(inverse[(parts[column].0, a)], parts[column].1) / w[a]),
            backward: Matrix::from_fn(n, n, |a, column| {
                let (k, real) = parts[column];
                // Q_ak c_k plus its conjugate: 2 Re Q Re c - 2 Im Q Im c.
                let twice = if is_real(values[k]) {
                    1.0
                } else if real {
                    2.0
                } else {
                    -2.0
                };
                twice * part(q[(a, k)], real)
            }),
        }
    }

    /// |Q| |Q^{-1}| in the Frobenius norm, for the basis Q of the modes. Errors of modes are amplified by this factor at most. It is 1 to
    /// 40 up to N_t = 4, then ten times more for every two nodes.
    pub fn condition(&self, time: &RadauTime) -> f64 {
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let unweighted = self.forward.values().iter().zip(time.weights().iter().cycle()).map(|(x, w)| x * w);
        norm(&mut self.backward.values().iter().copied()) * norm(&mut { unweighted })
    }

    /// The mean of |lambda| over all eigenvalues: a real shift that represents them all.
    pub fn mean_shift(&self) -> f64 {
        let (sum, count) = self.eigenvalues.iter().fold((0.0, 0.0), |(sum, count), &l| {
            let multiplicity = if is_real(l) { 1.0 } else { 2.0 };
            (sum + multiplicity * l.norm(), count + multiplicity)
        });
        sum / count
    }
}

/// Whether an eigenvalue is real.
pub fn is_real(lambda: c64) -> bool {
    lambda.im.abs() <= 1e-10
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separation_is_harmless_at_low_orders() {
        let condition = |order| {
            let time = RadauTime::new(order);
            TemporalModes::new(&time).condition(&time)
        };
        assert!((condition(1) - 1.0).abs() < 1e-14);
        assert!((2..=4).all(|order| condition(order) < 50.0) && condition(16) > 1e9);
    }

    #[test]
    fn modes_rebuild_the_time_matrix() {
        for order in 1..=6 {
            let time = RadauTime::new(order);
            let modes = TemporalModes::new(&time);
            // backward L forward = W^{-1} T W^{-1}, with L acting on columns as multiplication by lambda.
            let mut scaled = Matrix::from_fn(order, order, |i, j| modes.forward[(i, j)]);
            let mut column = 0;
            for &l in &modes.eigenvalues {
                let old = scaled.clone();
                if is_real(l) {
                    scaled = Matrix::from_fn(
                        order,
                        order,
                        |i, j| if i == column { l.re * old[(i, j)] } else { old[(i, j)] },
                    );
                    column += 1;
                } else {
                    scaled = Matrix::from_fn(order, order, |i, j| match i {
                        i if i == column => l.re * old[(i, j)] - l.im * old[(i + 1, j)],
                        i if i == column + 1 => l.im * old[(i - 1, j)] + l.re * old[(i, j)],
                        _ => old[(i, j)],
                    });
                    column += 2;
                }
            }
            let rebuilt = modes.backward.product(&scaled);
            let w = time.weights();
            for a in 0..order {
                for b in 0..order {
                    let expected = time.slab_matrix()[(a, b)] / w[a] / w[b];
                    assert!(
                        (rebuilt[(a, b)] - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                        "N_t = {order}: {a}, {b}"
                    );
                }
            }
        }
    }
}
