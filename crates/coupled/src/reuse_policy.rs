//! When it pays to freeze the flow's Jacobian anew.
//!
//! Freezing costs about as much as B Krylov iterations. After k slabs with n_1, .. n_k iterations one slab has cost, beyond n_1,
//!
//! ```text
//! c_k = (B + e_1 + .. + e_k) / k,    e_j = n_j - n_1                                                              (wear)
//! ```
//!
//! in the mean. That mean falls as long as the next excess is less than it; a frozen Jacobian ages faster and faster, so that the next
//! excess is taken to be twice the last.

/// B: 15 to 27 iterations on a heaving airfoil at N_s = 4 to 8 and N_t = 3.
pub const FREEZING: usize = 20;

/// Where a Jacobian did not last for the slab after its own, so many slabs begin with a new one before the next is put to the test.
const EAGER: usize = 4;

/// Whether, and when, the Jacobian was frozen in a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RebuiltInSlab {
    /// It was not.
    No,
    /// Ahead of all iterations.
    AtFirst,
    /// After some, which it had made too many.
    Later,
}

/// What the iterations of the slabs since the Jacobian was frozen say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JacobianReusePolicy {
    /// n_1.
    pub base: usize,
    /// e_1 + .. + e_k.
    pub excess: usize,
    /// k, 0 as long as nothing is frozen.
    pub slabs: usize,
    /// Slabs still to begin with a new one.
    pub eager: usize,
}

impl JacobianReusePolicy {
    /// Records a slab with that many iterations since the Jacobian was frozen, or since the bottom of the slab. Returns whether the
    /// next slab is to begin with a new one.
    pub fn record(&mut self, iterations: usize, frozen: RebuiltInSlab) -> bool {
        match frozen {
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

    /// The iterations of a slab by which as much is lost as freezing costs: the time to freeze, even in the midst of it.
    pub fn patience(&self) -> usize {
        if self.slabs == 0 { usize::MAX } else { self.base + FREEZING }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slab, counted from the freezing, after which a Jacobian is frozen anew.
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
