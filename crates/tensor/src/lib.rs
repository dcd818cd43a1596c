//! Numbers for kernels.
//!
//! A point function (a flux, a law, a boundary state) and a pointwise step of a kernel are written once, generic in a
//! number type, and are used with
//!
//! * `f64`: a value, for tests and for data that are prepared once;
//! * [`Lanes`]: the same value in several cells at once, one cell per SIMD lane;
//! * [`Dual`] of either: a value with its derivative in one direction, so that the product with a Jacobian has the same
//!   source.
//!
//! [`Real`] is their common arithmetic. [`Over`] combines a number with another that carries fewer derivatives, such as
//! a differentiated state on a mesh that is not differentiated.
//!
//! [`Arch`] runs a kernel with the instructions of the machine.
//!
//! Nothing here loops over cells or allocates.
//!
//! The derivative of the speed of sound c = sqrt(gamma p / rho) along dp = 1, which is c / 2 p:
//!
//! ```
//! use tensor::{Dual, Real};
//!
//! fn sound_speed<T: Real>(pressure: T, density: T) -> T {
//!     (pressure / density * 1.4).sqrt()
//! }
//!
//! let (p, rho) = (2.0, 1.2);
//! let c = sound_speed(Dual::new(p, 1.0), Dual::new(rho, 0.0));
//! assert_eq!(c.value, sound_speed(p, rho));
//! assert!((c.derivative - c.value / (2.0 * p)).abs() < 1e-15);
//! ```

mod arch;
mod counted;
mod dual;
mod lanes;
mod real;
mod rotation;
mod small;

pub use arch::{Arch, runs_here};
pub use counted::{Counted, count_operations};
pub use dual::Dual;
pub use lanes::{LaneNumber, Lanes, Pack, WIDTH, zeroed};
pub use real::{Over, Real, Transcendental};
pub use rotation::{angular_velocity, moved_by_rotation, rotated};
pub use small::{AXES, cofactor, cross, det, determinant, dot, matrix_from_columns, norm, smooth_ramp, trace};

pub use pulp;
