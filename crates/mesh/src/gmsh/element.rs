//! Kinds of elements, and the order in which Gmsh lists their nodes.

/// The meaning of a type number: a point, line, quadrilateral or hexahedron with all its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    pub(super) dimension: usize,
    pub(super) degree: usize,
}

/// Type numbers of degree 1, 2, ..
const LINES: [i64; 10] = [1, 8, 26, 27, 28, 62, 63, 64, 65, 66];
const QUADRILATERALS: [i64; 10] = [3, 10, 36, 37, 38, 47, 48, 49, 50, 51];
const HEXAHEDRA: [i64; 9] = [5, 12, 92, 93, 94, 95, 96, 97, 98];
const POINT: i64 = 15;

impl Kind {
    /// The kind with type number `code`, or the name of an unsupported kind.
    pub(super) fn from_code(code: i64) -> Result<Kind, &'static str> {
        if code == POINT {
            return Ok(Kind { dimension: 0, degree: 1 });
        }
        let families: [&[i64]; 3] = [&LINES, &QUADRILATERALS, &HEXAHEDRA];
        for (family, codes) in families.into_iter().enumerate() {
            if let Some(index) = codes.iter().position(|&known| known == code) {
                return Ok(Kind { dimension: family + 1, degree: index + 1 });
            }
        }
        Err(match code {
            2 | 9 | 20..=25 | 42..=46 => "triangles",
            4 | 11 | 29..=35 | 71..=75 => "tetrahedra",
            6 | 13 | 18 | 90 | 91 => "prisms",
            7 | 14 | 19 | 118..=124 => "pyramids",
            16 | 17 | 39..=41 => "without inner nodes; set Mesh.SecondOrderIncomplete to 0",
            _ => "unknown",
        })
    }

    /// The number of nodes of an element.
    pub(super) fn n_nodes(self) -> usize {
        (self.degree + 1).pow(self.dimension as u32)
    }

    /// For each node, in the order of the file, its index in the lattice of the cell, axis 0 fastest.
    pub(super) fn lattice_indices(self) -> Vec<usize> {
        let n = self.degree + 1;
        let nodes = nodes(self.dimension, self.degree);
        nodes.iter().map(|node| (0..self.dimension).rev().fold(0, |index, a| index * n + node[a])).collect()
    }
}

type Node = [usize; 3];

/// Corners as Gmsh numbers them; the first 2^D are those of a line, a quadrilateral, a hexahedron.
const CORNERS: [Node; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Edges as pairs of corners, in the order and direction in which their nodes are listed.
const LINE_EDGES: [[usize; 2]; 1] = [[0, 1]];
const QUADRILATERAL_EDGES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]];

/// Faces of a hexahedron: the origin and the ends of the two axes of the quadrilateral.
const HEXAHEDRON_FACES: [[usize; 3]; 6] = [[0, 3, 1], [0, 1, 4], [0, 4, 3], [1, 2, 5], [2, 3, 6], [4, 5, 7]];

/// The lattice positions, in 0..=degree along each axis, of the nodes of an element: corners, the inside of edges, the
/// inside of faces, the inside. The inside of a face or cell is ordered like an element of degree p - 2.
fn nodes(dimension: usize, degree: usize) -> Vec<Node> {
    if degree == 0 || dimension == 0 {
        return vec![[0; 3]];
    }
    let (edges, faces): (&[[usize; 2]], &[[usize; 3]]) = match dimension {
        1 => (&LINE_EDGES, &[]),
        2 => (&QUADRILATERAL_EDGES, &[]),
        _ => (&HEXAHEDRON_EDGES, &HEXAHEDRON_FACES),
    };
    let mut nodes = CORNERS[..1 << dimension].iter().map(|corner| corner.map(|c| c * degree)).collect::<Vec<_>>();
    for [from, to] in edges {
        nodes.extend((1..degree).map(|k| between(degree, *from, &[*to], &[k])));
    }
    if degree >= 2 {
        for [origin, first, second] in faces {
            let inside = self::nodes(2, degree - 2).into_iter();
            nodes.extend(inside.map(|[i, j, _]| between(degree, *origin, &[*first, *second], &[i + 1, j + 1])));
        }
        if dimension > 1 {
            let shifted = |node: Node| std::array::from_fn(|a| if a < dimension { node[a] + 1 } else { 0 });
            nodes.extend(self::nodes(dimension, degree - 2).into_iter().map(shifted));
        }
    }
    nodes
}

/// The lattice position that is `steps[k]` steps from corner `origin` towards corner `ends[k]`, for all k.
fn between(degree: usize, origin: usize, ends: &[usize], steps: &[usize]) -> Node {
    std::array::from_fn(|a| {
        let start = CORNERS[origin][a] * degree;
        ends.iter().zip(steps).fold(start, |x, (&end, step)| match (CORNERS[origin][a], CORNERS[end][a]) {
            (0, 1) => x + step,
            (1, 0) => x - step,
            _ => x,
        })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_lattice_node_is_listed_once() {
        for (dimension, degrees) in [(0, 1), (1, 10), (2, 10), (3, 9)] {
            for degree in 1..=degrees {
                let kind = Kind { dimension, degree };
                let mut indices = kind.lattice_indices();
                indices.sort_unstable();
                assert_eq!(indices, (0..kind.n_nodes()).collect::<Vec<_>>(), "{kind:?}");
            }
        }
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
        assert_eq!(Kind::from_code(2), Err("triangles"));
        assert_eq!(Kind::from_code(4), Err("tetrahedra"));
        assert!(Kind::from_code(17).unwrap_err().contains("SecondOrderIncomplete"));
        assert_eq!(Kind::from_code(-1), Err("unknown"));
    }
}
