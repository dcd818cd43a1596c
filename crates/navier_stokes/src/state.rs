//! The state of the gas at a point, with named components.
//!
//! Kernels carry the conserved state as an array `[T; M]`, M = D + 2: density, momentum, total energy per volume.

use crate::error::{InvalidParameter, finite, positive};
use crate::gas::Gas;
use tensor::{Over, Real, dot};

/// Mass, momentum and total energy per volume: rho, rho w, rho E.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conserved<T, const D: usize> {
    /// rho
    pub density: T,
    /// rho w
    pub momentum: [T; D],
    /// rho E = rho e + rho |w|^2 / 2
    pub energy: T,
}

/// Density, velocity and pressure: rho, w, p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive<T, const D: usize> {
    /// rho
    pub density: T,
    /// w
    pub velocity: [T; D],
    /// p
    pub pressure: T,
}

impl<T: Real, const D: usize> Conserved<T, D> {
    /// Names the components of `u`.
    #[inline(always)]
    pub fn unpack<const M: usize>(u: &[T; M]) -> Self {
        const { assert!(M == D + 2, "a state has a density, D momenta and an energy") };
        let mut momentum = [u[0]; D];
        momentum.copy_from_slice(&u[1..1 + D]);
        Conserved { density: u[0], momentum, energy: u[M - 1] }
    }
    /// The components in the order of the unknowns.
    #[inline(always)]
    pub fn pack<const M: usize>(&self) -> [T; M] {
        components(self.density, &self.momentum, self.energy)
    }
    /// w = rho w / rho
    #[inline(always)]
    pub fn velocity(&self) -> [T; D] {
        scaled(&self.momentum, self.density.recip())
    }
}

impl<T: Real, const D: usize> Primitive<T, D> {
    /// w = rho w / rho and p from the gas law.
    #[inline(always)]
    pub fn from_conserved(gas: &Gas, u: &Conserved<T, D>) -> Self {
        let velocity = u.velocity();
        Primitive { density: u.density, velocity, pressure: gas.pressure(u, &velocity) }
    }
    /// Names and converts the components of `u`.
    #[inline(always)]
    pub fn unpack<const M: usize>(gas: &Gas, u: &[T; M]) -> Self {
        Primitive::from_conserved(gas, &Conserved::unpack(u))
    }
    /// rho E = p / (gamma - 1) + rho |w|^2 / 2
    #[inline(always)]
    pub fn to_conserved(&self, gas: &Gas) -> Conserved<T, D> {
        let momentum = scaled(&self.velocity, self.density);
        let energy = self.pressure * (1.0 / (gas.gamma() - 1.0)) + dot(&momentum, &self.velocity) * 0.5;
        Conserved { density: self.density, momentum, energy }
    }
    /// The conserved components in the order of the unknowns.
    #[inline(always)]
    pub fn pack<const M: usize>(&self, gas: &Gas) -> [T; M] {
        self.to_conserved(gas).pack()
    }
}

impl<const D: usize> Primitive<f64, D> {
    /// The state itself.
    ///
    /// # Errors
    /// A density or pressure that is not positive, a velocity that is not finite.
    pub fn checked(self) -> Result<Self, InvalidParameter> {
        positive("density", self.density)?;
        positive("pressure", self.pressure)?;
        finite("velocity", self.velocity)?;
        Ok(self)
    }
    /// The same constants in the number type of `like`.
    #[inline(always)]
    pub fn constant<T: Real>(&self, like: T) -> Primitive<T, D> {
        let mut velocity = [like; D];
        for i in 0..D {
            velocity[i] = like.constant(self.velocity[i]);
        }
        Primitive { density: like.constant(self.density), velocity, pressure: like.constant(self.pressure) }
    }
}

/// The array (mass, momentum, energy), of states and of fluxes alike.
#[inline(always)]
pub(crate) fn components<T: Real, const D: usize, const M: usize>(mass: T, momentum: &[T; D], energy: T) -> [T; M] {
    const { assert!(M == D + 2, "a state has a density, D momenta and an energy") };
    let mut u = [mass; M];
    u[1..1 + D].copy_from_slice(momentum);
    u[M - 1] = energy;
    u
}

/// factor a
#[inline(always)]
pub(crate) fn scaled<T: Real, const D: usize>(a: &[T; D], factor: T) -> [T; D] {
    let mut b = *a;
    for i in 0..D {
        b[i] = a[i] * factor;
    }
    b
}

/// Numbers of the geometry, or given ones, as numbers of the state.
#[inline(always)]
pub(crate) fn lifted<T: Over<G>, G: Real, const N: usize>(a: &[G; N]) -> [T; N] {
    let mut lifted = [T::lift(a[0]); N];
    for i in 1..N {
        lifted[i] = T::lift(a[i]);
    }
    lifted
}

/// a . n, of a vector of the state with a vector of the geometry.
#[inline(always)]
pub(crate) fn along<T: Over<G>, G: Real, const D: usize>(a: &[T; D], n: &[G; D]) -> T {
    let mut sum = a[0].scale(n[0]);
    for i in 1..D {
        sum += a[i].scale(n[i]);
    }
    sum
}
