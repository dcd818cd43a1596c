//! Reads a resolved case, as a result file holds it.

use super::movers::Movers;
use super::{AllowedChange, Case, Freedom, Motion, Time, bodies, checker_of, given, motion, time};
use crate::checker::{Checked, Checker, OTHERS, Sound};
use crate::document::Document;
use crate::error::CaseError;
use crate::key::Key;
use crate::raw;
use crate::reading::{self, Read};
use std::path::Path;

/// The title of a resolved case, if it has one.
pub fn title_of(resolved: &str) -> Option<String> {
    let case: toml::Table = resolved.parse().ok()?;
    Some(case.get("title")?.as_str()?.to_owned())
}

/// The ratio of specific heats of a resolved case; `None` without a flow.
///
/// # Errors
/// The error of `resolved`, which another version of the program may have written. Only the keys that are needed are read.
pub fn ratio_of_specific_heats_of(resolved: &str) -> Result<Option<f64>, String> {
    let case: toml::Table = resolved.parse().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let Some(flow) = case.get("flow") else { return Ok(None) };
    let gamma = flow.get("gas").and_then(|gas| gas.get("gamma")).and_then(toml::Value::as_float);
    gamma.map(Some).ok_or_else(|| "it has no number `flow.gas.gamma`".to_owned())
}

/// The names among `boundaries` that are walls in a resolved case: no-slip or slip walls, no planes of symmetry. Empty without a flow.
pub fn walls_of<'b>(resolved: &str, boundaries: &'b [String]) -> Vec<&'b str> {
    let case: toml::Table = resolved.parse().unwrap_or_default();
    let Some(conditions) = case.get("flow").and_then(|flow| flow.get("boundary")) else { return Vec::new() };
    let condition_of = |name: &str| -> Option<raw::Condition> {
        conditions.get(name).or_else(|| conditions.get(OTHERS))?.clone().try_into().ok()
    };
    let is_wall = |name: &&str| condition_of(name).is_some_and(|condition| condition.is_wall());
    boundaries.iter().map(String::as_str).filter(is_wall).collect()
}

/// The gas of a resolved case, as text and without what is `allowed` to change; `None` without a flow.
///
/// # Errors
/// The error of `resolved`, which another version of the program may have written.
pub fn gas_of(resolved: &str, allowed: &[AllowedChange]) -> Result<Option<String>, String> {
    let raw = raw::from_toml(resolved)?;
    let text = |flow: &raw::Flow| {
        let mut gas = flow.gas.clone();
        if allowed.contains(&AllowedChange::Viscosity) {
            gas.viscosity = raw::Viscosity::Inviscid;
        }
        if allowed.contains(&AllowedChange::Mach) {
            (gas.mach, gas.gas_constant) = (None, None);
        }
        serde_json::to_string(&gas).map_err(|error| error.to_string())
    };
    raw.flow.as_ref().map(text).transpose()
}

/// The rigid bodies of a resolved case, as text: what their coordinates mean.
///
/// # Errors
/// As [`gas_of`].
pub fn bodies_of(resolved: &str) -> Result<String, String> {
    let raw = raw::from_toml(resolved)?;
    let bodies: Vec<String> = raw.bodies.iter().map(|(name, body)| described(name, body)).collect();
    Ok(if bodies.is_empty() { "none".to_owned() } else { bodies.join("; ") })
}

/// The observed points of the structure of a resolved case, in the order of their values.
///
/// # Errors
/// As [`gas_of`].
pub fn structure_points_of(resolved: &str) -> Result<Vec<(String, Vec<f64>)>, String> {
    let points = raw::from_toml(resolved)?.structure.map(|structure| structure.points);
    Ok(points.into_iter().flatten().collect())
}

/// The walls of which a resolved case keeps distributions during the run.
///
/// # Errors
/// As [`gas_of`].
pub fn walls_with_series_of(resolved: &str) -> Result<Vec<String>, String> {
    let surfaces = raw::from_toml(resolved)?.output.surfaces.filter(|surfaces| surfaces.every.is_some());
    Ok(surfaces.map_or_else(Vec::new, |surfaces| surfaces.walls))
}

/// The start of the run of a resolved case.
///
/// # Errors
/// As [`gas_of`].
pub fn start_of(resolved: &str) -> Result<f64, String> {
    Ok(raw::from_toml(resolved)?.time.start)
}

/// Whether the run of a resolved case begins with a search for a steady flow.
///
/// # Errors
/// As [`gas_of`].
pub fn searches_steady_flow(resolved: &str) -> Result<bool, String> {
    Ok(raw::from_toml(resolved)?.solver.steady.is_some())
}

/// The coordinates of the rigid bodies of a resolved case, body after body. `here` is a case with the same bodies.
///
/// # Errors
/// The error of `resolved`, which another version of the program may have written.
pub fn freedoms_of<const D: usize>(resolved: &str, here: &Case<D>) -> Result<Vec<Vec<Freedom>>, Box<CaseError>> {
    with_checker(resolved, |checker, raw| {
        let flow = (raw.flow.is_some(), here.flow.as_ref());
        let bodies = bodies::check(checker, &raw.bodies, &here.mesh, flow, &time_of(checker, raw)?)?;
        Ok(bodies.into_iter().map(|body| body.freedoms).collect())
    })
}

