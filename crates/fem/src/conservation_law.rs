//! The interface of a physics to the kernels: point functions without loops, allocation or mesh.

use tensor::{Over, Real};

/// A point of a boundary, as a condition sees it.
#[derive(Clone, Copy, Debug)]
pub struct BoundaryPoint<'a, G, const D: usize, const M: usize> {
    /// The unit normal out of the domain.
    pub normal: &'a [G; D],
    /// The velocity of the mesh.
    pub velocity: &'a [G; D],
    /// The prescribed data at the point; arbitrary for conditions that take none, see [`ConservationLaw::takes_data`].
    pub data: &'a [G; M],
}

/// What a condition imposes at a point of a boundary.
#[derive(Clone, Copy, Debug)]
pub struct Imposed<T, const M: usize> {
    /// The normal inviscid flux, relative to the moving facet.
    pub flux: [T; M],
    /// The state u_b at which viscous terms are evaluated and towards which the penalty pulls. Equal to the state inside where the condition
    /// imposes nothing on viscous terms.
    pub state: [T; M],
}

/// A conservation law of `M` components in `D` dimensions, on a mesh that moves with velocity v:
///
/// ```text
/// d/dt int_K u + int_dK ( F_c(u) - u v - F_v(u, grad u) ) . n = int_K b                                   (claw)
/// ```
///
/// Every method is a pure function of point values, generic in the number type `T` of the state and the number type `G` of
/// the geometry (see [`Over`]). Gradients and fluxes are indexed `[direction][component]`. Normals are of unit length and
/// point from minus to plus, and on the boundary out of the domain.
pub trait ConservationLaw<const D: usize, const M: usize>: Send + Sync {
    /// A boundary condition, without its data at a point; those are passed as `data` below.
    type Boundary: Copy + Send + Sync;

    /// Whether F_v is present. Without it no gradients are computed.
    fn is_viscous(&self) -> bool;

    /// F_c(u) - u v - F_v(u, grad u). `gradient` is not read if the law is not viscous.
    fn flux<T: Over<G>, G: Real>(&self, u: &[T; M], gradient: &[[T; M]; D], v: &[G; D]) -> [[T; M]; D];

    /// Whether the inviscid volume terms are those of (split), with [`Self::two_point_flux`]. They need points that are the nodes.
    fn is_split(&self) -> bool {
        false
    }

    /// f# of (split): a flux through the area vector `area` between two states, relative to a mesh that moves through it by `grid_flux`,
    /// volume per time. Consistent with F_c(u) . area - grid_flux u, and symmetric. By default the mean of both.
    #[inline(always)]
    fn two_point_flux<T: Over<G>, G: Real>(&self, a: &[T; M], b: &[T; M], area: &[G; D], grid_flux: G) -> [T; M] {
        let zero = [area[0].zero(); D];
        let [of_a, of_b] = [a, b].map(|u| self.flux(u, &[[u[0].zero(); M]; D], &zero));
        let mut mean = *a;
        for m in 0..M {
            mean[m] = (a[m] + b[m]).scale(-grid_flux);
            for k in 0..D {
                mean[m] = (of_a[k][m] + of_b[k][m]).scale_add(area[k], mean[m]);
            }
            mean[m] = mean[m] * 0.5;
        }
        mean
    }

    /// Whether cells have the viscosity of (entropy viscosity), see the module `entropy_viscosity`. It needs points that are the nodes,
    /// and the law to know an entropy S.
    #[inline(always)]
    fn corrects_entropy(&self) -> bool {
        false
    }

    /// The entropy variables v = S'(u) of an entropy S, which is convex.
    #[inline(always)]
    fn entropy_variables<T: Real>(&self, u: &[T; M]) -> [T; M] {
        [u[0].zero(); M]
    }

    /// Psi = v . F_c - F_S, `[direction]`, with the flux F_S of the entropy, and phi = v . u - S > 0.
    #[inline(always)]
    fn entropy_potential<T: Real>(&self, u: &[T; M]) -> ([T; D], T) {
        ([u[0].zero(); D], u[0].constant(1.0))
    }

    /// H grad v with H = du/dv: the gradient of a state whose entropy variables have the `gradient`.
    #[inline(always)]
    fn gradient_by_entropy<T: Real>(&self, _u: &[T; M], gradient: &[[T; M]; D]) -> [[T; M]; D] {
        *gradient
    }

