//! `[mesh.generate.ellipsoid]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::EllipsoidGenerator;
use ::mesh::Mesh;
use ::mesh::generate::EllipsoidMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the semi-axis along x", "semi_axes.0"),
    ("the semi-axis along y", "semi_axes.1"),
    ("the semi-axis along z", "semi_axes.2"),
    ("the radius of the far field", "outer_radius"),
    ("the height of the first cell", "first_cell"),
    ("the number of cells along x", "cells.0"),
    ("the number of cells along y", "cells.1"),
    ("the number of cells along z", "cells.2"),
    ("the number of cells outwards", "cells.3"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &EllipsoidGenerator, order: usize) -> Checked<Mesh<3>> {
    let family = Family { checker, key: Key::new("mesh.generate.ellipsoid"), parameters: PARAMETERS };
    let EllipsoidGenerator { semi_axes, outer_radius, first_cell, cells } = *raw;
    let generator = EllipsoidMesh { semi_axes, outer_radius, first_cell, cells, order };
    family.check_size::<3>("cells", &[generator.n_cells()], order)?;
    generator.build().map_err(|error| family.refused(error))
}
