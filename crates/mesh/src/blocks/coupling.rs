//! The graph of the cells of a mesh, with the couplings through the facets as weights.

use super::graph::Graph;
use crate::{InteriorFacet, Mesh, Side};
use std::array::from_fn;
use tensor::norm;

/// The weight of a coupling of 1, as between squares.
const UNIT: f64 = 10.0;
/// Stronger couplings count as this: no cut goes through them anyway.
const STRONGEST: f64 = 1e5;

/// Cells and facets as a graph. Two cells that share several facets, as across a periodic boundary, have one edge.
pub(super) fn graph<const D: usize>(mesh: &Mesh<D>) -> Graph {
    let extents: Vec<[f64; D]> = (0..mesh.n_cells()).map(|cell| extents(mesh, cell)).collect();
    let edge = |facet: &InteriorFacet| {
        let seen = |side: Side| aspect_ratio_seen(&extents[side.cell], side.face / 2);
        (facet.minus.cell, facet.plus.cell, weight((seen(facet.minus) * seen(facet.plus)).sqrt()))
    };
    Graph::new(vec![1; mesh.n_cells()], mesh.interior_facets().iter().map(edge))
}

/// The distances of the centres of opposite faces, which are here the means of corners: cuts do not depend on the curving of cells, as
/// [`Mesh::extents`] does.
fn extents<const D: usize>(mesh: &Mesh<D>, cell: usize) -> [f64; D] {
    from_fn(|axis| {
        let (low, high) = (2 * axis, 2 * axis + 1);
        let (low, high) = (mesh.face_centre(Side { cell, face: low }), mesh.face_centre(Side { cell, face: high }));
        norm(&from_fn::<f64, D, _>(|i| high[i] - low[i]))
    })
}

/// How many times the cell is longer along its facet than across. In the plane this is the stiffness of the Laplace operator
/// through the facet.
fn aspect_ratio_seen<const D: usize>(extents: &[f64; D], axis: usize) -> f64 {
    let along = (0..D).filter(|&other| other != axis).map(|other| extents[other]);
    along.fold(0.0, f64::max) / extents[axis]
}

/// A coupling as an integer, at least 1. It is rounded at a place where no ratio of small numbers lies.
fn weight(coupling: f64) -> i64 {
    let rounded = (UNIT * coupling.min(STRONGEST) + std::f64::consts::FRAC_1_PI).floor();
    (rounded as i64).max(1)
}
