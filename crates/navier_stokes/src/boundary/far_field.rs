//! The far field.

use super::{BoundaryProblem, Condition, InviscidProblem, zero_flux};
use crate::error::InvalidParameter;
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::Primitive;
use fem::BoundaryPoint;
use tensor::{Over, Real};

/// A uniform free stream outside. Through the Riemann solver it acts on the incoming waves; outgoing waves pass. No
/// viscous stress, no heat: wakes leave freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarField<const D: usize> {
    free_stream: Primitive<f64, D>,
}

impl<const D: usize> FarField<D> {
    /// The far field of `free_stream`.
    ///
    /// # Errors
    /// A density or pressure that is not positive, a velocity that is not finite.
    pub fn new(free_stream: Primitive<f64, D>) -> Result<Self, InvalidParameter> {
        Ok(FarField { free_stream: free_stream.checked()? })
    }

    /// The state outside.
    pub fn free_stream(&self) -> Primitive<f64, D> {
        self.free_stream
    }
}

impl<const D: usize> Condition<D> for FarField<D> {
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        _at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let outside = self.free_stream.constant(minus[0]).pack(&law.gas);
        BoundaryProblem { state: *minus, inviscid: InviscidProblem::Between(outside) }
    }

    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        _at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        zero_flux(stresses.velocity[0])
    }
}
