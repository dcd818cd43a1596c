//! The material of the mesh, and the stress of linear elasticity.

use crate::{ElasticityError, Law};
use tensor::Real;

/// Poisson's ratio above which a material is nearly incompressible: low orders are too stiff, and Newton's method may fail.
pub const NEARLY_INCOMPRESSIBLE: f64 = 0.49;

/// The quantity that vanishes along the third axis of a body in two dimensions. In 3-D it is not used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// No strain: a slice of a long body, held at its ends.
    #[default]
    Strain,
    /// No stress: a thin sheet, free to change its thickness. For the linear law.
    Stress,
}

/// An isotropic material: Young's modulus E_Y and Poisson's ratio nu of small strains, and a law. In 2-D the strain is plane, unless
/// [`Self::in_plane`] sets plane stress.
///
/// For the motion of a mesh E_Y may be 1: it scales the stress, not the displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    law: Law,
    plane: Plane,
}

impl Material {
    /// A linear material with E_Y > 0 and -1 < nu < 0.5. Outside this range the energy has no minimum.
    ///
    /// # Errors
    /// [`ElasticityError::Material`] if a constant is out of range or not a number.
    pub fn new(young: f64, poisson: f64) -> Result<Self, ElasticityError> {
        if !(young > 0.0 && young.is_finite()) {
            return Err(ElasticityError::Material {
                constant: "Young's modulus",
                value: young,
                accepted: "a positive number",
            });
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            return Err(ElasticityError::Material {
                constant: "Poisson's ratio",
                value: poisson,
                accepted: "-1 < nu < 0.5",
            });
        }
        Ok(Material { young, poisson, law: Law::Linear, plane: Plane::default() })
    }

    /// The same constants with another law.
    pub fn with_law(self, law: Law) -> Self {
        Material { law, ..self }
    }
    /// E_Y and nu.
    pub(crate) fn constants(&self) -> (f64, f64) {
        (self.young, self.poisson)
    }
    /// Plane strain or plane stress in 2-D.
    pub(crate) fn plane(&self) -> Plane {
        self.plane
    }
    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }

    /// The same in plane strain or plane stress.
    pub fn in_plane(self, plane: Plane) -> Self {
        Material { plane, ..self }
    }

    /// mu_s = E_Y / 2 (1 + nu), lambda_s = 2 mu_s nu / (1 - 2 nu). In plane stress lambda_s = 2 mu_s nu / (1 - nu), so that the stress
    /// along the third axis vanishes.
    pub fn lame(&self) -> Lame {
        let mu = self.young / (2.0 * (1.0 + self.poisson));
        let factor = if self.plane == Plane::Strain { 2.0 } else { 1.0 };
        Lame { mu, lambda: 2.0 * mu * self.poisson / (1.0 - factor * self.poisson) }
    }
}

/// The constants of Lame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// The first constant.
    pub lambda: f64,
    /// The shear modulus.
    pub mu: f64,
}

impl Lame {
    /// P = 2 mu_s eps + lambda_s tr(eps) I, eps = (H + H^T) / 2, of the displacement gradient H, `gradient[i][j]` = du_i/dx_j.
    #[inline(always)]
    pub fn stress<T: Real, const D: usize>(&self, gradient: &[[T; D]; D]) -> [[T; D]; D] {
        let mut trace = gradient[0][0];
        for i in 1..D {
            trace += gradient[i][i];
        }
        let mut sigma = *gradient;
        for i in 0..D {
            for j in 0..D {
                sigma[i][j] = (gradient[i][j] + gradient[j][i]) * self.mu;
            }
            sigma[i][i] += trace * self.lambda;
        }
        sigma
    }

    /// The energy product of two scalar functions in every pair of components: `block[i][j]` = eps(a e_i) : sigma(b e_j), with
    /// gradients `grad_a` and `grad_b`.
    pub fn block<const D: usize>(&self, grad_a: &[f64; D], grad_b: &[f64; D]) -> [[f64; D]; D] {
        let mut block = [[0.0; D]; D];
        for j in 0..D {
            let mut gradient = [[0.0; D]; D];
            gradient[j] = *grad_b;
            let sigma = self.stress(&gradient);
            for i in 0..D {
                block[i][j] = tensor::dot(&sigma[i], grad_a);
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn uniaxial_stress_stretches_by_e_and_contracts_by_nu() {
        let (young, poisson, stretch) = (3.0, 0.3, 0.01);
        let lame = Material::new(young, poisson).unwrap().lame();
        let side = -poisson * stretch;
        let sigma = lame.stress(&[[stretch, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, side]]);
        assert!((sigma[0][0] - young * stretch).abs() < 1e-15);
        assert!(sigma[1][1].abs() < 1e-15 && sigma[2][2].abs() < 1e-15);
    }

    /// Stretched by eps along x and free along y, a sheet contracts by nu eps along y, and the stress is E_Y eps.
    #[test]
    fn plane_stress_is_uniaxial_where_a_sheet_is_free() {
        let (young, poisson, stretch) = (3.0, 0.3, 0.01);
        let lame = Material::new(young, poisson).unwrap().in_plane(Plane::Stress).lame();
        let sigma = lame.stress(&[[stretch, 0.0], [0.0, -poisson * stretch]]);
        assert!((sigma[0][0] - young * stretch).abs() < 1e-16 && sigma[1][1].abs() < 1e-16, "{sigma:?}");
    }

    #[test]
    fn plane_strain_is_the_law_in_space_without_motion_along_the_third_axis() {
        let lame = Material::new(1.0, 0.4).unwrap().lame();
        let plane = lame.stress(&[[0.1, 0.3], [-0.2, 0.05]]);
        let space = lame.stress(&[[0.1, 0.3, 0.0], [-0.2, 0.05, 0.0], [0.0; 3]]);
        assert!((0..2).all(|i| (0..2).all(|j| plane[i][j] == space[i][j])));
    }

    #[test]
    fn stress_ignores_rotation_and_is_symmetric() {
        let lame = Material::new(2.0, 0.2).unwrap().lame();
        assert_eq!(lame.stress(&[[0.0, 0.7], [-0.7, 0.0]]), [[0.0; 2]; 2]);
        let sigma = lame.stress(&[[0.1, 0.3, -0.4], [0.2, 0.5, 0.6], [0.9, -0.8, 0.7]]);
        assert!((0..3).all(|i| (0..3).all(|j| sigma[i][j] == sigma[j][i])));
    }

    #[test]
    fn blocks_are_the_energy_of_unit_components_and_transpose_with_their_functions() {
        let lame = Material::new(1.0, 0.3).unwrap().lame();
        let (a, b) = ([0.3, -1.0, 0.7], [0.5, 0.2, -0.4]);
        let (ab, ba) = (lame.block(&a, &b), lame.block(&b, &a));
        // lambda a_i b_j + mu a_j b_i + mu delta_ij a.b
        for i in 0..3 {
            for j in 0..3 {
                let identity = if i == j { tensor::dot(&a, &b) } else { 0.0 };
                let expected = lame.lambda * a[i] * b[j] + lame.mu * (a[j] * b[i] + identity);
                assert!((ab[i][j] - expected).abs() < 1e-15);
                assert!((ab[i][j] - ba[j][i]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn impossible_materials_are_refused() {
        for (young, poisson) in [(0.0, 0.3), (-1.0, 0.3), (f64::NAN, 0.3), (1.0, 0.5), (1.0, -1.0), (1.0, f64::NAN)] {
            assert!(
                matches!(Material::new(young, poisson), Err(ElasticityError::Material { .. })),
                "E = {young}, nu = {poisson}"
            );
        }
    }
}
