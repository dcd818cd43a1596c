//! Checks of rotating frames.

use case::Case;
use mesh::{InteriorFacet, Mesh};
use navier_stokes::{Rotation, Source};
use std::array::from_fn;
use tensor::norm;

/// A translation is along the axis of rotation, or none, if less than this part of the centrifugal acceleration along the diameter of the mesh is left.
const TOLERANCE: f64 = 1e-9;

/// The warning about a mesh that is periodic across the axis of rotation of the frame.
pub fn jump_of_centrifugal_force<const D: usize>(case: &Case<D>) -> Option<String> {
    let Source::Rotating(rotation) = &case.flow.as_ref()?.law.source else { return None };
    let periodic = case.mesh.interior_facets().iter().filter(|facet| facet.periodic);
    let mut ways = periodic.map(|facet| translation(&case.mesh, facet));
    let diameter = case.mesh.diameter();
    let way = ways.find(|way| is_across(rotation, way, diameter))?;
    let way = way.map(|x| format!("{x:.4}")).join(", ");
    Some(format!(
        "the centrifugal force of `flow.rotation` jumps across the periodic boundary at the distance [{way}]: with an axis across it the flow is \
         not periodic; a `flow.rotation.axis` along this distance, or walls or other conditions in place of the periodic boundary"
    ))
}

/// The way from one side of a periodic facet to the other.
fn translation<const D: usize>(mesh: &Mesh<D>, facet: &InteriorFacet) -> [f64; D] {
    let [minus, plus] = [facet.minus, facet.plus].map(|side| mesh.face_positions(side));
    // The nodes of both sides may have another order.
    let mean = |i: usize| (0..plus.len()).map(|k| plus[k][i] - minus[k][i]).sum::<f64>() / plus.len() as f64;
    from_fn(mean)
}

/// Whether the centrifugal acceleration changes along `way`, in a mesh of this `diameter`. The joined sides of a full ring are in the same place.
fn is_across<const D: usize>(rotation: &Rotation<D>, way: &[f64; D], diameter: f64) -> bool {
    let along = |j: usize| norm(&rotation.centrifugal(from_fn(|i| f64::from(u8::from(i == j)))));
    let largest = (0..D).map(along).fold(0.0, f64::max);
    norm(&rotation.centrifugal(*way)) > TOLERANCE * largest * diameter
}
