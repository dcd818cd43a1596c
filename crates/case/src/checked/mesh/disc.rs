//! `[mesh.generate.disc]`

use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::DiscGenerator;
use ::mesh::Mesh;
use ::mesh::generate::DiscMesh;

const PARAMETERS: &[(&str, &str)] = &[
    ("the radius", "radius"),
    ("the number of cells along the middle block", "core_cells"),
    ("the number of cells outwards", "radial_cells"),
];

pub(super) fn build(checker: &Checker<'_>, raw: &DiscGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.disc"), parameters: PARAMETERS };
    let DiscGenerator { radius, core_cells, radial_cells } = *raw;
    // The middle block, and the four around it.
    let columns = radial_cells.saturating_mul(4).saturating_add(core_cells);
    family.check_size::<2>("core_cells", &[core_cells, columns], order)?;
    DiscMesh { radius, core_cells, radial_cells, order }.build().map_err(|error| family.refused(error))
}
