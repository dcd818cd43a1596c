//! The flow at points: columns of history.csv.

use super::opening_states::{by_node, dot_of};
use case::{Case, Probe};
use coupled::MeshMover;
use fem::functions_at;
use mesh::locate_in_cell;
use navier_stokes::{Gas, Primitive};

/// The names of the columns.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    let velocity = ["velocity_x", "velocity_y", "velocity_z"];
    let names = || ["density"].into_iter().chain(velocity.into_iter().take(D)).chain(["pressure"]);
    case.probes.iter().flat_map(|probe| names().map(|name| format!("{}_{name}", probe.name))).collect()
}

/// The flow on a moved mesh, and where its coefficients are.
pub struct FlowAtPoints<'a, const D: usize> {
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// Its displacement.
    pub displacement: &'a [f64],
    /// The state, `[cell][component][node]`.
    pub state: &'a [f64],
    /// Nodes per direction of the flow.
    pub order: usize,
    /// The gas.
    pub gas: &'a Gas,
}

impl<const D: usize> FlowAtPoints<'_, D> {
    /// The values of the columns; NaN where a point is outside of the mesh.
    pub fn row<const M: usize>(&self, probes: &[Probe<D>]) -> Vec<f64> {
        probes.iter().flat_map(|probe| self.of::<M>(probe)).collect()
    }

    fn of<const M: usize>(&self, probe: &Probe<D>) -> Vec<f64> {
        let place = if probe.carried { self.mover.reference.locate(&probe.at) } else { self.locate(&probe.at) };
        let Some((cell, xi)) = place else { return vec![f64::NAN; D + 2] };
        let Primitive { density, velocity, pressure } =
            Primitive::<f64, D>::unpack(self.gas, &self.state::<M>(cell, &xi));
        [&[density][..], &velocity, &[pressure]].concat()
    }

    /// The cell that contains `x` now, and the place there.
    fn locate(&self, x: &[f64; D]) -> Option<(usize, [f64; D])> {
        let nodes = |cell: usize| by_node::<D>(&self.mover.cell_positions(cell, self.displacement));
        locate(self.mover.reference.order(), self.mover.reference.n_cells(), nodes, x)
    }

    fn state<const M: usize>(&self, cell: usize, xi: &[f64; D]) -> [f64; M] {
        let length = M * self.order.pow(D as u32);
        let values = values_at(self.order, &self.state[cell * length..][..length], xi);
        std::array::from_fn(|m| values[m])
    }
}

/// The first of so many `cells` that contains `x`, and the place there. `nodes` are the positions of a cell of the given `order`,
/// `[node][component]`.
pub fn locate<N: AsRef<[f64]>, const D: usize>(
    order: usize,
    cells: usize,
    nodes: impl Fn(usize) -> N,
    x: &[f64; D],
) -> Option<(usize, [f64; D])> {
    (0..cells).find_map(|cell| Some((cell, locate_in_cell(order, nodes(cell).as_ref(), x)?)))
}

/// The polynomials of a cell of the given `order` with the `coefficients` `[component][node]` at the reference point `xi`.
pub fn values_at<const D: usize>(order: usize, coefficients: &[f64], xi: &[f64; D]) -> Vec<f64> {
    let functions = functions_at(order, xi);
    coefficients.chunks_exact(functions.len()).map(|nodal| dot_of(nodal, &functions)).collect()
}
