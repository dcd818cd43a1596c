//! The points of quadrature of a flow, and the flux between them.

use super::mesh_crate::{CellMap, Mesh};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;
use basis::{gauss, gauss_lobatto};
use fem::{PointFamily, Quadrature, Sampler};
use navier_stokes::VolumeFlux;

/// Checks `flow.quadrature` for a flow of `order` on `mesh`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: raw::Quadrature,
    mesh: &Mesh<D>,
    order: usize,
) -> Checked<Quadrature> {
    let quadrature = match raw {
        raw::Quadrature::Conserving => Quadrature::Conserving,
        raw::Quadrature::ThreeHalves => Quadrature::ThreeHalves,
        raw::Quadrature::Double => Quadrature::Double,
        raw::Quadrature::Collocated => Quadrature::Collocated(PointFamily::Gauss),
        raw::Quadrature::CollocatedLobatto => Quadrature::Collocated(PointFamily::Lobatto),
        raw::Quadrature::Points(points) => {
            let accepted = format!("{order}, the order of the flow, to 64");
            checker.require(&key.child("points"), "the number of points", (order..=64).contains(&points), &accepted)?;
            Quadrature::Points(points)
        }
    };
    if matches!(quadrature, Quadrature::Collocated(_)) {
        check_interpolated(checker, key, mesh, order)?;
    }
    if quadrature == Quadrature::Collocated(PointFamily::Gauss) {
        check_determinants(checker, key, mesh, order)?;
    }
    Ok(quadrature)
}

/// At Gauss points J is interpolated from the nodes of the flow. In strongly distorted cells it may have another sign there.
fn check_determinants<const D: usize>(checker: &Checker<'_>, key: &Key, mesh: &Mesh<D>, order: usize) -> Checked<()> {
    if order < 2 {
        return Ok(());
    }
    let at_points = Sampler::<D>::new(order, order, &gauss(order).points);
    let Some(cell) = first_inverted(mesh, order, |at_nodes| at_points.state(&at_nodes)) else { return Ok(()) };
    let problem = format!(
        "the Jacobian determinant of cell {cell}, interpolated from the nodes of the flow to the Gauss points, is not positive"
    );
    Err(checker.combination(
        key,
        &problem,
        "\"collocated_lobatto\" or \"conserving\", or a mesh with less distorted cells",
    ))
}

/// Collocated rules interpolate the mesh at the nodes of the flow. A lower order may turn curved cells inside out.
fn check_interpolated<const D: usize>(checker: &Checker<'_>, key: &Key, mesh: &Mesh<D>, order: usize) -> Checked<()> {
    let Some(cell) = inverted_by_interpolation(mesh, order) else { return Ok(()) };
    let problem = format!(
        "collocated points interpolate the mesh, of order {}, with the order {order} of the flow, which turns cell {cell} inside out",
        mesh.order()
    );
    Err(checker.combination(key, &problem, "`flow.order` up to the order of the mesh or more, or \"conserving\""))
}

/// The first cell of `mesh` that interpolation with polynomials of `order` turns inside out.
fn inverted_by_interpolation<const D: usize>(mesh: &Mesh<D>, order: usize) -> Option<usize> {
    (2..mesh.order()).contains(&order).then(|| first_inverted(mesh, order, |at_nodes| at_nodes)).flatten()
}

/// The first cell of `mesh`, interpolated at the nodes of `order`, where J has a value that is not positive among those that `values` makes of
/// the values at the nodes.
fn first_inverted<const D: usize>(
    mesh: &Mesh<D>,
    order: usize,
    values: impl Fn(Vec<f64>) -> Vec<f64>,
) -> Option<usize> {
    let nodes = gauss_lobatto(order).points;
    let (of_mesh, of_flow) = (CellMap::<D>::on_grid(mesh.order(), &nodes), CellMap::<D>::on_grid(order, &nodes));
    let is_inverted = |cell: &usize| {
        let interpolated = of_mesh.positions(mesh.cell_coordinates(*cell)).concat();
        values(of_flow.determinants(&interpolated)).iter().any(|det| det.is_nan() || *det <= 0.0)
    };
    (0..mesh.n_cells()).find(is_inverted)
}

/// The points and the flux of a split form for a flow of `order` on `mesh`; None if the mesh does not allow it.
pub(super) fn split_form<const D: usize>(mesh: &Mesh<D>, order: usize) -> Option<(Quadrature, VolumeFlux)> {
    let points = Quadrature::Collocated(PointFamily::Lobatto);
    inverted_by_interpolation(mesh, order).is_none().then_some((points, VolumeFlux::Entropy))
}

/// Checks `flow.volume_flux`: all but "central" need points that are the nodes.
pub(super) fn volume_flux(checker: &Checker<'_>, key: &Key, raw: &raw::Flow) -> Checked<VolumeFlux> {
    let flux = match raw.volume_flux {
        raw::VolumeFlux::Central => VolumeFlux::Central,
        raw::VolumeFlux::KineticEnergy => VolumeFlux::KineticEnergy,
        raw::VolumeFlux::Entropy => VolumeFlux::Entropy,
        raw::VolumeFlux::EntropyViscosity => VolumeFlux::EntropyViscosity,
    };
    if flux != VolumeFlux::Central && raw.quadrature != raw::Quadrature::CollocatedLobatto {
        let problem = "all volume fluxes but \"central\" need points of quadrature that are the nodes";
        return Err(checker.combination(&key.child("volume_flux"), problem, "`quadrature = \"collocated_lobatto\"`"));
    }
    Ok(flux)
}
