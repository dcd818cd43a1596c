//! The pressure on walls and planes of symmetry.
//!
//! ```text
//! inside     p_w = p
//! mirrored   p_w = p + rho w_r ( a w_r + (a^2 w_r^2 + c^2)^1/2 ),  a = (gamma + 1) / 4,  where w_r = w_n - v_n >= 0      (wall)
//!            p_w = p ( 1 + (gamma - 1) / 2 w_r / c )^(2 gamma / (gamma - 1)),                where w_r < 0
//! ```
//!
//! The second one is the pressure between the gas and its mirror image, which moves with the wall: behind a shock where gas runs into the wall,
//! behind an expansion where it runs away. It differs from p by rho c w_r, and so resists the velocity through the wall. Either way the flux is
//! [0 ; p_w n ; p_w v_n]: no mass, and the work of the force on the moving wall. The pressure inside is adjoint consistent, the other one is not.

use crate::law::NavierStokes;
use crate::state::{Primitive, along, components};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// The pressure that the inviscid flux of a wall takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallFlux {
    /// The one inside.
    #[default]
    Inside,
    /// The one between the gas inside and its mirror image.
    Mirrored,
}

/// The flux of a wall: [0 ; p_w n ; p_w v_n].
#[inline(always)]
pub(super) fn wall_flux<T: Over<G>, G: Real, const D: usize, const M: usize>(
    law: &NavierStokes<D>,
    minus: &[T; M],
    at: BoundaryPoint<'_, G, D, M>,
) -> [T; M] {
    let BoundaryPoint { normal: n, velocity: v, .. } = at;
    let p = wall_pressure(law, minus, at);
    let mut push = [p; D];
    for i in 0..D {
        push[i] = p.scale(n[i]);
    }
    components(p.zero(), &push, along(&push, v))
}

/// p_w of (wall).
#[inline(always)]
fn wall_pressure<T: Over<G>, G: Real, const D: usize, const M: usize>(
    law: &NavierStokes<D>,
    minus: &[T; M],
    at: BoundaryPoint<'_, G, D, M>,
) -> T {
    let BoundaryPoint { normal: n, velocity: v, .. } = at;
    let Primitive { density, velocity, pressure } = Primitive::<T, D>::unpack(&law.gas, minus);
    match law.wall_flux {
        WallFlux::Inside => pressure,
        WallFlux::Mirrored => {
            let (gamma, c) = (law.gas.gamma(), law.gas.sound_speed(density, pressure));
            let into = along(&velocity, n).minus(dot(v, n));
            let slope = into * (0.25 * (gamma + 1.0));
            let behind_shock = pressure + density * into * (slope + (slope * slope + c * c).sqrt());
            // Faster gas leaves a vacuum.
            let ratio = (into / c * (0.5 * (gamma - 1.0)) + 1.0).max(c.constant(1e-3));
            let behind_expansion = pressure * ratio.powf(2.0 * gamma / (gamma - 1.0));
            into.select_ge(into.zero(), behind_shock, behind_expansion)
        }
    }
}
