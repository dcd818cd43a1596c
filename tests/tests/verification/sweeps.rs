//! The preconditioner by blocks.

use crate::lines::uniform_flow;
use crate::slab_operator::Operator;
use coupled::preconditioner::{BlockIlu, FactoredModes, TimeScales};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Viscosity};
use newton_krylov::operator::Preconditioner;
use verification::{Noise, relative_difference};

/// A row of three cells, its preconditioner, and the length of its slab.
fn row<const D: usize, const M: usize>(orders: Orders, viscosity: Viscosity, dt: f64) -> (Operator<D, M>, BlockIlu<f32>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let cells = std::array::from_fn(|d| if d == 0 { 3 } else { 1 });
    let (mut operator, state) = uniform_flow::<D, M>(cells, orders, viscosity, dt);
    operator.linearise(&state);
    let sweeps = BlockIlu::new(&operator, TimeScales { dt, damping: 0.0 }, None);
    (operator, sweeps)
}

/// |B P^{-1} r - r| / |r| in a row of cells. A uniform flow has one Jacobian at all times, and a row has no fill that could be discarded. So P equals B except for the bits in which blocks are stored.
fn error<const D: usize, const M: usize>(orders: Orders, viscosity: Viscosity) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, mut sweeps) = row::<D, M>(orders, viscosity, 0.01);
    let r = Noise::new(7).vector(operator.layout.len(), 1.0);
    let (mut x, mut found) = (vec![0.0; r.len()], vec![0.0; r.len()]);
    sweeps.apply(&r, &mut x);
    operator.product(&x, &mut found);
    relative_difference(&found, &r)
}

const VISCOUS: Viscosity = Viscosity::Constant(0.02);

/// Blocks of even and of odd order, real and complex modes.
#[test]
fn sweeps_invert_what_they_are_made_of() {
    let of = |flow, time| Orders { flow, mesh: 2, time };
    for (name, bar, error) in [
        ("2-D, viscous", 0.05, error::<2, 4>(of(4, 3), VISCOUS)),
        ("2-D, order 8", 0.25, error::<2, 4>(of(8, 2), VISCOUS)),
        ("3-D, odd", 0.05, error::<3, 5>(of(3, 3), Viscosity::Inviscid)),
        ("3-D, viscous", 0.05, error::<3, 5>(of(3, 1), VISCOUS)),
    ] {
        assert!(error < bar, "{name}: {error:.1e}");
    }
}

/// The ends of a row cause no fill. They once came last: a sum over no pair of neighbours is -0, which as bits is large.
#[test]
fn what_leaves_no_fill_is_eliminated_first() {
    let (_, sweeps) = row::<2, 4>(Orders { flow: 2, mesh: 2, time: 1 }, VISCOUS, 1.0);
    assert_eq!(sweeps.ordering().cells, [0, 1, 2]);
}
