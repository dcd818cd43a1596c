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
//! * [`Source`]: body forces and sponges.
//! * [`Boundary`] and its conditions.
//! * [`WallForce`]: forces, power and heat of walls.
//! * [`exact`], [`Exact`], [`Manufactured`]: prescribed states and the sources that make them solutions.

mod boundary;
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
pub use forces::{Coefficients, ForceScales, WallForce};
pub use gas::{Gas, Viscosity};
pub use law::{Compiled, NavierStokes};
pub use manufactured::Manufactured;
pub use reference::Reference;
pub use riemann::Riemann;
pub use shock_capturing::ShockCapturing;
pub use source::Source;
pub use state::{Conserved, Primitive};
pub use two_point::VolumeFlux;
