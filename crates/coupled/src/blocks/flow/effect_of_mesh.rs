//! The effect B v that velocities v of the mesh have on the residual of the flow and on its loads.
//!
//! ```text
//! v = V x,    x = sum_j c_j q_j,    B v = sum_j c_j B V q_j,    q_j orthonormal                                  (effect of mesh)
//! ```
//!
//! A product along the mesh costs about twice a product along the state. Where rigid bodies with n unknowns x move the whole mesh, n products
//! serve all Krylov directions. Later Newton steps of a slab may keep the products of an earlier one: B changes little between them.

use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy};

/// A remainder of this size, relative to x, is rounding.
const ROUNDING: f64 = 1e-12;

/// With the products of an earlier point, a remainder of this size is no more than their error.
const OLD_REMAINDER: f64 = 1e-3;

/// B v: rows of the residual, and the loads on walls.
#[derive(Default)]
pub(super) struct Effect {
    pub(super) residual: Vec<f64>,
    pub(super) loads: Vec<f64>,
}

/// The effect of the direction last taken, and of a basis of the unknowns of bodies.
#[derive(Default)]
pub(super) struct EffectOfMesh {
    /// The direction last taken: x, or v where no products are kept; empty where nothing is known.
    direction: Vec<f64>,
    /// Its effect.
    effect: Effect,
    /// q_j and B V q_j.
    basis: Vec<(Vec<f64>, Effect)>,
    /// Whether the products are those of an earlier point of linearisation.
    is_old: bool,
    /// Whether the effect is small beside the residual, once that has been judged.
    is_small: Option<bool>,
}

impl EffectOfMesh {
    /// Forgets all products.
    pub(super) fn forget(&mut self) {
        self.direction.clear();
        self.basis.clear();
        (self.is_old, self.is_small) = (false, None);
    }

    /// The point of linearisation has changed a little: if the effect was small, the products with the basis will do.
    pub(super) fn grow_old(&mut self) {
        if self.is_small != Some(true) {
            return self.forget();
        }
        self.direction.clear();
        (self.is_old, self.is_small) = (true, None);
    }

    /// The effect last taken, if there is a basis and its size has not been compared with the residual since the point of linearisation changed.
    pub(super) fn unjudged(&self) -> Option<&Effect> {
        let is_known = !self.direction.is_empty() && !self.basis.is_empty();
        (is_known && self.is_small.is_none()).then_some(&self.effect)
    }

    /// Notes whether the effect is small. Returns true if it must be taken anew: it is not, and the products are old.
    pub(super) fn judge(&mut self, is_small: bool) -> bool {
        let taken_anew = self.is_old && !is_small;
        if taken_anew {
            self.forget();
        }
        self.is_small = Some(is_small);
        taken_anew
    }

    /// Whether the effect last taken is that of `direction`.
    pub(super) fn is_of(&self, direction: &[f64]) -> bool {
        self.direction == direction
    }

    /// The effect last taken.
    pub(super) fn of_last(&self) -> &Effect {
        &self.effect
    }

    /// Takes the effect of `v`, which `product` sets, and keeps nothing.
    pub(super) fn take_alone(&mut self, v: &[f64], product: impl FnOnce(&mut Effect)) {
        self.direction.clear();
        self.direction.extend_from_slice(v);
        product(&mut self.effect);
    }

    /// Takes the effect of `x` by (effect of mesh), or returns a q whose effect is to be [learnt](Self::learn) before that.
    pub(super) fn take(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        if self.is_of(x) {
            return None;
        }
        let (coefficients, rest) = self.split(x);
        let size = Euclidean.norm(&rest);
        if size <= if self.is_old { OLD_REMAINDER } else { ROUNDING } * Euclidean.norm(x) {
            self.combine(&coefficients);
            self.direction.clear();
            self.direction.extend_from_slice(x);
            return None;
        }
        if self.is_old {
            self.forget();
            return self.take(x);
        }
        Some(rest.iter().map(|x| x / size).collect())
    }

    /// Keeps the effect of `q`, which [`Self::take`] has returned and `product` sets.
    pub(super) fn learn(&mut self, q: Vec<f64>, product: impl FnOnce(&mut Effect)) {
        let mut effect = Effect::default();
        product(&mut effect);
        self.basis.push((q, effect));
    }

