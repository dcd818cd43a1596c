//! The effect B v that velocities v of the mesh have on the residual of the flow and on its loads.
//!
//! ```text
//! v = sum_j c_j q_j + w,    B v = sum_j c_j B q_j + B w,    q_j orthonormal                                      (effect of mesh)
//! ```
//!
//! A product along the mesh costs about twice a product along the state. Rigid bodies with n unknowns move the mesh in a space of n
//! dimensions. Products with its basis then serve all Krylov directions.

use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// A remainder w of this size, relative to v, is rounding.
const ROUNDING: f64 = 1e-12;

/// B v: rows of the residual, and the loads on walls.
#[derive(Default)]
struct Effect {
    residual: Vec<f64>,
    loads: Vec<f64>,
}

impl Effect {
    /// Adds `factor` times `other`.
    fn add(&mut self, factor: f64, other: &Effect) {
        add(factor, &other.residual, &mut self.residual);
        add(factor, &other.loads, &mut self.loads);
    }
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

    /// The residual of B v.
    pub(super) fn residual(&self) -> &[f64] {
        &self.effect.residual
    }

    /// The loads of B v.
    pub(super) fn loads(&self) -> &[f64] {
        &self.effect.loads
    }

    /// Takes the effect of `v` by (effect of mesh). `product` writes the residual of B x for a given x, and returns the loads.
    pub(super) fn take(&mut self, v: &[f64], mut product: impl FnMut(&[f64], &mut Vec<f64>) -> Vec<f64>) {
        let mut of = |x: &[f64]| {
            let mut residual = Vec::new();
            let loads = product(x, &mut residual);
            Effect { residual, loads }
        };
        self.velocities = v.to_vec();
        let (coefficients, rest) = self.split(v);
        let size = Euclidean.norm(&rest);
        let is_new = size > ROUNDING * Euclidean.norm(v);
        if is_new && self.basis.len() == self.dimension {
            self.effect = of(v);
            return;
        }
        self.effect.residual.fill(0.0);
        self.effect.loads.fill(0.0);
        for (c, (_, effect)) in coefficients.iter().zip(&self.basis) {
            self.effect.add(*c, effect);
        }
        if is_new {
            let q: Vec<f64> = rest.iter().map(|rest| rest / size).collect();
            let effect = of(&q);
            self.effect.add(size, &effect);
            self.basis.push((q, effect));
        }
    }

    /// c and w of (effect of mesh), orthogonalised twice.
    fn split(&self, v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut coefficients, mut rest) = (vec![0.0; self.basis.len()], v.to_vec());
        for _ in 0..2 {
            for (sum, (q, _)) in coefficients.iter_mut().zip(&self.basis) {
                let c = Euclidean.dot(q, &rest);
                add(-c, q, &mut rest);
                *sum += c;
            }
        }
        (coefficients, rest)
    }
}

/// sums := sums + factor terms; empty sums are zero.
fn add(factor: f64, terms: &[f64], sums: &mut Vec<f64>) {
    sums.resize(terms.len(), 0.0);
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += factor * term);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B x of a small matrix, with loads that are twice the residual.
    fn product(x: &[f64], residual: &mut Vec<f64>) -> Vec<f64> {
        *residual = vec![x[0] + 2.0 * x[1], x[2] - x[1], 3.0 * x[2]];
        residual.iter().map(|r| 2.0 * r).collect()
    }

    /// Velocities in a plane take two products, whatever their number and their size; others take one each.
    #[test]
    fn two_products_serve_a_plane() {
        let mut of_mesh = EffectOfMesh { dimension: 2, ..EffectOfMesh::default() };
        let mut products = 0;
        let mut check = |v: [f64; 3], count: usize| {
            of_mesh.take(&v, |x, residual| {
                products += 1;
                product(x, residual)
            });
            let mut expected = Vec::new();
            let loads = product(&v, &mut expected);
            let size = v.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
            let error = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(
                error(of_mesh.residual(), &expected) <= 1e-14 * size && error(of_mesh.loads(), &loads) <= 1e-14 * size
            );
            assert!(of_mesh.is_of(&v) && products == count, "{products} products");
        };
        check([1.0, 2.0, 0.0], 1);
        check([-3e8, -6e8, 0.0], 1);
        check([1.0, 2.0 + 1e-3, 0.0], 2);
        check([0.7, -0.3, 0.0], 2);
        check([0.0, 0.0, 0.0], 2);
        check([0.7, -0.3, 1.0], 3);
        check([0.7, -0.3, 2.0], 4);
    }
}
