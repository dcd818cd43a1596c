//! `[mesh.generate.rotating_box]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::RotatingBoxGenerator;
use ::mesh::Mesh;
use ::mesh::generate::RotatingBoxMesh;

const PARAMETERS: &[(&str, &str)] =
    &[("the side", "side"), ("the side of the hole", "hole"), ("the number of cells per side", "cells_per_side")];

pub(super) fn build(checker: &Checker<'_>, raw: &RotatingBoxGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.rotating_box"), parameters: PARAMETERS };
    let RotatingBoxGenerator { side, hole, cells_per_side } = *raw;
    family.check_size::<2>("cells_per_side", &[cells_per_side; 2], order)?;
    RotatingBoxMesh { side, hole, cells_per_side, order }.build().map_err(|error| family.refused(error))
}
