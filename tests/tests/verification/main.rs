//! Verification of the numerics against exact solutions and identities: one program, so that the kernels are compiled once.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod architecture;
mod boundary_flux;
mod coarse_level;
mod data_at_points;
mod elastic_body;
mod entropy;
mod large_rotation;
mod lines;
mod low_order;
mod manufactured_interface;
mod rigid_body;
mod shares;
mod slab_operator;
mod spinning_body;
mod spring_mass;
mod sweeps;
mod top_of_slab;
mod valid_steps;
mod viscous;
mod vortex;
mod wall_loads;
