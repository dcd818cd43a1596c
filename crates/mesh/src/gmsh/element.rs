//! Kinds of elements.

use super::shape::{Node, Shape};

/// The meaning of a type number: a shape with all its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind {
    pub(super) shape: Shape,
    pub(super) degree: usize,
}

/// Type numbers of degree 1, 2, ..
const FAMILIES: [(Shape, &[i64]); 7] = [
    (Shape::Point, &[15]),
    (Shape::Line, &[1, 8, 26, 27, 28, 62, 63, 64, 65, 66]),
    (Shape::Triangle, &[2, 9, 21, 23, 25, 42, 43, 44, 45, 46]),
    (Shape::Quadrilateral, &[3, 10, 36, 37, 38, 47, 48, 49, 50, 51]),
    (Shape::Tetrahedron, &[4, 11, 29, 30, 31, 71, 72, 73, 74, 75]),
    (Shape::Prism, &[6, 13, 90, 91, 106, 107, 108, 109, 110]),
    (Shape::Hexahedron, &[5, 12, 92, 93, 94, 95, 96, 97, 98]),
];

impl Kind {
    /// The kind with type number `code`, or the name of an unsupported kind.
    pub(super) fn from_code(code: i64) -> Result<Kind, &'static str> {
        for (shape, codes) in FAMILIES {
            if let Some(index) = codes.iter().position(|&known| known == code) {
                return Ok(Kind { shape, degree: index + 1 });
            }
        }
        Err(match code {
            7 | 14 | 19 | 118..=131 => {
                "pyramids, which join hexahedra to tetrahedra: mesh all volumes with tetrahedra, or all with hexahedra"
            }
            16..=18 | 20 | 22 | 24 | 32 | 33 | 39..=41 | 52..=61 | 79..=83 | 99..=105 | 111..=117 | 137 => {
                "without inner nodes; set Mesh.SecondOrderIncomplete to 0"
            }
            _ => "unknown",
        })
    }

    /// The kind, if it is supported.
    pub(super) fn known(shape: Shape, degree: usize) -> Option<Kind> {
        let codes = FAMILIES.iter().find(|(known, _)| *known == shape).map_or(0, |(_, codes)| codes.len());
        (1..=codes).contains(&degree).then_some(Kind { shape, degree })
    }

    /// The type number.
    #[cfg(test)]
    pub(super) fn code(self) -> i64 {
        let codes = FAMILIES.iter().find(|(shape, _)| *shape == self.shape).map_or(&[0][..], |(_, codes)| codes);
        codes[self.degree - 1]
    }

    /// The cells of this program.
    pub(super) fn of_cell(dimension: usize, degree: usize) -> Kind {
        let shape = if dimension == 2 { Shape::Quadrilateral } else { Shape::Hexahedron };
        Kind { shape, degree }
    }

    pub(super) fn dimension(self) -> usize {
        self.shape.dimension()
    }

    /// The number of nodes of an element: the product over its simplices, of dimension d, of
    ///
    /// ```text
    /// (p + 1) (p + 2) .. (p + d) / d!
    /// ```
    pub(super) fn n_nodes(self) -> usize {
        let of_simplex = |&d: &usize| (1..=d).fold(1, |count, k| count * (self.degree + k) / k);
        self.shape.factors().iter().map(of_simplex).product()
    }

    /// The lattice positions of the nodes, in the order of the file.
    pub(super) fn nodes(self) -> Vec<Node> {
        self.shape.nodes(self.degree)
    }

    /// For each node, in the order of the file, its index in the lattice of a cell, axis 0 fastest. The shape is a
    /// product of lines.
    pub(super) fn lattice_indices(self) -> Vec<usize> {
        let n = self.degree + 1;
        let index = |node: &Node| (0..self.dimension()).rev().fold(0, |index, a| index * n + node[a]);
        self.nodes().iter().map(index).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_lattice_node_is_listed_once() {
        for (shape, codes) in FAMILIES {
            for degree in 1..=codes.len() {
                let kind = Kind { shape, degree };
                let nodes = kind.nodes();
                let distinct: BTreeSet<Node> = nodes.iter().copied().collect();
                assert_eq!((nodes.len(), distinct.len()), (kind.n_nodes(), kind.n_nodes()), "{kind:?}");
                assert!(nodes.iter().all(|&node| is_inside(kind, node)), "{kind:?}");
            }
        }
    }

    /// Whether the coordinates of every simplex have a sum of at most the degree.
    fn is_inside(kind: Kind, node: Node) -> bool {
        let mut axis = 0;
        kind.shape.factors().iter().all(|&d| {
            axis += d;
            node[axis - d..axis].iter().sum::<usize>() <= kind.degree
        })
    }

    /// The positions of nodes, one digit per axis, as Gmsh 4.15 gives them.
    #[test]
    fn simplices_and_prisms_as_gmsh_lists_them() {
        let listed = |code: i64| {
            let kind = Kind::from_code(code).unwrap();
            let digits = |node: &Node| node[..kind.dimension()].iter().map(|x| x.to_string()).collect::<String>();
            kind.nodes().iter().map(digits).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(listed(23), "00 40 04 10 20 30 31 22 13 03 02 01 11 21 12");
        assert_eq!(listed(25), "00 50 05 10 20 30 40 41 32 23 14 04 03 02 01 11 31 13 21 22 12");
        assert_eq!(listed(29), "000 300 030 003 100 200 210 120 020 010 002 001 012 021 102 201 110 101 011 111");
        let corners = "000 500 050 005 100 200 300 400 410 320 230 140 040 030 020 010 004 003 002 001";
        let edges = "014 023 032 041 104 203 302 401 110 130 310 120 220 210 101 301 103 201 202 102";
        let faces = "011 013 031 012 022 021 113 311 131 212 221 122 111 211 121 112";
        assert_eq!(listed(31), format!("{corners} {edges} {faces}"));
        assert_eq!(listed(13), "000 200 020 002 202 022 100 010 001 110 201 021 102 012 112 101 011 111");
        let corners = "000 400 040 004 404 044 100 200 300 010 020 030 001 002 003 310 220 130 401 402 403 041 042 043";
        let edges = "104 204 304 014 024 034 314 224 134 110 120 210 114 214 124 101 301 303 103 201 302 203 102 202";
        let faces = "011 013 033 031 012 023 032 021 022 311 131 133 313 221 132 223 312 222";
        assert_eq!(listed(91), format!("{corners} {edges} {faces} 111 113 112 211 213 212 121 123 122"));
    }

    /// The figures of the Gmsh reference manual, section "Node ordering".
    #[test]
    fn elements_of_degree_2_as_in_the_manual() {
        assert_eq!(Kind::from_code(8).unwrap().lattice_indices(), [0, 2, 1]);
        assert_eq!(Kind::from_code(10).unwrap().lattice_indices(), [0, 2, 8, 6, 1, 5, 7, 3, 4]);
        let corners = [0, 2, 8, 6, 18, 20, 26, 24];
        let edges = [1, 3, 9, 5, 11, 7, 17, 15, 19, 21, 23, 25];
        let faces = [4, 10, 12, 14, 16, 22];
        let expected: Vec<usize> = corners.into_iter().chain(edges).chain(faces).chain([13]).collect();
        assert_eq!(Kind::from_code(12).unwrap().lattice_indices(), expected);
        assert_eq!(Kind::from_code(36).unwrap().lattice_indices()[..6], [0, 3, 15, 12, 1, 2]);
        assert_eq!(Kind::from_code(36).unwrap().lattice_indices()[6..], [7, 11, 14, 13, 8, 4, 5, 6, 10, 9]);
    }

    #[test]
    fn other_types_are_named() {
        assert!(Kind::from_code(7).unwrap_err().contains("pyramids"));
        for incomplete in [17, 18, 20, 32, 111] {
            assert!(Kind::from_code(incomplete).unwrap_err().contains("SecondOrderIncomplete"));
        }
        assert_eq!(Kind::from_code(-1), Err("unknown"));
    }
}
