//! What a condition imposes on the gas, and the inviscid flux that follows from it.
//!
//! The kernels are compiled for every condition. So the solution of each problem stands here once, and not in each condition.

use super::opening::Opening;
use super::wall_pressure::wall_flux;
use crate::flux::inviscid_normal;
use crate::law::NavierStokes;
use crate::state::{Primitive, along};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// What a condition imposes at a point.
pub(crate) struct BoundaryProblem<T, G, const D: usize, const M: usize> {
    /// u_b, at which viscous terms are evaluated. It is the state inside, unless the condition imposes another one.
    pub(crate) state: [T; M],
    /// The problem that the inviscid flux solves.
    pub(crate) inviscid: InviscidProblem<T, G, D, M>,
}

/// The problem that the inviscid flux through a boundary solves.
pub(crate) enum InviscidProblem<T, G, const D: usize, const M: usize> {
    /// The flux of this state on the facet, which is u_b.
    OfState(Primitive<T, D>),
    /// The Riemann problem between the gas inside and this state outside.
    Between([T; M]),
    /// The pressure on a wall.
    Wall,
    /// The flux of the state between the gas inside and a reservoir.
    Opening(Opening<T, G, D>),
}

impl<T: Over<G>, G: Real, const D: usize, const M: usize> InviscidProblem<T, G, D, M> {
    /// (F_c - u v) . n through the boundary, where the state inside is `minus`.
    #[inline(always)]
    pub(crate) fn flux(&self, law: &NavierStokes<D>, minus: &[T; M], at: BoundaryPoint<'_, G, D, M>) -> [T; M] {
        let (gas, n, v_n) = (&law.gas, at.normal, dot(at.velocity, at.normal));
        let state = match self {
            InviscidProblem::Wall => return wall_flux(law, minus, at),
            InviscidProblem::Between(outside) => return law.riemann.on_boundaries().flux(gas, minus, outside, n, v_n),
            InviscidProblem::OfState(state) => *state,
            InviscidProblem::Opening(opening) => opening.state(gas, &Primitive::unpack(gas, minus)),
        };
        inviscid_normal(&state.pack(gas), along(&state.velocity, n), state.pressure, n, v_n)
    }
}

impl<const D: usize, const M: usize> BoundaryProblem<f64, f64, D, M> {
    /// The state that the condition asks for: that outside of a Riemann problem, that of an opening, or u_b.
    pub(crate) fn target_state(&self, law: &NavierStokes<D>, minus: &[f64; M]) -> [f64; M] {
        match &self.inviscid {
            InviscidProblem::OfState(_) | InviscidProblem::Wall => self.state,
            InviscidProblem::Between(outside) => *outside,
            InviscidProblem::Opening(opening) => {
                opening.state(&law.gas, &Primitive::unpack(&law.gas, minus)).pack(&law.gas)
            }
        }
    }
}
