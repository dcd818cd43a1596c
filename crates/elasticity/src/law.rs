//! The laws of meshes and bodies at a point: the first Piola stress P = dW/dH of the displacement gradient H = grad d.
//!
//! ```text
//! W = mu eps : eps + lambda/2 tr(eps)^2,                   eps = (H + H^T) / 2                                   (linear)
//! P = 2 mu eps + lambda tr(eps) I
//!
//! W = mu/2 (|F|^2 - D - 2 ln J) + lambda/2 (ln J)^2,       F = I + H,  J = det F                                 (neo-Hookean)
//! P = mu (F - F^{-T}) + lambda ln J F^{-T}
//!
//! W = mu E : E + lambda/2 tr(E)^2,                         E = (F^T F - I) / 2                          (St. Venant-Kirchhoff)
//! P = F (2 mu E + lambda tr(E) I)
//! ```
//!
//! They agree to first order in H. The linear law costs one solve, but treats a rotation as a strain: after a large rotation its
//! cells invert. The other laws are invariant under rotations. In the neo-Hookean law -ln J prevents the collapse of cells at the
//! points where W is integrated. The law of St. Venant and Kirchhoff is for large displacements of small strain: it does not resist
//! a compression to less than about half of the length.

use crate::Lame;
use crate::geometry::quadrature_points;
use basis::{Rule, gauss, gauss_lobatto};
use tensor::{Real, cofactor, determinant, dot};

/// The energy of a mesh or a body, and the reference of its strain.
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
    /// (St. Venant-Kirchhoff), about the initial mesh. For bodies.
    StVenantKirchhoff,
}

impl Law {
    /// Whether P is linear in H; one solve with K then gives the equilibrium.
    pub fn is_linear(self) -> bool {
        matches!(self, Law::Linear | Law::Incremental)
    }

    /// The points of a cell of order N at which the energy is integrated, per direction. The logarithm is a barrier at these points
    /// only, so there are 2N, including those at the ends. W of (St. Venant-Kirchhoff) has the degree 4 (N - 1) on affine cells, which
    /// 2N - 1 points integrate exactly.
    pub(crate) fn rule(self, dimension: usize, order: usize) -> Rule {
        match self {
            Law::Linear | Law::Incremental => gauss(quadrature_points(dimension, order)),
            Law::NeoHookean => gauss_lobatto(2 * order),
            Law::StVenantKirchhoff => gauss((2 * order - 1).max(quadrature_points(dimension, order))),
        }
    }
}

/// A stress of the displacement gradient, for any number type.
pub(crate) trait PointLaw: Copy + Send + Sync {
    /// Whether the law is defined for J > 0 only.
    const HAS_BARRIER: bool;
    /// The fields that it looks at: the displacement, or that and the velocity.
    const FIELDS: usize = 1;

    /// P and J of H, `gradient[i][j]` = d d_i / d x_j, and of its `rate` H' where the law looks at that.
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], rate: &[[T; D]; D]) -> PointStress<T, D>;
}

/// A law with an energy.
pub(crate) trait Hyperelastic: PointLaw {
    /// W of H.
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T;
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
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], _: &[[T; D]; D]) -> PointStress<T, D> {
        PointStress { piola: Lame::stress(&self, gradient), volume_ratio: gradient[0][0].constant(1.0) }
    }
}

impl Hyperelastic for Lame {
    /// sigma : H / 2
    #[inline(always)]
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T {
        contraction(&Lame::stress(&self, gradient), gradient) * 0.5
    }
}

/// (neo-Hookean)
#[derive(Clone, Copy, Debug)]
pub(crate) struct NeoHookean(pub(crate) Lame);

impl PointLaw for NeoHookean {
    const HAS_BARRIER: bool = true;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], _: &[[T; D]; D]) -> PointStress<T, D> {
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

impl Hyperelastic for NeoHookean {
    #[inline(always)]
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T {
        let Lame { lambda, mu } = self.0;
        let f = plus_identity(gradient);
        let ln_j = determinant(&f, &cofactor(&f)).ln();
        (contraction(&f, &f) - D as f64 - ln_j * 2.0) * (0.5 * mu) + ln_j * ln_j * (0.5 * lambda)
    }
}

/// (St. Venant-Kirchhoff)
#[derive(Clone, Copy, Debug)]
pub(crate) struct StVenantKirchhoff(pub(crate) Lame);

impl PointLaw for StVenantKirchhoff {
    const HAS_BARRIER: bool = false;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], _: &[[T; D]; D]) -> PointStress<T, D> {
        let (f, second) = (plus_identity(gradient), Lame::stress(&self.0, &green_strain(gradient)));
        PointStress { piola: times_symmetric(&f, &second), volume_ratio: f[0][0].constant(1.0) }
    }
}

