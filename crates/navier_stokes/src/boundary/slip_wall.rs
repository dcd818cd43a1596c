//! The frictionless wall, which is also the plane of symmetry.

use super::{BoundaryProblem, Condition, InviscidProblem};
use crate::flux::Stresses;
use crate::law::NavierStokes;
use crate::state::{Primitive, along, components};
use fem::BoundaryPoint;
use tensor::{Over, Real, dot};

/// Gas may slide along the wall but not cross it; no shear, no heat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlipWall;

impl<const D: usize> Condition<D> for SlipWall {
    /// The state inside with the normal velocity of the wall: w - (w_n - v_n) n.
    #[inline(always)]
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M> {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let mut state = Primitive::unpack(&law.gas, minus);
        let relative = along(&state.velocity, n).minus(dot(v, n));
        for i in 0..D {
            state.velocity[i] -= relative.scale(n[i]);
        }
        BoundaryProblem { state: state.pack(&law.gas), inviscid: InviscidProblem::Wall }
    }

    /// [0 ; s n ; s v_n] with the normal stress s = n . tau n.
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, velocity: v, .. } = at;
        let mut traction = stresses.traction(n);
        let stress = along(&traction, n);
        for i in 0..D {
            traction[i] = stress.scale(n[i]);
        }
        components(stress.zero(), &traction, along(&traction, v))
    }
}
