//! The loads of the flow on walls: their work, their sum, their derivatives.

use crate::slab_operator::{Operator, moving_slab, perturbed};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{AdiabaticWall, Boundary, Compiled, Exact, NavierStokes, Riemann, SlipWall, Viscosity};
use verification::Noise;

/// A slab with walls around it that all are loaded, a state in it and the velocities of its mesh.
fn loaded_slab<const D: usize, const M: usize>(
    orders: Orders,
    wall: Boundary<D>,
) -> (Operator<D, M>, Vec<f64>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, uniform) = moving_slab::<D, M>(orders, Viscosity::Constant(0.02), Riemann::Roe, 2, wall);
    operator.load_boundaries(&vec![true; operator.problem.kernels.boundaries()]);
    let velocities = Noise::new(7).vector(operator.mesh.field_len() * orders.time, 0.2);
    operator.set_mesh(&velocities);
    let (state, _) = perturbed(&uniform, 4);
    (operator, state, velocities)
}

fn residual<const D: usize, const M: usize>(operator: &mut Operator<D, M>, state: &[f64]) -> Vec<f64> {
    let mut r = vec![0.0; state.len()];
    operator.residual(state, &mut r).unwrap();
    operator.loads().to_vec()
}

/// The sum of loads times velocities is the work of the walls, and the sum of loads their impulse.
fn assert_work_and_impulse<const D: usize, const M: usize>(orders: Orders, wall: Boundary<D>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state, velocities) = loaded_slab::<D, M>(orders, wall);
    let loads = residual(&mut operator, &state);
    let nodes = operator.loaded_nodes();
    let length = operator.mesh.field_len();
    let (mut work, mut impulse, mut size) = (0.0, [0.0; D], 0.0);
    for (point, loads) in operator.tables.time_points.iter().zip(loads.chunks_exact(nodes.len() * D)) {
        let phi = operator.tables.time.values(point.s);
        for (node, load) in nodes.iter().zip(loads.chunks_exact(D)) {
            for d in 0..D {
                let v: f64 = (0..orders.time).map(|a| phi[a] * velocities[a * length + node * D + d]).sum();
                let power = load[d] * v;
                work += power;
                size += power.abs();
                impulse[d] += load[d];
            }
        }
    }
    let mut expected = (0.0, [0.0; D]);
    for at in operator.boundary_fluxes(None) {
        for flux in &at.boundaries {
            expected.0 += at.weight * flux.work;
            (0..D).for_each(|d| expected.1[d] += at.weight * flux.total()[1 + d]);
        }
    }
    assert!(size > 1e-3 && (work - expected.0).abs() <= 1e-14 * size, "{orders:?}, {wall:?}: {work}, {expected:?}");
    let error = (0..D).map(|d| (impulse[d] - expected.1[d]).abs()).fold(0.0, f64::max);
    assert!(error <= 1e-14 * (1.0 + size), "{orders:?}, {wall:?}: {error:e}");
}

#[test]
fn what_the_loads_do_to_the_mesh_is_the_work_of_the_walls() {
    for (flow, mesh, time) in [(3, 3, 2), (2, 4, 3), (5, 3, 1)] {
        let orders = Orders { flow, mesh, time };
        assert_work_and_impulse::<2, 4>(orders, Boundary::SlipWall(SlipWall));
        assert_work_and_impulse::<2, 4>(orders, Boundary::AdiabaticWall(AdiabaticWall::new([0.0; 2]).unwrap()));
    }
    let orders = Orders { flow: 3, mesh: 2, time: 2 };
    assert_work_and_impulse::<3, 5>(orders, Boundary::SlipWall(SlipWall));
    assert_work_and_impulse::<3, 5>(orders, Boundary::AdiabaticWall(AdiabaticWall::new([0.0; 3]).unwrap()));
}

/// The largest difference between the derivative of the loads and a central difference, relative to the derivative.
fn derivative_error<const D: usize, const M: usize>(orders: Orders, wall: Boundary<D>, with_mesh: bool) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state, velocities) = loaded_slab::<D, M>(orders, wall);
    let mut noise = Noise::new(11);
    let x = noise.vector(state.len(), 1.0);
    let w = noise.vector(velocities.len(), if with_mesh { 1.0 } else { 0.0 });
    operator.linearise(&state);
    let mut out = vec![0.0; state.len()];
    if with_mesh {
        operator.product_with_mesh(&x, &w, &mut out);
    } else {
        operator.product(&x, &mut out);
    }
    let product = operator.loads().to_vec();
    let step = 1e-5;
    let moved = |v: &[f64], w: &[f64], a: f64| -> Vec<f64> { v.iter().zip(w).map(|(v, w)| v + a * w).collect() };
    let mut at = |a: f64| {
        operator.set_mesh(&moved(&velocities, &w, a));
        residual(&mut operator, &moved(&state, &x, a))
    };
    let (plus, minus) = (at(step), at(-step));
    let size = product.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
    let difference = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * step));
    product.iter().zip(difference).fold(0.0, |m: f64, (p, d)| m.max((p - d).abs())) / size
}

#[test]
fn derivatives_of_the_loads_match_differences() {
    for with_mesh in [false, true] {
        for wall in [Boundary::SlipWall(SlipWall), Boundary::AdiabaticWall(AdiabaticWall::new([0.0; 2]).unwrap())] {
            let error = derivative_error::<2, 4>(Orders { flow: 3, mesh: 4, time: 2 }, wall, with_mesh);
            assert!(error < 1e-7, "2-D, {wall:?}, with mesh: {with_mesh}: {error:e}");
        }
        let wall = Boundary::AdiabaticWall(AdiabaticWall::new([0.0; 3]).unwrap());
        let error = derivative_error::<3, 5>(Orders { flow: 2, mesh: 3, time: 2 }, wall, with_mesh);
        assert!(error < 1e-7, "3-D, with mesh: {with_mesh}: {error:e}");
    }
}
