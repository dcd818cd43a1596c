//! Faces of a cell, and the relation of the lattices of two cells on a facet.

/// One face of one cell. `face` = 2 axis + side, side 0 at xi_axis = -1 and side 1 at xi_axis = +1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Side {
    /// The cell.
    pub cell: usize,
    /// Its face.
    pub face: usize,
}

/// A facet between two cells. Its normal points from `minus` to `plus`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InteriorFacet {
    /// The side that the normal points away from.
    pub minus: Side,
    /// The side that the normal points to.
    pub plus: Side,
    /// The lattice of `plus` relative to that of `minus`.
    pub orientation: Orientation,
    /// Whether the two sides are a translation apart.
    pub periodic: bool,
}

/// A facet on the boundary of the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// The cell and its face.
    pub side: Side,
    /// Index into [`crate::Mesh::boundary_names`].
    pub boundary: usize,
}

/// The axis normal to face `face`, and its side: 0 low, 1 high.
pub const fn axis_and_side(face: usize) -> (usize, usize) {
    (face / 2, face % 2)
}

/// The lattice indices of the nodes on `face`, for a cell with `n` nodes per direction. They come in the order of the
/// face's own lattice: the remaining axes in increasing order, the first one fastest. `n` = 2 gives the corners.
pub fn face_nodes(dimension: usize, n: usize, face: usize) -> Vec<usize> {
    let (axis, side) = axis_and_side(face);
    let stride = n.pow(axis as u32);
    let fixed = side * (n - 1) * stride;
    // The digits of i below `axis` keep their position, higher digits move up by one.
    (0..n.pow(dimension as u32 - 1)).map(|i| i % stride + i / stride * stride * n + fixed).collect()
}

/// The index of corner `k` of a cell (bit a: the side along axis a) in the lattice of the cell with `n` nodes per
/// direction.
pub fn corner_node(dimension: usize, n: usize, k: usize) -> usize {
    (0..dimension).map(|a| (k >> a & 1) * (n - 1) * n.pow(a as u32)).sum()
}

/// +1 if the outward normal of `face` points along its axis, -1 if it points against it.
pub const fn outward_sign(face: usize) -> f64 {
    if face % 2 == 1 { 1.0 } else { -1.0 }
}

/// +1 if the tangents along the axes of the face's lattice give the outward normal, -1 if they give the inward one.
///
/// The normal from tangents is the cross product in 3-D, and (t_x, t_y) -> (t_y, -t_x) in 2-D. Both give +e_0 for axis
/// 0 and -e_1 for axis 1. The cross product gives +e_2 for axis 2.
pub const fn tangent_sign(face: usize) -> f64 {
    let parity = if face / 2 == 1 { -1.0 } else { 1.0 };
    parity * outward_sign(face)
}

/// The face lattice of the plus side relative to that of the minus side. (i_0, i_1) becomes (i_1, i_0) if `swap`; then
/// index k is counted from the other end if `flip[k]`. In 2-D only `flip[0]` is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Orientation {
    swap: bool,
    flip: [bool; 2],
}

impl Orientation {
    /// The lexicographic index in the plus face's lattice of the node with index `i` in the minus face's lattice, with
    /// `n` nodes per direction on a facet of dimension `facet_dimension` (D - 1: 1 or 2).
    pub fn plus_index(self, facet_dimension: usize, n: usize, i: usize) -> usize {
        let turned = |k: usize, index: usize| if self.flip[k] { n - 1 - index } else { index };
        if facet_dimension == 1 {
            return turned(0, i);
        }
        let (i0, i1) = (i % n, i / n);
        let (j0, j1) = if self.swap { (i1, i0) } else { (i0, i1) };
        turned(0, j0) + n * turned(1, j1)
    }

    /// +1 if both lattices turn the same way, -1 if they are mirrored.
    pub fn parity(self) -> f64 {
        let [first, second] = self.flip;
        if self.swap ^ first ^ second { -1.0 } else { 1.0 }
    }

