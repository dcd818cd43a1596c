//! The material of a structure, point by point.
//!
//! Stresses are linear in the constants of Lame. With spatially constant mu_0, lambda_0,
//!
//! ```text
//! mu_s(x) = s(x) mu_0,   lambda_s(x) = s(x) lambda_0 + e(x)                                                    (relative)
//! ```
//!
//! The stress is s times the stress for (mu_0, lambda_0), plus e times the stress for (0, 1). e = 0 unless Poisson's ratio varies.

use crate::{ElasticityError, Lame, Law, Material, Plane};
use std::sync::Arc;

/// A function of the position at rest.
pub type Field<const D: usize> = Arc<dyn Fn(&[f64; D]) -> f64 + Send + Sync>;

/// A quantity of a body.
#[derive(Clone)]
pub enum MaterialProperty<const D: usize> {
    /// The same everywhere.
    Constant(f64),
    /// Varies from point to point.
    Field(Field<D>),
}

impl<const D: usize> MaterialProperty<D> {
    fn at(&self, x: &[f64; D]) -> f64 {
        match self {
            MaterialProperty::Constant(value) => *value,
            MaterialProperty::Field(field) => field(x),
        }
    }

    /// The value if it is constant; otherwise `instead`.
    fn constant_or(&self, instead: f64) -> f64 {
        if let MaterialProperty::Constant(value) = self { *value } else { instead }
    }
}

/// Young's modulus and Poisson's ratio of an elastic body, and its law.
#[derive(Clone)]
pub struct Solid<const D: usize> {
    /// E
    pub young: MaterialProperty<D>,
    /// nu
    pub poisson: MaterialProperty<D>,
    /// Plane strain or plane stress, in 2-D.
    pub plane: Plane,
    /// The law for strains that are not small.
    pub law: Law,
}

/// The constants at a point by (relative).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relative {
    /// s
    pub(crate) stiffness: f64,
    /// e
    pub(crate) excess: f64,
}

impl<const D: usize> Solid<D> {
    /// The constants at `x`.
    ///
    /// # Errors
    /// [`ElasticityError::MaterialAt`] if a constant is out of range or not a number there.
    pub fn lame(&self, x: &[f64; D]) -> Result<Lame, ElasticityError> {
        let material = Material::new(self.young.at(x), self.poisson.at(x));
        let at_point = |source| ElasticityError::MaterialAt { position: x.to_vec(), source: Box::new(source) };
        Ok(material.map_err(at_point)?.in_plane(self.plane).lame())
    }

    /// The law, if it exists for this plane state.
    pub(crate) fn law(&self) -> Result<Law, ElasticityError> {
        if self.plane == Plane::Stress && !self.law.is_linear() {
            Err(ElasticityError::PlaneStress)
        } else {
            Ok(self.law)
        }
    }

    /// Whether nu varies in space.
    pub(crate) fn ratio_varies(&self) -> bool {
        matches!(self.poisson, MaterialProperty::Field(_))
    }

    /// (mu_0, lambda_0): the constants of the body if E and nu are constant, otherwise those of E = 1 and nu = 0.
    pub(crate) fn base(&self) -> Result<Lame, ElasticityError> {
        Ok(Material::new(self.young.constant_or(1.0), self.poisson.constant_or(0.0))?.in_plane(self.plane).lame())
    }

    /// The constants at `x` relative to `base`.
    pub(crate) fn relative(&self, base: Lame, x: &[f64; D]) -> Result<Relative, ElasticityError> {
        let lame = self.lame(x)?;
        let stiffness = lame.mu / base.mu;
        let excess = if self.ratio_varies() { lame.lambda - stiffness * base.lambda } else { 0.0 };
        Ok(Relative { stiffness, excess })
    }
}

/// The same material everywhere.
impl<const D: usize> From<Material> for Solid<D> {
    fn from(material: Material) -> Self {
        let (young, poisson) = material.constants();
        Solid {
            young: MaterialProperty::Constant(young),
            poisson: MaterialProperty::Constant(poisson),
            plane: material.plane(),
            law: material.law(),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn varying() -> Solid<2> {
        let young = MaterialProperty::Field(Arc::new(|x: &[f64; 2]| 2.0 + x[0]));
        let poisson = MaterialProperty::Field(Arc::new(|x: &[f64; 2]| 0.4 * x[1]));
        Solid { young, poisson, plane: Plane::Stress, law: Law::Linear }
    }

    #[test]
    fn relative_constants_are_those_of_the_point() {
        let (solid, x) = (varying(), [0.5, 0.75]);
        let (base, expected) = (solid.base().unwrap(), Material::new(2.5, 0.3).unwrap().in_plane(Plane::Stress).lame());
        let Relative { stiffness, excess } = solid.relative(base, &x).unwrap();
        assert!((stiffness * base.mu - expected.mu).abs() < 1e-15);
        assert!((stiffness * base.lambda + excess - expected.lambda).abs() < 1e-15);
        let uniform = Solid::<2>::from(Material::new(7.0, 0.3).unwrap());
        let relative = uniform.relative(uniform.base().unwrap(), &x).unwrap();
        assert_eq!(relative, Relative { stiffness: 1.0, excess: 0.0 });
    }

    #[test]
    fn an_impossible_material_is_refused_with_its_place() {
        let error = varying().lame(&[0.0, 1.5]).unwrap_err();
        assert!(matches!(&error, ElasticityError::MaterialAt { position, .. } if position == &[0.0, 1.5]), "{error}");
    }
}