    /// The effect is sum_j c_j B V q_j; without a basis it has no rows.
    fn combine(&mut self, c: &[f64]) {
        let EffectOfMesh { effect: Effect { residual, loads }, basis, .. } = self;
        residual.clear();
        loads.clear();
        for (c, (_, of_q)) in c.iter().zip(basis) {
            residual.resize(of_q.residual.len(), 0.0);
            loads.resize(of_q.loads.len(), 0.0);
            axpy(*c, &of_q.residual, residual);
            axpy(*c, &of_q.loads, loads);
        }
    }

    /// c, and what is left of `x`, orthogonalised twice.
    fn split(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut coefficients, mut rest) = (vec![0.0; self.basis.len()], x.to_vec());
        for _ in 0..2 {
            for (sum, (q, _)) in coefficients.iter_mut().zip(&self.basis) {
                let c = Euclidean.dot(q, &rest);
                axpy(-c, q, &mut rest);
                *sum += c;
            }
        }
        (coefficients, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B V x of a small matrix, with loads that are twice the residual.
    fn product(x: &[f64], effect: &mut Effect) {
        effect.residual = vec![x[0] + 2.0 * x[1], x[2] - x[1], 3.0 * x[2]];
        effect.loads = effect.residual.iter().map(|r| 2.0 * r).collect();
    }

    fn error(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Takes the effect of `x`; returns the number of products.
    fn take(of_mesh: &mut EffectOfMesh, x: &[f64]) -> usize {
        let mut products = 0;
        while let Some(q) = of_mesh.take(x) {
            of_mesh.learn(q.clone(), |effect| product(&q, effect));
            products += 1;
        }
        products
    }

    /// After the point of linearisation has changed, the basis serves until its effect is found to be large.
    #[test]
    fn old_products_serve_until_they_are_forgotten() {
        let mut of_mesh = EffectOfMesh::default();
        assert_eq!(take(&mut of_mesh, &[1.0, 2.0, 0.0]), 1);
        assert!(of_mesh.unjudged().is_some() && !of_mesh.judge(true), "products of this point are exact");
        assert!(of_mesh.unjudged().is_none(), "it is judged once");
        of_mesh.grow_old();
        assert!(of_mesh.unjudged().is_none(), "nothing was taken yet");
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0 + 1e-4, 0.0]), 0, "a small remainder");
        assert!(of_mesh.unjudged().is_some() && of_mesh.judge(false), "a large effect must be taken anew");
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0, 0.0]), 1);
        of_mesh.grow_old();
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0, 0.0]), 1, "a large effect never serves later points");
        assert!(!of_mesh.judge(true));
        of_mesh.grow_old();
        assert_eq!(take(&mut of_mesh, &[1.0, 0.0, 0.0]), 1, "another direction needs new products");
    }

    /// Directions take as many products as their space has dimensions, whatever their number and their size.
    #[test]
    fn three_products_serve_all_directions() {
        let mut of_mesh = EffectOfMesh::default();
        let mut check = |x: [f64; 3], products: usize| {
            assert_eq!(take(&mut of_mesh, &x), products, "{x:?}");
            let mut expected = Effect::default();
            product(&x, &mut expected);
            let size = x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            assert!(error(&of_mesh.of_last().residual, &expected.residual) <= 1e-14 * size);
            assert!(error(&of_mesh.of_last().loads, &expected.loads) <= 1e-14 * size);
            assert!(of_mesh.is_of(&x));
        };
        check([1.0, 2.0, 0.0], 1);
        check([-3e8, -6e8, 0.0], 0);
        check([1.0, 2.0 + 1e-3, 0.0], 1);
        check([0.7, -0.3, 0.0], 0);
        check([0.0, 0.0, 0.0], 0);
        check([0.7, -0.3, 1.0], 1);
        check([0.7, -0.3, 2.0], 0);
    }

    /// A body may rest in the first Krylov direction.
    #[test]
    fn a_body_that_rests_has_no_effect_and_needs_no_product() {
        let mut of_mesh = EffectOfMesh::default();
        assert_eq!(take(&mut of_mesh, &[0.0; 3]), 0);
        assert!(of_mesh.of_last().residual.is_empty() && of_mesh.unjudged().is_none());
    }
}
