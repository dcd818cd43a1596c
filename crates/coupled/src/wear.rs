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

/// B: 20 to 27 iterations on a heaving airfoil at N_s = 4 to 6 and N_t = 3.
const FREEZING: usize = 20;

/// A solve is given up on the preconditioner, and the next has a new one, after twice the iterations of a slab and these.
const PATIENCE: usize = 20;

/// What the iterations of the slabs since the Jacobian was frozen say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wear {
    /// n_1.
    pub base: usize,
    /// e_1 + .. + e_k.
    pub excess: usize,
    /// k, 0 as long as nothing is frozen.
    pub slabs: usize,
}

impl Wear {
    /// Records a slab with that many iterations since the Jacobian was frozen, or since the bottom of the slab. Returns whether the
    /// Jacobian should be frozen anew in the next one.
    pub fn record(&mut self, iterations: usize, frozen_in_slab: bool) -> bool {
        if frozen_in_slab || self.slabs == 0 {
            *self = Wear { base: iterations, excess: 0, slabs: 1 };
            return false;
        }
        let excess = iterations.saturating_sub(self.base);
        self.excess += excess;
        self.slabs += 1;
        // 2 e_k > c_k
        2 * excess * self.slabs > FREEZING + self.excess
    }

    /// The iterations after which a single solve says that the preconditioner is of no use.
    pub fn patience(&self) -> usize {
        if self.slabs == 0 { usize::MAX } else { 2 * self.base + PATIENCE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slab, counted from the freezing, after which a Jacobian is frozen anew.
    fn lifetime(iterations: impl Fn(usize) -> usize) -> Option<usize> {
        let mut wear = Wear::default();
        (0..100).find(|&slab| wear.record(iterations(slab), slab == 0)).map(|slab| slab + 1)
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

    #[test]
    fn patience_is_endless_until_something_is_frozen() {
        let mut wear = Wear::default();
        assert_eq!(wear.patience(), usize::MAX);
        wear.record(12, true);
        assert_eq!(wear.patience(), 44);
    }
}
