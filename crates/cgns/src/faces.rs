//! Faces of elements. In two dimensions the faces of a cell are its edges.

use mesh::{ListedElement, Shape};

/// The vertices of a face, around it.
pub(crate) type Face = Vec<usize>;

/// The vertices of a face in increasing order, filled up with the largest number.
pub(crate) type Key = [u32; 4];

pub(crate) fn key(face: &[usize]) -> Key {
    let mut key = [u32::MAX; 4];
    for (entry, &vertex) in key.iter_mut().zip(face) {
        *entry = vertex as u32;
    }
    key.sort_unstable();
    key
}

/// The face as an element of degree 1.
pub(crate) fn element(face: &[usize], names: Vec<usize>) -> ListedElement {
    let (shape, nodes) = match *face {
        [a, b] => (Shape::Line, vec![a, b]),
        [a, b, c] => (Shape::Triangle, vec![a, b, c]),
        [a, b, c, d] => (Shape::Quadrilateral, vec![a, b, d, c]),
        _ => (Shape::Point, face.to_vec()),
    };
    ListedElement { shape, degree: 1, nodes, names }
}

/// The nodes at the corners of an element, in the order of CGNS.
pub(crate) fn corners(element: &ListedElement) -> Face {
    let p = element.degree;
    let triangle = (p + 1) * (p + 2) / 2;
    let (square, layer) = ([0, p, (p + 1) * (p + 1) - 1, (p + 1) * p], (p + 1) * (p + 1));
    let indices = match element.shape {
        Shape::Point => vec![0],
        Shape::Line => vec![0, p],
        Shape::Triangle => vec![0, p, triangle - 1],
        Shape::Quadrilateral => square.to_vec(),
        Shape::Tetrahedron => vec![0, p, triangle - 1, element.nodes.len() - 1],
        Shape::Prism => (0..2).flat_map(|k| [0, p, triangle - 1].map(|index| index + k * p * triangle)).collect(),
        Shape::Hexahedron => (0..2).flat_map(|k| square.map(|index| index + k * p * layer)).collect(),
    };
    indices.into_iter().map(|index| element.nodes[index]).collect()
}

/// The faces of a cell, as numbers of its corners in the order of CGNS.
fn faces(shape: Shape) -> &'static [&'static [usize]] {
    match shape {
        Shape::Triangle => &[&[0, 1], &[1, 2], &[2, 0]],
        Shape::Quadrilateral => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
        Shape::Tetrahedron => &[&[0, 1, 2], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        Shape::Prism => &[&[0, 1, 2], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5], &[3, 4, 5]],
        Shape::Hexahedron => {
            &[&[0, 1, 2, 3], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7], &[4, 5, 6, 7]]
        }
        Shape::Point | Shape::Line => &[],
    }
}

/// The faces of `elements` of dimension `dimension` that belong to one of them only.
pub(crate) fn outer(elements: &[ListedElement], dimension: usize) -> Vec<Face> {
    let mut all: Vec<(Key, u32, u8)> = Vec::new();
    for (cell, element) in elements.iter().enumerate().filter(|(_, element)| element.shape.dimension() == dimension) {
        for index in 0..faces(element.shape).len() {
            all.push((key(&face(element, index)), cell as u32, index as u8));
        }
    }
    all.sort_unstable();
    let single = all.chunk_by(|one, other| one.0 == other.0).filter(|equal| equal.len() == 1);
    single.map(|equal| face(&elements[equal[0].1 as usize], usize::from(equal[0].2))).collect()
}

/// Face `index` of a cell.
fn face(cell: &ListedElement, index: usize) -> Face {
    let corners = corners(cell);
    faces(cell.shape)[index].iter().map(|&corner| corners[corner]).collect()
}
