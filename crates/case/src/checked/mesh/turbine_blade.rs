//! `[mesh.generate.turbine_blade]`

use super::family::Family;
use super::point_file;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{BladeCells, Profile, TurbineBladeGenerator};
use ::mesh::generate::{BladeMesh, ClosedCurve, low_pressure_turbine_profile};
use ::mesh::{Mesh, MeshError};

const PARAMETERS: &[(&str, &str)] = &[
    ("the pitch", "pitch"),
    ("the distance of the inflow", "inflow_distance"),
    ("the distance of the outflow", "outflow_distance"),
    ("the thickness of the O-block", "layer"),
    ("the height of the first cell", "first_cell"),
    ("the number of cells along a side", "cells.side"),
    ("the number of cells around an end", "cells.end"),
    ("the number of cells normal to the blade", "cells.normal"),
    ("the number of cells beside the O-block", "cells.gap"),
    ("the number of cells before the blade", "cells.before"),
    ("the number of cells behind the blade", "cells.after"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &TurbineBladeGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.turbine_blade"), parameters: PARAMETERS };
    check_size(&family, &raw.cells, order)?;
    let BladeCells { side, end, normal, gap, before, after } = raw.cells;
    let generator = BladeMesh {
        profile: profile(&family, &raw.profile)?,
        pitch: raw.pitch,
        slopes: [
            slope(&family, "inflow_angle", raw.inflow_angle)?,
            slope(&family, "outflow_angle", raw.outflow_angle)?,
        ],
        distances: [raw.inflow_distance, raw.outflow_distance],
        layer: raw.layer,
        first_cell: raw.first_cell,
        cells: ::mesh::generate::BladeCells { side, end, normal, gap, before, after },
        order,
    };
    generator.build().map_err(|error| family.refused(error))
}

/// An upper bound of the columns and rows: a layer around two sides and two ends, in a frame of equal width and height.
fn check_size(family: &Family<'_>, cells: &BladeCells, order: usize) -> Checked<()> {
    let sum = |numbers: &[usize]| numbers.iter().fold(0_usize, |sum, n| sum.saturating_add(*n));
    let BladeCells { side, end, normal, gap, before, after } = *cells;
    let columns = sum(&[before, side, side, after, end, end]);
    family.check_size::<2>("cells", &[columns, sum(&[gap, gap, end, normal])], order)
}

/// dy/dx of a direction in degrees.
fn slope(family: &Family<'_>, name: &str, angle: f64) -> Checked<f64> {
    let accepted = "an angle between -87 and 87 degrees";
    family.checker.require(&family.key.child(name), "the direction of the flow", angle.abs() <= 87.0, accepted)?;
    Ok(angle.to_radians().tan())
}

fn profile(family: &Family<'_>, raw: &Profile) -> Checked<ClosedCurve> {
    let key = family.key.child("profile");
    match raw {
        Profile::LowPressureTurbine => low_pressure_turbine_profile().map_err(|error| family.refused_at(&key, error)),
        Profile::File(path) => {
            let (key, path) = (key.child("file"), family.checker.beside_case(path));
            let points = point_file::read(&path).map_err(|cause| family.checker.error(&key, *cause))?;
            ClosedCurve::through(&points).map_err(|error: MeshError| family.refused_at(&key, error))
        }
    }
}
