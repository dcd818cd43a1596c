//! What the kernels ask of a physics: point functions, no loops, no allocation, no mesh.

use tensor::{Over, Real};

/// A point of a boundary, as a condition sees it.
#[derive(Clone, Copy, Debug)]
pub struct BoundaryPoint<'a, G, const D: usize, const M: usize> {
    /// The unit normal out of the domain.
    pub normal: &'a [G; D],
    /// The velocity of the mesh.
    pub velocity: &'a [G; D],
    /// The prescribed state where [`ConservationLaw::takes_state`], otherwise arbitrary.
    pub data: &'a [G; M],
}

/// A conservation law of `M` components in `D` dimensions, on a mesh that moves with velocity v:
///
/// ```text
/// d/dt int_K u + int_dK ( F_c(u) - u v - F_v(u, grad u) ) . n = int_K s                                   (claw)
/// ```
///
/// Every method is a pure function of point values, generic in the number type `T` of the state and the number type `G` of
/// the geometry (see [`Over`]). Gradients and fluxes are indexed `[direction][component]`. Normals are of unit length and
/// point from minus to plus, and on the boundary out of the domain.
pub trait ConservationLaw<const D: usize, const M: usize>: Send + Sync {
    /// A boundary condition, without the data that it takes at a point; those come as `data` below.
    type Boundary: Copy + Send + Sync;

    /// Whether F_v is present. Without it no gradients are computed.
    fn is_viscous(&self) -> bool;

    /// F_c(u) - u v - F_v(u, grad u). `gradient` is not read where the law is not viscous.
    fn flux<T: Over<G>, G: Real>(&self, u: &[T; M], gradient: &[[T; M]; D], v: &[G; D]) -> [[T; M]; D];

    /// F_v(u, gradient), linear in `gradient`.
    fn viscous_flux<T: Real>(&self, u: &[T; M], gradient: &[[T; M]; D]) -> [[T; M]; D];

    /// The flux, times length squared, that evens out a jump `slope` of the normal derivative of the state between two cells. It acts on
    /// what [`Self::viscous_flux`] does not diffuse, and its speed tends to zero with the viscosity. `mean` is the mean state, `sigma` the
    /// penalty of (sip), an inverse length. Linear in `slope`.
    fn slope_flux<T: Over<G>, G: Real>(&self, mean: &[T; M], slope: &[T; M], sigma: G) -> [T; M];

    /// The numerical flux between two states on a facet whose normal velocity is `v_n`: consistent with
    /// F_c(u) . n - v_n u, and antisymmetric under exchange of the sides.
    fn numerical_flux<T: Over<G>, G: Real>(&self, minus: &[T; M], plus: &[T; M], n: &[G; D], v_n: G) -> [T; M];

    /// The numbers of data that `condition` takes at a point and time: none, or the components of a prescribed state.
    fn takes_state(&self, condition: Self::Boundary) -> bool;

    /// The state u_b that `condition` imposes: the one at which viscous terms are evaluated and towards which the penalty
    /// pulls. Equal to `minus` where the condition imposes nothing on viscous terms.
    fn boundary_state<T: Over<G>, G: Real>(
        &self,
        condition: Self::Boundary,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M];

    /// The normal inviscid flux through the boundary, relative to the moving facet.
    fn boundary_flux<T: Over<G>, G: Real>(
        &self,
        condition: Self::Boundary,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M];

    /// The normal viscous flux F_v(state, gradient) . n through the boundary, as far as `condition` lets it pass (no heat
    /// through an adiabatic wall, no shear on a symmetry plane). Linear in `gradient`.
    fn boundary_viscous_flux<T: Over<G>, G: Real>(
        &self,
        condition: Self::Boundary,
        state: &[T; M],
        gradient: &[[T; M]; D],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M];

    /// The velocity of the boundary itself where the mesh moves with `v`: another one where a wall slides in its own plane.
    #[inline(always)]
    fn boundary_velocity<G: Real>(&self, _condition: Self::Boundary, _n: &[G; D], v: &[G; D]) -> [G; D] {
        *v
    }

    /// The momentum of a state or of a flux: forces on boundaries, their moments and their work are made of it. Zero where the
    /// law conserves no momentum.
    #[inline(always)]
    fn momentum<T: Real>(&self, u: &[T; M]) -> [T; D] {
        [u[0].zero(); D]
    }

    /// The energy of a state or of a flux: heat through boundaries is made of it. Zero where the law conserves no energy.
    #[inline(always)]
    fn energy<T: Real>(&self, u: &[T; M]) -> T {
        u[0].zero()
    }

    /// A number that is positive exactly where `u` is admissible (the smaller of density and pressure, say).
    #[inline(always)]
    fn admissibility<T: Real>(&self, u: &[T; M]) -> T {
        u[0].constant(1.0)
    }

    /// What makes `u` inadmissible, if anything: the name of the quantity and its value.
    fn inadmissible(&self, _u: &[f64; M]) -> Option<(&'static str, f64)> {
        None
    }

    /// Positive sizes that make the components comparable: a residual component is divided by its scale in norms.
    fn scales(&self) -> [f64; M];
}
