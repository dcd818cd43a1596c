//! The state at the start of a run.

use fem::{SlabOperator, StateField};

/// The state at time `t` at the nodes of every cell, on the mesh in the position last set at the bottom of a slab (at first the
/// reference position); laid out at one time.
pub fn interpolate<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    field: &dyn StateField<D, M>,
    t: f64,
) -> Vec<f64> {
    let (layout, orders) = (operator.layout.at_one_time(), operator.tables.orders);
    let nodes = basis::gauss_lobatto(orders.flow).points;
    let sampler = fem::Sampler::<D>::new(orders.flow, orders.mesh, &nodes);
    let (n, row) = (layout.nodes, operator.tables.bottom_row());
    let mut position = vec![0.0; operator.mesh.slot_len()];
    let mut u = vec![0.0; layout.len()];
    for cell in 0..layout.cells {
        operator.mesh.positions(cell, row.row(0), &mut position);
        let x = sampler.positions(&position);
        for i in 0..n {
            let state = field.value(&std::array::from_fn(|d| x[d * n + i]), t);
            (0..M).for_each(|m| u[layout.index(cell, 0, m, i)] = state[m]);
        }
    }
    u
}
