//! An artificial viscosity that gives shocks a width which the mesh resolves.
//!
//! ```text
//! F_a = [ 0 ; beta w_k,k delta_ij ; beta w_k,k w_i + beta c_p T_,i / Pr_a ]                                   (F_a)
//! beta = k rho l c chi(r),   r = - l w_k,k / c,   chi(r) = q^2 / (q + r_0),   q = max(r - r_0, 0)            (beta)
//! 1 / l^2 = ( |G rho_,i|^2 + eps^2 rho^2 g^4 ) / ( |rho_,i|^2 + eps^2 rho^2 g^2 ),   g^2 = |G|^2 / D         (spacing)
//! ```
//!
//! This is a bulk viscosity with a conduction of heat. It acts where the gas is compressed by more than r_0 speeds of sound over the
//! distance l between two nodes. Elsewhere it is exactly zero: in smooth flow that the mesh resolves, in expansions, contacts and shear.
//! The ramp chi has a continuous derivative, so Newton's method sees a smooth function.
//!
//! G_ij counts distances between nodes along axis i of the cell, per length along j. So l is the distance between nodes in the direction in
//! which the density changes. With eps = 1/100 it is a mean over all directions where the density hardly changes.
//!
//! As part of the viscous flux, F_a conserves mass, momentum and energy. Both of its parts produce entropy, beta (w_k,k)^2 / T and the
//! usual one of conduction.
//!
//! After Fernandez, Nguyen & Peraire, AIAA 2018-0062 (the sensor of shocks, and a bulk viscosity); here with the local speed of sound, and
//! without smoothing from cell to cell.

use crate::error::{InvalidParameter, positive};
use crate::gas::Gas;
use crate::state::Primitive;
use tensor::{Over, Real, smooth_ramp};

/// The numbers of (beta).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShockCapturing {
    strength: f64,
    threshold: f64,
}

/// Pr_a of (F_a).
pub(crate) const ARTIFICIAL_PRANDTL: f64 = 0.72;

/// eps^2 of (spacing).
const LITTLE: f64 = 1e-4;

impl ShockCapturing {
    /// With k, the `strength`, and r_0, the `threshold`.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn new(strength: f64, threshold: f64) -> Result<Self, InvalidParameter> {
        positive("strength of shock capturing", strength)?;
        positive("threshold of shock capturing", threshold)?;
        Ok(ShockCapturing { strength, threshold })
    }

    /// beta at a point, with `gradient[direction][component]` of the conserved variables and G of (spacing), `grid[axis][direction]`.
    #[inline(always)]
    pub(crate) fn viscosity<T: Over<G>, G: Real, const D: usize, const M: usize>(
        self,
        gas: &Gas,
        u: &[T; M],
        gradient: &[[T; M]; D],
        grid: &[[G; D]; D],
    ) -> T {
        let Primitive { density, velocity: w, pressure } = Primitive::<T, D>::unpack(gas, u);
        let mut expansion = gradient[0][1] - w[0] * gradient[0][0];
        for i in 1..D {
            expansion += gradient[i][1 + i] - w[i] * gradient[i][0];
        }
        // - rho w_k,k
        let compression = -expansion;
        let per_square = inverse_spacing_squared(density, gradient, grid);
        let l_over_c = (density / (pressure * per_square * gas.gamma())).sqrt();
        let r = compression * l_over_c / density;
        let chi = smooth_ramp(r - self.threshold, r.constant(self.threshold));
        density * chi / (per_square * l_over_c) * self.strength
    }
}

/// 1 / l^2 of (spacing).
#[inline(always)]
fn inverse_spacing_squared<T: Over<G>, G: Real, const D: usize, const M: usize>(
    density: T,
    gradient: &[[T; M]; D],
    grid: &[[G; D]; D],
) -> T {
    let little = density * density * LITTLE;
    let (mut size, mut steps, mut mean) = (density.zero(), density.zero(), grid[0][0].zero());
    for i in 0..D {
        size += gradient[i][0] * gradient[i][0];
        let mut step = gradient[0][0].scale(grid[i][0]);
        for j in 1..D {
            step = gradient[j][0].scale_add(grid[i][j], step);
        }
        steps += step * step;
        for j in 0..D {
            mean += grid[i][j] * grid[i][j];
        }
    }
    mean = mean * (1.0 / D as f64);
    let little = little.scale(mean);
    (steps + little.scale(mean)) / (size + little)
}