/// A rigid body in words: its coordinates, its walls and what it turns about.
fn described(name: &str, body: &raw::Body) -> String {
    let coordinates: Vec<&str> =
        body.coordinates().into_iter().filter_map(|(name, given)| given.map(|_| name)).collect();
    let walls = body.walls.clone().unwrap_or_else(|| vec![name.to_owned()]).join(", ");
    let pivot = body.pivot.as_ref().filter(|pivot| pivot.iter().any(|x| *x != 0.0));
    let pivot = pivot.map_or_else(|| "the origin".to_owned(), |pivot| format!("{pivot:?}"));
    let axis = body.axis.filter(|axis| body.rotation.is_some() && !is_along_z(axis));
    let axis = axis.map_or_else(String::new, |axis| format!(" and the axis {axis:?}"));
    format!("`{name}` with {}, walls {walls}, about {pivot}{axis}", coordinates.join(", "))
}

/// Whether an axis is the one that is taken where none is given.
fn is_along_z(axis: &[f64; 3]) -> bool {
    axis[0] == 0.0 && axis[1] == 0.0 && axis[2] > 0.0
}

/// The quadrature of a resolved case with a flow, as text: integrals over the same flow are equal where it is.
///
/// # Errors
/// As [`gas_of`].
pub fn quadrature_of(resolved: &str) -> Result<Option<String>, String> {
    let raw = raw::from_toml(resolved)?;
    let text = |flow: &raw::Flow| match flow.quadrature {
        raw::Quadrature::Collocated | raw::Quadrature::CollocatedLobatto => {
            format!("{:?} {} {}", flow.quadrature, flow.order, raw.time.order)
        }
        other => format!("{other:?}"),
    };
    Ok(raw.flow.as_ref().map(text))
}

/// The motion that a resolved case, as text, gives to the mesh of `here`, a case with the same bodies and walls of a structure.
///
/// # Errors
/// The error of `resolved`, which another version of the program may have written.
pub fn motion_of<const D: usize>(resolved: &str, here: &Case<D>) -> Result<Option<Motion<D>>, Box<CaseError>> {
    with_checker(resolved, |checker, raw| {
        motion::check(checker, raw.motion.as_ref(), &here.mesh, &Movers::of(here), &time_of(checker, raw)?)
    })
}

/// Pressure and temperature of the reference state of a resolved case in `D` dimensions with a flow.
///
/// # Errors
/// As [`motion_of`].
pub fn reference_of<const D: usize>(resolved: &str) -> Result<[f64; 2], Box<CaseError>> {
    with_checker(resolved, |checker, raw| {
        let key = Key::new("flow");
        let missing = || checker.combination(&key, "there is no reference state without a flow", "a section [flow]");
        let given = given::check::<D>(checker, &key, raw.flow.as_ref().ok_or_else(missing)?)?;
        Ok([given.reference.pressure(&given.gas), given.reference.temperature(&given.gas)])
    })
}

/// What `check` finds of a resolved case. Its files are not read: the case does not say in which directory they are. Tables are written out.
fn with_checker<R>(
    resolved: &str,
    check: impl FnOnce(&Checker<'_>, &raw::Case) -> Checked<R>,
) -> Result<R, Box<CaseError>> {
    let document = Document::parse(Path::new("case"), resolved.to_owned(), &[])?;
    let Read { case, errors, damage } = reading::read(&document)?;
    errors.all()?;
    let raw = case.expect("a case without errors can be read");
    let Sound { checker, errors } = checker_of(&document, &raw, damage);
    errors.all()?;
    check(&checker, &raw)
}

/// The time that a resolved case covers.
fn time_of(checker: &Checker<'_>, raw: &raw::Case) -> Checked<Time> {
    time::check(checker, &raw.time, raw.flow.is_some() && raw.solver.steady.is_some())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_case_of_another_version_tells_what_is_there() {
        let text = "title = \"a\"\nunknown = 1\n[flow.gas]\ngamma = 1.3\n";
        assert_eq!(title_of(text).as_deref(), Some("a"));
        assert_eq!(ratio_of_specific_heats_of(text), Ok(Some(1.3)));
        assert_eq!((title_of("[mesh]"), ratio_of_specific_heats_of("[mesh]")), (None, Ok(None)));
        assert_eq!(title_of("="), None);
        assert!(ratio_of_specific_heats_of("[flow]").is_err() && ratio_of_specific_heats_of("=").is_err());
    }

    /// It was read from the working directory, and its absence was taken for another version of the program.
    #[test]
    fn the_mesh_of_a_resolved_case_is_not_read() {
        let text = "mesh.file = \"nowhere.msh\"\ntime = { order = 2, end = 1, step = 0.1 }\n[flow]\norder = 2\n\
                    gas = { mach = 0.5 }\ninitial.uniform = { density = 1, velocity = [1, 0], pressure = 2 }\n\
                    reference = { density = 1, speed = 1, pressure = 3 }\n";
        let [pressure, temperature] = reference_of::<2>(text).unwrap();
        // T = p / (rho R) with R = 1 / (gamma M^2).
        let expected = 3.0 * 1.4 * 0.25;
        assert!((pressure - 3.0).abs() < 1e-14 && (temperature - expected).abs() < 1e-14, "{pressure} {temperature}");
    }

    #[test]
    fn walls_are_told_from_other_boundaries() {
        let text = "[flow.boundary]\nin = { inflow = {} }\nside = \"symmetry\"\nplate = \"slip_wall\"\nothers = { adiabatic_wall = {} }\n";
        let names = ["in", "side", "plate", "blade"].map(str::to_owned);
        assert_eq!(walls_of(text, &names), ["plate", "blade"]);
        assert!(walls_of("[mesh]", &names).is_empty() && walls_of("=", &names).is_empty());
    }
}
