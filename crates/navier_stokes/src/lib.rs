//! Pointwise physics of a compressible perfect gas: fluxes, boundary conditions, exact states.
//!
//! [`NavierStokes`] is the conservation law that the kernels of `fem` integrate. This crate contains no mesh and no loops
//! over cells. Every point function is generic in the number type and in the dimension, and inlined. It runs in SIMD
//! lanes, and with dual numbers it gives exact products with the Jacobian.
//!
//! Loops over directions are kept short, with one statement each if there are two indices. A longer body is not unrolled
//! for duals in three dimensions; the arrays that it indexes then go through memory, at twice the cost.
//!
//! * [`Gas`], [`Viscosity`]: the equation of state; [`Reference`]: scales and dimensionless numbers.
//! * [`Conserved`], [`Primitive`]: states with named components.
//! * [`Riemann`]: numerical fluxes on moving facets.
//! * [`ShockCapturing`]: an artificial viscosity.
//! * [`Source`]: body forces, sponges and the [`Rotation`] of a frame.
//! * [`Boundary`] and its conditions.
//! * [`WallForce`]: forces, power and heat of walls.
//! * [`exact`], [`Exact`], [`Manufactured`]: prescribed states and the sources that make them solutions.
//!
//! The numerical flux of a uniform stream through a facet is that of the stream. Through a facet that moves with the gas only the pressure
//! acts:
//!
//! ```
//! use fem::ConservationLaw;
//! use navier_stokes::{Gas, NavierStokes, Primitive, Reference, Riemann, Source, Viscosity, VolumeFlux, WallFlux};
//!
//! let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Inviscid)?;
//! let law = NavierStokes {
//!     gas,
//!     riemann: Riemann::Hllc,
//!     reference: Reference::new(&gas, 1.2, 0.5, 2.0)?,
//!     source: Source::<2>::Given,
//!     volume_flux: VolumeFlux::Central,
//!     shock_capturing: None,
//!     wall_flux: WallFlux::Inside,
//! };
//! let stream = Primitive { density: 1.2, velocity: [0.5, 0.25], pressure: 2.0 };
//! let u: [f64; 4] = stream.to_conserved(&gas).pack();
//! assert!((Primitive::<f64, 2>::unpack(&gas, &u).pressure - 2.0).abs() < 1e-15);
//!
//! let flux = |v_n| law.numerical_flux(&u, &u, &[1.0, 0.0], v_n);
//! let at_rest = [0.6, 0.6 * 0.5 + 2.0, 0.6 * 0.25, 0.5 * (u[3] + 2.0)];
//! for (flux, exact) in [(flux(0.0), at_rest), (flux(0.5), [0.0, 2.0, 0.0, 0.5 * 2.0])] {
//!     assert!(flux.iter().zip(exact).all(|(flux, exact)| (flux - exact).abs() < 1e-14), "{flux:?}");
//! }
//! # Ok::<(), navier_stokes::InvalidParameter>(())
//! ```

mod boundary;
mod entropy;
mod error;
pub mod exact;
mod flux;
mod forces;
mod gas;
mod law;
mod manufactured;
mod reference;
mod riemann;
mod shock_capturing;
mod source;
mod state;
#[cfg(test)]
mod tests;
mod two_point;

pub use boundary::{
    AdiabaticWall, Boundary, FarField, Inflow, IsothermalWall, Outflow, PrescribedState, SlipWall, SupersonicInflow,
    VelocityInflow, WallFlux,
};
pub use error::InvalidParameter;
pub use exact::{Exact, ExactState};
pub use flux::viscous_stress;
pub use forces::{Coefficients, ForceScales, WallForce};
pub use gas::{Gas, Viscosity};
pub use law::{Compiled, NavierStokes};
pub use manufactured::Manufactured;
pub use reference::Reference;
pub use riemann::Riemann;
pub use shock_capturing::ShockCapturing;
pub use source::{Rotation, Source};
pub use state::{Conserved, Primitive};
pub use two_point::VolumeFlux;
