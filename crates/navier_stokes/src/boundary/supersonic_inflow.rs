//! Supersonic inflow of a given state.

use super::{BoundaryProblem, Condition, InviscidProblem};
use crate::law::NavierStokes;
use crate::state::{Primitive, lifted};
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A complete state, given at every point and time. All waves enter, so the flux is F_c(u_b) for any gas inside. Viscous terms take the
/// state as Dirichlet data. The condition is well posed only if the given normal velocity relative to the facet exceeds the speed of
/// sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupersonicInflow;

impl<const D: usize> Condition<D> for SupersonicInflow {
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        _minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let state = lifted(at.data);
        BoundaryProblem { state, inviscid: InviscidProblem::OfState(Primitive::unpack(&law.gas, &state)) }
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        true
    }
}
