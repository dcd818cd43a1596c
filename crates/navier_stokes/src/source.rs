//! Sources on the right-hand side of the equations.
//!
//! ```text
//! b = ( 0, rho a, rho w . a ) - zeta ( u - u_t )                                                         (sponge)
//! b = ( 0, rho a - 2 Omega x rho w, rho w . a )                                                          (rotation)
//! ```
//!
//! with the acceleration a of a body force, and the strength zeta and the target state u_t of a sponge. In a frame that turns with the angular
//! velocity Omega, w is relative to the frame, and a contains the centrifugal acceleration - Omega x (Omega x r). The Coriolis force does no work.

use crate::error::{InvalidParameter, finite};
use crate::state::{Conserved, lifted};
use tensor::{Over, Real, dot};

/// The meaning of the data of the source at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Source<const D: usize> {
    /// Data = b: mass, momentum and energy per volume and time.
    #[default]
    Given,
    /// Data = [_, a, _]: (sponge) with zeta = 0.
    Acceleration,
    /// Data = [zeta, a, _]: (sponge).
    Sponge {
        /// u_t
        target: Conserved<f64, D>,
    },
    /// Data = [_, a, _]: (rotation).
    Rotating(Rotation<D>),
}

/// The rotation of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<const D: usize> {
    /// Omega x, as a matrix.
    turn: [[f64; D]; D],
}

impl<const D: usize> Rotation<D> {
    /// A rotation with the angular velocity Omega; in two dimensions it has a component along z alone.
    ///
    /// # Errors
    /// An angular velocity that is not finite.
    pub fn new(angular_velocity: [f64; 3]) -> Result<Self, InvalidParameter> {
        let [x, y, z] = finite("angular velocity", angular_velocity)?;
        let turn = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        Ok(Rotation { turn: std::array::from_fn(|i| std::array::from_fn(|j| turn[i][j])) })
    }

    /// The centrifugal acceleration - Omega x (Omega x r) at the place `r` relative to the axis.
    pub fn centrifugal(&self, r: [f64; D]) -> [f64; D] {
        let turned = |a: [f64; D]| -> [f64; D] { std::array::from_fn(|i| dot(&self.turn[i], &a)) };
        turned(turned(r)).map(|a| -a)
    }

    /// `b` - 2 Omega x rho w
    #[inline(always)]
    fn with_coriolis<T: Real, const M: usize>(&self, u: &[T; M], b: [T; M]) -> [T; M] {
        let mut sum = b;
        for i in 0..D {
            for j in 0..D {
                sum[1 + i] += u[1 + j] * (-2.0 * self.turn[i][j]);
            }
        }
        sum
    }
}

impl<const D: usize> Source<D> {
    /// Whether it is a force, which adds no mass for any data.
    pub fn is_force(&self) -> bool {
        matches!(self, Source::Acceleration | Source::Rotating(_))
    }

    /// b at a point.
    #[inline(always)]
    pub(crate) fn at<T: Over<G>, G: Real, const M: usize>(&self, u: &[T; M], data: &[G; M]) -> [T; M] {
        match self {
            Source::Given => lifted(data),
            Source::Acceleration => body_force::<T, G, D, M>(u, data),
            Source::Rotating(rotation) => rotation.with_coriolis(u, body_force::<T, G, D, M>(u, data)),
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
