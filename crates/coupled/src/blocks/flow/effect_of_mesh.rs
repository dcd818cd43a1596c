//! The effect B v that velocities v of the mesh have on the residual of the flow and on its loads.
//!
//! ```text
//! v = sum_j c_j q_j + w,    B v = sum_j c_j B q_j + B w,    q_j orthonormal                                      (effect of mesh)
//! ```
//!
//! A product along the mesh costs about twice a product along the state. Rigid bodies with n unknowns move the mesh in a space of n
//! dimensions. Products with its basis then serve all Krylov directions. Those of the first Newton step of a slab also serve the others
//! if the motion of the bodies hardly changes any more, as that of heavy bodies.

use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy};

/// A remainder w of this size, relative to v, is rounding.
const ROUNDING: f64 = 1e-12;

/// The basis serves the next Newton step too if the effect of the last step is this small, relative to the residual that it has left. The
/// error of a basis that is one step old is then less than the tolerance of a linear solve.
pub(crate) const SMALL: f64 = 0.3;

/// B v: rows of the residual, and the loads on walls.
#[derive(Default)]
pub(super) struct Effect {
    pub(super) residual: Vec<f64>,
    pub(super) loads: Vec<f64>,
}

/// The effect of the velocities last taken, and of a basis of those before.
#[derive(Default)]
pub(super) struct EffectOfMesh {
    /// The largest number of basis vectors, zero without a basis.
    pub(super) dimension: usize,
    /// v; empty where nothing is known.
    velocities: Vec<f64>,
    /// B v
    effect: Effect,
    /// q_j and B q_j.
    basis: Vec<(Vec<f64>, Effect)>,
}

impl EffectOfMesh {
    /// Forgets all products: the point of linearisation has changed.
    pub(super) fn forget(&mut self) {
        self.velocities.clear();
        self.basis.clear();
    }

    /// Whether the effect last taken is that of `v`.
    pub(super) fn is_of(&self, v: &[f64]) -> bool {
        self.velocities == v
    }

    /// B v.
    pub(super) fn of_last(&self) -> &Effect {
        &self.effect
    }

    /// The rows of B v if v is in the space of the basis.
    pub(super) fn known(&self, v: &[f64]) -> Option<Vec<f64>> {
        let (coefficients, _, size) = self.split(v);
        if self.basis.is_empty() || size > ROUNDING * Euclidean.norm(v) {
            return None;
        }
        let mut effect = Vec::new();
        sum_into(coefficients.iter().zip(&self.basis).map(|(c, (_, of_q))| (*c, &of_q.residual[..])), &mut effect);
        Some(effect)
    }

    /// Takes the effect of `v` by (effect of mesh), where `product` sets B x for a given x.
    pub(super) fn take(&mut self, v: &[f64], mut product: impl FnMut(&[f64], &mut Effect)) {
        self.velocities.clear();
        self.velocities.extend_from_slice(v);
        if self.dimension == 0 {
            return product(v, &mut self.effect);
        }
        let (mut coefficients, rest, size) = self.split(v);
        let is_known = size <= ROUNDING * Euclidean.norm(v) && !self.basis.is_empty();
        if !is_known && (self.basis.len() == self.dimension || size == 0.0) {
            return product(v, &mut self.effect);
        }
        if !is_known {
            let (q, mut effect) = (rest.iter().map(|w| w / size).collect::<Vec<f64>>(), Effect::default());
            product(&q, &mut effect);
            self.basis.push((q, effect));
            coefficients.push(size);
        }
        self.combine(&coefficients);
    }

    /// B v := sum_j c_j B q_j
    fn combine(&mut self, c: &[f64]) {
        let EffectOfMesh { effect: Effect { residual, loads }, basis, .. } = self;
        sum_into(c.iter().zip(&*basis).map(|(c, (_, of_q))| (*c, &of_q.residual[..])), residual);
        sum_into(c.iter().zip(&*basis).map(|(c, (_, of_q))| (*c, &of_q.loads[..])), loads);
    }

