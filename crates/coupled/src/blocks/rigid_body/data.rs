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

/// The fluid that moves with a body, for the preconditioner alone: a layer that is incompressible for slow motions, and takes up
/// sound for fast ones.
///
/// ```text
/// load = - s m_L(s) G_kl W_l,    m_L(s) = rho L / (1 + s L / c),    G_kl = int (g_k . n)(g_l . n) dS               (added mass)
/// ```
///
/// s is the derivative in time. The load is -rho L G dW/dt for s L << c, and -rho c G W, that of plane waves, for s L >> c.
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

impl AddedMass {
    /// m_L for motions of the real `rate` s.
    pub(super) fn surface_density(&self, rate: f64) -> f64 {
        self.density * self.depth / (1.0 + rate * self.delay())
    }

    /// L / c
    pub(super) fn delay(&self) -> f64 {
        self.depth / self.speed_of_sound
    }
}
