//! Meshes and structures as a user of the crate sees them. One program: the kernels are compiled where they are used, and each program would take a minute.

mod common;
mod convergence;
mod dynamics;
mod large_displacement;
mod modes;
mod operator_times;
mod proof_share;
mod solver_times;
mod solvers;
mod statics;
mod vibration;
