//! Shapes of elements, and the order in which Gmsh lists their nodes.

/// A shape: a product of simplices. A simplex of dimension d has the reference coordinates x_a >= 0 with a sum of at
/// most 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// One node.
    Point,
    /// A line.
    Line,
    /// A simplex of dimension 2.
    Triangle,
    /// A product of two lines.
    Quadrilateral,
    /// A simplex of dimension 3.
    Tetrahedron,
    /// The product of a triangle and a line.
    Prism,
    /// A product of three lines.
    Hexahedron,
}

/// A lattice position: a reference point of an element, times the degree.
pub(super) type Node = [usize; 3];

/// A face: its shape, its origin and the ends of its two axes, as corners of the element.
type Face = (Shape, [usize; 3]);

/// Corners as Gmsh numbers them; the first 2^D are those of a line, a quadrilateral, a hexahedron.
const CORNERS: [Node; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Corners of a tetrahedron; the first three are those of a triangle.
const SIMPLEX_CORNERS: [Node; 4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
const PRISM_CORNERS: [Node; 6] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]];

/// Edges as pairs of corners, in the order and direction in which their nodes are listed.
const LINE_EDGES: [[usize; 2]; 1] = [[0, 1]];
const TRIANGLE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
const QUADRILATERAL_EDGES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [3, 0], [3, 2], [3, 1]];
const PRISM_EDGES: [[usize; 2]; 9] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [3, 5], [4, 5]];
const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]];

const TETRAHEDRON_FACES: [Face; 4] = {
    use Shape::Triangle;
    [(Triangle, [0, 2, 1]), (Triangle, [0, 1, 3]), (Triangle, [0, 3, 2]), (Triangle, [3, 1, 2])]
};
const PRISM_FACES: [Face; 5] = {
    use Shape::{Quadrilateral, Triangle};
    [
        (Triangle, [0, 2, 1]),
        (Triangle, [3, 4, 5]),
        (Quadrilateral, [0, 1, 3]),
        (Quadrilateral, [0, 3, 2]),
        (Quadrilateral, [1, 2, 4]),
    ]
};
const HEXAHEDRON_FACES: [Face; 6] = {
    use Shape::Quadrilateral;
    [
        (Quadrilateral, [0, 3, 1]),
        (Quadrilateral, [0, 1, 4]),
        (Quadrilateral, [0, 4, 3]),
        (Quadrilateral, [1, 2, 5]),
        (Quadrilateral, [2, 3, 6]),
        (Quadrilateral, [4, 5, 7]),
    ]
};

impl Shape {
    /// The shape is a product of simplices of these dimensions, in the order of the axes.
    pub(super) fn factors(self) -> &'static [usize] {
        match self {
            Shape::Point => &[],
            Shape::Line => &[1],
            Shape::Triangle => &[2],
            Shape::Quadrilateral => &[1, 1],
            Shape::Tetrahedron => &[3],
            Shape::Prism => &[2, 1],
            Shape::Hexahedron => &[1, 1, 1],
        }
    }

    /// The dimension of the shape.
    pub fn dimension(self) -> usize {
        self.factors().iter().sum()
    }

    /// Whether it is a cell of this program: a product of lines.
    pub(super) fn is_product_of_lines(self) -> bool {
        self.factors().iter().all(|&dimension| dimension == 1)
    }

    /// The lattice positions of the corners for degree 1, in the order of Gmsh and of CGNS.
    pub fn corners(self) -> &'static [[usize; 3]] {
        match self {
            Shape::Triangle => &SIMPLEX_CORNERS[..3],
            Shape::Tetrahedron => &SIMPLEX_CORNERS,
            Shape::Prism => &PRISM_CORNERS,
            _ => &CORNERS[..1 << self.dimension()],
        }
    }

    pub(super) fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Shape::Point => &[],
            Shape::Line => &LINE_EDGES,
            Shape::Triangle => &TRIANGLE_EDGES,
            Shape::Quadrilateral => &QUADRILATERAL_EDGES,
            Shape::Tetrahedron => &TETRAHEDRON_EDGES,
            Shape::Prism => &PRISM_EDGES,
            Shape::Hexahedron => &HEXAHEDRON_EDGES,
        }
    }

    pub(super) fn faces(self) -> &'static [Face] {
        match self {
            Shape::Tetrahedron => &TETRAHEDRON_FACES,
            Shape::Prism => &PRISM_FACES,
            Shape::Hexahedron => &HEXAHEDRON_FACES,
            _ => &[],
        }
    }

    /// The lattice positions, in 0..=degree along each axis, of the nodes of an element: corners, the inside of edges,
    /// the inside of faces, the inside.
    pub(super) fn nodes(self, degree: usize) -> Vec<Node> {
        if degree == 0 {
            return vec![[0; 3]];
        }
        let mut nodes: Vec<Node> = self.corners().iter().map(|corner| corner.map(|c| c * degree)).collect();
        for &[from, to] in self.edges() {
            nodes.extend((1..degree).map(|k| self.between(degree, from, &[to], &[k])));
        }
        for &(face, [origin, first, second]) in self.faces() {
            let inside = face.inside(degree).into_iter();
            nodes.extend(inside.map(|[i, j, _]| self.between(degree, origin, &[first, second], &[i, j])));
        }
        nodes.extend(self.inside(degree));
        nodes
    }

    /// The nodes inside of an element are ordered like those of an element of a lower degree. The nodes inside of a
    /// prism are ordered by the triangle first.
    fn inside(self, degree: usize) -> Vec<Node> {
        let smaller = |shape: Shape, by: usize| degree.checked_sub(by).map_or(Vec::new(), |degree| shape.nodes(degree));
        let nodes = match self {
            Shape::Point | Shape::Line => Vec::new(),
            Shape::Triangle => smaller(self, 3),
            Shape::Tetrahedron => smaller(self, 4),
            Shape::Quadrilateral | Shape::Hexahedron => smaller(self, 2),
            Shape::Prism => {
                let line = smaller(Shape::Line, 2);
                let column = |[i, j, _]: Node| line.iter().map(move |&[k, ..]| [i, j, k]);
                smaller(Shape::Triangle, 3).into_iter().flat_map(column).collect()
            }
        };
        let dimension = self.dimension();
        let shifted = |node: Node| std::array::from_fn(|a| if a < dimension { node[a] + 1 } else { 0 });
        nodes.into_iter().map(shifted).collect()
    }

    /// In an element of `degree`, the lattice position that is `steps[k]` steps from corner `origin` towards corner `ends[k]`, for
    /// all k.
    pub fn between(self, degree: usize, origin: usize, ends: &[usize], steps: &[usize]) -> [usize; 3] {
        let corners = self.corners();
        std::array::from_fn(|a| {
            let start = corners[origin][a] * degree;
            ends.iter().zip(steps).fold(start, |x, (&end, step)| match (corners[origin][a], corners[end][a]) {
                (0, 1) => x + step,
                (1, 0) => x - step,
                _ => x,
            })
        })
    }
}
