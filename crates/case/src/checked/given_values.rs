//! The values of boundary conditions by formulas.

use super::boundary_data::{BoundaryData, Data};
use super::controls::Control;
use super::flow::Flow;
use super::mesh_crate::Mesh;
use super::openings::{NodeAndNormal, nodes_of_boundary};
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::{is_bounded, is_computable};
use crate::point_data::PointData;
use crate::state::State;
use crate::vector::Vector;
use navier_stokes::{Boundary, Outflow, VelocityInflow};

/// The formulas of a condition, by the names of their keys.
struct Named<'a, const D: usize> {
    /// The name of the condition.
    condition: &'static str,
    /// Quantities that are positive.
    positive: Vec<(&'static str, &'static str, &'a Program)>,
    vector: Option<(&'static str, &'a Vector<D>)>,
}

impl<'a, const D: usize> Named<'a, D> {
    /// None if the condition has no formulas of its own.
    fn of(data: &'a BoundaryData<D>) -> Option<Self> {
        let Some(Data::Values(values)) = &data.data else { return None };
        let PointData { first, vector, last } = &**values;
        let temperature = ("temperature", "the temperature", last);
        let total_temperature = ("total_temperature", "the temperature", last);
        let (condition, positive, vector) = match &data.condition {
            Boundary::Inflow(_) => {
                let pressure = ("total_pressure", "the pressure", first);
                ("inflow", vec![pressure, total_temperature], Some(("direction", vector)))
            }
            Boundary::Outflow(outflow) => {
                let velocity = (*outflow == Outflow::of_velocity()).then_some(("velocity", vector));
                ("outflow", vec![("pressure", "the pressure", first), total_temperature], velocity)
            }
            Boundary::VelocityInflow(VelocityInflow::OfVelocity) => {
                ("velocity_inflow", vec![temperature], Some(("velocity", vector)))
            }
            Boundary::VelocityInflow(VelocityInflow::OfMassFlux) => {
                ("velocity_inflow", vec![temperature], Some(("mass_flux", vector)))
            }
            Boundary::IsothermalWall(_) => ("isothermal_wall", vec![temperature], Some(("slide", vector))),
            Boundary::AdiabaticWall(_) => ("adiabatic_wall", Vec::new(), Some(("slide", vector))),
            _ => return None,
        };
        Some(Named { condition, positive, vector })
    }
}

/// Checks the formulas in the `data` of a condition at `key` on `nodes` of a boundary at `t`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    data: &BoundaryData<D>,
    nodes: &[NodeAndNormal<D>],
    t: f64,
) -> Checked<()> {
    let Some(Named { condition, positive, vector }) = Named::of(data) else { return Ok(()) };
    let key = key.child(condition);
    for (name, quantity, formula) in positive {
        nodes.iter().try_for_each(|(x, _)| check_positive(checker, &key.child(name), quantity, formula, (x, t)))?;
    }
    let Some((name, vector)) = vector else { return Ok(()) };
    for (x, _) in nodes {
        let holds = vector.evaluate(x, t).iter().all(|w| is_bounded(*w));
        let quantity = || format!("the vector at {x:?} and t = {t}");
        let accepted = "formulas that are finite everywhere";
        require_of_formula(checker, &key.child(name), holds, quantity, accepted)?;
    }
    Ok(())
}

/// Checks the formulas of time alone over the run, on any boundary with a node at `x`. They need not know where the boundary is.
pub(super) fn check_of_time<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    data: &BoundaryData<D>,
    x: &[f64; D],
    time: &Time,
) -> Checked<()> {
    let Some(Named { condition, positive, .. }) = Named::of(data) else { return Ok(()) };
    let of_time = positive.into_iter().filter(|(.., formula)| !formula.depends_on_position());
    for (name, quantity, formula) in of_time {
        let key = key.child(condition).child(name);
        time.check_times().into_iter().try_for_each(|t| check_positive(checker, &key, quantity, formula, (x, t)))?;
    }
    Ok(())
}

