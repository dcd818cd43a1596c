//! `[mesh.generate.airfoil]`

use super::family::Family;
use crate::case::checker::{Checked, Checker};
use crate::case::key::Key;
use crate::case::raw::{AirfoilGenerator, NearWake};
use ::mesh::Mesh;
use ::mesh::generate::AirfoilMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the thickness", "thickness"),
    ("the distance of the far field", "far_field"),
    ("the height of the first cell", "first_cell"),
    ("the length of the cell at the trailing edge", "trailing_edge_cell"),
    ("the number of cells along a side", "surface_cells"),
    ("the number of cells along the wake", "wake_cells"),
    ("the length of the near wake", "near_wake.length"),
    ("the number of cells of the near wake", "near_wake.cells"),
    ("the number of cells outwards", "normal_cells"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &AirfoilGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.airfoil"), parameters: PARAMETERS };
    let AirfoilGenerator { thickness, far_field, first_cell, trailing_edge_cell, .. } = *raw;
    let AirfoilGenerator { surface_cells, wake_cells, normal_cells, .. } = *raw;
    let half = surface_cells.saturating_add(wake_cells);
    family.check_size::<2>("normal_cells", &[2, half, normal_cells], order)?;
    let generator = AirfoilMesh {
        thickness,
        far_field,
        first_cell,
        trailing_edge_cell,
        surface_cells,
        wake_cells,
        near_wake: raw.near_wake.map(|NearWake { length, cells }| ::mesh::generate::NearWake { length, cells }),
        normal_cells,
        order,
    };
    generator.build().map_err(|error| family.refused(error))
}
