//! Natural frequencies and shapes of a structure.
//!
//! ```text
//! K phi = omega^2 M phi,     phi_i . M phi_j = delta_ij,     phi = 0 at fixed entries                          (modes)
//! ```
//!
//! Method: inverse iteration of a block of vectors with Rayleigh-Ritz. X := (K + s M)^{-1} M X, then the small eigenproblem of X.KX for
//! X.MX = I, whose eigenvectors rotate X. Let p be the first mode outside the block. Mode k gains the factor (omega_k^2 + s) / (omega_p^2 +
//! s) per iteration. The shift s > 0 allows rigid motions. It is that of a compact body at first, and falls with the frequencies that are found
//! until it is small beside omega_p^2. A block, not a single vector, finds modes of equal frequency.

use crate::ritz::Pencil;
use crate::shifted::Shifted;
use crate::{ElasticityError, Structure};
use fem::parallel::{self, Grain};
use newton_krylov::inner_product::reduce;

/// Vectors of the block beyond the requested modes.
const GUARD: usize = 8;
/// omega^2 has converged when its change is below this, relative to omega^2 and RIGID times s: rigid motions have no frequency.
const TOLERANCE: f64 = 1e-10;
/// See `TOLERANCE`.
const RIGID: f64 = 1e-2;
/// A shift above this part of the highest omega^2 of the block is replaced by SMALL times that.
const LARGE: f64 = 0.5;
/// See `LARGE`.
const SMALL: f64 = 0.1;
/// Relative tolerance of a solve with K + s M.
const SOLVE_TOLERANCE: f64 = 1e-10;
/// Iterations after which the search gives up: five times the number for a slender beam.
const MAX_ITERATIONS: usize = 60;

/// A natural mode.
#[derive(Clone, Debug, PartialEq)]
pub struct NaturalMode {
    /// omega: radians per unit of time.
    pub angular_frequency: f64,
    /// phi, `[C0 node][component]`, of modal mass 1.
    pub shape: Vec<f64>,
}

impl NaturalMode {
    /// omega / 2 pi
    pub fn frequency(&self) -> f64 {
        self.angular_frequency / std::f64::consts::TAU
    }
}

/// The `count` modes of lowest frequency, in increasing order. Rigid motions that no support prevents have frequency 0,
/// up to round-off.
///
/// # Errors
/// [`ElasticityError::TooManyModes`], [`ElasticityError::Modes`] without convergence, or the error of a solve with K +
/// s M.
pub fn natural_modes<const D: usize>(
    structure: &Structure<D>,
    count: usize,
) -> Result<Vec<NaturalMode>, ElasticityError> {
    natural_modes_at(structure, &[], count)
}

/// The same with K at the displacement `d`; empty means at rest. K must be positive semi-definite there.
pub(crate) fn natural_modes_at<const D: usize>(
    structure: &Structure<D>,
    d: &[f64],
    count: usize,
) -> Result<Vec<NaturalMode>, ElasticityError> {
    structure.require_modes(count)?;
    let size = (count + GUARD).min(structure.count_free());
    let mut s = structure.typical_shift();
    let mut shifted = structure.shifted(s, Vec::new(), d)?;
    let mut block = Block { x: start(structure, size), omega_squared: vec![f64::INFINITY; size] };
    for _ in 0..MAX_ITERATIONS {
        let old = std::mem::take(&mut block.omega_squared);
        block = block.iterate(structure, &shifted)?;
        let highest = block.omega_squared[size - 1];
        if s > LARGE * highest && highest > 0.0 {
            s = SMALL * highest;
            shifted = structure.shifted(s, Vec::new(), d)?;
            continue;
        }
        let settled =
            |k: usize| (block.omega_squared[k] - old[k]).abs() <= TOLERANCE * (block.omega_squared[k] + RIGID * s);
        if (0..count).all(settled) {
            return Ok(block.into_modes(count));
        }
    }
    Err(ElasticityError::Modes { wanted: count, iterations: MAX_ITERATIONS })
}

/// Approximate modes.
struct Block {
    x: Vec<Vec<f64>>,
    omega_squared: Vec<f64>,
}

impl Block {
    /// One inverse iteration with Rayleigh-Ritz.
    fn iterate<const D: usize>(self, structure: &Structure<D>, shifted: &Shifted<D>) -> Result<Self, ElasticityError> {
        let solve = |x: &Vec<f64>| {
            let (mut inertia, mut y) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            structure.apply_mass(x, &mut inertia);
            structure.at_fixed(&mut inertia, |_| 0.0);
            shifted.solve(structure, &inertia, &mut y, SOLVE_TOLERANCE).map(|_| y)
        };
        let solved = parallel::map(self.x.len(), Grain::Any, &|k| solve(&self.x[k]));
        let mut x = solved.into_iter().collect::<Result<Vec<_>, _>>()?;
        let pencil = Pencil {
            k: &|x, out| shifted.apply_stiffness(structure, x, out),
            m: &|x, out| structure.apply_mass(x, out),
        };
        Ok(Block { omega_squared: pencil.ritz(&mut x)?, x })
    }

    fn into_modes(self, count: usize) -> Vec<NaturalMode> {
        let mode = |(mut shape, omega_squared): (Vec<f64>, f64)| {
            // Choose the sign of the shape such that its largest entry is positive.
            let larger = |m: f64, x: f64| if x.abs() > m.abs() { x } else { m };
            let sign = reduce(shape.iter().copied(), larger).map_or(1.0, f64::signum);
            shape.iter_mut().for_each(|x| *x *= sign);
            // For rigid motions round-off may be negative.
            NaturalMode { angular_frequency: omega_squared.max(0.0).sqrt(), shape }
        };
        self.x.into_iter().zip(self.omega_squared).take(count).map(mode).collect()
    }
}

/// Independent vectors that contain every mode: waves of increasing number along every axis, shifted so that no symmetry
/// excludes a mode.
pub(crate) fn start<const D: usize>(structure: &Structure<D>, size: usize) -> Vec<Vec<f64>> {
    let diameter = structure.mesh().diameter();
    let vector = |number: usize| -> Vec<f64> {
        let wave = |x: &[f64; D], i: usize| {
            let phase: f64 = (0..D).map(|a| x[a] * (1.0 + (0.7 * (number + 2 * a + i) as f64).fract())).sum();
            ((number / D + 1) as f64 * phase / diameter + (number * (i + 1)) as f64).sin()
        };
        let mut vector: Vec<f64> =
            structure.coordinates().iter().flat_map(|x| std::array::from_fn::<f64, D, _>(|i| wave(x, i))).collect();
        structure.at_fixed(&mut vector, |_| 0.0);
        vector
    };
    (0..size).map(vector).collect()
}
