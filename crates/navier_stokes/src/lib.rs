//! Pointwise physics of a compressible gas: fluxes, boundary conditions, exact states
