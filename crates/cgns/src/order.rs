//! The order of the nodes of elements in CGNS.
//!
//! The corners are those of Gmsh, see [`Shape::corners`]. Edges, faces and the inside are not.
//!
//! The standard, SIDS section "Unstructured grid element numbering conventions", lists corners, then the inside of edges,
//! faces and the element. The inside of a square is listed ring by ring from the outside. Each ring begins at the corner
//! near the origin and follows the first axis. The inside of a hexahedron or prism is listed plane by plane along the last
//! axis.

use mesh::Shape;

/// A lattice position: reference coordinates times the degree.
type Node = [usize; 3];

/// A face: its shape, its origin and the ends of its two axes, as corners of the element.
type Face = (Shape, [usize; 3]);

const LINE_EDGES: [[usize; 2]; 1] = [[0, 1]];
const TRIANGLE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
const QUADRILATERAL_EDGES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const PRISM_EDGES: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 4], [2, 5], [3, 4], [4, 5], [5, 3]];
const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 5], [2, 6], [3, 7], [4, 5], [5, 6], [6, 7], [7, 4]];

const TETRAHEDRON_FACES: [Face; 4] = {
    use Shape::Triangle;
    [(Triangle, [0, 1, 2]), (Triangle, [0, 1, 3]), (Triangle, [1, 2, 3]), (Triangle, [2, 0, 3])]
};
const PRISM_FACES: [Face; 5] = {
    use Shape::{Quadrilateral, Triangle};
    [
        (Triangle, [0, 1, 2]),
        (Quadrilateral, [0, 1, 3]),
        (Quadrilateral, [1, 2, 4]),
        (Quadrilateral, [2, 0, 5]),
        (Triangle, [3, 4, 5]),
    ]
};
const HEXAHEDRON_FACES: [Face; 6] = {
    use Shape::Quadrilateral;
    [
        (Quadrilateral, [0, 1, 3]),
        (Quadrilateral, [0, 1, 4]),
        (Quadrilateral, [1, 2, 5]),
        (Quadrilateral, [2, 3, 6]),
        (Quadrilateral, [3, 0, 7]),
        (Quadrilateral, [4, 5, 7]),
    ]
};

/// For each node in the order of [`mesh::ListedElement`], its index in the order of CGNS.
pub(crate) fn from_cgns(shape: Shape, degree: usize) -> Vec<usize> {
    let nodes = nodes(shape, degree);
    let mut indices: Vec<usize> = (0..nodes.len()).collect();
    indices.sort_by_key(|&index| {
        let [i, j, k] = nodes[index];
        [k, j, i]
    });
    indices
}

/// The lattice positions of the nodes in the order of CGNS.
fn nodes(shape: Shape, degree: usize) -> Vec<Node> {
    let mut nodes: Vec<Node> = shape.corners().iter().map(|corner| corner.map(|c| c * degree)).collect();
    for &[from, to] in edges(shape) {
        nodes.extend((1..degree).map(|step| shape.between(degree, from, &[to], &[step])));
    }
    for &(face, [origin, first, second]) in faces(shape) {
        let inside = inside_of_face(face, degree).into_iter();
        nodes.extend(inside.map(|steps| shape.between(degree, origin, &[first, second], &steps)));
    }
    nodes.extend(inside(shape, degree));
    nodes
}

fn edges(shape: Shape) -> &'static [[usize; 2]] {
    match shape {
        Shape::Point => &[],
        Shape::Line => &LINE_EDGES,
        Shape::Triangle => &TRIANGLE_EDGES,
        Shape::Quadrilateral => &QUADRILATERAL_EDGES,
        Shape::Tetrahedron => &TETRAHEDRON_EDGES,
        Shape::Prism => &PRISM_EDGES,
        Shape::Hexahedron => &HEXAHEDRON_EDGES,
    }
}

fn faces(shape: Shape) -> &'static [Face] {
    match shape {
        Shape::Tetrahedron => &TETRAHEDRON_FACES,
        Shape::Prism => &PRISM_FACES,
        Shape::Hexahedron => &HEXAHEDRON_FACES,
        _ => &[],
    }
}

/// Steps along the axes of a face to the nodes inside. A triangle of degree 3, the highest, has one.
fn inside_of_face(face: Shape, degree: usize) -> Vec<[usize; 2]> {
    match face {
        Shape::Triangle if degree < 3 => Vec::new(),
        Shape::Triangle => vec![[1, 1]],
        _ => rings(1, degree.saturating_sub(1)),
    }
}

/// The square of the positions `first..=last` along two axes, ring by ring from the outside, each ring from
/// `[first, first]` along axis 0.
fn rings(first: usize, last: usize) -> Vec<[usize; 2]> {
    if first >= last {
        return if first == last { vec![[first, first]] } else { Vec::new() };
    }
    let mut nodes: Vec<[usize; 2]> = (first..last).map(|k| [k, first]).collect();
    nodes.extend((first..last).map(|k| [last, k]));
    nodes.extend((first + 1..=last).rev().map(|k| [k, last]));
    nodes.extend((first + 1..=last).rev().map(|k| [first, k]));
    nodes.extend(rings(first + 1, last - 1));
    nodes
}

/// The nodes that lie on no face, and of a plane element on no edge.
fn inside(shape: Shape, degree: usize) -> Vec<Node> {
    let plane = |face, k| inside_of_face(face, degree).into_iter().map(move |[i, j]| [i, j, k]);
    match shape {
        Shape::Triangle | Shape::Quadrilateral => plane(shape, 0).collect(),
        Shape::Prism => (1..degree).flat_map(|k| plane(Shape::Triangle, k)).collect(),
        Shape::Hexahedron => (1..degree).flat_map(|k| plane(Shape::Quadrilateral, k)).collect(),
        Shape::Point | Shape::Line | Shape::Tetrahedron => Vec::new(),
    }
}
