//! `[mesh.generate.closed_body]`

use super::family::Family;
use super::point_file;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{BodyPoints, ClosedBodyGenerator};
use ::mesh::generate::{ClosedBodyMesh, ClosedCurve};
use ::mesh::{Mesh, MeshError};

const PARAMETERS: &[(&str, &str)] = &[
    ("the area within the points", "points"),
    ("the radius of the far field", "outer_radius"),
    ("the radius of the far field less the largest distance of the wall from its centroid", "outer_radius"),
    ("the height of the first cell", "first_cell"),
    ("the number of cells around", "cells.0"),
    ("the number of cells outwards", "cells.1"),
];

/// The requirements on a body, for the error of an inverted cell.
const REMEDY: &str = "a smooth closed curve that does not cross itself and is at most slightly concave, with points in order; more \
                      `cells` around, a smaller `first_cell`, a larger `outer_radius`, or a higher order; for other bodies a file of Gmsh, `mesh.file`";

pub(super) fn build(checker: &Checker<'_>, raw: &ClosedBodyGenerator, order: usize) -> Checked<Mesh<2>> {
    let family = Family { checker, key: Key::new("mesh.generate.closed_body"), parameters: PARAMETERS };
    let ClosedBodyGenerator { outer_radius, first_cell, cells, .. } = *raw;
    family.check_size::<2>("cells", &cells, order)?;
    let generator = ClosedBodyMesh { body: body(&family, &raw.points)?, outer_radius, first_cell, cells, order };
    generator.build().map_err(|error| match error {
        MeshError::Inverted { .. } | MeshError::Degenerate { .. } => {
            checker.combination(&family.key, &error.to_string(), REMEDY)
        }
        error => family.refused(error),
    })
}

/// The curve through the points.
fn body(family: &Family<'_>, points: &BodyPoints) -> Checked<ClosedCurve> {
    let (checker, key) = (family.checker, family.key.child("points"));
    let points = match points {
        BodyPoints::List(points) => points.clone(),
        BodyPoints::File(file) => {
            point_file::read(&checker.beside_case(file)).map_err(|cause| checker.error(&key, *cause))?
        }
    };
    ClosedCurve::through(&points).map_err(|error| family.refused_at(&key, error))
}
