//! How exactly a Newton step solves its linear system: Eisenstat & Walker (SIAM J. Sci. Comput. 17, 1996), choice 2.
//!
//! ```text
//! (forcing)   eta = gamma (|F| / |F_old|)^2
//! ```

/// The settings of [`Settings::next`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// eta of the first step.
    pub initial: f64,
    /// gamma of (forcing), in (0, 1].
    pub gamma: f64,
    /// The smallest eta. 1e-6 shows quadratic convergence; 1e-3 costs less.
    pub minimum: f64,
    /// The largest eta, below 1.
    pub maximum: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { initial: 0.1, gamma: 0.9, minimum: 1e-3, maximum: 0.1 }
    }
}

/// The step before the one that eta is wanted for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Previous {
    /// |F_old|, where that step started.
    pub norm: f64,
    /// Its eta.
    pub forcing: f64,
}

impl Settings {
    /// eta of the step that starts at |F| = `norm`; `tolerance` is the |F| at which Newton stops, 0 < tolerance < norm.
    ///
    /// A single good step must not tighten eta at once: eta >= gamma eta_old^2 while that exceeds 0.1. And no step solves more
    /// exactly than Newton needs in the end: eta >= tolerance / (2 |F|).
    pub fn next(&self, norm: f64, previous: Option<Previous>, tolerance: f64) -> f64 {
        let eta = previous.map_or(self.initial, |old| {
            let eta = self.gamma * (norm / old.norm).powi(2);
            let memory = self.gamma * old.forcing.powi(2);
            if memory > 0.1 { eta.max(memory) } else { eta }
        });
        eta.clamp(self.minimum, self.maximum).max(0.5 * tolerance / norm)
    }
}
