//! The flow along straight lines.

use super::cell_finder::CellFinder;
use super::cells::StateSource;
use super::probes::{FlowAtPoints, names, state_at};
use case::{FieldFormula, Line};
use fem::parallel::{self, Grain};
use tensor::{AXES, norm};

/// The columns of the file of a line: time, distance from its start, position, fields.
pub fn columns<const D: usize>(line: &Line<D>, formulas: &[FieldFormula]) -> Vec<String> {
    let place = ["t", "s"].into_iter().chain(AXES.into_iter().take(D));
    place.chain(names::<D>(&line.fields, formulas)).map(str::to_owned).collect()
}

/// What does not change with time in the rows of a line, after the time: the distances from the start, and the positions unless the mesh
/// carries them.
pub fn places<const D: usize>(line: &Line<D>) -> Vec<Vec<f64>> {
    let position = |point: &[f64; D]| if line.carried { Vec::new() } else { point.to_vec() };
    line.points.iter().map(|point| [vec![distance(line, point)], position(point)].concat()).collect()
}

/// The distance of a `point` from the start of a line.
fn distance<const D: usize>(line: &Line<D>, point: &[f64; D]) -> f64 {
    norm(&std::array::from_fn::<f64, D, _>(|i| point[i] - line.points[0][i]))
}

/// A row for each point; values are NaN where there is no mesh.
pub fn rows<const D: usize, const M: usize>(
    flow: &FlowAtPoints<D>,
    line: &Line<D>,
    source: &StateSource,
) -> Vec<Vec<f64>> {
    let cells = finder(flow, line.carried);
    let places = parallel::map(line.points.len(), Grain::Any, &|number| cells.find(&line.points[number]));
    let state = state_at(source, &places);
    let count = names::<D>(&line.fields, flow.formulas).count();
    let row = |point: &[f64; D], place: &Option<(usize, [f64; D])>| {
        let s = distance(line, point);
        let (x, values) = match place {
            Some((cell, xi)) => {
                let cell = flow.cell(*cell);
                (if line.carried { cell.position(xi) } else { *point }, cell.values::<M>(&state, xi, &line.fields))
            }
            None => (*point, vec![f64::NAN; count]),
        };
        [&[flow.time, s][..], &x, &values].concat()
    };
    parallel::map(places.len(), Grain::Any, &|number| row(&line.points[number], &places[number]))
}

/// Finds the cells of points, with the cells as they are, or at rest.
fn finder<const D: usize>(flow: &FlowAtPoints<D>, at_rest: bool) -> CellFinder<D> {
    let mesh = &flow.mover.reference;
    let nodes = |cell| if at_rest { mesh.cell_coordinates(cell).to_vec() } else { flow.nodes(cell) };
    CellFinder::of_nodes(mesh.order(), parallel::map(mesh.n_cells(), Grain::Any, &nodes))
}
