//! A uniform flow has no residual on any motion of the mesh.

use super::moving_slab_on;
use fem::{Orders, SlabEnd, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use verification::{RULES, Rule, curved_box, curved_box_at, law, prescribed};

/// The residual of a uniform flow on any motion is round-off, relative to the moments of the state.
fn free_stream_residual<const D: usize, const M: usize>(
    rule: Rule,
    orders: Orders,
    viscosity: Viscosity,
    cells: usize,
) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    free_stream_residual_on::<D, M>(rule, &curved_box(cells, orders.mesh), 0.0, orders, viscosity)
}

/// The same on `mesh`, which has moved by `way` along every axis before.
fn free_stream_residual_on<const D: usize, const M: usize>(
    rule: Rule,
    mesh: &mesh::Mesh<D>,
    way: f64,
    orders: Orders,
    viscosity: Viscosity,
) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state) =
        moving_slab_on::<D, M>(rule, mesh, way, orders, law(viscosity, Riemann::Hllc), prescribed());
    let mut residual = vec![0.0; state.len()];
    operator.residual(&state, &mut residual).unwrap();
    let mut mass_product = vec![0.0; operator.layout.at_one_time().len()];
    operator.mass_product(&state[..mass_product.len()], SlabEnd::Bottom, &mut mass_product);
    let size = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    size(&residual) / size(&mass_product)
}

#[test]
fn free_stream_has_no_residual_in_2d() {
    for (rule, flow, time) in RULES.iter().flat_map(|&rule| each_order(rule, &[2, 3, 4, 6, 8], &[1, 2, 3, 4])) {
        for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.01)] {
            let orders = Orders { flow, mesh: flow, time };
            let residual = free_stream_residual::<2, 4>(rule, orders, viscosity, 3);
            assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_t = {time}, {viscosity:?}: {residual:.1e}");
        }
    }
    // Different orders.
    for (rule, flow, mesh) in RULES.iter().flat_map(|&rule| each_order(rule, &[3, 5], &[2, 3, 4, 5])) {
        let orders = Orders { flow, mesh, time: 2 };
        let residual = free_stream_residual::<2, 4>(rule, orders, Viscosity::Constant(0.01), 3);
        assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_m = {mesh}: {residual:.1e}");
    }
}

fn each_order(rule: Rule, first: &[usize], second: &[usize]) -> Vec<(Rule, usize, usize)> {
    first.iter().flat_map(|&a| second.iter().map(move |&b| (rule, a, b))).collect()
}

#[test]
fn free_stream_has_no_residual_in_3d() {
    for rule in RULES {
        for (flow, mesh, time) in [(2, 2, 1), (3, 3, 2), (4, 4, 3), (3, 4, 4), (5, 3, 2), (8, 8, 1)] {
            let orders = Orders { flow, mesh, time };
            let residual = free_stream_residual::<3, 5>(rule, orders, Viscosity::Constant(0.01), 2);
            assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_m = {mesh}, N_t = {time}: {residual:.1e}");
        }
    }
}

/// Metric terms from absolute positions once lost the digits that these have in common: 1e-7 of the residual at x =
/// 1e6.
#[test]
fn free_stream_has_no_residual_far_from_the_origin() {
    for (rule, (lower, way)) in RULES
        .iter()
        .flat_map(|rule| [(100.0, 0.0), (1e6, 0.0), (-1e6, 0.0), (0.0, 1e6), (0.0, -1e6)].map(|x| (*rule, x)))
    {
        for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.01)] {
            for order in [3, 6] {
                let orders = Orders { flow: order, mesh: order, time: 2 };
                let residual =
                    free_stream_residual_on::<2, 4>(rule, &curved_box_at(lower, 3, order), way, orders, viscosity);
                assert!(
                    residual < 1e-12,
                    "{rule:?}, 2-D, x = {lower} + {way}, N = {order}, {viscosity:?}: {residual:.1e}"
                );
            }
            let orders = Orders { flow: 4, mesh: 4, time: 2 };
            let residual = free_stream_residual_on::<3, 5>(rule, &curved_box_at(lower, 2, 4), way, orders, viscosity);
            assert!(residual < 1e-12, "{rule:?}, 3-D, x = {lower} + {way}, {viscosity:?}: {residual:.1e}");
        }
    }
}
