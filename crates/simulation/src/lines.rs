//! The flow along straight lines.

use super::probes::{FlowAtPoints, names};
use case::{FieldFormula, Line};
use mesh::locate_in_cell;
use rayon::prelude::*;
use tensor::norm;

/// The columns of the file of a line: time, distance from its start, position, fields.
pub fn columns<const D: usize>(line: &Line<D>, formulas: &[FieldFormula]) -> Vec<String> {
    let place = ["t", "s"].into_iter().chain(["x", "y", "z"].into_iter().take(D));
    place.chain(names::<D>(&line.fields, formulas)).map(str::to_owned).collect()
}

/// A row for each point; values are NaN where there is no mesh.
pub fn rows<const D: usize, const M: usize>(flow: &FlowAtPoints<D>, line: &Line<D>) -> Vec<Vec<f64>> {
    let cells = Cells::new(flow, line.carried);
    let count = names::<D>(&line.fields, flow.formulas).count();
    let row = |point: &[f64; D]| {
        let start = line.points[0];
        let s = norm(&std::array::from_fn::<f64, D, _>(|i| point[i] - start[i]));
        let (x, values) = match cells.locate(point) {
            Some((cell, xi)) => {
                let cell = flow.cell(cell);
                (if line.carried { cell.position(&xi) } else { *point }, cell.values::<M>(&xi, &line.fields))
            }
            None => (*point, vec![f64::NAN; count]),
        };
        [&[flow.time, s][..], &x, &values].concat()
    };
    line.points.par_iter().map(row).collect()
}

/// The cells of a mesh, among which points are sought.
struct Cells<const D: usize> {
    order: usize,
    /// Positions of the nodes of each, `[node][component]`, and the box around them, enlarged by half because curved sides may bulge.
    cells: Vec<(Vec<f64>, [[f64; D]; 2])>,
}

impl<const D: usize> Cells<D> {
    /// The cells as they are, or at rest.
    fn new(flow: &FlowAtPoints<D>, at_rest: bool) -> Self {
        let mesh = &flow.mover.reference;
        let nodes = |cell| if at_rest { mesh.cell_coordinates(cell).to_vec() } else { flow.nodes(cell) };
        let cell = |cell: usize| {
            let nodes = nodes(cell);
            let of = |pick: fn(f64, f64) -> f64, i: usize| nodes.iter().skip(i).step_by(D).copied().reduce(pick);
            let end = |pick, i| of(pick, i).unwrap_or(f64::NAN);
            let margin = |i| 0.5 * (end(f64::max, i) - end(f64::min, i));
            let lower = std::array::from_fn(|i| end(f64::min, i) - margin(i));
            let upper = std::array::from_fn(|i| end(f64::max, i) + margin(i));
            (nodes, [lower, upper])
        };
        Cells { order: mesh.order(), cells: (0..mesh.n_cells()).into_par_iter().map(cell).collect() }
    }

    /// The first cell that contains `x`, and the place there.
    fn locate(&self, x: &[f64; D]) -> Option<(usize, [f64; D])> {
        let is_near = |[lower, upper]: &[[f64; D]; 2]| (0..D).all(|i| (lower[i]..=upper[i]).contains(&x[i]));
        let near = self.cells.iter().enumerate().filter(|(_, (_, around))| is_near(around));
        near.into_iter().find_map(|(cell, (nodes, _))| Some((cell, locate_in_cell(self.order, nodes, x)?)))
    }
}
