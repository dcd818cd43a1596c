//! `[mesh.generate.annulus]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::AnnulusGenerator;
use ::mesh::Mesh;
use ::mesh::generate::AnnulusMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the radius of the wall", "inner_radius"),
    ("the radius of the far field less that of the wall", "outer_radius"),
    ("the height of the first cell", "first_cell"),
    ("the number of cells around", "cells.0"),
    ("the number of cells outwards", "cells.1"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &AnnulusGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.annulus"), parameters: PARAMETERS };
    let AnnulusGenerator { inner_radius, outer_radius, first_cell, cells } = *raw;
    family.check_size::<2>("cells", &cells, order)?;
    let generator = AnnulusMesh { inner_radius, outer_radius, first_cell, cells, order };
    generator.build().map_err(|error| family.refused(error))
}
