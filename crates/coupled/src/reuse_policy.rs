//! When a new Jacobian of the flow pays.
//!
//! Computing one costs about as much as B Krylov iterations. After k slabs with n_1, .. n_k iterations, the mean cost of a slab beyond n_1
//! is
//!
//! ```text
//! c_k = (B + e_1 + .. + e_k) / k,    e_j = n_j - n_1                                                             (reuse)
//! ```
//!
//! It falls as long as the next excess e_{k+1} is less than it. A Jacobian ages faster and faster, so the next excess is estimated as twice
//! the last one.

/// B: 15 to 27 iterations on a heaving airfoil at N_s = 4 to 8 and N_t = 3. On a blade at Re = 50,000, N_s = 5, 60 instead of 20 leads to 80 instead of
/// 110 Jacobians in 300 slabs, and to 13 % more work.
pub const FREEZING: usize = 20;

/// If a Jacobian did not serve the slab after its own, this many slabs begin with a new one. Then a Jacobian is tried in two slabs again.
const EAGER: usize = 4;

/// Whether, and when, the Jacobian was computed in a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RebuiltInSlab {
    /// Not in this slab.
    No,
    /// Before the first iteration.
    AtFirst,
    /// Later, because the older Jacobian took too many iterations.
    Later,
}

/// Iteration counts since the Jacobian was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JacobianReusePolicy {
    /// n_1.
    pub base: usize,
    /// e_1 + .. + e_k.
    pub excess: usize,
    /// k; 0 before the first Jacobian.
    pub slabs: usize,
    /// The number of slabs that still begin with a new one.
    pub eager: usize,
}

impl JacobianReusePolicy {
    /// Records a slab. `iterations` are counted from the last Jacobian of this slab, or from the bottom of the slab. Returns whether the
    /// next slab begins with a new Jacobian.
    pub fn record(&mut self, iterations: usize, rebuilt: RebuiltInSlab) -> bool {
        match rebuilt {
            RebuiltInSlab::No if self.slabs > 0 => self.age(iterations),
            RebuiltInSlab::Later if self.slabs > 0 => {
                *self = JacobianReusePolicy { base: self.base, excess: 0, slabs: 1, eager: EAGER };
                true
            }
            _ => {
                *self =
                    JacobianReusePolicy { base: iterations, excess: 0, slabs: 1, eager: self.eager.saturating_sub(1) };
                self.eager > 0
            }
        }
    }

    /// 2 e_k > c_k, after one more slab.
    fn age(&mut self, iterations: usize) -> bool {
        let excess = iterations.saturating_sub(self.base);
        self.excess += excess;
        self.slabs += 1;
        2 * excess * self.slabs > FREEZING + self.excess
    }

    /// The number of iterations of a slab after which a new Jacobian pays, even within the slab.
    pub fn patience(&self) -> usize {
        if self.slabs == 0 { usize::MAX } else { self.base + FREEZING }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of slabs that a Jacobian serves.
    fn lifetime(iterations: impl Fn(usize) -> usize) -> Option<usize> {
        let mut reuse_policy = JacobianReusePolicy::default();
        (0..100)
            .find(|&slab| {
                reuse_policy
                    .record(iterations(slab), if slab == 0 { RebuiltInSlab::AtFirst } else { RebuiltInSlab::No })
            })
            .map(|slab| slab + 1)
    }

    /// Of all lifetimes, the one with the least cost per slab.
    fn best(iterations: impl Fn(usize) -> usize) -> usize {
        let cost = |k: usize| (FREEZING + (0..k).map(&iterations).sum::<usize>()) as f64 / k as f64;
        (1..100).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0)
    }

    #[test]
    fn a_jacobian_lives_about_as_long_as_pays_best() {
        assert_eq!(lifetime(|_| 7), None);
        // Iterations of a pitching airfoil at dt = 0.05: 11, 22, 40, 72, ..
        let doubling = |slab: usize| 11 * 2_usize.pow(slab.min(20) as u32);
        assert_eq!(lifetime(doubling), Some(best(doubling)));
        for growth in 1..20 {
            let linear = |slab: usize| 10 + growth * slab;
            let (found, best) = (lifetime(linear).unwrap_or(0), best(linear));
            assert!(found.abs_diff(best) <= 1 + best / 2, "{growth}: {found}, best {best}");
        }
    }

    /// Where a Jacobian serves its own slab only, most slabs begin with a new one.
    #[test]
    fn short_lives_are_learnt() {
        let mut reuse_policy = JacobianReusePolicy::default();
        assert_eq!(reuse_policy.patience(), usize::MAX);
        assert!(!reuse_policy.record(12, RebuiltInSlab::AtFirst));
        assert_eq!(reuse_policy.patience(), 12 + FREEZING);
        assert!(reuse_policy.record(5, RebuiltInSlab::Later));
        let begun_anew = (0..100).take_while(|_| reuse_policy.record(12, RebuiltInSlab::AtFirst)).count();
        assert_eq!((begun_anew, reuse_policy.base), (EAGER - 1, 12));
    }
}
