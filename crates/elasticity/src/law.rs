//! The laws of the mesh at a point: the first Piola stress P = dW/dH of the displacement gradient H = grad d.
//!
//! ```text
//! W = mu eps : eps + lambda/2 tr(eps)^2,                   eps = (H + H^T) / 2                                   (linear)
//! P = 2 mu eps + lambda tr(eps) I
//!
//! W = mu/2 (|F|^2 - D - 2 ln J) + lambda/2 (ln J)^2,       F = I + H,  J = det F                                 (neo-Hookean)
//! P = mu (F - F^{-T}) + lambda ln J F^{-T}
//! ```
//!
//! They agree to first order in H. The linear law costs one solve, but treats a rotation as a strain: after a large rotation its
//! cells invert. The neo-Hookean law is invariant under rotations, and -ln J prevents the collapse of cells at the points where W
//! is integrated.

use crate::Lame;
use crate::geometry::quadrature_points;
use basis::{Rule, gauss, gauss_lobatto};
use tensor::{Real, cofactor, determinant};

/// The energy that the mesh minimises, and the reference of its strain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Law {
    /// (linear), about the initial mesh: K is constant, and the mesh depends only on the position of its boundary.
    #[default]
    Linear,
    /// (linear) for the increment d - d_n of a slab, about the mesh at its bottom. The stiffness is fixed to the material. If it is a
    /// power of det J, this is the Jacobian of the mesh at the bottom.
    Incremental,
    /// (neo-Hookean), about the initial mesh.
    NeoHookean,
}

impl Law {
    /// Whether P is linear in H; one solve with K then gives the equilibrium.
    pub fn is_linear(self) -> bool {
        self != Law::NeoHookean
    }

    /// The points of a cell of order N at which the energy is integrated, per direction. The logarithm is a barrier at these points
    /// only, so there are 2N, including those at the ends.
    pub(crate) fn rule(self, dimension: usize, order: usize) -> Rule {
        match self {
            Law::Linear | Law::Incremental => gauss(quadrature_points(dimension, order)),
            Law::NeoHookean => gauss_lobatto(2 * order),
        }
    }
}

/// A law for any number type.
pub(crate) trait PointLaw: Copy + Send + Sync {
    /// Whether the law is defined for J > 0 only.
    const HAS_BARRIER: bool;

    /// P and J of H, `gradient[i][j]` = d d_i / d x_j.
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> PointStress<T, D>;
}

/// The stress of a law, and J.
pub(crate) struct PointStress<T, const D: usize> {
    /// P, `[i][j]` = dW/dH_ij.
    pub(crate) piola: [[T; D]; D],
    /// J = det F; 1 for a law without barrier. P is meaningless unless J > 0.
    pub(crate) volume_ratio: T,
}

impl PointLaw for Lame {
    const HAS_BARRIER: bool = false;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> PointStress<T, D> {
        PointStress { piola: Lame::stress(&self, gradient), volume_ratio: gradient[0][0].constant(1.0) }
    }
}

/// (neo-Hookean)
#[derive(Clone, Copy, Debug)]
pub(crate) struct NeoHookean(pub(crate) Lame);

impl PointLaw for NeoHookean {
    const HAS_BARRIER: bool = true;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> PointStress<T, D> {
        let Lame { lambda, mu } = self.0;
        let f = plus_identity(gradient);
        let cofactor = cofactor(&f);
        let j = determinant(&f, &cofactor);
        // F^{-T} = cof F / J
        let factor = (j.ln() * lambda - mu) / j;
        let mut piola = f;
        for i in 0..D {
            for k in 0..D {
                piola[i][k] = factor.mul_add(cofactor[i][k], f[i][k] * mu);
            }
        }
        PointStress { piola, volume_ratio: j }
    }
}

