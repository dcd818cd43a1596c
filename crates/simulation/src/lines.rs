//! The flow along straight lines.

use super::cell_finder::CellFinder;
use super::cells::StateSource;
use super::probes::{FlowAtPoints, names, state_at};
use case::{FieldFormula, Line};
use rayon::prelude::*;
use tensor::norm;

/// The columns of the file of a line: time, distance from its start, position, fields.
pub fn columns<const D: usize>(line: &Line<D>, formulas: &[FieldFormula]) -> Vec<String> {
    let place = ["t", "s"].into_iter().chain(["x", "y", "z"].into_iter().take(D));
    place.chain(names::<D>(&line.fields, formulas)).map(str::to_owned).collect()
}

/// A row for each point; values are NaN where there is no mesh.
pub fn rows<const D: usize, const M: usize>(
    flow: &FlowAtPoints<D>,
    line: &Line<D>,
    source: &StateSource,
) -> Vec<Vec<f64>> {
    let cells = finder(flow, line.carried);
    let places: Vec<Option<(usize, [f64; D])>> = line.points.par_iter().map(|point| cells.find(point)).collect();
    let state = state_at(source, &places);
    let count = names::<D>(&line.fields, flow.formulas).count();
    let row = |(point, place): (&[f64; D], &Option<(usize, [f64; D])>)| {
        let start = line.points[0];
        let s = norm(&std::array::from_fn::<f64, D, _>(|i| point[i] - start[i]));
        let (x, values) = match place {
            Some((cell, xi)) => {
                let cell = flow.cell(*cell);
                (if line.carried { cell.position(xi) } else { *point }, cell.values::<M>(&state, xi, &line.fields))
            }
            None => (*point, vec![f64::NAN; count]),
        };
        [&[flow.time, s][..], &x, &values].concat()
    };
    line.points.par_iter().zip(&places).map(row).collect()
}

/// Finds the cells of points, with the cells as they are, or at rest.
fn finder<const D: usize>(flow: &FlowAtPoints<D>, at_rest: bool) -> CellFinder<D> {
    let mesh = &flow.mover.reference;
    let nodes = |cell| if at_rest { mesh.cell_coordinates(cell).to_vec() } else { flow.nodes(cell) };
    CellFinder::of_nodes(mesh.order(), (0..mesh.n_cells()).into_par_iter().map(nodes).collect())
}
