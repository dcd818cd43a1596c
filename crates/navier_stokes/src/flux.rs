//! The fluxes of the compressible Navier-Stokes equations.
//!
//! With density rho, velocity w, total energy E and enthalpy H per mass, pressure p, temperature T, and the velocity v of
//! the mesh, in direction i,
//!
//! ```text
//! F_c = [ rho w_i ; rho w_j w_i + p delta_ij ; rho H w_i ]                                                    (F_c)
//! F_v = [ 0 ; tau_ij ; tau_ij w_j + kappa T_,i ]                                                              (F_v)
//! tau_ij = mu (w_i,j + w_j,i) - 2/3 mu w_k,k delta_ij                                                         (tau)
//! ```
//!
//! after Diosady & Murman, AIAA 2018-0919, (7) and (8). In two dimensions w_k,k has two terms and the factor is still
//! 2/3: two-dimensional flow of a three-dimensional gas.

use crate::gas::Gas;
use crate::shock_capturing::ARTIFICIAL_PRANDTL;
use crate::state::{Conserved, Primitive, along, components, scaled};
use tensor::{Over, Real, dot, trace};

/// F_c(u) - u v = u (w_i - v_i) + p [0 ; e_i ; w_i], indexed `[direction][component]`.
#[inline(always)]
pub(crate) fn inviscid<T: Over<G>, G: Real, const D: usize, const M: usize>(
    gas: &Gas,
    u: &[T; M],
    v: &[G; D],
) -> [[T; M]; D] {
    let Primitive { velocity: w, pressure: p, .. } = Primitive::<T, D>::unpack(gas, u);
    let mut flux = [*u; D];
    for i in 0..D {
        let relative = w[i].minus(v[i]);
        for c in 0..M {
            flux[i][c] = u[c] * relative;
        }
        flux[i][1 + i] += p;
        flux[i][M - 1] += p * w[i];
    }
    flux
}

/// (F_c(u) - u v) . n = u (w_n - v_n) + p [0 ; n ; w_n], with the normal velocity w_n and the pressure of `u`.
#[inline(always)]
pub(crate) fn inviscid_normal<T: Over<G>, G: Real, const D: usize, const M: usize>(
    u: &[T; M],
    w_n: T,
    p: T,
    n: &[G; D],
    v_n: G,
) -> [T; M] {
    let relative = w_n.minus(v_n);
    let mut flux = *u;
    for c in 0..M {
        flux[c] = u[c] * relative;
    }
    for i in 0..D {
        flux[1 + i] += p.scale(n[i]);
    }
    flux[M - 1] += p * w_n;
    flux
}

/// F_v(u, gradient), indexed `[direction][component]`; `gradient` is the gradient of the conserved variables.
#[inline(always)]
pub(crate) fn viscous<T: Real, const D: usize, const M: usize>(
    gas: &Gas,
    u: &[T; M],
    gradient: &[[T; M]; D],
) -> [[T; M]; D] {
    Stresses::new(gas, u, gradient).flux()
}

/// (F_a)(u, gradient) with the viscosity `beta`, indexed `[direction][component]`.
#[inline(always)]
pub(crate) fn artificial<T: Real, const D: usize, const M: usize>(
    gas: &Gas,
    u: &[T; M],
    gradient: &[[T; M]; D],
    beta: T,
) -> [[T; M]; D] {
    Stresses::artificial(gas, u, gradient, beta).flux()
}

/// Gas of the state `u` that is exchanged between two cells if the slope of the density jumps. It carries its momentum and its energy along,
///
/// ```text
/// X = a [rho_,n] [1 ; w ; E],   1 / a = 1 / c + rho / (sigma mu)                                                   (exchange)
/// ```
///
/// with a speed a. Where viscosity dominates in the cell, a is near c; elsewhere it is near the viscous speed sigma mu / rho.
#[inline(always)]
pub(crate) fn mass_exchange<T: Over<G>, G: Real, const D: usize, const M: usize>(
    gas: &Gas,
    u: &[T; M],
    slope: T,
    sigma: G,
) -> [T; M] {
    let state = Primitive::<T, D>::unpack(gas, u);
    let c = gas.sound_speed(state.density, state.pressure);
    let viscous = gas.dynamic_viscosity(gas.temperature(state.density, state.pressure)).scale(sigma);
    let mass = c * viscous / (c * state.density + viscous) * slope;
    let per_mass = mass / state.density;
    let mut flux = *u;
    for m in 0..M {
        flux[m] = u[m] * per_mass;
    }
    flux
}

/// Viscous stress and conducted heat at a point.
pub(crate) struct Stresses<T, const D: usize> {
    /// w, at which they do work
    pub(crate) velocity: [T; D],
    /// tau_ij, symmetric
    pub(crate) tau: [[T; D]; D],
    /// mu
    viscosity: T,
    /// w_j,i, `[i][j]`.
    w_grad: [[T; D]; D],
    /// kappa T_,i: the heat flux against direction i
    pub(crate) heat: [T; D],
}

/// Velocity, internal energy per mass, and their gradients.
struct Slopes<T, const D: usize> {
    velocity: [T; D],
    internal: T,
    /// w_j,i, `[i][j]`.
    w_grad: [[T; D]; D],
    e_grad: [T; D],
}

