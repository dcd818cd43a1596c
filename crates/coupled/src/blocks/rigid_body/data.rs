//! The data of a rigid body.

use super::{Coordinate, Vec3};
use basis::Matrix;
use std::sync::Arc;

/// The data of a rigid body.
#[derive(Clone)]
pub struct RigidBodyData {
    /// Its name.
    pub name: String,
    /// m
    pub mass: f64,
    /// J, about the centre of mass, at rest.
    pub inertia: [Vec3; 3],
    /// c at rest.
    pub centre_of_mass: Vec3,
    /// p
    pub pivot: Vec3,
    /// The coordinates that it has.
    pub coordinates: Vec<Coordinate>,
    /// b as a function of time: weight, for example.
    pub force: Option<Arc<dyn Fn(f64) -> Vec3 + Send + Sync>>,
    /// The estimate of the added mass, for its preconditioner.
    pub added_mass: AddedMass,
}

/// The mass of fluid that moves with a body, for the preconditioner alone.
///
/// ```text
/// m_L G_kl,    m_L = rho L / sqrt(1 + (|lambda| L / (dt c))^2),    G_kl = int (g_k . n)(g_l . n) dS                (added mass)
/// ```
#[derive(Clone, Debug)]
pub struct AddedMass {
    /// rho
    pub density: f64,
    /// c
    pub speed_of_sound: f64,
    /// L
    pub depth: f64,
    /// G, `[coordinate][coordinate]`.
    pub area: Matrix,
}
