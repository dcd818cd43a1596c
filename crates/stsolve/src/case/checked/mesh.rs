//! The mesh of a case.

use super::{mesh_crate, order};
use crate::case::checker::{Checked, Checker};
use crate::case::error::Cause;
use crate::case::key::Key;
use crate::case::raw::{BoxGenerator, Curving, Generate, Mesh};
use mesh_crate::BoxMesh;

/// The number of dimensions of the mesh.
pub(super) fn dimension(checker: &Checker<'_>, raw: &Mesh) -> Checked<usize> {
    let Generate::Box(generator) = &raw.generate;
    let dimension = generator.lower.len();
    checker.require(
        &box_key().child("lower"),
        "the number of axes",
        (2..=3).contains(&dimension),
        "two or three entries",
    )?;
    Ok(dimension)
}

/// Builds the mesh.
pub(super) fn build<const D: usize>(checker: &Checker<'_>, raw: &Mesh) -> Checked<mesh_crate::Mesh<D>> {
    let order = order(checker, &Key::new("mesh.order"), "the order of the mesh", raw.order)?;
    let Generate::Box(generator) = &raw.generate;
    let generated = box_mesh(checker, generator, order)?;
    Ok(match generator.scramble {
        Some(seed) => generated.scrambled(seed),
        None => generated,
    })
}

fn box_mesh<const D: usize>(checker: &Checker<'_>, raw: &BoxGenerator, order: usize) -> Checked<mesh_crate::Mesh<D>> {
    let key = box_key();
    let (lower, upper) =
        (checker.vector(&key.child("lower"), &raw.lower)?, checker.vector(&key.child("upper"), &raw.upper)?);
    let cells = checker.vector(&key.child("cells"), &raw.cells)?;
    for axis in 0..D {
        let extent = upper[axis] - lower[axis];
        let at = |name: &str| key.child(name).entry(axis);
        checker.require(
            &at("upper"),
            "the corner",
            extent > 0.0 && extent.is_finite(),
            "more than the same entry of `lower`",
        )?;
        checker.at_least_one(&at("cells"), "the number of cells", cells[axis])?;
    }
    // Checked before anything is allocated.
    let nodes = cells.iter().fold(order.pow(D as u32), |product, n| product.saturating_mul(*n));
    checker.require(
        &key.child("cells"),
        "the size of the mesh",
        nodes <= MOST_NODES,
        "fewer cells: at most 2^28 nodes in all",
    )?;
    let ratios = match &raw.size_ratio {
        Some(ratios) => checker.vector(&key.child("size_ratio"), ratios)?,
        None => [1.0; D],
    };
    for axis in 0..D {
        checker.positive(&key.child("size_ratio").entry(axis), "the ratio of sizes", ratios[axis])?;
    }
    let periodic = checker.axes(&key.child("periodic"), &raw.periodic)?;
    let generator = BoxMesh { lower, upper, cells, order, curving: curving(raw.curving), periodic };
    // Whatever is wrong now, corners and cells are fine: the curving inverts cells.
    let key = curving_key(&key.child("curving"), raw.curving);
    generator.build_graded(ratios).map_err(|error| checker.error(&key, Cause::Mesh(error)))
}

fn box_key() -> Key {
    Key::new("mesh.generate.box")
}

/// Nodes of a mesh at most: coordinates of some gigabytes.
const MOST_NODES: usize = 1 << 28;

/// The key of the amplitude.
fn curving_key(key: &Key, raw: Curving) -> Key {
    let name = match raw {
        Curving::None => return key.clone(),
        Curving::Smooth { .. } => "smooth",
        Curving::Wavy { .. } => "wavy",
        Curving::Random { .. } => "random",
    };
    key.child(name).child("amplitude")
}

fn curving(raw: Curving) -> mesh_crate::Curving {
    match raw {
        Curving::None => mesh_crate::Curving::None,
        Curving::Smooth { amplitude } => mesh_crate::Curving::Smooth { amplitude },
        Curving::Wavy { amplitude } => mesh_crate::Curving::Wavy { amplitude },
        Curving::Random { amplitude, seed } => mesh_crate::Curving::Random { amplitude, seed },
    }
}
