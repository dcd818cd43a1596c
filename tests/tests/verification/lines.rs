//! The preconditioner by directions.

use crate::slab_operator::{Operator, uniform_coefficients};
use coupled::preconditioner::{LinePreconditioner, TimeScales};
use fem::{Orders, StateField};
use mesh::{BoxMesh, Curving};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use newton_krylov::operator::Preconditioner;
use verification::{Noise, free_stream, law, operator, prescribed, relative_difference};

const ORDERS: Orders = Orders { flow: 4, mesh: 2, time: 3 };

/// A uniform flow that crosses a box of cells at rest.
pub fn uniform_flow<const D: usize, const M: usize>(
    cells: [usize; D],
    orders: Orders,
    viscosity: Viscosity,
    dt: f64,
) -> (Operator<D, M>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let law = law::<D>(viscosity, Riemann::Roe);
    let upper = std::array::from_fn(|d| 1.0 + 0.3 * d as f64);
    let (lower, periodic) = ([0.0; D], [false; D]);
    let mesh = BoxMesh { lower, upper, cells, order: orders.mesh, curving: Curving::None, periodic }.build().unwrap();
    let data = free_stream::<D, M>(&law);
    let state = data.value(&[0.0; D], 0.0);
    let mut operator = operator(&mesh, law, orders, prescribed(), data);
    let nodes = operator.mesh.field_len();
    let bottom = uniform_coefficients(&operator, &state, 1);
    operator.begin_slab(0.0, dt, fem::Bottom::new(&bottom, &vec![0.0; nodes]));
    operator.set_mesh(&vec![0.0; orders.time * nodes]);
    let state = uniform_coefficients(&operator, &state, orders.time);
    (operator, state)
}

/// x in the middle cell, r = B x there, and |P^{-1} r - x| / |x|. B couples the neighbours to x as well, but P treats cells
/// alone.
fn error<const D: usize, const M: usize>(viscosity: Viscosity, dt: f64) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state) = uniform_flow::<D, M>([3; D], ORDERS, viscosity, dt);
    operator.linearise(&state);
    let layout = operator.layout;
    let middle = layout.cell(layout.cells / 2);
    let mut x = vec![0.0; layout.len()];
    x[middle.clone()].copy_from_slice(&Noise::new(3).vector(middle.len(), 1.0));
    let (mut r, mut found) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    operator.product(&x, &mut r);
    LinePreconditioner::new(&operator, TimeScales { dt, damping: 0.0 }).apply(&r, &mut found);
    relative_difference(&found[middle.clone()], &x[middle])
}

/// The product of one factor per axis differs from their sum by products of operators along two axes: by dt^2. In viscous gas mixed
/// derivatives are neglected as well: dt times the viscosity.
#[test]
fn directions_are_of_second_order() {
    let ratio =
        |error: fn(Viscosity, f64) -> f64, viscosity: Viscosity| error(viscosity, 0.004) / error(viscosity, 0.002);
    for (name, error) in [("2-D", error::<2, 4> as fn(Viscosity, f64) -> f64), ("3-D", error::<3, 5>)] {
        assert!(error(Viscosity::Inviscid, 0.002) < 3e-2, "{name}: {:.1e}", error(Viscosity::Inviscid, 0.002));
        let inviscid = ratio(error, Viscosity::Inviscid);
        assert!((3.5..4.2).contains(&inviscid), "{name}: the error falls by {inviscid:.2} where dt is halved");
        let viscous = ratio(error, Viscosity::Constant(0.02));
        assert!((1.8..4.2).contains(&viscous), "{name}: the error falls by {viscous:.2} where dt is halved");
    }
}