    /// c and w of (effect of mesh), with the norm of w. Orthogonalised twice, unless v is in the space of the basis.
    fn split(&self, v: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
        let (mut coefficients, mut rest) = (vec![0.0; self.basis.len()], v.to_vec());
        let mut size = 0.0;
        for _ in 0..2 {
            for (sum, (q, _)) in coefficients.iter_mut().zip(&self.basis) {
                let c = Euclidean.dot(q, &rest);
                axpy(-c, q, &mut rest);
                *sum += c;
            }
            size = Euclidean.norm(&rest);
            if size <= ROUNDING * Euclidean.norm(&coefficients) {
                break;
            }
        }
        (coefficients, rest, size)
    }
}

/// sum := sum_j c_j x_j
fn sum_into<'a>(mut terms: impl Iterator<Item = (f64, &'a [f64])>, sum: &mut Vec<f64>) {
    sum.clear();
    if let Some((c, x)) = terms.next() {
        sum.extend(x.iter().map(|x| c * x));
    }
    terms.for_each(|(c, x)| axpy(c, x, sum));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B x of a small matrix, with loads that are twice the residual.
    fn product(x: &[f64], effect: &mut Effect) {
        effect.residual = vec![x[0] + 2.0 * x[1], x[2] - x[1], 3.0 * x[2]];
        effect.loads = effect.residual.iter().map(|r| 2.0 * r).collect();
    }

    fn error(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// A check that the effect of v is right, and of the number of products until then.
    fn checked(dimension: usize) -> impl FnMut([f64; 3], usize) {
        let mut of_mesh = EffectOfMesh { dimension, ..EffectOfMesh::default() };
        let mut products = 0;
        move |v, count| {
            of_mesh.take(&v, |x, effect| {
                products += 1;
                product(x, effect);
            });
            let (mut expected, of_last) = (Effect::default(), of_mesh.of_last());
            product(&v, &mut expected);
            let size = v.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
            assert!(error(&of_last.residual, &expected.residual) <= 1e-14 * size);
            assert!(error(&of_last.loads, &expected.loads) <= 1e-14 * size);
            assert!(of_mesh.is_of(&v) && products == count, "{products} products");
        }
    }

    /// The first increment of a mesh may be zero; its effect has all rows nevertheless.
    #[test]
    fn a_mesh_that_rests_has_an_effect_of_zeros() {
        checked(0)([0.0; 3], 1);
        checked(2)([0.0; 3], 1);
    }

    #[test]
    fn the_effect_of_velocities_in_the_basis_is_known() {
        let mut of_mesh = EffectOfMesh { dimension: 2, ..EffectOfMesh::default() };
        assert_eq!(of_mesh.known(&[0.0; 3]), None);
        of_mesh.take(&[1.0, 2.0, 0.0], product);
        let mut expected = Effect::default();
        product(&[-0.5, -1.0, 0.0], &mut expected);
        assert!(error(&of_mesh.known(&[-0.5, -1.0, 0.0]).unwrap_or_default(), &expected.residual) < 1e-15);
        assert_eq!(of_mesh.known(&[0.0, 1.0, 0.0]), None);
        of_mesh.forget();
        assert_eq!(of_mesh.known(&[1.0, 2.0, 0.0]), None);
    }

    /// Velocities in a plane take two products, whatever their number and their size; others take one each.
    #[test]
    fn two_products_serve_a_plane() {
        let mut check = checked(2);
        check([1.0, 2.0, 0.0], 1);
        check([-3e8, -6e8, 0.0], 1);
        check([1.0, 2.0 + 1e-3, 0.0], 2);
        check([0.7, -0.3, 0.0], 2);
        check([0.0, 0.0, 0.0], 2);
        check([0.7, -0.3, 1.0], 3);
        check([0.7, -0.3, 2.0], 4);
    }
}
