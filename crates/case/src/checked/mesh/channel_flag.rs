//! `[mesh.generate.channel_flag]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{ChannelFlagGenerator, FlagCells};
use ::mesh::Mesh;
use ::mesh::generate::ChannelFlagMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the length", "extent.0"),
    ("the height", "extent.1"),
    ("x of the centre", "centre.0"),
    ("y of the centre", "centre.1"),
    ("the diameter", "diameter"),
    ("the end of the flag", "flag_end"),
    ("the thickness of the flag", "thickness"),
    ("the height of the first cell", "first_cell"),
    ("the height of the cells beside the flag", "flag_cell"),
    ("the number of cells around", "cells.around"),
    ("the number of cells outwards", "cells.outwards"),
    ("the number of cells beside the flag", "cells.beside"),
    ("the number of cells along the flag", "cells.along"),
    ("the number of cells across the flag", "cells.across"),
    ("the number of cells after the flag", "cells.after"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &ChannelFlagGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.channel_flag"), parameters: PARAMETERS };
    let ChannelFlagGenerator { extent, centre, diameter, flag_end, thickness, first_cell, flag_cell, cells } = *raw;
    let FlagCells { around, outwards, beside, along, across, after } = cells;
    let rows = beside.saturating_mul(2).saturating_add(across);
    let columns = outwards.saturating_add(along).saturating_add(after);
    family.check_size::<2>("cells", &[rows.saturating_add(around.saturating_mul(3)), columns], order)?;
    let cells = ::mesh::generate::FlagCells { around, outwards, beside, along, across, after };
    let generator =
        ChannelFlagMesh { extent, centre, diameter, flag_end, thickness, first_cell, flag_cell, cells, order };
    generator.build().map_err(|error| family.refused(error))
}
