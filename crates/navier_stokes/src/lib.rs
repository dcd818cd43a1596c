//! Pointwise physics of a compressible perfect gas: fluxes, boundary conditions, exact states.
//!
//! [`NavierStokes`] is the conservation law that the kernels of `fem` integrate. Nothing here knows a mesh or loops over
//! cells. Every point function is generic in the number type and in the dimension, and inlined: it runs in SIMD lanes, and
//! on dual numbers it gives the exact action of the Jacobian.
//!
//! Loops over directions are kept short, one statement each where there are two indices: a longer body is not unrolled for
//! duals in three dimensions, and the arrays that it indexes then go through memory, at twice the cost.
//!
//! * [`Gas`], [`Viscosity`]: the equation of state; [`Reference`]: scales and dimensionless numbers.
//! * [`Conserved`], [`Primitive`]: a state in names.
//! * [`Riemann`]: numerical fluxes on moving facets.
//! * [`Boundary`] and its conditions.
//! * [`WallForce`]: what the fluid does to walls.
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
mod state;
#[cfg(test)]
mod tests;

pub use boundary::{
    AdiabaticWall, Boundary, FarField, Inflow, IsothermalWall, Outflow, PrescribedState, SlipWall, SupersonicInflow,
    VelocityInflow,
};
pub use error::InvalidParameter;
pub use exact::{Exact, ExactState};
pub use forces::{Coefficients, ForceScales, WallForce};
pub use gas::{Gas, Viscosity};
pub use law::{Compiled, NavierStokes};
pub use manufactured::Manufactured;
pub use reference::Reference;
pub use riemann::Riemann;
pub use state::{Conserved, Primitive};
