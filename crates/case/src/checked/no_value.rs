//! Formulas of a flow that have no value during a run, such as one with a table that ends.

use super::boundary_data::Data;
use super::flow::Flow;
use super::mesh_crate::Mesh;
use super::openings::nodes_of_boundary;
use crate::point_data::PointData;
use crate::state::State;

/// A formula without a finite value.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct NoValue {
    /// What it belongs to, in the words of the case file.
    pub of: String,
    /// The place.
    pub x: Vec<f64>,
    /// The time.
    pub t: f64,
}

/// The part of the way to the centre of a cell.
const INWARDS: f64 = 1e-3;

impl<const D: usize> Flow<D> {
    /// The first formula of a source, a sponge or a boundary condition that has no finite value at one of `times`. Nodes have the `displacement`
    /// of (cell, node of the cell, position at rest). Sources are looked at beside the nodes, within cells: at all times beside one node of each
    /// cell, and at every sixteenth time beside the others.
    pub fn without_value(
        &self,
        mesh: &Mesh<D>,
        displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
        times: &[f64],
    ) -> Option<NoValue> {
        let few: Vec<f64> = times.iter().copied().step_by(16).collect();
        let of_source = self.source.as_ref().and_then(super::Source::formulas).and_then(|formulas| {
            let look = |count: usize, times: &[f64]| {
                let nodes = (0..mesh.n_cells()).flat_map(|cell| beside_nodes(mesh, cell, &displacement, count));
                without_value("flow.source` or `flow.sponge", &|x, t| has_value(formulas, x, t), nodes, times)
            };
            look(1, times).or_else(|| look(usize::MAX, &few))
        });
        of_source.or_else(|| self.boundary_without_value(mesh, displacement, times))
    }

    fn boundary_without_value(
        &self,
        mesh: &Mesh<D>,
        displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
        times: &[f64],
    ) -> Option<NoValue> {
        let names = mesh.boundary_names().iter().enumerate();
        names.zip(&self.boundary).find_map(|((boundary, name), data)| {
            let data = data.data.as_ref()?;
            let nodes = nodes_of_boundary(mesh, boundary, &displacement).into_iter().map(|(x, _)| x);
            let has_value = |x: &[f64; D], t: f64| match data {
                Data::Values(formulas) => has_value(formulas, x, t),
                Data::State(State::Expression(state)) => {
                    let numbers = [state.density.evaluate(x, t), state.pressure.evaluate(x, t)];
                    are_finite(&numbers) && are_finite(&state.velocity.evaluate(x, t))
                }
                Data::State(_) => true,
            };
            without_value(&format!("flow.boundary.{name}"), &has_value, nodes, times)
        })
    }
}

/// Points beside the first nodes of a cell, up to `count`, a little towards its centre: at a node itself a formula may have no value, and need none.
fn beside_nodes<const D: usize>(
    mesh: &Mesh<D>,
    cell: usize,
    displacement: &impl Fn(usize, usize, &[f64; D]) -> [f64; D],
    count: usize,
) -> Vec<[f64; D]> {
    let at_rest = mesh.cell_coordinates(cell).as_chunks::<D>().0;
    let displaced = |(k, rest): (usize, &[f64; D])| {
        let d = displacement(cell, k, rest);
        std::array::from_fn(|i| rest[i] + d[i])
    };
    let nodes: Vec<[f64; D]> = at_rest.iter().enumerate().map(displaced).collect();
    let centre: [f64; D] = std::array::from_fn(|i| nodes.iter().map(|x| x[i]).sum::<f64>() / nodes.len() as f64);
    let beside = |x: &[f64; D]| std::array::from_fn(|i| x[i] + INWARDS * (centre[i] - x[i]));
    nodes.iter().take(count).map(beside).collect()
}

/// The first of the `nodes` where a formula of `of` has no value at one of `times`.
fn without_value<const D: usize>(
    of: &str,
    has_value: &dyn Fn(&[f64; D], f64) -> bool,
    mut nodes: impl Iterator<Item = [f64; D]>,
    times: &[f64],
) -> Option<NoValue> {
    nodes.find_map(|x| {
        let t = times.iter().copied().find(|t| !has_value(&x, *t))?;
        Some(NoValue { of: of.to_owned(), x: x.to_vec(), t })
    })
}

fn has_value<const D: usize>(formulas: &PointData<D>, x: &[f64; D], t: f64) -> bool {
    are_finite(&[formulas.first.evaluate(x, t), formulas.last.evaluate(x, t)])
        && are_finite(&formulas.vector.evaluate(x, t))
}

fn are_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}