    /// The orientation that maps the vertices `minus` of a face (2 or 4, in the order of the face's lattice) to the
    /// same vertices in the order of the other side. `None` if there is none.
    pub fn from_corners(minus: &[usize], plus: &[usize]) -> Option<Self> {
        let facet_dimension = match (minus.len(), plus.len()) {
            (2, 2) => 1,
            (4, 4) => 2,
            _ => return None,
        };
        let carries = |o: &Orientation| (0..minus.len()).all(|i| minus[i] == plus[o.plus_index(facet_dimension, 2, i)]);
        Self::all(facet_dimension).into_iter().find(carries)
    }

    /// The 2 orientations of an edge, or the 8 of a quadrilateral.
    pub fn all(facet_dimension: usize) -> Vec<Self> {
        let bit = |code: usize, k: usize| code >> k & 1 == 1;
        let count = if facet_dimension == 1 { 2 } else { 8 };
        (0..count).map(|code| Orientation { flip: [bit(code, 0), bit(code, 1)], swap: bit(code, 2) }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn face_lattices_of_a_cube() {
        assert_eq!(face_nodes(3, 2, 0), [0, 2, 4, 6]);
        assert_eq!(face_nodes(3, 2, 3), [2, 3, 6, 7]);
        assert_eq!(face_nodes(3, 3, 5), [18, 19, 20, 21, 22, 23, 24, 25, 26]);
        assert_eq!(face_nodes(2, 3, 1), [2, 5, 8]);
        assert_eq!(face_nodes(2, 3, 2), [0, 1, 2]);
        assert_eq!((0..8).map(|k| corner_node(3, 3, k)).collect::<Vec<_>>(), [0, 2, 6, 8, 18, 20, 24, 26]);
    }

    #[test]
    fn tangents_make_normals_with_the_sign() {
        let unit = |axis: usize| std::array::from_fn::<f64, 3, _>(|i| f64::from(u8::from(i == axis)));
        let cross = |a: [f64; 3], b: [f64; 3]| {
            std::array::from_fn::<f64, 3, _>(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                a[j] * b[k] - a[k] * b[j]
            })
        };
        for face in 0..6 {
            let (axis, _) = axis_and_side(face);
            let tangents: Vec<_> = (0..3).filter(|&a| a != axis).map(unit).collect();
            let normal = cross(tangents[0], tangents[1])[axis] * tangent_sign(face);
            assert_eq!(normal, outward_sign(face));
        }
        // 2-D: the turn of e_1 = (0, 1) is (1, 0), the turn of e_0 is (0, -1).
        assert_eq!((0..4).map(tangent_sign).collect::<Vec<_>>(), [-1.0, 1.0, 1.0, -1.0]);
    }

    #[test]
    fn every_orientation_is_a_permutation_and_is_found_from_its_corners() {
        for dimension in [1, 2] {
            for orientation in Orientation::all(dimension) {
                let n = 4_usize;
                let mut image: Vec<usize> =
                    (0..n.pow(dimension as u32)).map(|i| orientation.plus_index(dimension, n, i)).collect();
                image.sort_unstable();
                assert_eq!(image, (0..image.len()).collect::<Vec<_>>());

                let minus: Vec<usize> = (10..10 + 2_usize.pow(dimension as u32)).collect();
                let mut plus = vec![0; minus.len()];
                for i in 0..minus.len() {
                    plus[orientation.plus_index(dimension, 2, i)] = minus[i];
                }
                assert_eq!(Orientation::from_corners(&minus, &plus), Some(orientation));
            }
        }
        // Opposite corners exchanged: no rotation or reflection of a square.
        assert_eq!(Orientation::from_corners(&[1, 2, 3, 4], &[1, 2, 4, 3]), None);
        assert_eq!(Orientation::from_corners(&[1, 2], &[1, 3]), None);
    }
}
