//! Kinds of elements.

use mesh::Shape;

/// A kind of element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kind {
    /// The name in the standard.
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    pub(crate) degree: usize,
    /// The number of nodes.
    pub(crate) n_nodes: usize,
    /// Whether the nodes form the whole lattice: equidistant, with all inner nodes.
    pub(crate) is_lattice: bool,
}

/// The number of the kind in which every element is preceded by its own.
pub(crate) const MIXED: i64 = 20;

/// Kinds by their number: name, shape, degree, number of nodes.
const KINDS: [(i64, &str, Shape, usize, usize); 36] = {
    use Shape::{Hexahedron, Line, Point, Prism, Quadrilateral, Tetrahedron, Triangle};
    [
        (2, "NODE", Point, 1, 1),
        (3, "BAR_2", Line, 1, 2),
        (4, "BAR_3", Line, 2, 3),
        (24, "BAR_4", Line, 3, 4),
        (40, "BAR_5", Line, 4, 5),
        (5, "TRI_3", Triangle, 1, 3),
        (6, "TRI_6", Triangle, 2, 6),
        (25, "TRI_9", Triangle, 3, 9),
        (26, "TRI_10", Triangle, 3, 10),
        (41, "TRI_12", Triangle, 4, 12),
        (42, "TRI_15", Triangle, 4, 15),
        (7, "QUAD_4", Quadrilateral, 1, 4),
        (8, "QUAD_8", Quadrilateral, 2, 8),
        (9, "QUAD_9", Quadrilateral, 2, 9),
        (27, "QUAD_12", Quadrilateral, 3, 12),
        (28, "QUAD_16", Quadrilateral, 3, 16),
        (43, "QUAD_P4_16", Quadrilateral, 4, 16),
        (44, "QUAD_25", Quadrilateral, 4, 25),
        (10, "TETRA_4", Tetrahedron, 1, 4),
        (11, "TETRA_10", Tetrahedron, 2, 10),
        (29, "TETRA_16", Tetrahedron, 3, 16),
        (30, "TETRA_20", Tetrahedron, 3, 20),
        (45, "TETRA_22", Tetrahedron, 4, 22),
        (47, "TETRA_35", Tetrahedron, 4, 35),
        (14, "PENTA_6", Prism, 1, 6),
        (15, "PENTA_15", Prism, 2, 15),
        (16, "PENTA_18", Prism, 2, 18),
        (34, "PENTA_24", Prism, 3, 24),
        (36, "PENTA_40", Prism, 3, 40),
        (53, "PENTA_75", Prism, 4, 75),
        (17, "HEXA_8", Hexahedron, 1, 8),
        (18, "HEXA_20", Hexahedron, 2, 20),
        (19, "HEXA_27", Hexahedron, 2, 27),
        (37, "HEXA_32", Hexahedron, 3, 32),
        (39, "HEXA_64", Hexahedron, 3, 64),
        (56, "HEXA_125", Hexahedron, 4, 125),
    ]
};

impl Kind {
    /// The kind with number `code`, or the reason why it is not supported.
    pub(crate) fn from_code(code: i64) -> Result<Kind, String> {
        if let Some(&(_, name, shape, degree, n_nodes)) = KINDS.iter().find(|(known, ..)| *known == code) {
            let is_lattice = n_nodes == lattice(shape, degree);
            return Ok(Kind { name, shape, degree, n_nodes, is_lattice });
        }
        Err(match code {
            12 | 13 | 21 | 31..=33 | 48..=50 => {
                "pyramids are not supported: mesh all volumes with tetrahedra and prisms, or all with hexahedra".into()
            }
            22 | 23 => "elements of the kinds NGON_n and NFACE_n (polygons and polyhedra) are not supported: save \
                        sections of QUAD_4, HEXA_8 or their kinds of higher order"
                .into(),
            _ => format!(
                "elements of type {code} are not supported: use quadrilaterals or hexahedra with all inner nodes"
            ),
        })
    }

    /// Refuses a kind of cell whose nodes do not form the whole lattice.
    pub(crate) fn check_cell(self) -> Result<Kind, String> {
        match self.is_lattice {
            true => Ok(self),
            false if self.degree == 4 && [15, 35, 75].contains(&self.n_nodes) => Err(format!(
                "elements of the kind {}, whose inner nodes are not evenly spaced, are not supported: save triangles, \
                 tetrahedra and prisms of degree 3 or less",
                self.name
            )),
            false => Err(format!(
                "elements of the kind {}, without all inner nodes, are not supported: save QUAD_9, QUAD_16 or QUAD_25, \
                 HEXA_27, HEXA_64 or HEXA_125, or straight cells",
                self.name
            )),
        }
    }
}

/// The number of nodes of an element if the standard places them equidistantly, 0 otherwise.
fn lattice(shape: Shape, degree: usize) -> usize {
    let (line, triangle) = (degree + 1, (degree + 1) * (degree + 2) / 2);
    match shape {
        Shape::Point => 1,
        Shape::Line => line,
        Shape::Quadrilateral => line * line,
        Shape::Hexahedron => line * line * line,
        _ if degree > 3 => 0,
        Shape::Triangle => triangle,
        Shape::Tetrahedron => triangle * (degree + 3) / 3,
        Shape::Prism => triangle * line,
    }
}
