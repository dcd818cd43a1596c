//! The compressible Navier-Stokes equations as a conservation law.

use crate::boundary::{Boundary, WallFlux};
use crate::entropy;
use crate::flux::{self, Stresses};
use crate::gas::{Gas, Viscosity};
use crate::reference::Reference;
use crate::riemann::Riemann;
use crate::shock_capturing::ShockCapturing;
use crate::source::Source;
use crate::state::{Conserved, Primitive};
use crate::two_point::{self, VolumeFlux};
use fem::{BoundaryPoint, ConservationLaw, Imposed, Kernels, LawKernels};
use tensor::{Over, Real};

/// The law in `D` dimensions: the gas, the numerical flux, and the reference state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavierStokes<const D: usize> {
    /// The gas.
    pub gas: Gas,
    /// The numerical flux of facets and of boundary conditions that prescribe a state.
    pub riemann: Riemann,
    /// The state that sets the scales of the components.
    pub reference: Reference,
    /// The meaning of the source's data.
    pub source: Source<D>,
    /// The inviscid flux inside of cells.
    pub volume_flux: VolumeFlux,
    /// The artificial viscosity of shocks, if there is one.
    pub shock_capturing: Option<ShockCapturing>,
    /// The inviscid flux of walls and planes of symmetry.
    pub wall_flux: WallFlux,
}

impl<const D: usize, const M: usize> ConservationLaw<D, M> for NavierStokes<D> {
    type Boundary = Boundary<D>;

    #[inline(always)]
    fn is_viscous(&self) -> bool {
        self.shock_capturing.is_some() || !matches!(self.gas.viscosity(), Viscosity::Inviscid)
    }

    #[inline(always)]
    fn flux<T: Over<G>, G: Real>(&self, u: &[T; M], gradient: &[[T; M]; D], v: &[G; D]) -> [[T; M]; D] {
        let mut flux = flux::inviscid(&self.gas, u, v);
        if ConservationLaw::<D, M>::is_viscous(self) {
            let viscous = flux::viscous(&self.gas, u, gradient);
            for i in 0..D {
                for c in 0..M {
                    flux[i][c] -= viscous[i][c];
                }
            }
        }
        flux
    }

    #[inline(always)]
    fn is_split(&self) -> bool {
        self.volume_flux.is_split()
    }

    #[inline(always)]
    fn two_point_flux<T: Over<G>, G: Real>(&self, a: &[T; M], b: &[T; M], area: &[G; D], grid_flux: G) -> [T; M] {
        two_point::flux((&self.gas, self.volume_flux), [a, b], area, grid_flux)
    }

    #[inline(always)]
    fn corrects_entropy(&self) -> bool {
        self.volume_flux == VolumeFlux::EntropyViscosity
    }

    #[inline(always)]
    fn entropy_variables<T: Real>(&self, u: &[T; M]) -> [T; M] {
        entropy::variables::<T, D, M>(&self.gas, u)
    }

    #[inline(always)]
    fn entropy_potential<T: Real>(&self, u: &[T; M]) -> ([T; D], T) {
        let Conserved { density, momentum, .. } = Conserved::unpack(u);
        (momentum, density)
    }

    #[inline(always)]
    fn gradient_by_entropy<T: Real>(&self, u: &[T; M], gradient: &[[T; M]; D]) -> [[T; M]; D] {
        entropy::gradient_of_state(&self.gas, u, gradient)
    }

    #[inline(always)]
    fn signal_speed<T: Real>(&self, u: &[T; M]) -> T {
        let Primitive { density, pressure, .. } = Primitive::<T, D>::unpack(&self.gas, u);
        self.gas.sound_speed(density, pressure)
    }

    #[inline(always)]
    fn viscous_flux<T: Real>(&self, u: &[T; M], gradient: &[[T; M]; D]) -> [[T; M]; D] {
        flux::viscous(&self.gas, u, gradient)
    }

    #[inline(always)]
    fn captures_shocks(&self) -> bool {
        self.shock_capturing.is_some()
    }

    #[inline(always)]
    fn artificial_viscosity<T: Over<G>, G: Real>(&self, u: &[T; M], gradient: &[[T; M]; D], grid: &[[G; D]; D]) -> T {
        match self.shock_capturing {
            Some(capturing) => capturing.viscosity(&self.gas, u, gradient, grid),
            None => u[0].zero(),
        }
    }

