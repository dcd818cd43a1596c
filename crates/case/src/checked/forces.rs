//! The reference values of forces on walls.

use super::boundary_data::BoundaryData;
use super::mesh_crate::Mesh;
use super::time::Time;
use super::vector_of_time::vector_of_time;
use crate::checker::{Checked, Checker};
use crate::error::collected;
use crate::key::Key;
use crate::raw;
use crate::vector::Vector;
use navier_stokes::{ForceScales, Reference, WallForce};
use std::collections::BTreeMap;

/// A boundary that is a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall<const D: usize> {
    /// Its number in `Mesh::boundary_names`.
    pub boundary: usize,
    /// Its name.
    pub name: String,
    /// The point about which moments are taken.
    point: Vector<D>,
    /// The reference values that make forces dimensionless.
    pub scales: ForceScales<D>,
}

impl<const D: usize> Wall<D> {
    /// The point about which moments are taken at time `t`.
    pub fn point(&self, t: f64) -> [f64; D] {
        self.point.evaluate(&[0.0; D], t)
    }

    /// The reported moments of `force`: in two dimensions the one about the axis of positive moments, in three those about x, y and z
    /// for any such axis.
    pub fn moments(&self, force: &WallForce<D>) -> Vec<f64> {
        if D == 2 { vec![self.scales.moment(force)] } else { force.moment.to_vec() }
    }
}

/// The contents of `[flow.forces]`, and the values from which its defaults follow.
pub(super) struct Given<'a> {
    /// The section.
    pub(super) forces: &'a BTreeMap<String, raw::Forces>,
    /// The reference state.
    pub(super) reference: Reference,
    /// The reference length.
    pub(super) length: f64,
    /// The time that the run covers.
    pub(super) time: &'a Time,
}

/// Checks `[flow.forces]`: the walls among the boundaries, with given or default values.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    &Given { forces: raw, reference, length, time }: &Given<'_>,
    mesh: &Mesh<D>,
    boundaries: &[BoundaryData<D>],
) -> Checked<Vec<Wall<D>>> {
    let names = mesh.boundary_names();
    let is_wall = |number: usize| boundaries[number].condition.is_wall();
    if let Some(number) = (0..names.len()).find(|&number| raw.contains_key(&names[number]) && !is_wall(number)) {
        let problem = format!("there is no force on `{}`: it is not a wall", names[number]);
        let accepted = "boundaries whose condition is a wall";
        return Err(checker.combination(&key.child(&names[number]), &problem, accepted));
    }
    let given = checker.by_boundary_or_default(key, raw, names)?;
    let walls = given.iter().enumerate().filter(|(number, _)| is_wall(*number));
    let wall = |(boundary, (key, forces)): (usize, &(Key, raw::Forces))| {
        let scales = scales(checker, key, forces, reference, length)?;
        let point = match &forces.point {
            Some(formulas) => {
                vector_of_time(checker, &key.child("point"), "the coordinate of the point", formulas, time)?
            }
            None => Vector::zero(),
        };
        Ok(Wall { boundary, name: names[boundary].clone(), point, scales })
    };
    collected(walls.map(wall))
}

fn scales<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Forces,
    reference: Reference,
    length: f64,
) -> Checked<ForceScales<D>> {
    let positive = |name: &str, given: Option<f64>, default: f64| match given {
        Some(value) => checker.positive(&key.child(name), &format!("the {name}"), value),
        None => Ok(default),
    };
    let mut drag_direction = [0.0; D];
    drag_direction[0] = 1.0;
    if let Some(direction) = &raw.drag_direction {
        let key = key.child("drag_direction");
        let direction: [f64; D] = checker.finite_vector(&key, "the direction", direction)?;
        let norm = tensor::norm(&direction);
        checker.require(
            &key,
            "the direction",
            norm > 0.0 && norm.is_finite(),
            "a vector that is not zero, nor of infinite length",
        )?;
        drag_direction = direction.map(|component| component / norm);
    }
    Ok(ForceScales {
        dynamic_pressure: reference.dynamic_pressure(),
        area: positive("area", raw.area, length.powi(D as i32 - 1))?,
        length: positive("length", raw.length, length)?,
        drag_direction,
        moment_axis: moment_axis::<D>(checker, &key.child("moment_positive"), raw.moment_positive)?,
    })
}

/// The unit vector about which moments count as positive by the right-hand rule.
fn moment_axis<const D: usize>(checker: &Checker<'_>, key: &Key, raw: raw::MomentPositive) -> Checked<[f64; 3]> {
    match raw {
        raw::MomentPositive::CounterClockwise => Ok([0.0, 0.0, 1.0]),
        // The nose is upstream and lift to the left of drag: clockwise.
        raw::MomentPositive::NoseUp => Ok([0.0, 0.0, -1.0]),
        raw::MomentPositive::Axis(axis) => super::unit_axis::<D>(checker, &key.child("axis"), axis, "a moment"),
    }
}
