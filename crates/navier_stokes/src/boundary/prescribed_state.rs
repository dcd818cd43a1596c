//! A prescribed state.

use super::{BoundaryProblem, Condition, InviscidProblem};
use crate::law::NavierStokes;
use crate::state::lifted;
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A state given at every point and time, for instance an exact solution. The Riemann solver selects the part that comes
/// in, and viscous terms take the state as Dirichlet data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedState;

impl<const D: usize> Condition<D> for PrescribedState {
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        _law: &NavierStokes<D>,
        _minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let state = lifted(at.data);
        BoundaryProblem { state, inviscid: InviscidProblem::Between(state) }
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        true
    }
}
