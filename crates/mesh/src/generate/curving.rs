//! Smooth maps of the unit box, to make curved cells.

use crate::random::SplitMix64;
use std::array::from_fn;
use std::f64::consts::{PI, TAU};

/// The deformation of a generated box: r becomes r + d(r) in coordinates r in [0, 1]^D of the box. No component of d
/// exceeds `amplitude`, a fraction of the extent of the box. Up to 0.05 cells stay valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curving {
    /// Straight cells.
    None,
    /// d_i = amplitude prod_a sin(2 pi r_a): the boundary and its tangential spacing do not change.
    Smooth {
        /// The largest displacement.
        amplitude: f64,
    },
    /// d_i = amplitude sin(2 pi sum_a r_a + i): the boundary is curved too, and remains periodic.
    Wavy {
        /// The largest displacement.
        amplitude: f64,
    },
    /// A few random Fourier modes, periodic. Along axes that are not periodic d is damped by sin(pi r_a), so that the
    /// boundary there does not change.
    Random {
        /// A bound of the displacement.
        amplitude: f64,
        /// The seed of the field.
        seed: u64,
    },
}

impl Curving {
    /// The requested largest displacement.
    pub(crate) fn amplitude(&self) -> f64 {
        match *self {
            Curving::None => 0.0,
            Curving::Smooth { amplitude } | Curving::Wavy { amplitude } | Curving::Random { amplitude, .. } => {
                amplitude
            }
        }
    }
}

/// The displacement d(r) of a [`Curving`], with its random numbers drawn.
pub(super) struct Deformation<const D: usize> {
    curving: Curving,
    periodic: [bool; D],
    modes: Vec<Mode<D>>,
}

/// weight_i sin(2 pi k . r + phase_i)
struct Mode<const D: usize> {
    wave_vector: [f64; D],
    phase: [f64; D],
    weight: [f64; D],
}

/// Modes of a random field.
const MODES: usize = 4;

impl<const D: usize> Deformation<D> {
    pub(super) fn new(curving: Curving, periodic: [bool; D]) -> Self {
        let modes = match curving {
            Curving::Random { seed, .. } => {
                let mut random = SplitMix64::new(seed);
                (0..MODES).map(|_| Mode::random(&mut random)).collect()
            }
            _ => Vec::new(),
        };
        Deformation { curving, periodic, modes }
    }

    /// d(r)
    pub(super) fn displacement(&self, r: &[f64; D]) -> [f64; D] {
        match self.curving {
            Curving::None => [0.0; D],
            Curving::Smooth { amplitude } => [amplitude * r.map(|r| (TAU * r).sin()).iter().product::<f64>(); D],
            Curving::Wavy { amplitude } => from_fn(|i| amplitude * (TAU * r.iter().sum::<f64>() + i as f64).sin()),
            Curving::Random { amplitude, .. } => from_fn(|i| amplitude * self.damping(r) * self.random_field(r, i)),
        }
    }

    /// The product of sin(pi r_a) over the axes that are not periodic.
    fn damping(&self, r: &[f64; D]) -> f64 {
        (0..D).filter(|&a| !self.periodic[a]).map(|a| (PI * r[a]).sin()).product()
    }

    fn random_field(&self, r: &[f64; D], i: usize) -> f64 {
        self.modes.iter().map(|mode| mode.value(r, i)).sum()
    }
}

impl<const D: usize> Mode<D> {
    /// Wave numbers -1, 0, 1, not all zero; weights such that the sum of the modes stays within [-1, 1].
    fn random(random: &mut SplitMix64) -> Self {
        let mut wave_vector = from_fn(|_| random.below(3) as f64 - 1.0);
        if wave_vector == [0.0; D] {
            wave_vector[random.below(D)] = 1.0;
        }
        let phase = from_fn(|_| PI * random.symmetric());
        let weight = from_fn(|_| random.symmetric() / MODES as f64);
        Mode { wave_vector, phase, weight }
    }

    fn value(&self, r: &[f64; D], i: usize) -> f64 {
        let k_r: f64 = (0..D).map(|a| self.wave_vector[a] * r[a]).sum();
        self.weight[i] * (TAU * k_r + self.phase[i]).sin()
    }
}
