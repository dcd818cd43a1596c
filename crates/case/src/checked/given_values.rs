//! The values of boundary conditions by formulas.

use super::boundary_data::{BoundaryData, Data};
use super::mesh_crate::Mesh;
use super::openings::nodes_with_normals;
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::{is_bounded, is_computable};
use crate::point_data::PointData;
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

/// Checks the formulas in the `data` of a condition at `key` on the nodes of a boundary.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    data: &BoundaryData<D>,
    mesh: &Mesh<D>,
    boundary: usize,
    time: &Time,
) -> Checked<()> {
    let Some(Named { condition, positive, vector }) = Named::of(data) else { return Ok(()) };
    let (key, nodes) = (key.child(condition), nodes_with_normals(mesh, boundary));
    for (name, quantity, formula) in positive {
        for (x, t) in places(&nodes, time, !formula.depends_on_position()) {
            let value = formula.evaluate(&x, t);
            let quantity = format!("{quantity} at {x:?} and t = {t}, {value},");
            let holds = value > 0.0 && is_computable(value);
            checker.require_of_formula(&key.child(name), &quantity, holds, "a formula that is positive everywhere")?;
        }
    }
    let Some((name, vector)) = vector else { return Ok(()) };
    for (x, t) in places(&nodes, time, false) {
        let holds = vector.evaluate(&x, t).iter().all(|w| is_bounded(*w));
        let quantity = format!("the vector at {x:?} and t = {t}");
        checker.require_of_formula(&key.child(name), &quantity, holds, "formulas that are finite everywhere")?;
    }
    Ok(())
}

/// The nodes at the start. At other times they may have moved, so only formulas `of_time` alone are checked then.
fn places<const D: usize>(
    nodes: &[([f64; D], [f64; D])],
    time: &Time,
    of_time: bool,
) -> impl Iterator<Item = ([f64; D], f64)> {
    let at_start = nodes.iter().map(|(x, _)| (*x, time.start));
    let later = nodes.iter().take(usize::from(of_time)).flat_map(|(x, _)| time.check_times().map(|t| (*x, t)));
    at_start.chain(later)
}
