//! The state at the start of a run.

use fem::{Sampler, SlabOperator, StateField};
use std::array::from_fn;

/// Nodes are looked at so far inside of their cell, too, in units of half of the cell.
const INSIDE: f64 = 1e-6;

/// A component that changes by more than this on that way jumps, relative to its scale and its value.
const JUMP: f64 = 1e-3;

/// The state at time `t` at the nodes of every cell, on the mesh in the position last set at the bottom of a slab (at first the
/// reference position); laid out at one time.
///
/// Where the state jumps at a node, the value is the one inside of the cell. So a jump between two cells leaves both of them smooth.
pub fn interpolate<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    field: &dyn StateField<D, M>,
    t: f64,
) -> Vec<f64> {
    let (layout, orders) = (operator.layout.at_one_time(), operator.tables.orders);
    let nodes = basis::gauss_lobatto(orders.flow).points;
    let inside: Vec<f64> = nodes.iter().map(|x| (1.0 - INSIDE) * x).collect();
    let [at_nodes, inside] = [&nodes, &inside].map(|points| Sampler::<D>::new(orders.flow, orders.mesh, points));
    let scales = operator.problem.kernels.scales();
    let (n, row) = (layout.nodes, operator.tables.bottom_row());
    let mut position = vec![0.0; operator.mesh.slot_len()];
    let mut u = vec![0.0; layout.len()];
    for cell in 0..layout.cells {
        operator.mesh.positions(cell, row.row(0), &mut position);
        let [x, within] = [&at_nodes, &inside].map(|sampler| sampler.positions(&position));
        for i in 0..n {
            let [state, within] = [&x, &within].map(|x| field.value(&from_fn(|d| x[d * n + i]), t));
            let jumps = (0..M).any(|m| (state[m] - within[m]).abs() > JUMP * (scales[m] + state[m].abs()));
            let state = if jumps { within } else { state };
            (0..M).for_each(|m| u[layout.index(cell, 0, m, i)] = state[m]);
        }
    }
    u
}