impl<T: Real, const D: usize> Slopes<T, D> {
    /// From the conserved variables and their gradient, by
    ///
    /// ```text
    /// w_j,i = ((rho w_j)_,i - w_j rho_,i) / rho,   e_,i = ((rho E)_,i - E rho_,i) / rho - w_j w_j,i,   T_,i = e_,i / c_v
    /// ```
    #[inline(always)]
    fn new<const M: usize>(u: &[T; M], gradient: &[[T; M]; D]) -> Self {
        let u = Conserved::unpack(u);
        let inverse = u.density.recip();
        let w = u.velocity();
        let energy = u.energy * inverse;
        let internal = energy - dot(&w, &w) * 0.5;
        let (mut w_grad, mut e_grad) = ([w; D], w);
        for i in 0..D {
            for j in 0..D {
                w_grad[i][j] = (gradient[i][1 + j] - w[j] * gradient[i][0]) * inverse;
            }
        }
        for i in 0..D {
            e_grad[i] = (gradient[i][M - 1] - energy * gradient[i][0]) * inverse - dot(&w, &w_grad[i]);
        }
        Slopes { velocity: w, internal, w_grad, e_grad }
    }
}

impl<T: Real, const D: usize> Stresses<T, D> {
    /// Of F_v.
    #[inline(always)]
    pub(crate) fn new<const M: usize>(gas: &Gas, u: &[T; M], gradient: &[[T; M]; D]) -> Self {
        let Slopes { velocity, internal, w_grad, e_grad } = Slopes::new(u, gradient);
        // T = e / c_v with c_v = R / (gamma - 1), and kappa / c_v = mu gamma / Pr.
        let mu = gas.dynamic_viscosity(internal * ((gas.gamma() - 1.0) / gas.gas_constant()));
        let heat = scaled(&e_grad, mu * (gas.gamma() / gas.prandtl()));
        Stresses { velocity, tau: stress(mu, &w_grad), viscosity: mu, w_grad, heat }
    }

    /// Of (F_a) with the viscosity `beta`.
    #[inline(always)]
    pub(crate) fn artificial<const M: usize>(gas: &Gas, u: &[T; M], gradient: &[[T; M]; D], beta: T) -> Self {
        let Slopes { velocity, w_grad, e_grad, .. } = Slopes::new(u, gradient);
        let pressure = trace(&w_grad) * beta;
        let mut tau = [[beta.zero(); D]; D];
        for i in 0..D {
            tau[i][i] = pressure;
        }
        let heat = scaled(&e_grad, beta * (gas.gamma() / ARTIFICIAL_PRANDTL));
        Stresses { velocity, tau, viscosity: beta, w_grad, heat }
    }

    /// [0 ; tau_ij ; tau_ij w_j + kappa T_,i], indexed `[direction][component]`.
    #[inline(always)]
    fn flux<const M: usize>(&self) -> [[T; M]; D] {
        let mut flux = [[self.velocity[0].zero(); M]; D];
        for i in 0..D {
            for j in 0..D {
                flux[i][1 + j] = self.tau[i][j];
            }
        }
        for i in 0..D {
            flux[i][M - 1] = dot(&self.tau[i], &self.velocity) + self.heat[i];
        }
        flux
    }

    /// F_v . n = [0 ; tau n ; (tau n) . w + kappa T_,n]
    #[inline(always)]
    pub(crate) fn normal_flux<G: Real, const M: usize>(&self, n: &[G; D]) -> [T; M]
    where
        T: Over<G>,
    {
        let traction = self.traction(n);
        let work = dot(&traction, &self.velocity);
        components(work.zero(), &traction, work + along(&self.heat, n))
    }

    /// The flux where gas leaves: no heat, and a traction without derivatives along the normal,
    ///
    /// ```text
    /// F_v . n = [ 0 ; t ; t . w ],   t_i = mu ( n_j w_j,i - n_i w_k,k )                                              (leaving)
    /// ```
    ///
    /// An outflow has no data for such derivatives. With those from inside a disturbance grows into the domain wherever the mesh resolves
    /// the length mu / (rho w_n). As part of the inviscid flux, this is the condition mu w_i,n = (p - p_b) n_i of incompressible flow: plane
    /// channel flow leaves unchanged.
    #[inline(always)]
    pub(crate) fn leaving_flux<G: Real, const M: usize>(&self, n: &[G; D]) -> [T; M]
    where
        T: Over<G>,
    {
        let divergence = trace(&self.w_grad);
        let mut traction = self.velocity;
        for i in 0..D {
            traction[i] = self.viscosity * (along(&self.w_grad[i], n) - divergence.scale(n[i]));
        }
        let work = dot(&traction, &self.velocity);
        components(work.zero(), &traction, work)
    }

    /// The traction tau n on the facet with normal `n`.
    #[inline(always)]
    pub(crate) fn traction<G: Real>(&self, n: &[G; D]) -> [T; D]
    where
        T: Over<G>,
    {
        let mut traction = self.velocity;
        for i in 0..D {
            traction[i] = along(&self.tau[i], n);
        }
        traction
    }
}

/// (tau) in the state `state` with the velocity gradient `w_grad[i][j]` = w_j,i, `[i][j]`.
pub fn viscous_stress<const D: usize>(gas: &Gas, state: &Primitive<f64, D>, w_grad: &[[f64; D]; D]) -> [[f64; D]; D] {
    stress(gas.dynamic_viscosity(gas.temperature(state.density, state.pressure)), w_grad)
}

/// (tau), with `w_grad[i][j]` = w_j,i.
#[inline(always)]
fn stress<T: Real, const D: usize>(mu: T, w_grad: &[[T; D]; D]) -> [[T; D]; D] {
    let divergence = trace(w_grad);
    let mut tau = *w_grad;
    for i in 0..D {
        for j in 0..D {
            tau[i][j] = mu * (w_grad[i][j] + w_grad[j][i]);
        }
        tau[i][i] -= mu * divergence * (2.0 / 3.0);
    }
    tau
}
