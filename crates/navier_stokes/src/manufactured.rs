//! Sources that make a given state an exact solution.

use crate::exact::ExactState;
use crate::law::NavierStokes;
use fem::{ConservationLaw, StateField};
use tensor::{Dual, Transcendental};

/// The source of the state u of `exact`, zero where u solves the equations:
///
/// ```text
/// s = d/dt u + d/dx_i ( F_c(u) - F_v(u, grad u) )_i                                                  (manufactured)
/// ```
///
/// Nothing is derived by hand: all derivatives are computed by nested dual numbers through the flux of the scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manufactured<E, const D: usize> {
    /// The law that the state satisfies with the source.
    pub law: NavierStokes<D>,
    /// The state.
    pub exact: E,
}

impl<E, const D: usize> Manufactured<E, D> {
    /// s at `x` and `t`.
    fn source<T: Transcendental, const M: usize>(&self, x: &[T; D], t: T) -> [T; M]
    where
        E: ExactState<D, M>,
    {
        let now = Dual::new(t, T::from(1.0));
        let mut source = derivatives(self.exact.state(&constants(x), now));
        for i in 0..D {
            let flux = self.law.flux(
                &self.exact.state(&along_axis(x, i), Dual::new(t, t.zero())),
                &gradient(&self.exact, &along_axis(x, i), Dual::new(t, t.zero())),
                &[Dual::new(t.zero(), t.zero()); D],
            );
            let slope = derivatives(flux[i]);
            for c in 0..M {
                source[c] += slope[c];
            }
        }
        source
    }
}

impl<const D: usize, const M: usize, E: ExactState<D, M>> StateField<D, M> for Manufactured<E, D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        self.source(x, t)
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.source(x, Dual::from(t))
    }
}

/// grad u of an exact state, indexed `[direction][component]`.
pub(crate) fn gradient<E: ExactState<D, M>, T: Transcendental, const D: usize, const M: usize>(
    exact: &E,
    x: &[T; D],
    t: T,
) -> [[T; M]; D] {
    std::array::from_fn(|k| derivatives(exact.state(&along_axis(x, k), Dual::new(t, t.zero()))))
}

/// The point `x` as dual numbers, differentiated along `axis`.
fn along_axis<T: Transcendental, const D: usize>(x: &[T; D], axis: usize) -> [Dual<T>; D] {
    let mut moving = constants(x);
    moving[axis].derivative = x[axis].constant(1.0);
    moving
}

/// `x` as constants.
fn constants<T: Transcendental, const D: usize>(x: &[T; D]) -> [Dual<T>; D] {
    x.map(|x| Dual::new(x, x.zero()))
}

fn derivatives<T, const M: usize>(u: [Dual<T>; M]) -> [T; M] {
    u.map(|u| u.derivative)
}
