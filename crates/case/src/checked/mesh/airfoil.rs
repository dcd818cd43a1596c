//! `[mesh.generate.airfoil]`

use super::airfoil_points::{POINTS, Points};
use super::camber::{Contour, FourDigits, cambered};
use super::family::Family;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, AirfoilGenerator};
use ::mesh::Mesh;
use ::mesh::generate::{AirfoilMesh, NearPart};

const PARAMETERS: &[(&str, &str)] = &[
    ("the points of the contour", "profile"),
    ("the distance of the far field", "far_field"),
    ("the height of the first cell", "first_cell"),
    ("the length of the cell at the trailing edge", "trailing_edge_cell"),
    ("the number of cells along a side", "surface_cells"),
    ("the number of cells along the wake", "wake_cells"),
    ("the extent of the near wake", "near_wake.extent"),
    ("the number of cells of the near wake", "near_wake.cells"),
    ("the number of cells outwards", "normal_cells"),
    ("the extent of the cells near the wall", "near_wall.extent"),
    ("the number of cells near the wall", "near_wall.cells"),
    ("the thickness", "thickness"),
];

pub(super) fn build(checker: &Checker<'_>, given: &AirfoilGenerator, order: usize) -> Checked<Mesh<2>> {
    // The first one is a file of points, the last one the thickness.
    let last = PARAMETERS.len() - 1;
    let parameters = match (&given.profile, &given.naca) {
        (Some(_), _) => &PARAMETERS[..last],
        (None, Some(_)) => &PARAMETERS[1..last],
        (None, None) => &PARAMETERS[1..],
    };
    let family = Family { checker, key: Key::new("mesh.generate.airfoil"), parameters };
    let thickness = given.thickness.unwrap_or(AirfoilMesh::naca0012(order).thickness);
    let AirfoilGenerator { far_field, first_cell, trailing_edge_cell, .. } = *given;
    let AirfoilGenerator { surface_cells, wake_cells, normal_cells, .. } = *given;
    let half = surface_cells.saturating_add(wake_cells);
    family.check_size::<2>("normal_cells", &[2, half, normal_cells], order)?;
    let part = |part: raw::NearPart| NearPart { extent: part.extent, cells: part.cells };
    let contour = contour(&family, given)?;
    let generator = AirfoilMesh {
        thickness: contour.as_ref().map_or(thickness, Shape::thickness),
        far_field,
        first_cell,
        trailing_edge_cell,
        surface_cells,
        wake_cells,
        near_wake: given.near_wake.map(part),
        normal_cells,
        near_wall: given.near_wall.map(part),
        order,
    };
    let mesh = match &contour {
        None => generator.build(),
        // The same bits as by the thickness.
        Some(Shape::Naca(airfoil)) if airfoil.camber == 0.0 => generator.build(),
        Some(Shape::Naca(airfoil)) => {
            let position = |sigma: f64| airfoil.position(&generator, sigma);
            let ends = [-1.0, airfoil.foremost(&generator), 1.0];
            cambered(&generator, &Contour { position: Box::new(position), ends })
        }
        Some(Shape::Points(points)) => cambered(&generator, &points.contour()),
    };
    mesh.map_err(|error| family.refused(error))
}

/// An airfoil that is given by more than its thickness.
enum Shape {
    Naca(FourDigits),
    Points(Points),
}

impl Shape {
    fn thickness(&self) -> f64 {
        match self {
            Shape::Naca(airfoil) => airfoil.thickness,
            Shape::Points(points) => points.contour().thickness(),
        }
    }
}

fn contour(family: &Family<'_>, given: &AirfoilGenerator) -> Checked<Option<Shape>> {
    let (checker, key) = (family.checker, |name: &str| family.key.child(name));
    let ways = [given.thickness.is_some(), given.naca.is_some(), given.profile.is_some()];
    if ways.iter().filter(|way| **way).count() > 1 {
        let accepted = "one of `thickness`, `naca` and `profile`";
        return Err(checker.combination(&family.key, "the airfoil is given twice", accepted));
    }
    match (&given.naca, &given.profile) {
        (Some(digits), _) => {
            let accepted =
                "four digits such as \"2412\": camber, its place, and a thickness from 01 to 50; \"0012\" is symmetric";
            let airfoil = FourDigits::of(digits);
            checker.require(&key("naca"), "the airfoil", airfoil.is_some(), accepted)?;
            Ok(airfoil.map(Shape::Naca))
        }
        (None, Some(file)) => {
            let key = key("profile");
            let read = Points::read(&checker.beside_case(file)).map_err(|cause| checker.error(&key, *cause))?;
            let points = read.map_err(|problem| checker.combination(&key, &problem, POINTS))?;
            Ok(Some(Shape::Points(points)))
        }
        (None, None) => Ok(None),
    }
}
