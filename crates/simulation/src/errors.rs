//! Errors of the flow at the time reached, where the exact flow is known.

use super::crew::look_at_last_slab;
use case::{Flow, State};
use coupled::FlowMarch;
use fem::{StateField, squared_errors_of_cells};
use navier_stokes::{Conserved, Exact};
use newton_krylov::inner_product::largest;
use output::ErrorNorms;

/// Whether something is known of the exact flow.
pub fn are_known<const D: usize>(flow: &Flow<D>) -> bool {
    flow.exact.is_some() || flow.free_stream().is_some()
}

/// For every cell the squared L2 errors of the components, and the largest difference of a coefficient from the free stream; 0 where they are
/// not known: `[cell][M + 1]` on rank 0. A collective call.
pub fn of_cells<const D: usize, const M: usize>(flow: &Flow<D>, march: &mut FlowMarch<D, M>) -> Vec<f64> {
    look_at_last_slab(march);
    let (operator, state) = (&march.solver.system.flow.operator, &march.state);
    let row = if state.slab == 0 { operator.tables.bottom_row() } else { operator.top_row() };
    let squares = match &flow.exact {
        Some(exact) => squared_errors_of_cells(operator, &state.u, row.row(0), &Exact(exact.clone()), state.time),
        None => vec![[0.0; M]; operator.layout.cells],
    };
    let stream = flow.free_stream().map(|stream| Exact(stream.clone()).value(&[0.0; D], 0.0));
    let layout = operator.layout.at_one_time();
    let deviation = |cell: usize| {
        let differs = |stream: &[f64; M]| {
            let numbers = layout.cell(cell).map(|i| (state.u[i] - stream[layout.component_of(i)]).abs());
            largest(numbers)
        };
        stream.as_ref().map_or(0.0, differs)
    };
    let of_cell = |(cell, squares): (usize, &[f64; M])| squares.iter().copied().chain([deviation(cell)]).collect();
    let numbers: Vec<Vec<f64>> = squares.iter().enumerate().map(of_cell).collect();
    operator.share.join(&numbers.concat())
}

/// The L2 norms of the errors of [`of_cells`].
pub fn norms<const D: usize, const M: usize>(of_cells: &[f64], norms: &mut ErrorNorms) {
    let mut squares = [0.0; M];
    for cell in of_cells.chunks_exact(M + 1) {
        squares.iter_mut().zip(cell).for_each(|(sum, square)| *sum += square);
    }
    let squares = Conserved::<f64, D>::unpack(&squares);
    norms.density_l2 = Some(squares.density.sqrt());
    norms.momentum_l2 = Some(squares.momentum.iter().sum::<f64>().sqrt());
    norms.energy_l2 = Some(squares.energy.sqrt());
}

/// The largest difference of a coefficient from the uniform state `stream`, relative to the largest component of that.
pub fn largest_deviation<const D: usize, const M: usize>(of_cells: &[f64], stream: &State<D>) -> f64 {
    let state: [f64; M] = Exact(stream.clone()).value(&[0.0; D], 0.0);
    let scale = largest(state.map(f64::abs));
    largest(of_cells.chunks_exact(M + 1).map(|cell| cell[M])) / scale
}