/// F = I + H.
#[inline(always)]
pub(crate) fn plus_identity<T: Real, const D: usize>(gradient: &[[T; D]; D]) -> [[T; D]; D] {
    let mut f = *gradient;
    for i in 0..D {
        f[i][i] = f[i][i] + 1.0;
    }
    f
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::material;
    use tensor::{Dual, Transcendental, dot};

    /// W of (neo-Hookean).
    fn energy<T: Transcendental, const D: usize>(lame: Lame, gradient: &[[T; D]; D]) -> T {
        let f = plus_identity(gradient);
        let ln_j = determinant(&f, &cofactor(&f)).ln();
        let square = f.iter().map(|row| dot(row, row)).fold(T::from(0.0), |sum, row| sum + row);
        (square - D as f64 - ln_j * 2.0) * (lame.mu / 2.0) + ln_j * ln_j * (lame.lambda / 2.0)
    }

    fn stress<const D: usize>(gradient: &[[f64; D]; D]) -> [[f64; D]; D] {
        NeoHookean(material().lame()).stress(gradient).piola
    }

    fn largest_difference<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) -> f64 {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    const PLANE: [[f64; 2]; 2] = [[0.3, -0.7], [0.9, 0.4]];
    const SPACE: [[f64; 3]; 3] = [[0.3, -0.7, 0.2], [0.9, 0.4, -0.1], [-0.3, 0.5, -0.2]];

    fn is_derivative_of_energy<const D: usize>(gradient: &[[f64; D]; D]) {
        let lame = material().lame();
        let piola = stress(gradient);
        for i in 0..D {
            for j in 0..D {
                let mut dual = gradient.map(|row| row.map(|h| Dual::new(h, 0.0)));
                dual[i][j].derivative = 1.0;
                assert!((piola[i][j] - energy(lame, &dual).derivative).abs() < 1e-14, "dual, {i}, {j}");
                let at = |h: f64| {
                    let mut moved = *gradient;
                    moved[i][j] += h;
                    energy(lame, &moved)
                };
                let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((piola[i][j] - difference).abs() < 1e-8, "difference, {i}, {j}");
            }
        }
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        is_derivative_of_energy(&PLANE);
        is_derivative_of_energy(&SPACE);
    }

    /// W(Q F) = W(F) and P(Q F) = Q P(F): a rotation of any angle costs no energy.
    #[test]
    fn energy_does_not_notice_rotations() {
        let rotate = |f: &[[f64; 2]; 2]| -> [[f64; 2]; 2] {
            let (sin, cos) = 2.4_f64.sin_cos();
            let q = [[cos, -sin], [sin, cos]];
            std::array::from_fn(|i| std::array::from_fn(|j| (0..2).map(|k| q[i][k] * f[k][j]).sum()))
        };
        let minus_identity = |mut f: [[f64; 2]; 2]| {
            (0..2).for_each(|i| f[i][i] -= 1.0);
            f
        };
        let rotated = minus_identity(rotate(&plus_identity(&PLANE)));
        let lame = material().lame();
        assert!((energy(lame, &rotated) - energy(lame, &PLANE)).abs() < 1e-14);
        assert!(largest_difference(&stress(&rotated), &rotate(&stress(&PLANE))) < 1e-14);
        let pure = minus_identity(rotate(&plus_identity(&[[0.0; 2]; 2])));
        assert!(largest_difference(&stress(&pure), &[[0.0; 2]; 2]) < 1e-15);
    }

    /// The difference of the two laws falls with the square of the strain.
    #[test]
    fn small_strains_are_linear() {
        let difference = |size: f64| {
            let gradient = SPACE.map(|row| row.map(|h| h * size));
            largest_difference(&stress(&gradient), &Lame::stress(&material().lame(), &gradient))
        };
        let order = (difference(1e-3) / difference(5e-4)).log2();
        assert!((order - 2.0).abs() < 0.01, "order {order}");
    }

    #[test]
    fn plane_strain_is_the_law_in_space_without_motion_along_the_third_axis() {
        let space = stress(&[[0.3, -0.7, 0.0], [0.9, 0.4, 0.0], [0.0; 3]]);
        let plane = stress(&PLANE);
        assert!((0..2).all(|i| (0..2).all(|j| (plane[i][j] - space[i][j]).abs() < 1e-15)));
    }

    #[test]
    fn volume_ratio_tells_an_inverted_point() {
        let law = NeoHookean(material().lame());
        assert!((law.stress(&[[1.0, 0.0], [0.0, 0.5]]).volume_ratio - 3.0).abs() < 1e-15);
        assert!(law.stress(&[[-1.5, 0.0], [0.0, 0.5]]).volume_ratio < 0.0);
        assert_eq!(PointLaw::stress(material().lame(), &[[-1.5, 0.0], [0.0, 0.5]]).volume_ratio, 1.0);
    }
}
