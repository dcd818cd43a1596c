//! The flow at points, from the coefficients of the cells that contain them: columns of history.csv, and the values of lines and slices.

use super::cells::{StateInCells, StateSource};
use super::nodal::{by_node, dot_of};
use super::opening_states::slopes_at;
use super::surfaces::physical;
use case::{Case, Field, FieldFormula, Flow, Probe};
use coupled::MeshMover;
use fem::functions_at;
use mesh::{CellMap, locate_in_cell};
use report::fields::{self, CellSample, Medium};
use tensor::det;

/// The names of the columns.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    let formulas = &case.observed.formulas;
    let of = |probe: &Probe<D>| -> Vec<String> {
        names::<D>(&probe.fields, formulas).map(|name| format!("{}_{name}", probe.name)).collect()
    };
    case.observed.probes.iter().flat_map(of).collect()
}

/// The names of the components of `fields`, and of the `formulas`.
pub fn names<'a, const D: usize>(
    fields: &'a [Field],
    formulas: &'a [FieldFormula],
) -> impl Iterator<Item = &'a str> + use<'a, D> {
    let components = fields.iter().flat_map(|field| field.components(D).iter().copied());
    components.chain(formulas.iter().map(|formula| formula.name.as_str()))
}

/// A cell, and a reference point in it; `None` outside of the mesh.
pub type Place<const D: usize> = Option<(usize, [f64; D])>;

/// The flow on a moved mesh, to be observed at points.
pub struct FlowAtPoints<'a, const D: usize> {
    /// The flow of the case.
    pub flow: &'a Flow<D>,
    /// Fields by formulas.
    pub formulas: &'a [FieldFormula],
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// Its displacement.
    pub displacement: &'a [f64],
    /// Its velocity; empty where that is not known.
    pub velocity: &'a [f64],
    /// The time.
    pub time: f64,
}

impl<'a, const D: usize> FlowAtPoints<'a, D> {
    /// The cells of the points, and the places there; `None` outside of the mesh.
    pub fn places(&self, probes: &[Probe<D>]) -> Vec<Place<D>> {
        let place = |probe: &Probe<D>| {
            if probe.carried { self.mover.reference.locate(&probe.at) } else { self.locate(&probe.at) }
        };
        probes.iter().map(place).collect()
    }

    /// The values of the columns of points at these `places`; NaN outside of the mesh.
    pub fn row<const M: usize>(&self, probes: &[Probe<D>], places: &[Place<D>], source: &StateSource) -> Vec<f64> {
        let state = state_at(source, places);
        let value = |(probe, place): (&Probe<D>, &Place<D>)| match place {
            Some((cell, xi)) => self.cell(*cell).values::<M>(&state, xi, &probe.fields),
            None => vec![f64::NAN; names::<D>(&probe.fields, self.formulas).count()],
        };
        probes.iter().zip(places).flat_map(value).collect()
    }

    /// The cell that contains `x` now, and the place there.
    fn locate(&self, x: &[f64; D]) -> Place<D> {
        locate(self.mover.reference.order(), self.mover.reference.n_cells(), |cell| self.nodes(cell), x)
    }

    /// The positions of the nodes of a cell, `[node][component]`.
    pub fn nodes(&self, cell: usize) -> Vec<f64> {
        by_node::<D>(&self.mover.cell_positions(cell, self.displacement))
    }

    /// A cell, at the points of which the flow is wanted.
    pub fn cell(&self, cell: usize) -> CellAtPoints<'_, 'a, D> {
        CellAtPoints { of: self, cell, nodes: self.nodes(cell) }
    }
}

/// The state in the cells of `places`.
pub fn state_at<'a, const D: usize>(source: &StateSource<'a>, places: &[Place<D>]) -> StateInCells<'a> {
    source(places.iter().flatten().map(|place| place.0).collect())
}

/// A cell of the flow.
pub struct CellAtPoints<'b, 'a, const D: usize> {
    of: &'b FlowAtPoints<'a, D>,
    cell: usize,
    /// Positions, `[node][component]`.
    pub nodes: Vec<f64>,
}

impl<const D: usize> CellAtPoints<'_, '_, D> {
    /// The position at the reference point `xi`.
    pub fn position(&self, xi: &[f64; D]) -> [f64; D] {
        CellMap::at(self.of.mover.reference.order(), xi).positions(&self.nodes)[0]
    }

    /// The components of `fields` at the reference point `xi`, and the formulas, from the state in the cells.
    pub fn values<const M: usize>(&self, state: &StateInCells, xi: &[f64; D], fields: &[Field]) -> Vec<f64> {
        let (of, x, u) = (self.of, self.position(xi), state.of(self.cell));
        let (state, of_mesh) = (values_at(of.flow.order, u, xi), functions_at(of.mover.reference.order(), xi));
        let (gradients, jacobian) = self.slopes::<M>(u, xi);
        let rest = of.mover.reference.position(self.cell, xi);
        let sample = CellSample {
            state: &state,
            mesh_velocity: &self.velocity(&of_mesh),
            jacobian: &[jacobian],
            gradients: &gradients,
            displacement: &std::array::from_fn::<f64, D, _>(|i| x[i] - rest[i]),
            ..CellSample::of_points(1)
        };
        let medium = Medium::of(of.flow);
        let of_fields = fields.iter().flat_map(|field| fields::components::<D, M>(*field, &medium, &sample));
        let of_formulas = fields::of_formulas::<D, M>(of.formulas, Some(&medium), &sample, &x, of.time);
        of_fields.chain(of_formulas).flatten().collect()
    }

    /// grad u, `[direction][component]`, and det J / det J_0.
    fn slopes<const M: usize>(&self, u: &[f64], xi: &[f64; D]) -> (Vec<Vec<f64>>, f64) {
        let order = self.of.flow.order;
        let functions = slopes_at(order, xi);
        let nodes = order.pow(D as u32);
        let slopes: [[f64; M]; D] =
            std::array::from_fn(|j| std::array::from_fn(|m| dot_of(&u[m * nodes..], &functions[j])));
        let jacobian = CellMap::at(self.of.mover.reference.order(), xi).jacobians(&self.nodes)[0];
        let rest = self.of.mover.reference.jacobian(self.cell, xi);
        let det = |j: &[[f64; D]; D]| det(j);
        (physical(&slopes, &jacobian).iter().map(|slope| slope.to_vec()).collect(), det(&jacobian) / det(&rest))
    }

    /// The velocity of the mesh.
    fn velocity(&self, functions: &[f64]) -> [f64; D] {
        let at = |node: usize, i: usize| self.of.velocity.get(node * D + i).copied().unwrap_or(0.0);
        let nodes = || self.of.mover.numbering.cell(self.cell).iter().zip(functions);
        std::array::from_fn(|i| nodes().map(|(&node, phi)| phi * at(node, i)).sum())
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
