//! The laws of meshes and bodies at a point: the first Piola stress P = dPsi/dH of the displacement gradient H = grad d.
//!
//! ```text
//! Psi = mu_s eps : eps + lambda_s/2 tr(eps)^2,             eps = (H + H^T) / 2                                   (linear)
//! P = 2 mu_s eps + lambda_s tr(eps) I
//!
//! Psi = mu_s/2 (|F|^2 - D - 2 ln J) + lambda_s/2 (ln J)^2,   F = I + H,  J = det F                               (neo-Hookean)
//! P = mu_s (F - F^{-T}) + lambda_s ln J F^{-T},   F - F^{-T} = H + H^T F^{-T},   J = 1 + e,   e = tr H + .. + det H
//!
//! Psi = mu_s eps_G : eps_G + lambda_s/2 tr(eps_G)^2,       eps_G = (F^T F - I) / 2                      (St. Venant-Kirchhoff)
//! P = F (2 mu_s eps_G + lambda_s tr(eps_G) I)
//! ```
//!
//! The right-hand forms of (neo-Hookean) lose no digits where the strain is small.
//!
//! The laws agree to first order in H. The linear law costs one solve, but treats a rotation as a strain: after a large rotation its
//! cells invert. The other laws are invariant under rotations. In the neo-Hookean law -ln J prevents the collapse of cells at the
//! points where Psi is integrated. The law of St. Venant and Kirchhoff is for large displacements of small strain: it does not resist
//! a compression to less than about half of the length.

use crate::Lame;
use crate::geometry::quadrature_points;
use basis::{Rule, gauss, gauss_lobatto};
use tensor::{Real, cofactor, det, determinant, dot, trace};

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
    /// only, so there are 2N, including those at the ends. Psi of (St. Venant-Kirchhoff) has the degree 4 (N - 1) on affine cells, which
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
    /// Psi of H.
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T;
}

/// The stress of a law, and J.
pub(crate) struct PointStress<T, const D: usize> {
    /// P, `[i][j]` = dPsi/dH_ij.
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
        let mut inverse = cofactor(&plus_identity(gradient));
        let Volume { ratio, logarithm } = volume(gradient);
        // F^{-T} = cof F / J
        for row in &mut inverse {
            for entry in row {
                *entry = *entry / ratio;
            }
        }
        let (pressure, mut piola) = (logarithm * lambda, *gradient);
        for i in 0..D {
            for k in 0..D {
                let mut sum = gradient[i][k];
                for l in 0..D {
                    sum = gradient[l][i].mul_add(inverse[l][k], sum);
                }
                piola[i][k] = pressure.mul_add(inverse[i][k], sum * mu);
            }
        }
        PointStress { piola, volume_ratio: ratio }
    }
}

impl Hyperelastic for NeoHookean {
    #[inline(always)]
    fn energy<T: Real, const D: usize>(self, gradient: &[[T; D]; D]) -> T {
        let Lame { lambda, mu } = self.0;
        let ln_j = volume(gradient).logarithm;
        // |F|^2 - D = 2 tr H + |H|^2
        let stretch = contraction(gradient, gradient) + (trace(gradient) - ln_j) * 2.0;
        stretch * (0.5 * mu) + ln_j * ln_j * (0.5 * lambda)
    }
}

/// J and ln J.
struct Volume<T> {
    ratio: T,
    logarithm: T,
}

/// J = 1 + e of H. The rounding of that sum is exact as e - (J - 1), so ln J = ln(1 + e) has all digits where e is small.
#[inline(always)]
fn volume<T: Real, const D: usize>(gradient: &[[T; D]; D]) -> Volume<T> {
    let cofactor = cofactor(gradient);
    let mut e = trace(gradient) + determinant(gradient, &cofactor);
    if D == 3 {
        // The principal minors of H
        e += trace(&cofactor);
    }
    let ratio = e + 1.0;
    Volume { ratio, logarithm: ratio.ln() + (e - (ratio - 1.0)) / ratio }
}

/// (St. Venant-Kirchhoff)
#[derive(Clone, Copy, Debug)]
pub(crate) struct StVenantKirchhoff(pub(crate) Lame);

impl PointLaw for StVenantKirchhoff {
    // Its energy is finite for any F. But det F is positive in any body.
    const HAS_BARRIER: bool = true;
    #[inline(always)]
    fn stress<T: Real, const D: usize>(self, gradient: &[[T; D]; D], _: &[[T; D]; D]) -> PointStress<T, D> {
        let (f, second) = (plus_identity(gradient), Lame::stress(&self.0, &green_strain(gradient)));
        PointStress { piola: times_symmetric(&f, &second), volume_ratio: det(&f) }
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
/// P = beta F (2 mu_s eps_G' + lambda_s tr(eps_G') I),      eps_G' = sym(F^T H')                                  (viscous)
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

/// eps_G = (H + H^T + H^T H) / 2: without the rounding of F^T F - I where the strain is small.
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
mod tests;
