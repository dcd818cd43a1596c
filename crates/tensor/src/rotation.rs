//! Rotations by a rotation vector Theta: about its direction, by its length in radians.
//!
//! ```text
//! R y = exp(Theta^) y = y + c_1 Theta x y + c_2 Theta x (Theta x y)                                              (Rodrigues)
//! omega = T(Theta) Theta',    T y = y + c_2 Theta x y + c_3 Theta x (Theta x y)                                  (angular velocity)
//! c_k = sum_j (-x)^j / (k + 2j)!,    x = |Theta|^2                                                               (Stumpff)
//! ```
//!
//! c_1 = sin(t)/t, c_2 = (1 - cos(t))/t^2 and c_3 = (t - sin(t))/t^3 with t = |Theta|. As functions of x they are smooth at zero. T is
//! singular where t is a multiple of 2 pi but zero; along Theta it is the identity for any t.

use crate::{Transcendental, cross};

/// R y. In two dimensions y has no component along z, and neither has the result.
pub fn rotated<T: Transcendental, const D: usize>(theta: &[T; 3], y: &[T; D]) -> [T; D] {
    let moved = moved_by_rotation(theta, &std::array::from_fn(|i| y.get(i).copied().unwrap_or(T::from(0.0))));
    std::array::from_fn(|i| y[i] + moved[i])
}

/// R y - y, to as many digits for small angles as for large ones.
pub fn moved_by_rotation<T: Transcendental>(theta: &[T; 3], y: &[T; 3]) -> [T; 3] {
    change(1, theta, y)
}

/// omega, for the derivative Theta' = `rate`.
pub fn angular_velocity<T: Transcendental>(theta: &[T; 3], rate: &[T; 3]) -> [T; 3] {
    let change = change(2, theta, rate);
    std::array::from_fn(|i| rate[i] + change[i])
}

/// c_k Theta x y + c_(k+1) Theta x (Theta x y)
fn change<T: Transcendental>(k: usize, theta: &[T; 3], y: &[T; 3]) -> [T; 3] {
    let x = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2];
    let (first, second) = (stumpff(k, x), stumpff(k + 1, x));
    let once = cross(theta, y);
    let twice = cross(theta, &once);
    std::array::from_fn(|i| first * once[i] + second * twice[i])
}

/// c_k by (Stumpff) for small x, by c_k = (1 - c_(k-2)) / x otherwise; k is 3 at most.
fn stumpff<T: Transcendental>(k: usize, x: T) -> T {
    if x.value() < 1.0 {
        return series(k, x);
    }
    match k {
        0 => x.sqrt().cos(),
        1 => x.sqrt().sin() / x.sqrt(),
        _ => (T::from(1.0) - stumpff(k - 2, x)) / x,
    }
}

/// (Stumpff) by Horner's rule, to round-off for x <= 1.
fn series<T: Transcendental>(k: usize, x: T) -> T {
    let one = T::from(1.0);
    let factor = |j: usize| 1.0 / (((k + 2 * j - 1) * (k + 2 * j)) as f64);
    let sum = (1..10).rev().fold(one, |sum, j| one - x * sum * factor(j));
    (1..=k).fold(sum, |sum, j| sum * (1.0 / j as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dual, dot};

    /// Derivative of `f` at x by a dual.
    fn slope(f: impl Fn(Dual<f64>) -> Dual<f64>, x: f64) -> f64 {
        f(Dual::new(x, 1.0)).derivative
    }

    #[test]
    fn series_and_closed_forms_agree_where_they_meet() {
        for k in 0..4 {
            let (below, above) = (series(k, 1.0), stumpff(k, 1.0));
            assert!((below - above).abs() < 1e-15, "c_{k}: {below} and {above}");
            let (below, above) = (slope(|x| series(k, x), 1.0), slope(|x| stumpff(k, x), 1.0));
            assert!((below - above).abs() < 1e-14, "c_{k}': {below} and {above}");
        }
    }

    #[test]
    fn rotations_keep_lengths_and_their_axis() {
        for length in [0.0, 1e-9, 0.4, 2.0, 6.0, 400.0] {
            let (theta, y) = ([0.6 * length, 0.0, 0.8 * length], [0.3, -1.2, 0.5]);
            let turned = rotated(&theta, &y);
            assert!((dot(&turned, &turned) - dot(&y, &y)).abs() < 1e-14, "{length}");
            let along = angular_velocity(&theta, &[0.6, 0.0, 0.8]);
            assert!((along[0] - 0.6).abs() + along[1].abs() + (along[2] - 0.8).abs() < 1e-14, "{along:?}");
        }
        let quarter = rotated(&[0.0, 0.0, std::f64::consts::FRAC_PI_2], &[2.0, 1.0]);
        assert!((quarter[0] + 1.0).abs() < 1e-15 && (quarter[1] - 2.0).abs() < 1e-15, "{quarter:?}");
    }

    #[test]
    fn small_rotations_keep_their_digits() {
        let moved = moved_by_rotation(&[0.0, 0.0, 1e-12], &[2.0, 1.0, 5.0]);
        assert!((moved[0] + 1e-12).abs() < 1e-23 && (moved[1] - 2e-12).abs() < 1e-23, "{moved:?}");
    }

    /// d(R y) = omega x R y along any change of Theta.
    #[test]
    fn the_angular_velocity_is_that_of_the_rotation() {
        for scale in [1e-6, 0.3, 1.5] {
            let (theta, rate, y) = ([scale, -0.7 * scale, 0.4 * scale], [0.2, 0.9, -0.5], [0.3, -1.2, 0.5]);
            let moving = std::array::from_fn(|i| Dual::new(theta[i], rate[i]));
            let turned = rotated(&moving, &y.map(Dual::from));
            let expected = cross(&angular_velocity(&theta, &rate), &turned.map(|x| x.value));
            assert!((0..3).all(|i| (turned[i].derivative - expected[i]).abs() < 1e-14), "{turned:?}, {expected:?}");
        }
    }
}
