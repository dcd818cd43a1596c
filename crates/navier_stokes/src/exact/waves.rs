//! A smooth state for manufactured sources.

use super::ExactState;
use crate::error::{InvalidParameter, positive};
use crate::gas::Gas;
use crate::state::Primitive;
use std::f64::consts::TAU;
use tensor::Transcendental;

/// Waves in different directions, one each for density, velocities and pressure, with period `length` in space and time.
/// With phi_q = (2 pi / length) (+-x +-y (+-z) - t) + q and the sound speed c of the mean,
///
/// ```text
/// rho = mean (1 + a sin phi_0),   w_i = mean + a c sin phi_i,   p = mean (1 + a sin phi_M-1)               (waves)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waves<const D: usize> {
    gas: Gas,
    mean: Primitive<f64, D>,
    amplitude: f64,
    length: f64,
}

impl<const D: usize> Waves<D> {
    /// Waves of relative `amplitude` a and period `length` about `mean`.
    ///
    /// # Errors
    /// A mean state or a length out of range, an amplitude outside [0, 1).
    pub fn new(gas: Gas, mean: Primitive<f64, D>, amplitude: f64, length: f64) -> Result<Self, InvalidParameter> {
        mean.checked()?;
        positive("length of the waves", length)?;
        if !(0.0..1.0).contains(&amplitude) {
            return Err(InvalidParameter::Amplitude { value: amplitude });
        }
        Ok(Waves { gas, mean, amplitude, length })
    }

    /// a sin phi_q; the sign along axis i is bit i of q.
    fn wave<T: Transcendental>(&self, x: &[T; D], t: T, q: usize) -> T {
        let mut phase = -t;
        for i in 0..D {
            phase += if (q >> i) & 1 == 0 { x[i] } else { -x[i] };
        }
        (phase * (TAU / self.length) + q as f64).sin() * self.amplitude
    }
}

impl<const D: usize, const M: usize> ExactState<D, M> for Waves<D> {
    fn state<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; M] {
        let c = self.gas.sound_speed(self.mean.density, self.mean.pressure);
        let mut state = self.mean.constant(t);
        state.density = (self.wave(x, t, 0) + 1.0) * self.mean.density;
        for i in 0..D {
            state.velocity[i] += self.wave(x, t, 1 + i) * c;
        }
        state.pressure = (self.wave(x, t, M - 1) + 1.0) * self.mean.pressure;
        state.pack(&self.gas)
    }
}
