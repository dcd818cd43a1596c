//! Checks that formulas give admissible states at the start and on boundaries.

use super::mesh_crate::{CellMap, Mesh, face_nodes};
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::magnitude::{is_bounded, is_computable};
use crate::state::{Formulas, State};
use basis::gauss_lobatto;

/// Where and when a state is checked.
struct StatePoint<const D: usize> {
    cell: usize,
    x: [f64; D],
    t: f64,
}

/// Checks that the state `initial` at time `start`, given at `key`, is admissible at all nodes of a flow of `order`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    initial: &State<D>,
    mesh: &Mesh<D>,
    order: usize,
    start: f64,
) -> Checked<()> {
    let State::Expression(formulas) = initial else { return Ok(()) };
    let map = CellMap::<D>::on_grid(mesh.order(), &gauss_lobatto(order).points);
    let mut places = (0..mesh.n_cells()).flat_map(|cell| {
        let positions = map.positions(mesh.cell_coordinates(cell));
        positions.into_iter().map(move |x| StatePoint { cell, x, t: start })
    });
    let key = key.child("expression");
    places.try_for_each(|place| check_at(checker, &key, formulas, &place))
}

/// Checks that the state of a `boundary`, given at `key`, is admissible at its nodes, at some times of the run.
pub(super) fn check_on_boundary<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    state: &State<D>,
    mesh: &Mesh<D>,
    boundary: usize,
    time: &Time,
) -> Checked<()> {
    let State::Expression(formulas) = state else { return Ok(()) };
    let key = key.child("expression");
    for facet in mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary) {
        let (cell, nodes) = (facet.side.cell, mesh.cell_coordinates(facet.side.cell));
        for k in face_nodes(D, mesh.order(), facet.side.face) {
            let x = std::array::from_fn(|i| nodes[k * D + i]);
            time.check_times()
                .into_iter()
                .try_for_each(|t| check_at(checker, &key, formulas, &StatePoint { cell, x, t }))?;
        }
    }
    Ok(())
}

fn check_at<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    state: &Formulas<D>,
    place: &StatePoint<D>,
) -> Checked<()> {
    let StatePoint { cell, x, t } = place;
    let state = state.primitive(x, *t);
    let at = format!("in cell {cell} at {x:?}, t = {t},");
    for (name, value) in [("density", state.density), ("pressure", state.pressure)] {
        let quantity = format!("the {name} {at} {value},");
        let positive = value > 0.0 && is_computable(value);
        checker.require_of_formula(
            &key.child(name),
            &quantity,
            positive,
            "a formula that is positive everywhere, and at most 1e60",
        )?;
    }
    for (axis, value) in state.velocity.into_iter().enumerate() {
        let (key, quantity) = (key.child("velocity").entry(axis), format!("the velocity {at} {value},"));
        checker.require_of_formula(
            &key,
            &quantity,
            is_bounded(value),
            "a formula that is finite everywhere, and at most 1e60",
        )?;
    }
    Ok(())
}
