//! The stress of a body in its current shape, for output.
//!
//! ```text
//! sigma = P F^T / J,     F = I + grad d,  J = det F                                                              (Cauchy)
//! sigma_v = (3/2 s : s)^1/2,     s = sigma - tr(sigma)/3 I                                                     (von Mises)
//! ```
//!
//! With the linear law displacements are small, and sigma = P.

use crate::law::{NeoHookean, PointLaw, StVenantKirchhoff, plus_identity};
use crate::{ElasticityError, Lame, Law, Plane, Solid};
use tensor::{det, dot};

/// A stress in space.
pub type Stress = [[f64; 3]; 3];

impl<const D: usize> Solid<D> {
    /// sigma at the point `x` at rest, where the displacement has the `gradient` `[i][j]` = d d_i / d x_j. In two dimensions with the
    /// stress along the third axis.
    ///
    /// # Errors
    /// As [`Solid::lame`].
    pub fn stress(&self, x: &[f64; D], gradient: &[[f64; D]; D]) -> Result<Stress, ElasticityError> {
        let lame = self.lame(x)?;
        if D == 2 && self.plane == Plane::Stress {
            return Ok(in_space(&Lame::stress(&lame, gradient)));
        }
        let gradient = &in_space(gradient);
        Ok(match self.law {
            Law::Linear | Law::Incremental => Lame::stress(&lame, gradient),
            Law::NeoHookean => pushed_forward(NeoHookean(lame), gradient),
            Law::StVenantKirchhoff => pushed_forward(StVenantKirchhoff(lame), gradient),
        })
    }
}

/// With zeros along the axes that D dimensions do not have.
fn in_space<const D: usize>(a: &[[f64; D]; D]) -> Stress {
    std::array::from_fn(|i| std::array::from_fn(|j| if i < D && j < D { a[i][j] } else { 0.0 }))
}

/// (Cauchy)
fn pushed_forward(law: impl PointLaw, gradient: &Stress) -> Stress {
    let (f, piola) = (plus_identity(gradient), law.stress(gradient, gradient).piola);
    let j = det(&f);
    std::array::from_fn(|i| std::array::from_fn(|k| dot(&piola[i], &f[k]) / j))
}

/// (von Mises)
pub fn von_mises(sigma: &Stress) -> f64 {
    let mean = (sigma[0][0] + sigma[1][1] + sigma[2][2]) / 3.0;
    let square = |i: usize, j: usize| (sigma[i][j] - if i == j { mean } else { 0.0 }).powi(2);
    let sum: f64 = (0..3).flat_map(|i| (0..3).map(move |j| square(i, j))).sum();
    (1.5 * sum).sqrt()
}

/// The principal stresses, the largest first: the eigenvalues of a symmetric matrix by the cosine of a third of an angle (Smith, Comm. ACM
/// 4, 1961).
pub fn principal(sigma: &Stress) -> [f64; 3] {
    let mean = (sigma[0][0] + sigma[1][1] + sigma[2][2]) / 3.0;
    let size = von_mises(sigma) / 3.0;
    if size == 0.0 {
        return [mean; 3];
    }
    let scaled: Stress =
        std::array::from_fn(|i| std::array::from_fn(|j| (sigma[i][j] - if i == j { mean } else { 0.0 }) / size));
    let half = (det(&scaled) / 2.0).clamp(-1.0, 1.0);
    let angle = half.acos() / 3.0;
    let at = |turn: f64| mean + 2.0 * size * (angle + turn).cos();
    let (largest, smallest) = (at(0.0), at(2.0 * std::f64::consts::FRAC_PI_3));
    [largest, 3.0 * mean - largest - smallest, smallest]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Material;

    fn solid(law: Law) -> Solid<2> {
        Material::new(2.0, 0.3).unwrap().with_law(law).into()
    }

    #[test]
    fn principal_stresses_are_those_of_a_turned_diagonal() {
        let (sin, cos) = 0.7_f64.sin_cos();
        let q = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let given = [5.0, -1.0, 2.0];
        let sigma: Stress =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| q[i][k] * given[k] * q[j][k]).sum()));
        let found = principal(&sigma);
        assert!(found.iter().zip([5.0, 2.0, -1.0]).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        assert!((von_mises(&sigma) - 27.0_f64.sqrt()).abs() < 1e-13);
        assert_eq!(principal(&[[0.0; 3]; 3]), [0.0; 3]);
    }

    /// Uniaxial stress E eps has that von Mises stress; in plane strain the third axis is held.
    #[test]
    fn small_strains_have_the_same_stress_by_every_law() {
        let gradient = [[1e-7, 0.0], [2e-7, -1e-7]];
        let linear = solid(Law::Linear).stress(&[0.0; 2], &gradient).unwrap();
        assert!((linear[2][2] - 0.3 * (linear[0][0] + linear[1][1])).abs() < 1e-20);
        for law in [Law::NeoHookean, Law::StVenantKirchhoff] {
            let other = solid(law).stress(&[0.0; 2], &gradient).unwrap();
            let apart = linear.as_flattened().iter().zip(other.as_flattened()).map(|(a, b)| (a - b).abs());
            // Strains of 1e-7 differ by their squares.
            assert!(apart.fold(0.0, f64::max) < 1e-12, "{law:?}: {other:?}");
        }
    }

    /// A turn turns the stress: principal stresses stay.
    #[test]
    fn a_turned_body_has_the_same_principal_stresses() {
        let stretch = [[0.2, 0.05], [0.05, -0.1]];
        let (sin, cos) = 1.1_f64.sin_cos();
        let turned: [[f64; 2]; 2] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let q = [[cos, -sin], [sin, cos]];
                let f = |k: usize| stretch[k][j] + f64::from(u8::from(k == j));
                q[i][0] * f(0) + q[i][1] * f(1) - f64::from(u8::from(i == j))
            })
        });
        for law in [Law::NeoHookean, Law::StVenantKirchhoff] {
            let [before, after] = [stretch, turned].map(|h| principal(&solid(law).stress(&[0.0; 2], &h).unwrap()));
            assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-13), "{law:?}: {before:?}, {after:?}");
        }
    }
}
