//! The settings of Newton's method that the keys stand for.

use crate::{PseudoTime, Solver, Steady};
use newton_krylov::{fgmres, forcing, newton, pseudo_time};

impl Steady {
    /// The settings of the Newton driver that finds the steady flow. `time_unit` is the reference length over the reference speed.
    pub fn newton(&self, time_unit: f64) -> newton::Settings {
        let inverse = 1.0 / (self.first_step * time_unit);
        let defaults = newton::Settings::default();
        let (maximum, iterations) = (self.krylov_tolerance, self.krylov_iterations);
        newton::Settings {
            relative_tolerance: self.tolerance,
            max_steps: self.steps,
            forcing: forcing::Settings {
                initial: maximum,
                minimum: defaults.forcing.minimum.min(maximum),
                maximum,
                ..defaults.forcing
            },
            krylov: fgmres::Settings { restart: iterations, max_iterations: iterations, ..defaults.krylov },
            pseudo_time: pseudo_time::Settings {
                initial_inverse: inverse,
                restart_inverse: inverse,
                power: self.power,
                growth: self.growth,
                ..defaults.pseudo_time
            },
            ..defaults
        }
    }
}

impl Solver {
    /// The settings of the Newton driver; the case leaves other settings at their defaults.
    pub fn newton(&self) -> newton::Settings {
        let defaults = newton::Settings::default();
        let maximum = self.krylov_tolerance;
        let forcing = forcing::Settings {
            initial: defaults.forcing.initial.min(maximum),
            minimum: defaults.forcing.minimum.min(maximum),
            maximum,
            ..defaults.forcing
        };
        let krylov = fgmres::Settings {
            restart: self.krylov_restart,
            max_iterations: self.krylov_iterations,
            ..defaults.krylov
        };
        let PseudoTime { initial_inverse, restart_inverse, power } = self.pseudo_time;
        let pseudo_time = pseudo_time::Settings { initial_inverse, restart_inverse, power, ..defaults.pseudo_time };
        newton::Settings {
            relative_tolerance: self.newton_tolerance,
            absolute_tolerance: self.newton_absolute_tolerance,
            max_steps: self.newton_steps,
            forcing,
            krylov,
            pseudo_time,
            ..defaults
        }
    }
}
