//! Boundary conditions, imposed weakly.
//!
//! Each condition implements the methods of [`Condition`]. On walls and symmetry planes no Riemann problem is solved: the
//! inviscid flux is by default the flux of the state u_b(u-) at which the viscous terms are evaluated; see [`WallFlux`]. The residual there depends on the
//! inner state only through u_b and the gradient. This makes the scheme and functionals like lift adjoint consistent
//! (Hartmann 2007). If gas may cross, inflow and outflow take F_c(u_b), where u_b is made of data and of the invariants that
//! leave. The far field and prescribed states leave that choice to the Riemann solver.
//!
//! The values of a condition are numbers, or vary with position and time: see [`given`].
//!
//! For every condition, data replace entropy and tangential velocity exactly where gas enters: see [`opening`].

mod adiabatic_wall;
mod far_field;
mod given;
mod inflow;
mod isothermal_wall;
mod no_slip;
mod opening;
mod outflow;
mod prescribed_state;
mod problem;
mod slip_wall;
mod supersonic_inflow;
mod velocity_inflow;
mod wall_pressure;

pub use adiabatic_wall::AdiabaticWall;
pub use far_field::FarField;
pub use inflow::Inflow;
pub use isothermal_wall::IsothermalWall;
pub use outflow::Outflow;
pub use prescribed_state::PrescribedState;
pub use slip_wall::SlipWall;
pub use supersonic_inflow::SupersonicInflow;
pub use velocity_inflow::VelocityInflow;
pub use wall_pressure::WallFlux;

use crate::flux::Stresses;
use crate::law::NavierStokes;
use fem::BoundaryPoint;
use problem::{BoundaryProblem, InviscidProblem};
use tensor::{Over, Real};

/// The interface of a boundary condition; [`fem::ConservationLaw`] describes the arguments.
pub(crate) trait Condition<const D: usize> {
    /// u_b, and the problem that the inviscid flux solves.
    fn problem<T: Over<G>, G: Real, const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
    ) -> BoundaryProblem<T, G, D, M>;

    /// F_v . n through the boundary: `stresses` and heat of u_b with the gradient inside, unless the condition imposes others.
    #[inline(always)]
    fn viscous_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        let BoundaryPoint { normal: n, .. } = at;
        stresses.normal_flux(n)
    }

    /// The same for F_a.
    #[inline(always)]
    fn artificial_flux<T: Over<G>, G: Real, const M: usize>(
        &self,
        stresses: &Stresses<T, D>,
        at: BoundaryPoint<'_, G, D, M>,
    ) -> [T; M] {
        self.viscous_flux(stresses, at)
    }

    /// The velocity of the boundary: the velocity of the mesh, unless the boundary slides in its own plane.
    #[inline(always)]
    fn velocity<G: Real, const M: usize>(&self, at: BoundaryPoint<'_, G, D, M>) -> [G; D] {
        *at.velocity
    }

    /// Whether the condition takes data at every point.
    #[inline(always)]
    fn takes_data(&self) -> bool {
        false
    }
}

/// A boundary condition of the gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary<const D: usize> {
    /// A free stream far away.
    FarField(FarField<D>),
    /// A state prescribed as a function of position and time.
    PrescribedState(PrescribedState),
    /// An adiabatic no-slip wall.
    AdiabaticWall(AdiabaticWall<D>),
    /// A no-slip wall of given temperature.
    IsothermalWall(IsothermalWall<D>),
    /// A frictionless wall.
    SlipWall(SlipWall),
    /// A plane of symmetry: the condition of a slip wall, but no body.
    Symmetry(SlipWall),
    /// Subsonic inflow of given total pressure, total temperature and direction.
    Inflow(Inflow<D>),
    /// Outflow to a given static pressure; nothing is imposed where it is supersonic.
    Outflow(Outflow<D>),
    /// Subsonic inflow of given velocity, or mass flux, and temperature.
    VelocityInflow(VelocityInflow),
    /// Supersonic inflow of a given state.
    SupersonicInflow(SupersonicInflow),
}

/// Calls the same method on whichever condition `$boundary` holds.
macro_rules! each {
    ($boundary:expr, $condition:ident => $call:expr) => {
        match $boundary {
            Boundary::FarField($condition) => $call,
            Boundary::PrescribedState($condition) => $call,
            Boundary::AdiabaticWall($condition) => $call,
            Boundary::IsothermalWall($condition) => $call,
            Boundary::SlipWall($condition) | Boundary::Symmetry($condition) => $call,
            Boundary::Inflow($condition) => $call,
            Boundary::Outflow($condition) => $call,
            Boundary::VelocityInflow($condition) => $call,
            Boundary::SupersonicInflow($condition) => $call,
        }
    };
}

/// Methods of [`Boundary`] that call the same method of the condition, with numbers T of the state and G of the geometry.
macro_rules! forwarded {
    ($($method:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {$(
        #[inline(always)]
        pub(crate) fn $method<T: Over<G>, G: Real, const M: usize>(
            &self,
            $($argument: $type,)*
            at: BoundaryPoint<'_, G, D, M>,
        ) -> $result {
            each!(self, condition => condition.$method($($argument,)* at))
        }
    )*};
}

impl<const D: usize> Boundary<D> {
    /// Whether the condition takes data at every point: a state, or a pressure, a vector and a temperature.
    #[inline(always)]
    pub fn takes_data(&self) -> bool {
        each!(self, condition => Condition::<D>::takes_data(condition))
    }

    /// Whether the boundary is the surface of a body, on which forces are evaluated.
    #[inline(always)]
    pub fn is_wall(&self) -> bool {
        matches!(self, Boundary::AdiabaticWall(_) | Boundary::IsothermalWall(_) | Boundary::SlipWall(_))
    }

    /// Whether no gas passes the boundary: walls and planes of symmetry.
    pub fn is_solid(&self) -> bool {
        self.is_wall() || matches!(self, Boundary::Symmetry(_))
    }

    /// Whether gas slips along the boundary, and does not pass it.
    pub fn is_slip(&self) -> bool {
        matches!(self, Boundary::SlipWall(_) | Boundary::Symmetry(_))
    }

    /// Whether gas sticks to the boundary.
    pub fn is_no_slip(&self) -> bool {
        matches!(self, Boundary::AdiabaticWall(_) | Boundary::IsothermalWall(_))
    }

    /// The state that the condition asks for where the gas inside has the state `minus`. A flow that follows the condition has this very
    /// state.
    pub fn target_state<const M: usize>(
        &self,
        law: &NavierStokes<D>,
        minus: &[f64; M],
        at: BoundaryPoint<'_, f64, D, M>,
    ) -> [f64; M] {
        self.problem(law, minus, at).target_state(law, minus)
    }

    forwarded! {
        problem(law: &NavierStokes<D>, minus: &[T; M]) -> BoundaryProblem<T, G, D, M>;
        viscous_flux(stresses: &Stresses<T, D>) -> [T; M];
        artificial_flux(stresses: &Stresses<T, D>) -> [T; M];
    }

    #[inline(always)]
    pub(crate) fn velocity<G: Real, const M: usize>(&self, at: BoundaryPoint<'_, G, D, M>) -> [G; D] {
        each!(self, condition => condition.velocity(at))
    }
}

/// The zero flux, in the number type of `like`.
#[inline(always)]
fn zero_flux<T: Real, const M: usize>(like: T) -> [T; M] {
    [like.zero(); M]
}