    /// The speed of signals relative to the medium, for x_0 of (entropy viscosity).
    #[inline(always)]
    fn signal_speed<T: Real>(&self, u: &[T; M]) -> T {
        u[0].constant(1.0)
    }

    /// F_v(u, gradient), linear in `gradient`.
    fn viscous_flux<T: Real>(&self, u: &[T; M], gradient: &[[T; M]; D]) -> [[T; M]; D];

    /// Whether there is an artificial viscosity, (artificial). Viscous laws only.
    #[inline(always)]
    fn captures_shocks(&self) -> bool {
        false
    }

    /// beta(u, grad u), the artificial viscosity at a point. `grid[axis][direction]` counts distances between nodes along an axis of the
    /// cell, per length.
    #[inline(always)]
    fn artificial_viscosity<T: Over<G>, G: Real>(&self, u: &[T; M], _gradient: &[[T; M]; D], _grid: &[[G; D]; D]) -> T {
        u[0].zero()
    }

    /// F_a(u, gradient; beta), linear in `gradient` and in the `viscosity` beta.
    #[inline(always)]
    fn artificial_flux<T: Real>(&self, u: &[T; M], _gradient: &[[T; M]; D], _viscosity: T) -> [[T; M]; D] {
        [[u[0].zero(); M]; D]
    }

    /// A flux, times length squared, that reduces a jump `slope` of the normal derivative of the state between two cells. It acts on
    /// quantities that [`Self::viscous_flux`] does not diffuse, and its speed tends to zero with the viscosity. `mean` is the mean state,
    /// `sigma` the penalty of (sip), an inverse length. Linear in `slope`.
    fn slope_flux<T: Over<G>, G: Real>(&self, mean: &[T; M], slope: &[T; M], sigma: G) -> [T; M];

    /// The numerical flux between two states on a facet whose normal velocity is `v_n`: consistent with
    /// F_c(u) . n - v_n u, and antisymmetric under exchange of the sides.
    fn numerical_flux<T: Over<G>, G: Real>(&self, minus: &[T; M], plus: &[T; M], n: &[G; D], v_n: G) -> [T; M];

    /// Whether `condition` takes data at every point and time. The law says what they mean: a state, or numbers from which the condition
    /// computes a state.
    fn takes_data(&self, condition: Self::Boundary) -> bool;

    /// What `condition` imposes where the state inside is `minus`.
    fn impose<T: Over<G>, G: Real>(
        &self,
        condition: Self::Boundary,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> Imposed<T, M>;

    /// The normal viscous flux F_v(state, gradient) . n through the boundary, without the part that `condition` blocks
    /// (heat at an adiabatic wall, shear at a symmetry plane). Linear in `gradient`.
    fn boundary_viscous_flux<T: Over<G>, G: Real>(
        &self,
        condition: Self::Boundary,
        state: &[T; M],
        gradient: &[[T; M]; D],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M];

    /// The same for F_a(state, gradient; beta) . n.
    #[inline(always)]
    fn boundary_artificial_flux<T: Over<G>, G: Real>(
        &self,
        _condition: Self::Boundary,
        state: &[T; M],
        _gradient: &[[T; M]; D],
        _viscosity: T,
        _at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        [state[0].zero(); M]
    }

    /// The velocity of the boundary itself. It differs from the velocity of the mesh for a wall that slides in its own plane.
    #[inline(always)]
    fn boundary_velocity<G: Real>(&self, _condition: Self::Boundary, at: BoundaryPoint<'_, G, D, M>) -> [G; D] {
        *at.velocity
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

    /// b, made of the `data` that are given at the point: by default they are b.
    #[inline(always)]
    fn source<T: Over<G>, G: Real>(&self, _u: &[T; M], data: &[G; M]) -> [T; M] {
        data.map(T::lift)
    }

    /// A number that is positive exactly if `u` is admissible (for example the smaller of density and pressure).
    #[inline(always)]
    fn admissibility<T: Real>(&self, u: &[T; M]) -> T {
        u[0].constant(1.0)
    }

    /// The quantity that makes `u` inadmissible, if any: its name and value.
    fn inadmissible(&self, _u: &[f64; M]) -> Option<(&'static str, f64)> {
        None
    }

    /// Positive scales of the components: in norms a residual component is divided by its scale.
    fn scales(&self) -> [f64; M];
}
