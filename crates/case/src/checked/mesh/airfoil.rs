//! `[mesh.generate.airfoil]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, AirfoilGenerator};
use ::mesh::Mesh;
use ::mesh::generate::{AirfoilMesh, NearPart};

const PARAMETERS: &[(&str, &str)] = &[
    ("the thickness", "thickness"),
    ("the distance of the far field", "far_field"),
    ("the height of the first cell", "first_cell"),
    ("the length of the cell at the trailing edge", "trailing_edge_cell"),
    ("the number of cells along a side", "surface_cells"),
    ("the number of cells along the wake", "wake_cells"),
    ("the extent of the near wake", "near_wake.extent"),
    ("the number of cells of the near wake", "near_wake.cells"),
    ("the number of cells outwards", "normal_cells"),
    ("the extent of the cells near the wall", "near_wall.extent"),
    ("the number of cells near the wall", "near_wall.cells"),
];

pub(super) fn build(checker: &Checker<'_>, given: &AirfoilGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.airfoil"), parameters: PARAMETERS };
    let AirfoilGenerator { thickness, far_field, first_cell, trailing_edge_cell, .. } = *given;
    let AirfoilGenerator { surface_cells, wake_cells, normal_cells, .. } = *given;
    let half = surface_cells.saturating_add(wake_cells);
    family.check_size::<2>("normal_cells", &[2, half, normal_cells], order)?;
    let part = |part: raw::NearPart| NearPart { extent: part.extent, cells: part.cells };
    let generator = AirfoilMesh {
        thickness,
        far_field,
        first_cell,
        trailing_edge_cell,
        surface_cells,
        wake_cells,
        near_wake: given.near_wake.map(part),
        normal_cells,
        near_wall: given.near_wall.map(part),
        order,
    };
    generator.build().map_err(|error| family.refused(error))
}
