//! `[mesh.generate.box]`

use super::box_regions;
use super::family::Family;
use crate::any_mesh::AnyMesh;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{BoxGenerator, Curving};
use ::mesh::{BoxMesh, Mesh};

pub(super) fn build(checker: &Checker<'_>, raw: &BoxGenerator, order: usize) -> Checked<AnyMesh> {
    let family = Family { checker, key: Key::new("mesh.generate.box"), parameters: &[] };
    match family.dimension("lower", raw.lower.len())? {
        2 => Ok(AnyMesh::Plane(box_mesh(&family, raw, order)?)),
        _ => Ok(AnyMesh::Space(box_mesh(&family, raw, order)?)),
    }
}

fn box_mesh<const D: usize>(family: &Family<'_>, raw: &BoxGenerator, order: usize) -> Checked<Mesh<D>> {
    let (checker, key) = (family.checker, &family.key);
    let corner = |name: &str, entries: &[f64]| checker.finite_vector::<D>(&key.child(name), "the corner", entries);
    let (lower, upper) = (corner("lower", &raw.lower)?, corner("upper", &raw.upper)?);
    let cells = checker.vector(&key.child("cells"), &raw.cells)?;
    let extents = std::array::from_fn(|axis| upper[axis] - lower[axis]);
    check_axes(family, &extents, &cells)?;
    family.check_size::<D>("cells", &cells, order)?;
    let ratios = match &raw.size_ratio {
        Some(ratios) => checker.vector(&key.child("size_ratio"), ratios)?,
        None => [1.0; D],
    };
    for axis in 0..D {
        let (key, ratio): (_, f64) = (key.child("size_ratio").entry(axis), ratios[axis]);
        let fine = ratio > 0.0 && ratio.ln().abs() <= LARGEST_RATIO.ln();
        checker.require(&key, "the ratio of sizes", fine, "a positive number, 1e-10 to 1e10")?;
    }
    let periodic = checker.axes(&key.child("periodic"), &raw.periodic)?;
    let generator = BoxMesh { lower, upper, cells, order, curving: curving(raw.curving), periodic };
    // Corners and cells are valid here, so any error is caused by the curving or the map.
    let curved_by = if raw.map.is_some() { key.child("map") } else { curving_key(key, raw.curving) };
    if raw.segments.is_empty() && raw.regions.is_empty() && raw.map.is_none() {
        return generator.build_graded(ratios).map_err(|error| family.refused_at(&curved_by, error));
    }
    box_regions::build(family, raw, &generator, ratios, &curved_by)
}

/// The largest ratio of cell sizes: beyond it, det J of thin cells is lost in round-off.
const LARGEST_RATIO: f64 = 1e10;

fn check_axes<const D: usize>(family: &Family<'_>, extents: &[f64; D], cells: &[usize; D]) -> Checked<()> {
    for axis in 0..D {
        let at = |name: &str| family.key.child(name).entry(axis);
        let positive = extents[axis] > 0.0 && extents[axis].is_finite();
        family.checker.require(&at("upper"), "the corner", positive, "more than the same entry of `lower`")?;
        family.checker.at_least_one(&at("cells"), "the number of cells", cells[axis])?;
    }
    let size = |axis: &usize| extents[*axis] / cells[*axis] as f64;
    let thinnest = (0..D).min_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0);
    let ratio = (0..D).map(|axis| size(&axis)).fold(0.0, f64::max) / size(&thinnest);
    let quantity = format!("the aspect ratio of the cells, {ratio:.1e},");
    let key = family.key.child("upper").entry(thinnest);
    family.checker.require(&key, &quantity, ratio <= LARGEST_RATIO, "extents and cells with a ratio up to 1e10")
}

/// The key of the amplitude.
fn curving_key(generator: &Key, raw: Curving) -> Key {
    let key = generator.child("curving");
    let name = match raw {
        Curving::None => return generator.clone(),
        Curving::Smooth { .. } => "smooth",
        Curving::Wavy { .. } => "wavy",
        Curving::Random { .. } => "random",
    };
    key.child(name).child("amplitude")
}

fn curving(raw: Curving) -> ::mesh::Curving {
    match raw {
        Curving::None => ::mesh::Curving::None,
        Curving::Smooth { amplitude } => ::mesh::Curving::Smooth { amplitude },
        Curving::Wavy { amplitude } => ::mesh::Curving::Wavy { amplitude },
        Curving::Random { amplitude, seed } => ::mesh::Curving::Random { amplitude, seed },
    }
}