    #[inline(always)]
    fn artificial_flux<T: Real>(&self, u: &[T; M], gradient: &[[T; M]; D], viscosity: T) -> [[T; M]; D] {
        flux::artificial(&self.gas, u, gradient, viscosity)
    }

    #[inline(always)]
    fn slope_flux<T: Over<G>, G: Real>(&self, mean: &[T; M], slope: &[T; M], sigma: G) -> [T; M] {
        flux::mass_exchange::<T, G, D, M>(&self.gas, mean, slope[0], sigma)
    }

    #[inline(always)]
    fn source<T: Over<G>, G: Real>(&self, u: &[T; M], data: &[G; M]) -> [T; M] {
        self.source.at(u, data)
    }

    #[inline(always)]
    fn numerical_flux<T: Over<G>, G: Real>(&self, minus: &[T; M], plus: &[T; M], n: &[G; D], v_n: G) -> [T; M] {
        self.riemann.flux(&self.gas, minus, plus, n, v_n)
    }

    #[inline(always)]
    fn takes_data(&self, condition: Boundary<D>) -> bool {
        condition.takes_data()
    }

    #[inline(always)]
    fn impose<T: Over<G>, G: Real>(
        &self,
        condition: Boundary<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> Imposed<T, M> {
        let problem = condition.problem(self, minus, at);
        Imposed { flux: problem.inviscid.flux(self, minus, at), state: problem.state }
    }

    #[inline(always)]
    fn boundary_viscous_flux<T: Over<G>, G: Real>(
        &self,
        condition: Boundary<D>,
        state: &[T; M],
        gradient: &[[T; M]; D],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        condition.viscous_flux(&Stresses::new(&self.gas, state, gradient), at)
    }

    #[inline(always)]
    fn boundary_artificial_flux<T: Over<G>, G: Real>(
        &self,
        condition: Boundary<D>,
        state: &[T; M],
        gradient: &[[T; M]; D],
        viscosity: T,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        condition.artificial_flux(&Stresses::artificial(&self.gas, state, gradient, viscosity), at)
    }

    #[inline(always)]
    fn boundary_velocity<G: Real>(&self, condition: Boundary<D>, at: BoundaryPoint<'_, G, D, M>) -> [G; D] {
        condition.velocity(at)
    }

    #[inline(always)]
    fn momentum<T: Real>(&self, u: &[T; M]) -> [T; D] {
        Conserved::unpack(u).momentum
    }

    #[inline(always)]
    fn energy<T: Real>(&self, u: &[T; M]) -> T {
        Conserved::<T, D>::unpack(u).energy
    }

    /// The smaller of density and pressure.
    #[inline(always)]
    fn admissibility<T: Real>(&self, u: &[T; M]) -> T {
        let state = Primitive::<T, D>::unpack(&self.gas, u);
        state.density.min(state.pressure)
    }

    fn inadmissible(&self, u: &[f64; M]) -> Option<(&'static str, f64)> {
        let u = Conserved::<f64, D>::unpack(u);
        let pressure = self.gas.pressure(&u, &u.velocity());
        let quantities = [("density", u.density), ("pressure", pressure)];
        quantities.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0)
    }

    fn scales(&self) -> [f64; M] {
        self.reference.scales(&self.gas)
    }
}

/// A law whose kernels are compiled in this crate, for its dimension.
pub trait Compiled<const D: usize, const M: usize>: ConservationLaw<D, M> + Sized {
    /// The kernels, with a condition for every boundary of the mesh in the order of its names.
    fn kernels(self, conditions: Vec<Self::Boundary>) -> Box<dyn Kernels<D, M>>;
}

impl Compiled<2, 4> for NavierStokes<2> {
    fn kernels(self, conditions: Vec<Boundary<2>>) -> Box<dyn Kernels<2, 4>> {
        Box::new(LawKernels::new(self, conditions))
    }
}

impl Compiled<3, 5> for NavierStokes<3> {
    fn kernels(self, conditions: Vec<Boundary<3>>) -> Box<dyn Kernels<3, 5>> {
        Box::new(LawKernels::new(self, conditions))
    }
}
