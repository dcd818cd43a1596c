//! The resolution of the first cell at a wall, by the boundary layer of a flat plate.

use case::{Case, Flow};
use mesh::{BoundaryDistance, BoundaryFacet, face_nodes};
use navier_stokes::Boundary;

/// The Reynolds number at which the boundary layer of a flat plate becomes turbulent.
const TRANSITION: f64 = 5e5;

/// The boundary layer of a flat plate at the distance L from its edge, Re = U L / nu (H. Schlichting, Boundary-Layer Theory).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlatPlate {
    /// Re.
    reynolds: f64,
}

impl FlatPlate {
    /// At a Reynolds number, if that is finite.
    pub(super) fn new(reynolds: f64) -> Option<Self> {
        reynolds.is_finite().then_some(FlatPlate { reynolds })
    }

    /// Re.
    pub(super) fn reynolds(self) -> f64 {
        self.reynolds
    }

    /// Whether the layer is turbulent.
    pub(super) fn is_turbulent(self) -> bool {
        self.reynolds > TRANSITION
    }

    /// c_f = 0.664 Re^-1/2 (Blasius), or 0.0592 Re^-1/5.
    fn friction(self) -> f64 {
        if self.is_turbulent() { 0.0592 * self.reynolds.powf(-0.2) } else { 0.664 * self.reynolds.powf(-0.5) }
    }

    /// delta / L = 5 Re^-1/2, or 0.37 Re^-1/5.
    pub(super) fn thickness(self) -> f64 {
        if self.is_turbulent() { 0.37 * self.reynolds.powf(-0.2) } else { 5.0 * self.reynolds.powf(-0.5) }
    }

    /// h+ = h u_tau / nu = (h / L) Re (c_f / 2)^1/2, for `height` = h / L.
    pub(super) fn wall_units(self, height: f64) -> f64 {
        height * self.reynolds * (0.5 * self.friction()).sqrt()
    }
}

/// The walls of a case and the cells at them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walls {
    /// The largest height of a cell at a no-slip wall; None if there are no such walls.
    pub(super) cell_height: Option<f64>,
    /// The distance from walls to the far field; infinite if one of them is missing.
    pub(super) far_field: f64,
}

impl Walls {
    /// The walls of `flow`.
    pub(super) fn new<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Self {
        let of = |chosen: fn(&Boundary<D>) -> bool| -> Vec<usize> {
            (0..flow.boundary.len()).filter(|&index| chosen(&flow.boundary[index].condition)).collect()
        };
        let no_slip = of(Boundary::is_no_slip);
        let (walls, far) = (of(Boundary::is_wall), of(|condition| matches!(condition, Boundary::FarField(_))));
        let facets = |chosen: Vec<usize>| {
            case.mesh.boundary_facets().iter().filter(move |facet| chosen.contains(&facet.boundary))
        };
        let distance = BoundaryDistance::new(&case.mesh, &far);
        let to_far = |facet: &BoundaryFacet| distance.at(&face(case, facet.side.cell, facet.side.face)[0]);
        Walls {
            cell_height: facets(no_slip).map(|facet| height(case, facet)).reduce(f64::max),
            far_field: facets(walls).map(to_far).fold(f64::INFINITY, f64::min),
        }
    }
}

/// The positions of the nodes of a face.
fn face<const D: usize>(case: &Case<D>, cell: usize, face: usize) -> Vec<[f64; D]> {
    let nodes = case.mesh.cell_coordinates(cell);
    let position = |k: usize| std::array::from_fn(|axis| nodes[k * D + axis]);
    face_nodes(D, case.mesh.order(), face).into_iter().map(position).collect()
}

/// The shortest path across the cell of a facet, along the lines of its lattice.
fn height<const D: usize>(case: &Case<D>, facet: &BoundaryFacet) -> f64 {
    // Faces 2 axis and 2 axis + 1 are opposite, and their lattices are the same.
    let opposite = face(case, facet.side.cell, facet.side.face ^ 1);
    let across = |(a, b): (&[f64; D], &[f64; D])| tensor::norm::<f64, D>(&std::array::from_fn(|i| b[i] - a[i]));
    face(case, facet.side.cell, facet.side.face).iter().zip(&opposite).map(across).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_flat_plate_is_that_of_the_textbook() {
        let laminar = FlatPlate::new(1e4).unwrap();
        assert!((laminar.friction() - 0.00664).abs() < 1e-12 && (laminar.thickness() - 0.05).abs() < 1e-12);
        // u_tau / U = sqrt(0.00332), so that h / L = 0.01 is 5.76 wall units.
        assert!((laminar.wall_units(0.01) - 100.0 * 0.00332_f64.sqrt()).abs() < 1e-12);
        let turbulent = FlatPlate::new(1e7).unwrap();
        assert!(turbulent.is_turbulent() && (turbulent.friction() - 0.002_357).abs() < 1e-6);
        assert!(FlatPlate::new(f64::INFINITY).is_none());
    }
}