/// Checks that the `formula` at `key` is positive at `x` and `t`.
fn check_positive<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    quantity: &str,
    formula: &Program,
    (x, t): (&[f64; D], f64),
) -> Checked<()> {
    let value = formula.evaluate(x, t);
    let quantity = || format!("{quantity} of {value} at {x:?} and t = {t}");
    let accepted = match formula.is_controlled() {
        false => "a formula that is positive everywhere",
        true => "a formula that is positive everywhere; a control begins with its `initial`, by default 0",
    };
    require_of_formula(checker, key, is_positive(value), quantity, accepted)
}

fn is_positive(value: f64) -> bool {
    value > 0.0 && is_computable(value)
}

/// A value of a boundary condition that must be positive and is not.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct NotPositive {
    /// The name of the boundary.
    pub boundary: String,
    /// The name of the value in the case file.
    pub key: &'static str,
    /// The place.
    pub x: Vec<f64>,
    /// The time.
    pub t: f64,
    /// The value there.
    pub value: f64,
}

/// The formulas of a condition that must be positive, by the names of their keys.
pub(super) fn positive_formulas<const D: usize>(data: &BoundaryData<D>) -> Vec<(&'static str, &Program)> {
    match &data.data {
        Some(Data::State(State::Expression(state))) => {
            vec![("density", &state.density), ("pressure", &state.pressure)]
        }
        _ => Named::of(data).map_or_else(Vec::new, |named| {
            named.positive.into_iter().map(|(key, _, formula)| (key, formula)).collect()
        }),
    }
}

impl<const D: usize> Flow<D> {
    /// The first value at `t` on a boundary of `mesh` that contains `control`, must be positive and is not. Nodes have the `displacement` of
    /// [`Self::not_positive`].
    pub fn not_positive_by(
        &self,
        control: &Control,
        mesh: &Mesh<D>,
        displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
        t: f64,
    ) -> Option<NotPositive> {
        let contains = |formula: &Program| formula.is_controlled_by(&control.value);
        self.not_positive_of(contains, mesh, displacement, &[t])
    }

    /// The first value at one of `times` on a boundary of `mesh` that must be positive and is not. Nodes have the `displacement` of (cell,
    /// node of the cell, position at rest).
    pub fn not_positive(
        &self,
        mesh: &Mesh<D>,
        displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
        times: &[f64],
    ) -> Option<NotPositive> {
        self.not_positive_of(|formula| formula.as_constant().is_none(), mesh, displacement, times)
    }

    /// The same, of the formulas that are `wanted`.
    fn not_positive_of(
        &self,
        wanted: impl Fn(&Program) -> bool,
        mesh: &Mesh<D>,
        displacement: impl Fn(usize, usize, &[f64; D]) -> [f64; D],
        times: &[f64],
    ) -> Option<NotPositive> {
        let names = mesh.boundary_names().iter().enumerate();
        names.zip(&self.boundary).find_map(|((boundary, name), data)| {
            let formulas: Vec<_> = positive_formulas(data).into_iter().filter(|(_, formula)| wanted(formula)).collect();
            // Nearly all boundaries end here, without a list of their nodes.
            if formulas.is_empty() {
                return None;
            }
            let nodes = nodes_of_boundary(mesh, boundary, &displacement);
            let places = times.iter().flat_map(|t| nodes.iter().map(move |(x, _)| (x, *t)));
            let mut values = places
                .flat_map(|(x, t)| formulas.iter().map(move |(key, formula)| (*key, x, t, formula.evaluate(x, t))));
            let (key, x, t, value) = values.find(|(.., value)| !is_positive(*value))?;
            Some(NotPositive { boundary: name.clone(), key, x: x.to_vec(), t, value })
        })
    }
}

/// Makes the name of the quantity for an error alone: there are many nodes.
fn require_of_formula(
    checker: &Checker<'_>,
    key: &Key,
    holds: bool,
    quantity: impl Fn() -> String,
    accepted: &str,
) -> Checked<()> {
    if holds { Ok(()) } else { checker.require_of_formula(key, &quantity(), false, accepted) }
}
