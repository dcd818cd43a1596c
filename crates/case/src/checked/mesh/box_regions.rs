//! Segments, regions and the map of `[mesh.generate.box]`

use super::family::Family;
use crate::checker::Checked;
use crate::error::CaseError;
use crate::key::Key;
use crate::raw::{Axis, BoxGenerator, Formula};
use crate::vector::Vector;
use ::mesh::generate::{BoxRegion, Segment};
use ::mesh::{BoxMesh, Mesh, MeshError, REST};
use tensor::AXES;

/// What a map must be.
const A_MAP: &str = "a map that neither folds nor mirrors the box, and sends different points to different places (with a mirror one axis reversed, \
                     -y for y), more cells, or a higher order";

/// The mesh of `generator`, whose sizes of cells have the given `ratios` along axes without segments. The error of an
/// inverted cell is one at the key `curved_by`, which is the map if there is one.
pub(super) fn build<const D: usize>(
    family: &Family<'_>,
    raw: &BoxGenerator,
    generator: &BoxMesh<D>,
    ratios: [f64; D],
    curved_by: &Key,
) -> Checked<Mesh<D>> {
    let mut segments: [Vec<Segment>; D] = std::array::from_fn(|axis| {
        vec![Segment { end: generator.upper[axis], cells: generator.cells[axis], ratio: ratios[axis] }]
    });
    for (axis, pieces) in &raw.segments {
        let number = number::<D>(family, *axis, ratios)?;
        let segment =
            |piece: &crate::raw::Segment| Segment { end: piece.end, cells: piece.cells, ratio: piece.size_ratio };
        segments[number] = pieces.iter().map(segment).collect();
    }
    let regions = raw.regions.keys().map(|name| region(family, raw, name)).collect::<Checked<Vec<_>>>()?;
    let formulas_of = |formulas: &Vec<Formula>| family.checker.formulas_of_position(&family.key.child("map"), formulas);
    let map: Option<Vector<D>> = raw.map.as_ref().map(formulas_of).transpose()?;
    let position = |x: &[f64; D]| map.as_ref().map_or(*x, |map| map.evaluate(x, 0.0));
    generator.build_in_regions(&segments, &regions, &position).map_err(|error| refused(family, raw, curved_by, error))
}

/// The number of an axis with segments: it is one of the box, and has no size ratio beside them.
fn number<const D: usize>(family: &Family<'_>, axis: Axis, ratios: [f64; D]) -> Checked<usize> {
    let (number, key) = (axis as usize, key_of_segments(family, axis as usize));
    if number >= D {
        return Err(family.checker.combination(&key, "the box has no such axis", "segments along x and y"));
    }
    if ratios[number] != 1.0 {
        let problem = "`size_ratio` has no effect along an axis with segments";
        return Err(family.checker.combination(&key, problem, "1 there, and a `size_ratio` for each segment"));
    }
    Ok(number)
}

fn key_of_segments(family: &Family<'_>, axis: usize) -> Key {
    family.key.child("segments").child(AXES[axis])
}

fn region<const D: usize>(family: &Family<'_>, raw: &BoxGenerator, name: &str) -> Checked<BoxRegion<D>> {
    let (key, region) = (family.key.child("regions").child(name), &raw.regions[name]);
    if name == REST {
        let problem = format!("`{REST}` is the name of all cells outside of the regions");
        return Err(family.checker.combination(&key, &problem, "another name"));
    }
    let at = |end: &str, values| family.checker.finite_vector::<D>(&key.child(end), "the corner", values);
    Ok(BoxRegion { name: name.to_owned(), lower: at("lower", &region.lower)?, upper: at("upper", &region.upper)? })
}

/// The error of the generator at the key that it is about.
fn refused(family: &Family<'_>, raw: &BoxGenerator, curved_by: &Key, error: MeshError) -> Box<CaseError> {
    let of_region = |name: &str| family.key.child("regions").child(name);
    if raw.map.is_some()
        && matches!(error, MeshError::Inverted { .. } | MeshError::Degenerate { .. } | MeshError::NonManifold { .. })
    {
        return family.checker.combination(curved_by, &error.to_string(), A_MAP);
    }
    let key = match &error {
        MeshError::Segments { axis, segment, .. } => key_of_segments(family, *axis).entry(*segment),
        MeshError::Unaligned { name, axis, value, .. } => {
            let is_lower = raw.regions.get(name).is_some_and(|region| region.lower[*axis] == *value);
            of_region(name).child(if is_lower { "lower" } else { "upper" }).entry(*axis)
        }
        MeshError::EmptyRegion { name } | MeshError::TwoRegions { second: name, .. } => of_region(name),
        _ => curved_by.clone(),
    };
    family.refused_at(&key, error)
}
