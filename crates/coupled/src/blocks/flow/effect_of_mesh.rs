//! The effect B v that velocities v of the mesh have on the residual of the flow and on its loads.
//!
//! ```text
//! v = sum_j c_j q_j + w,    B v = sum_j c_j B q_j + B w,    q_j orthonormal                                      (effect of mesh)
//! ```
//!
//! A product along the mesh costs about twice a product along the state. Rigid bodies with n unknowns move the mesh in a space of n
//! dimensions. Products with its basis then serve all Krylov directions. Later Newton steps of a slab may keep the products of an earlier one:
//! B changes little between them.

use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy};

/// A remainder w of this size, relative to v, is rounding.
const ROUNDING: f64 = 1e-12;

/// With the products of an earlier point, a remainder of this size is no more than their error.
const OLD_REMAINDER: f64 = 1e-3;

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
    /// Whether the B q_j are those of an earlier point of linearisation.
    is_old: bool,
    /// Whether the effect is small beside the residual, once that has been judged.
    is_small: Option<bool>,
}

impl EffectOfMesh {
    /// Forgets all products.
    pub(super) fn forget(&mut self) {
        self.velocities.clear();
        self.basis.clear();
        (self.is_old, self.is_small) = (false, None);
    }

    /// The point of linearisation has changed a little: if the effect was small, the products with the basis will do.
    pub(super) fn grow_old(&mut self) {
        if self.is_small != Some(true) {
            return self.forget();
        }
        self.velocities.clear();
        (self.is_old, self.is_small) = (true, None);
    }

    /// The effect last taken, if there is a basis and nobody has judged it since the point of linearisation changed.
    pub(super) fn unjudged(&self) -> Option<&Effect> {
        let is_known = !self.velocities.is_empty() && !self.basis.is_empty();
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

    /// Whether the effect last taken is that of `v`.
    pub(super) fn is_of(&self, v: &[f64]) -> bool {
        self.velocities == v
    }

    /// B v.
    pub(super) fn of_last(&self) -> &Effect {
        &self.effect
    }

    /// Takes the effect of `v` by (effect of mesh), where `product` sets B x for a given x.
    pub(super) fn take(&mut self, v: &[f64], mut product: impl FnMut(&[f64], &mut Effect)) {
        self.velocities.clear();
        self.velocities.extend_from_slice(v);
        if self.dimension == 0 {
            return product(v, &mut self.effect);
        }
        let (mut coefficients, rest) = self.split(v);
        let size = Euclidean.norm(&rest);
        let negligible = if self.is_old { OLD_REMAINDER } else { ROUNDING };
        let is_known = size <= negligible * Euclidean.norm(v) && !self.basis.is_empty();
        if !is_known && self.is_old {
            self.basis.clear();
            self.is_old = false;
            return self.take(v, product);
        }
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
        residual.clear();
        loads.clear();
        for (c, (_, of_q)) in c.iter().zip(basis) {
            residual.resize(of_q.residual.len(), 0.0);
            loads.resize(of_q.loads.len(), 0.0);
            axpy(*c, &of_q.residual, residual);
            axpy(*c, &of_q.loads, loads);
        }
    }

    /// c and w of (effect of mesh), orthogonalised twice.
    fn split(&self, v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut coefficients, mut rest) = (vec![0.0; self.basis.len()], v.to_vec());
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

    /// After the point of linearisation has changed, the basis serves until its effect is found to be large.
    #[test]
    fn old_products_serve_until_they_are_forgotten() {
        let (mut of_mesh, mut products) = (EffectOfMesh { dimension: 2, ..EffectOfMesh::default() }, 0);
        let mut take = |of_mesh: &mut EffectOfMesh, v: &[f64]| {
            of_mesh.take(v, |x, effect| {
                products += 1;
                product(x, effect);
            });
            products
        };
        assert_eq!(take(&mut of_mesh, &[1.0, 2.0, 0.0]), 1);
        assert!(of_mesh.unjudged().is_some() && !of_mesh.judge(true), "products of this point are exact");
        assert!(of_mesh.unjudged().is_none(), "it is judged once");
        of_mesh.grow_old();
        assert!(of_mesh.unjudged().is_none(), "nothing was taken yet");
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0 + 1e-4, 0.0]), 1, "a small remainder");
        assert!(of_mesh.unjudged().is_some() && of_mesh.judge(false), "a large effect must be taken anew");
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0, 0.0]), 2);
        of_mesh.grow_old();
        assert_eq!(take(&mut of_mesh, &[-2.0, -4.0, 0.0]), 3, "a large effect never serves later points");
        assert!(!of_mesh.judge(true));
        of_mesh.grow_old();
        assert_eq!(take(&mut of_mesh, &[1.0, 0.0, 0.0]), 4, "another direction needs new products");
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
