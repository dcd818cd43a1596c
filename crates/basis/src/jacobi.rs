//! Jacobi polynomials P_m^{(alpha, beta)}: orthogonal on [-1, 1] under (1 - x)^alpha (1 + x)^beta, with
//! P_m(1) = binomial(m + alpha, m). Legendre polynomials are alpha = beta = 0.

/// P_m^{(alpha, beta)}(x) by the three-term recurrence, Abramowitz & Stegun 22.7.1. For alpha = beta it is even or odd
/// to the bit.
///
///   2 k (k + a + b) (c - 2) P_k = (c - 1) (c (c - 2) x + a^2 - b^2) P_{k-1} - 2 (k + a - 1) (k + b - 1) c P_{k-2},
///
/// with c = 2k + a + b.
pub(crate) fn jacobi(m: usize, alpha: f64, beta: f64, x: f64) -> f64 {
    let (a, b) = (alpha, beta);
    let (mut previous, mut current) = (0.0, 1.0);
    for k in 1..=m {
        let next =
            if k == 1 { ((a - b) + (a + b + 2.0) * x) / 2.0 } else { recurrence(k as f64, a, b, x, current, previous) };
        (previous, current) = (current, next);
    }
    current
}

fn recurrence(k: f64, a: f64, b: f64, x: f64, p1: f64, p2: f64) -> f64 {
    let c = 2.0 * k + a + b;
    let first = (c - 1.0) * (c * (c - 2.0) * x + (a * a - b * b)) * p1;
    let second = 2.0 * (k + a - 1.0) * (k + b - 1.0) * c * p2;
    (first - second) / (2.0 * k * (k + a + b) * (c - 2.0))
}

/// d/dx P_m^{(alpha, beta)} = (m + alpha + beta + 1) / 2 P_{m-1}^{(alpha+1, beta+1)}.
pub(crate) fn jacobi_derivative(m: usize, alpha: f64, beta: f64, x: f64) -> f64 {
    match m {
        0 => 0.0,
        _ => (m as f64 + alpha + beta + 1.0) / 2.0 * jacobi(m - 1, alpha + 1.0, beta + 1.0, x),
    }
}

/// The Legendre polynomial P_m(x).
pub(crate) fn legendre(m: usize, x: f64) -> f64 {
    jacobi(m, 0.0, 0.0, x)
}

/// The m roots of P_m^{(alpha, beta)}, ascending: Newton's method to round-off from the roots of Darboux's
/// asymptotic formula (Szego, eq. 8.21.10)
///
///   x_k ~ cos(pi (k + alpha/2 - 1/4) / (m + (alpha + beta + 1)/2)),  k = 1..m from the right.
pub(crate) fn jacobi_roots(m: usize, alpha: f64, beta: f64) -> Vec<f64> {
    let count = m as f64 + (alpha + beta + 1.0) / 2.0;
    let guess = |k: usize| (std::f64::consts::PI * (k as f64 + alpha / 2.0 - 0.25) / count).cos();
    (1..=m).rev().map(|k| polish(m, alpha, beta, guess(k))).collect()
}

/// Newton's method; the asymptotic guess needs three to five steps, and the bound stops the last bit from flickering.
fn polish(m: usize, alpha: f64, beta: f64, mut x: f64) -> f64 {
    for _ in 0..10 {
        let step = jacobi(m, alpha, beta, x) / jacobi_derivative(m, alpha, beta, x);
        x -= step;
        if step.abs() <= f64::EPSILON / 4.0 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_degrees_are_the_known_ones() {
        let x = 0.3;
        assert!((legendre(3, x) - (5.0 * x * x * x - 3.0 * x) / 2.0).abs() < 1e-15);
        assert!((jacobi(2, 1.0, 1.0, x) - (15.0 * x * x - 3.0) / 4.0).abs() < 1e-15);
        assert!((jacobi(1, 1.0, 0.0, x) - (1.0 + 3.0 * x) / 2.0).abs() < 1e-15);
    }

    #[test]
    fn derivative_agrees_with_differences() {
        let h = 1e-5;
        for (m, alpha, beta) in [(0, 0.0, 0.0), (5, 0.0, 0.0), (7, 1.0, 0.0), (6, 1.0, 1.0)] {
            let p = |x| jacobi(m, alpha, beta, x);
            let difference = (p(0.4 + h) - p(0.4 - h)) / (2.0 * h);
            assert!((jacobi_derivative(m, alpha, beta, 0.4) - difference).abs() < 1e-7);
        }
    }

    #[test]
    fn the_guesses_lead_to_all_roots() {
        for m in 1..=64 {
            for (alpha, beta) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)] {
                let roots = jacobi_roots(m, alpha, beta);
                assert!(roots.windows(2).all(|pair| pair[1] - pair[0] > 1e-4), "{m} {alpha} {beta}");
                assert!(roots[0] > -1.0 && roots[m - 1] < 1.0);
                let worst =
                    roots.iter().map(|&x| (jacobi(m, alpha, beta, x) / jacobi_derivative(m, alpha, beta, x)).abs());
                assert!(worst.fold(0.0, f64::max) < 1e-15);
            }
        }
    }
}
