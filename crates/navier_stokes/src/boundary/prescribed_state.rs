//! A prescribed state.

use super::Condition;
use crate::law::NavierStokes;
use crate::state::lifted;
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// A state given at every point and time, for instance an exact solution. The Riemann solver selects the part that comes
/// in, and viscous terms take the state as Dirichlet data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedState;

impl<const D: usize> Condition<D> for PrescribedState {
    #[inline(always)]
    fn state<T: Over<G>, G: Real, const M: usize>(
        &self,
        _law: &NavierStokes<D>,
        _minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        lifted(at.data)
    }

    #[inline(always)]
    fn flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, data } = at;
        law.riemann.flux(&law.gas, minus, &lifted(data), n, dot(v, n))
    }

    #[inline(always)]
    fn takes_data(&self) -> bool {
        true
    }
}
