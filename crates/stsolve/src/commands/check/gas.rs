//! Warnings about the gas, and about walls that it hardly meets.

use super::Facts;
use super::warnings::{Warning, warning};
use case::Flow;
use navier_stokes::{Boundary, Viscosity};

/// If the reference temperature and Sutherland's temperature differ by more than this factor, the gas constant is
/// doubtful.
const FAR_FROM_SUTHERLAND: f64 = 3.0;

/// A wall is at most so many times hotter or colder than the gas, unless another unit of temperature was meant.
const UNLIKE_GAS: f64 = 10.0;

/// Without viscosity a gas slips along walls.
pub(super) fn friction<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    if flow.law.gas.viscosity() != Viscosity::Inviscid {
        return None;
    }
    let index = flow.boundary.iter().position(|data| data.condition.is_no_slip())?;
    let text = format!(
        "`{}` is a wall without slip, in a gas without viscosity: `flow.gas.viscosity = {{ constant = ... }}`, density times speed times length \
         over the Reynolds number that is wanted; or the condition \"slip_wall\"",
        facts.case.mesh.boundary_names()[index]
    );
    warning("viscosity", text)
}

/// The largest ratio of specific heats of any gas, that of one atom.
const LARGEST_GAMMA: f64 = 5.0 / 3.0;

/// No gas has a larger ratio of specific heats than one of single atoms.
pub(super) fn gamma<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let gamma = flow.law.gas.gamma();
    // 1.667 is a usual value.
    if gamma < LARGEST_GAMMA + 1e-3 {
        return None;
    }
    let text = format!("`flow.gas.gamma` of {gamma} is larger than that of any gas, 1 to 5/3: 1.4 for air");
    warning("ratio of specific heats", text)
}

/// Sutherland's law depends on the temperature itself, which depends on the gas constant: with R left at 1 it is p /
/// rho.
pub(super) fn sutherland<const D: usize>(flow: &Flow<D>) -> Option<Warning> {
    let gas = &flow.law.gas;
    let Viscosity::Sutherland { temperature, .. } = gas.viscosity() else { return None };
    let reference = flow.law.reference.temperature(&flow.law.gas);
    let ratio = reference / temperature;
    if (1.0 / FAR_FROM_SUTHERLAND..=FAR_FROM_SUTHERLAND).contains(&ratio) {
        return None;
    }
    let text = format!(
        "the reference temperature p / (rho R), {reference:.4e}, is {ratio:.1e} times `sutherland.temperature`, {temperature}: the viscosity there is \
         {:.2e}; `flow.gas.gas_constant` in the units of the case (air in SI units: 287.05), now {}",
        gas.dynamic_viscosity(reference),
        gas.gas_constant()
    );
    warning("Sutherland's law", text)
}

/// A temperature of walls in kelvin does not fit a gas whose constant is in other units: with R left at 1 the temperature of the gas is p / rho.
pub(super) fn wall_temperature<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let gas = flow.law.reference.temperature(&flow.law.gas);
    let unlike = |condition: &Boundary<D>| match condition {
        Boundary::IsothermalWall(wall) => {
            wall.temperature().filter(|wall| !(gas / UNLIKE_GAS..=gas * UNLIKE_GAS).contains(wall))
        }
        _ => None,
    };
    let mut walls = flow.boundary.iter().zip(facts.case.mesh.boundary_names());
    let (wall, name) = walls.find_map(|(data, name)| Some((unlike(&data.condition)?, name)))?;
    let text = format!(
        "the wall `{name}` has a temperature of {wall}, and the gas p / (rho R) = {gas:.4e}: `flow.gas.gas_constant` in the units of the case (air in \
         SI units: 287.05), now {}",
        flow.law.gas.gas_constant()
    );
    warning("wall temperature", text)
}
