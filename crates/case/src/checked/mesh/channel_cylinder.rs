//! `[mesh.generate.channel_cylinder]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::ChannelCylinderGenerator;
use ::mesh::Mesh;
use ::mesh::generate::ChannelCylinderMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the length", "extent.0"),
    ("the height", "extent.1"),
    ("x of the centre", "centre.0"),
    ("y of the centre", "centre.1"),
    ("the diameter", "diameter"),
    ("the height of the first cell", "first_cell"),
    ("the number of cells along a quarter", "cells.0"),
    ("the number of cells outwards", "cells.1"),
    ("the number of cells after", "cells.2"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &ChannelCylinderGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.channel_cylinder"), parameters: PARAMETERS };
    let ChannelCylinderGenerator { extent, centre, diameter, first_cell, cells } = *raw;
    let [around, outwards, after] = cells;
    let blocks = [around, outwards.saturating_mul(4).saturating_add(after)];
    family.check_size::<2>("cells", &blocks, order)?;
    let generator = ChannelCylinderMesh { extent, centre, diameter, first_cell, cells, order };
    generator.build().map_err(|error| family.refused(error))
}
