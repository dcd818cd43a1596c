//! The operator on the control volumes of the nodes, and the preconditioner made of it.

use crate::lines::uniform_flow;
use coupled::preconditioner::{TimeScales, low_order};
use fem::{NO_NEIGHBOUR, Neighbours, Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Viscosity};
use verification::Noise;

const ORDERS: Orders = Orders { flow: 4, mesh: 2, time: 2 };
const CELLS: usize = 3;

/// An increment that is linear in space, `[cell][component][node]`, along a direction of the state that varies with the component.
fn linear_increment<const D: usize, const M: usize>(operator: &crate::slab_operator::Operator<D, M>) -> Vec<f64> {
    let one = operator.layout.at_one_time();
    let nodes = basis::Lagrange::gauss_lobatto(ORDERS.flow).nodes().to_vec();
    let mut x = vec![0.0; one.len()];
    for (cell, m, i) in (0..one.cells).flat_map(|c| (0..M).flat_map(move |m| (0..one.nodes).map(move |i| (c, m, i)))) {
        let place = |axis: usize| {
            let cell = cell / CELLS.pow(axis as u32) % CELLS;
            cell as f64 + 0.5 * (1.0 + nodes[i / ORDERS.flow.pow(axis as u32) % ORDERS.flow])
        };
        let sum: f64 = (0..D).map(|axis| (1.0 + 0.3 * axis as f64 - 0.2 * m as f64) * place(axis)).sum();
        x[one.index(cell, 0, m, i)] = 0.1 + sum;
    }
    x
}

/// The sum of A x over the nodes of the middle cell, for each component.
fn sums_of_low_order<const D: usize, const M: usize>(
    operator: &crate::slab_operator::Operator<D, M>,
    x: &[f64],
    cell: usize,
) -> Vec<f64> {
    let (one, neighbours) = (operator.layout.at_one_time(), Neighbours::of(operator));
    let (n, nodes) = (ORDERS.flow, one.nodes);
    let state = |number: usize, m: usize| x[one.index(number / nodes, 0, m, number % nodes)];
    operator.low_order(0.5).with_rows(cell, |rows| {
        let mut sums = vec![0.0; M];
        let mut add = |block: &[f64], number: usize| {
            for (entry, value) in block.iter().enumerate() {
                sums[entry % M] += value * state(number, entry / M);
            }
        };
        for node in 0..nodes {
            let own = cell * nodes + node;
            add(&rows.diagonal[node * M * M..][..M * M], own);
            for face in 0..2 * D {
                let stride = n.pow(face as u32 / 2);
                let inside = node / stride % n != face % 2 * (n - 1);
                let on_face = node % stride + node / stride / n * stride;
                let across = neighbours.nodes[(cell * 2 * D + face) * nodes / n + on_face];
                let step = if face % 2 == 0 { own.wrapping_sub(stride) } else { own + stride };
                let other = if inside { step } else { across as usize };
                if inside || across != NO_NEIGHBOUR {
                    add(&rows.couplings[(node * 2 * D + face) * M * M..][..M * M], other);
                }
            }
        }
        sums
    })
}

/// What leaves a cell is the same in both operators where states do not jump: interior faces cancel, and the nodes integrate linear fluxes
/// exactly.
fn check_sums<const D: usize, const M: usize>()
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let dt = 0.1;
    let (mut operator, state) = uniform_flow::<D, M>([CELLS; D], ORDERS, Viscosity::Inviscid, dt);
    operator.linearise(&state);
    let (layout, x) = (operator.layout, linear_increment(&operator));
    let middle = layout.cells / 2;
    let expected = sums_of_low_order(&operator, &x, middle);
    // The increment is the same at all times. Of the terms in time only the moments at the bottom are left, and they are subtracted.
    let slab: Vec<f64> =
        (0..layout.cells).flat_map(|cell| x[layout.at_one_time().cell(cell)].repeat(layout.time_order)).collect();
    let mut product = vec![0.0; layout.len()];
    operator.product(&slab, &mut product);
    let mut moments = vec![0.0; x.len()];
    operator.mass_product(&x, fem::SlabEnd::Bottom, &mut moments);
    for m in 0..M {
        let at = |a: usize, i: usize| product[layout.index(middle, a, m, i)];
        let sum: f64 =
            (0..layout.time_order).flat_map(|a| (0..layout.nodes).map(move |i| (a, i))).map(|(a, i)| at(a, i)).sum();
        let mass: f64 = (0..layout.nodes).map(|i| moments[layout.at_one_time().index(middle, 0, m, i)]).sum();
        let found = (sum - mass) / dt;
        assert!((found - expected[m]).abs() < 1e-11 * (1.0 + found.abs()), "{D}-D, {m}: {found} {}", expected[m]);
    }
}

#[test]
fn both_operators_move_the_same_through_a_cell() {
    check_sums::<2, 4>();
    check_sums::<3, 5>();
}

/// |r - B P r| / |r| for a random residual: the preconditioner is an approximate inverse, in viscous and inviscid gas.
fn remaining_residual<const D: usize, const M: usize>(viscosity: Viscosity, dt: f64) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state) = uniform_flow::<D, M>([CELLS; D], ORDERS, viscosity, dt);
    operator.linearise(&state);
    let x = Noise::new(3).vector(operator.layout.len(), 1.0);
    let (mut r, mut found) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    operator.product(&x, &mut r);
    low_order(&operator, TimeScales { dt, damping: 0.0 }, None).apply(&r, &mut found);
    let mut left = vec![0.0; x.len()];
    operator.product(&found, &mut left);
    verification::relative_difference(&left, &r)
}

#[test]
fn a_random_residual_shrinks() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        let (plane, space) = (remaining_residual::<2, 4>(viscosity, 0.05), remaining_residual::<3, 5>(viscosity, 0.05));
        assert!(plane < 0.8 && space < 0.8, "{plane:.2} in 2-D, {space:.2} in 3-D");
    }
}
