//! Sources on the right-hand side of the equations.
//!
//! ```text
//! s = ( 0, rho a, rho w . a ) - sigma ( u - u_t )                                                        (sponge)
//! ```
//!
//! with the acceleration a of a body force, and the strength sigma and the target state u_t of a sponge.

use crate::state::Conserved;
use tensor::{Over, Real};

/// The meaning of the data of the source at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Source<const D: usize> {
    /// Data = s: mass, momentum and energy per volume and time.
    #[default]
    Given,
    /// Data = [_, a, _]: (sponge) with sigma = 0.
    Acceleration,
    /// Data = [sigma, a, _]: (sponge).
    Sponge {
        /// u_t
        target: Conserved<f64, D>,
    },
}

impl<const D: usize> Source<D> {
    /// s at a point.
    #[inline(always)]
    pub(crate) fn at<T: Over<G>, G: Real, const M: usize>(&self, u: &[T; M], data: &[G; M]) -> [T; M] {
        match self {
            Source::Given => given(u, data),
            Source::Acceleration => body_force::<T, G, D, M>(u, data),
            Source::Sponge { target } => {
                let (mut s, target) = (body_force::<T, G, D, M>(u, data), target.pack::<M>());
                for c in 0..M {
                    s[c] = (u[c] + -target[c]).scale_add(-data[0], s[c]);
                }
                s
            }
        }
    }
}

/// `data` as numbers of the state.
#[inline(always)]
fn given<T: Over<G>, G: Real, const M: usize>(u: &[T; M], data: &[G; M]) -> [T; M] {
    let mut s = *u;
    for c in 0..M {
        s[c] = T::lift(data[c]);
    }
    s
}

/// (0, rho a, rho w . a)
#[inline(always)]
fn body_force<T: Over<G>, G: Real, const D: usize, const M: usize>(u: &[T; M], data: &[G; M]) -> [T; M] {
    let mut s = [u[0].zero(); M];
    s[M - 1] = u[1].scale(data[1]);
    for i in 1..D {
        s[M - 1] = u[1 + i].scale_add(data[1 + i], s[M - 1]);
    }
    for i in 0..D {
        s[1 + i] = u[0].scale(data[1 + i]);
    }
    s
}
