//! `[mesh.generate.channel]`

use super::family::Family;
use crate::any_mesh::AnyMesh;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::ChannelGenerator;
use ::mesh::Mesh;
use ::mesh::generate::ChannelMesh;

pub(super) fn build(checker: &Checker<'_>, raw: &ChannelGenerator, order: usize) -> Checked<AnyMesh> {
    let family = Family { checker, key: Key::new("mesh.generate.channel"), parameters: &[] };
    match family.dimension("extent", raw.extent.len())? {
        2 => Ok(AnyMesh::Plane(channel(&family, raw, order)?)),
        _ => Ok(AnyMesh::Space(channel(&family, raw, order)?)),
    }
}

fn channel<const D: usize>(family: &Family<'_>, raw: &ChannelGenerator, order: usize) -> Checked<Mesh<D>> {
    let (checker, key) = (family.checker, &family.key);
    let extent: [f64; D] = checker.vector(&key.child("extent"), &raw.extent)?;
    let cells: [usize; D] = checker.vector(&key.child("cells"), &raw.cells)?;
    for axis in 0..D {
        checker.positive(&key.child("extent").entry(axis), "the extent", extent[axis])?;
        checker.at_least_one(&key.child("cells").entry(axis), "the number of cells", cells[axis])?;
    }
    family.check_size::<D>("cells", &cells, order)?;
    let wall_ratio = checker.positive(&key.child("wall_ratio"), "the ratio of heights", raw.wall_ratio)?;
    let generator = ChannelMesh { extent, cells, wall_ratio, periodic: raw.periodic, order };
    generator.build().map_err(|error| family.refused(error))
}