impl Hyperelastic for StVenantKirchhoff {
    #[inline(always)]
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T {
        let strain = green_strain(gradient);
        contraction(&Lame::stress(&self.0, &strain), &strain) * 0.5
    }
}

/// The viscous stress of a body of large displacement, for beta = 1,
///
/// ```text
/// P = beta F (2 mu E' + lambda tr(E') I),      E' = sym(F^T H')                                                  (viscous)
/// ```
///
/// It agrees with beta sigma(H') to first order, does not notice rotations, and takes the energy P : H' >= 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viscous(pub(crate) Lame);

impl PointLaw for Viscous {
    const HAS_BARRIER: bool = false;
    const FIELDS: usize = 2;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], rate: &[[T; D]; D]) -> PointStress<T, D> {
        let f = plus_identity(gradient);
        let mut product = f;
        for i in 0..D {
            for j in 0..D {
                let mut sum = f[0][i] * rate[0][j];
                for k in 1..D {
                    sum = f[k][i].mul_add(rate[k][j], sum);
                }
                product[i][j] = sum;
            }
        }
        // The stress of a gradient is that of its symmetric part.
        PointStress {
            piola: times_symmetric(&f, &Lame::stress(&self.0, &product)),
            volume_ratio: f[0][0].constant(1.0),
        }
    }
}

/// A B of a symmetric B.
#[inline(always)]
fn times_symmetric<T: Real, const D: usize>(a: &[[T; D]; D], b: &[[T; D]; D]) -> [[T; D]; D] {
    let mut product = *a;
    for i in 0..D {
        for k in 0..D {
            product[i][k] = dot(&a[i], &b[k]);
        }
    }
    product
}

/// E = (H + H^T + H^T H) / 2: without the rounding of F^T F - I where the strain is small.
#[inline(always)]
fn green_strain<T: Real, const D: usize>(gradient: &[[T; D]; D]) -> [[T; D]; D] {
    let mut strain = *gradient;
    for i in 0..D {
        for j in 0..D {
            let mut sum = gradient[i][j] + gradient[j][i];
            for k in 0..D {
                sum = gradient[k][i].mul_add(gradient[k][j], sum);
            }
            strain[i][j] = sum * 0.5;
        }
    }
    strain
}

