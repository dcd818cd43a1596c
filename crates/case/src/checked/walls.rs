//! No-slip walls.

use super::boundary_data::BoundaryData;
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::point_data::PointData;
use crate::raw;
use crate::vector::Vector;
use navier_stokes::{AdiabaticWall, Boundary, IsothermalWall};

/// Checks an adiabatic wall.
pub(super) fn adiabatic<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::AdiabaticWall,
) -> Checked<BoundaryData<D>> {
    let vector = slide(checker, key, raw.slide.as_deref())?;
    let Some(slide) = vector.as_constant() else {
        let data = PointData { first: Program::constant(0.0), vector, last: Program::constant(0.0) };
        return Ok(BoundaryData::by_formulas(Boundary::AdiabaticWall(AdiabaticWall::at_points()), data));
    };
    Ok(BoundaryData::uniform(Boundary::AdiabaticWall(checker.physics(key, AdiabaticWall::new(slide))?)))
}

/// Checks an isothermal wall.
pub(super) fn isothermal<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::IsothermalWall,
) -> Checked<BoundaryData<D>> {
    let vector = slide(checker, key, raw.slide.as_deref())?;
    let last = checker.formula::<D>(&key.child("temperature"), &raw.temperature)?;
    let data = PointData { first: Program::constant(0.0), vector, last };
    let Some((_, slide, temperature)) = data.as_constants() else {
        return Ok(BoundaryData::by_formulas(Boundary::IsothermalWall(IsothermalWall::at_points()), data));
    };
    let temperature = checker.positive(&key.child("temperature"), "the temperature", temperature)?;
    Ok(BoundaryData::uniform(Boundary::IsothermalWall(checker.physics(key, IsothermalWall::new(temperature, slide))?)))
}

/// The velocity with which a wall slides. Numbers must be finite.
fn slide<const D: usize>(checker: &Checker<'_>, key: &Key, raw: Option<&[raw::Formula]>) -> Checked<Vector<D>> {
    let key = key.child("slide");
    let slide: Vector<D> = raw.map_or(Ok(Vector::zero()), |formulas| checker.formulas(&key, formulas))?;
    if let Some(numbers) = slide.as_constant() {
        checker.finite_vector::<D>(&key, "the velocity", &numbers)?;
    }
    Ok(slide)
}
