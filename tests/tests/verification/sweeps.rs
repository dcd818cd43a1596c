//! The preconditioner by blocks.

use crate::lines::uniform_flow;
use basis::{RadauTime, TemporalModes};
use coupled::preconditioner::FlowPreconditioner;
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Viscosity};
use verification::{Noise, relative_difference};

/// |P^{-1} B x - x| / |x| in a row of three cells. A uniform flow has one Jacobian at all times, and a row of cells no fill that could be
/// discarded: P is B but for the bits in which blocks are stored.
fn error<const D: usize, const M: usize>(orders: Orders, viscosity: Viscosity, dt: f64) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let cells = std::array::from_fn(|d| if d == 0 { 3 } else { 1 });
    let (mut operator, state) = uniform_flow::<D, M>(cells, orders, viscosity, dt);
    operator.linearise(&state);
    let r = Noise::new(7).vector(operator.layout.len(), 1.0);
    let (mut x, mut found) = (vec![0.0; r.len()], vec![0.0; r.len()]);
    let modes = TemporalModes::new(&RadauTime::new(orders.time));
    let mut sweeps = FlowPreconditioner::new(operator.layout, modes, operator.space_jacobian(0.5), dt, 0.0, None);
    sweeps.apply(&r, &mut x);
    operator.product(&x, &mut found);
    relative_difference(&found, &r)
}

/// Blocks of even and of odd order, real and complex modes, slabs short and long beside a cell.
#[test]
fn sweeps_invert_what_they_are_made_of() {
    let viscous = Viscosity::Constant(0.02);
    for dt in [0.01, 1.0] {
        let of = |flow, time| Orders { flow, mesh: 2, time };
        for (name, error) in [
            ("2-D, viscous", error::<2, 4>(of(4, 3), viscous, dt)),
            ("2-D, order 8", error::<2, 4>(of(8, 2), viscous, dt)),
            ("3-D, odd", error::<3, 5>(of(3, 3), Viscosity::Inviscid, dt)),
            ("3-D, viscous", error::<3, 5>(of(3, 1), viscous, dt)),
        ] {
            println!("{name}, dt = {dt}: {error:.1e}");
        }
    }
}