/// A : B
#[inline(always)]
fn contraction<T: Real, const D: usize>(a: &[[T; D]; D], b: &[[T; D]; D]) -> T {
    let mut sum = a[0][0].zero();
    for i in 0..D {
        sum += dot(&a[i], &b[i]);
    }
    sum
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
    use tensor::Dual;

    fn neo_hookean() -> NeoHookean {
        NeoHookean(material().lame())
    }

    fn st_venant_kirchhoff() -> StVenantKirchhoff {
        StVenantKirchhoff(material().lame())
    }

    fn stress<const D: usize>(gradient: &[[f64; D]; D]) -> [[f64; D]; D] {
        neo_hookean().stress(gradient, gradient).piola
    }

    fn largest_difference<const D: usize>(a: &[[f64; D]; D], b: &[[f64; D]; D]) -> f64 {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    const PLANE: [[f64; 2]; 2] = [[0.3, -0.7], [0.9, 0.4]];
    const SPACE: [[f64; 3]; 3] = [[0.3, -0.7, 0.2], [0.9, 0.4, -0.1], [-0.3, 0.5, -0.2]];

    fn is_derivative_of_energy<const D: usize>(law: impl Hyperelastic, gradient: &[[f64; D]; D]) {
        let piola = law.stress(gradient, gradient).piola;
        for i in 0..D {
            for j in 0..D {
                let mut dual = gradient.map(|row| row.map(|h| Dual::new(h, 0.0)));
                dual[i][j].derivative = 1.0;
                assert!((piola[i][j] - law.energy(&dual).derivative).abs() < 1e-14, "dual, {i}, {j}");
                let at = |h: f64| {
                    let mut moved = *gradient;
                    moved[i][j] += h;
                    law.energy(&moved)
                };
                let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((piola[i][j] - difference).abs() < 1e-8, "difference, {i}, {j}");
            }
        }
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        is_derivative_of_energy(neo_hookean(), &PLANE);
        is_derivative_of_energy(neo_hookean(), &SPACE);
        is_derivative_of_energy(st_venant_kirchhoff(), &PLANE);
        is_derivative_of_energy(st_venant_kirchhoff(), &SPACE);
        is_derivative_of_energy(material().lame(), &SPACE);
    }

    /// W(Q F) = W(F) and P(Q F) = Q P(F): a rotation of any angle costs no energy.
    fn does_not_notice_rotations(law: impl Hyperelastic) {
        let rotate = |f: &[[f64; 2]; 2]| -> [[f64; 2]; 2] {
            let (sin, cos) = 2.4_f64.sin_cos();
            let q = [[cos, -sin], [sin, cos]];
            std::array::from_fn(|i| std::array::from_fn(|j| (0..2).map(|k| q[i][k] * f[k][j]).sum()))
        };
        let minus_identity = |mut f: [[f64; 2]; 2]| {
            (0..2).for_each(|i| f[i][i] -= 1.0);
            f
        };
        let stress = |gradient: &[[f64; 2]; 2]| law.stress(gradient, gradient).piola;
        let rotated = minus_identity(rotate(&plus_identity(&PLANE)));
        assert!((law.energy(&rotated) - law.energy(&PLANE)).abs() < 1e-14);
        assert!(largest_difference(&stress(&rotated), &rotate(&stress(&PLANE))) < 1e-14);
        let pure = minus_identity(rotate(&plus_identity(&[[0.0; 2]; 2])));
        assert!(largest_difference(&stress(&pure), &[[0.0; 2]; 2]) < 1e-15);
    }

    #[test]
    fn energy_does_not_notice_rotations() {
        does_not_notice_rotations(neo_hookean());
        does_not_notice_rotations(st_venant_kirchhoff());
    }

    /// The difference to the linear law falls with the square of the strain.
    fn small_strains_are_linear_in(law: impl PointLaw) {
        let difference = |size: f64| {
            let gradient = SPACE.map(|row| row.map(|h| h * size));
            largest_difference(&law.stress(&gradient, &gradient).piola, &Lame::stress(&material().lame(), &gradient))
        };
        let order = (difference(1e-3) / difference(5e-4)).log2();
        assert!((order - 2.0).abs() < 0.01, "order {order}");
    }

    #[test]
    fn small_strains_are_linear() {
        small_strains_are_linear_in(neo_hookean());
        small_strains_are_linear_in(st_venant_kirchhoff());
    }

    /// A body that spins, H' = W F with a skew W, has no viscous stress, however it is deformed; any other motion loses energy.
    #[test]
    fn viscous_stress_does_not_notice_spin() {
        let (law, f) = (Viscous(material().lame()), plus_identity(&PLANE));
        let spin = [[-f[1][0], -f[1][1]], f[0]];
        let none = law.stress(&PLANE, &spin).piola;
        assert!(largest_difference(&none, &[[0.0; 2]; 2]) < 1e-15);
        let rate = [[0.4, -0.3], [0.8, 0.1]];
        assert!(contraction(&law.stress(&PLANE, &rate).piola, &rate) > 0.1);
        let at_rest = law.stress(&[[0.0; 2]; 2], &rate).piola;
        assert!(largest_difference(&at_rest, &Lame::stress(&material().lame(), &rate)) < 1e-15);
    }

    #[test]
    fn plane_strain_is_the_law_in_space_without_motion_along_the_third_axis() {
        let space = stress(&[[0.3, -0.7, 0.0], [0.9, 0.4, 0.0], [0.0; 3]]);
        let plane = stress(&PLANE);
        assert!((0..2).all(|i| (0..2).all(|j| (plane[i][j] - space[i][j]).abs() < 1e-15)));
    }

    #[test]
    fn volume_ratio_tells_an_inverted_point() {
        let law = neo_hookean();
        let ratio = |law: NeoHookean, h: [[f64; 2]; 2]| law.stress(&h, &h).volume_ratio;
        assert!((ratio(law, [[1.0, 0.0], [0.0, 0.5]]) - 3.0).abs() < 1e-15);
        assert!(ratio(law, [[-1.5, 0.0], [0.0, 0.5]]) < 0.0);
        let inverted = [[-1.5, 0.0], [0.0, 0.5]];
        assert_eq!(PointLaw::stress(material().lame(), &inverted, &inverted).volume_ratio, 1.0);
    }
}
