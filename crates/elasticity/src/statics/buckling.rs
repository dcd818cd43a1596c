//! Whether an equilibrium is stable.
//!
//! Let K be the stiffness at the equilibrium and K_0 that at rest, which is definite with enough supports. Under loads that do not follow
//! the body the equilibrium is stable if w . K w > 0 for all displacements w. So the sign of
//!
//! ```text
//! mu = min w . K w / w . K_0 w                                                                              (stability)
//! ```
//!
//! decides. As long as loads hardly deform the body, K changes in proportion to them: it is K_0 + q (K - K_0) at q times the loads.
//! Then the body buckles at
//!
//! ```text
//! q = 1 / (1 - mu)                                                                                           (buckling)
//! ```
//!
//! K - K_0 consists of the effect of stresses and of that of rotations. A bent beam loses stiffness along some displacements because its sections
//! have turned, by their rotation times its slenderness, and does not buckle. This loss is the same for the opposite displacement, whereas tension
//! stiffens what compression makes softer. So there is a q only if the loss at -d is much smaller.
//!
//! Method: LOBPCG with one vector (Knyazev 2001). The low-order matrix of K_0 preconditions. Most eigenvalues of the pencil (K, K_0) are
//! near one, so few iterations find the lowest.

use super::Statics;
use crate::ritz::{Pencil, add_scaled};
use crate::{ElasticityError, NaturalMode, modes};
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// The change of mu in an iteration at which it has converged.
const TOLERANCE: f64 = 1e-7;
/// The loss of stiffness comes from rotations if this part of it is left after the opposite displacement.
const OF_BENDING: f64 = 0.5;
/// Iterations at most: several times those of a column of a hundred times its width.
const MAX_ITERATIONS: usize = 100;

/// The stability of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// mu of (stability), an upper bound: the least stiffness of the loaded body along any displacement, relative to that at rest.
    pub stiffness: f64,
    /// The same after the opposite displacement.
    pub reversed: f64,
}

impl Stability {
    /// Whether the equilibrium is unstable.
    pub fn is_unstable(&self) -> bool {
        self.stiffness < 0.0
    }

    /// q of (buckling); None if the loads make the body stiffer along every displacement, or bend it.
    pub fn buckling_factor(&self) -> Option<f64> {
        let [loss, reversed] = [1.0 - self.stiffness, 1.0 - self.reversed];
        (loss > TOLERANCE.sqrt() && reversed < OF_BENDING * loss).then(|| 1.0 / loss)
    }
}

impl<const D: usize> Statics<D> {
    /// The stability of the equilibrium `d`. None for a linear law, whose stiffness does not depend on loads, and with follower pressures,
    /// for which (stability) does not hold.
    ///
    /// # Errors
    /// [`ElasticityError::NotDefinite`] if `d` has an entry that is not a number.
    pub fn stability(&self, d: &[f64]) -> Result<Option<Stability>, ElasticityError> {
        if !self.loads_change_stiffness() {
            return Ok(None);
        }
        let opposite: Vec<f64> = d.iter().map(|d| -d).collect();
        Ok(Some(Stability { stiffness: self.least_stiffness(d)?, reversed: self.least_stiffness(&opposite)? }))
    }

    /// mu of (stability) at the displacement `d`.
    fn least_stiffness(&self, d: &[f64]) -> Result<f64, ElasticityError> {
        let structure = &self.structure;
        let pencil = Pencil {
            k: &|x, out| structure.apply_stiffness_at(d, x, out),
            m: &|x, out| structure.apply_stiffness(x, out),
        };
        let mut vectors = modes::start(structure, 1);
        let mut mu = pencil.ritz(&mut vectors)?[0];
        for _ in 0..MAX_ITERATIONS {
            let old = vectors[0].clone();
            let gradient = self.preconditioned_gradient(&pencil, mu, &old);
            if gradient.iter().all(|g| *g == 0.0) {
                break;
            }
            vectors.insert(1, gradient);
            let lowest = pencil.ritz(&mut vectors)?[0];
            let change = (lowest - mu).abs();
            mu = lowest;
            if change <= TOLERANCE * (1.0 + mu.abs()) {
                break;
            }
            vectors.truncate(1);
            vectors.push(direction(&pencil, &old, &vectors[0]));
        }
        Ok(mu)
    }

    /// The `count` modes of lowest frequency of small vibrations about the stable equilibrium `d`, (modes) with K at `d`. As for
    /// [`Self::stability`], the result is None for a linear law and with follower pressures.
    ///
    /// # Errors
    /// As [`modes::natural_modes`].
    pub fn natural_modes(&self, d: &[f64], count: usize) -> Result<Option<Vec<NaturalMode>>, ElasticityError> {
        self.loads_change_stiffness().then(|| modes::natural_modes_at(&self.structure, d, count)).transpose()
    }

    /// Whether K at an equilibrium differs from K at rest, and is symmetric.
    fn loads_change_stiffness(&self) -> bool {
        !self.structure.law().is_linear() && self.loads.pressures.is_empty()
    }

    /// P^{-1} (K x - mu K_0 x)
    fn preconditioned_gradient(&self, pencil: &Pencil<'_>, mu: f64, x: &[f64]) -> Vec<f64> {
        let (mut gradient, mut at_rest, mut z) = (vec![0.0; x.len()], vec![0.0; x.len()], vec![0.0; x.len()]);
        (pencil.k)(x, &mut gradient);
        (pencil.m)(x, &mut at_rest);
        add_scaled(-mu, &at_rest, &mut gradient);
        self.structure.at_fixed(&mut gradient, |_| 0.0);
        self.stiffness.low_order.apply(&gradient, &mut z);
        z
    }
}

/// The part of `new` that is orthogonal to `old`, where old . M old = 1.
fn direction(pencil: &Pencil<'_>, old: &[f64], new: &[f64]) -> Vec<f64> {
    let (mut inertia, mut direction) = (vec![0.0; old.len()], new.to_vec());
    (pencil.m)(old, &mut inertia);
    add_scaled(-Euclidean.dot(&inertia, new), old, &mut direction);
    direction
}
