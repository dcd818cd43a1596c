//! Zones that are lattices of vertices.

use crate::CgnsError;
use crate::base::{count, read_vertices};
use crate::condition::{Condition, Location, Points, Role};
use crate::faces::Face;
use crate::lists::Lists;
use crate::node::Node;
use crate::unstructured;
use mesh::{ListedElement, Numbers, Shape};

/// A lattice of vertices, the first axis fastest. It has length 1 along missing axes.
struct Lattice {
    /// The index of the first vertex in the lists.
    first: usize,
    lengths: [usize; 3],
    dimension: usize,
}

/// Appends a zone.
pub(crate) fn read(
    lists: &mut Lists,
    zone: &Node,
    conditions: &[Condition],
    cell_names: &[usize],
) -> Result<(), CgnsError> {
    let dimension = lists.dimension;
    let lengths = lengths(zone, dimension)?;
    let vertices = lengths.into_iter().try_fold(1_usize, usize::checked_mul);
    let vertices = vertices.ok_or_else(|| zone.error(format!("its size {lengths:?} is too large")))?;
    let (first, first_cell) = (read_vertices(lists, zone, vertices)?, lists.lists.elements.len());
    let lattice = Lattice { first, lengths, dimension };
    let cells = lengths.map(|length| length - 1);
    lists.begin(format!("{}, cell", zone.path), Numbers::Lattice(cells[..dimension].to_vec()));
    for cell in boxes([0; 3], cells.map(|length| length.max(1))) {
        lists.push(lattice.cell(cell, cell_names));
    }
    conditions.iter().try_for_each(|condition| match read_condition(lists, &lattice, first_cell, condition) {
        // An interface may be a single vertex or an edge.
        Err(_) if condition.role != Role::Boundary => Ok(()),
        read => read,
    })
}

/// The numbers of vertices along the axes.
fn lengths(zone: &Node, dimension: usize) -> Result<[usize; 3], CgnsError> {
    let sizes = zone.integers()?;
    if sizes.len() != 3 * dimension {
        let problem =
            format!("it has {} sizes, a structured zone of dimension {dimension} has 3 per axis", sizes.len());
        return Err(zone.error(problem));
    }
    let mut lengths = [1; 3];
    for (length, &size) in lengths.iter_mut().zip(&sizes[..dimension]) {
        *length = count(zone, size)?;
        if *length < 2 {
            return Err(zone.error(format!("it has {size} vertices along an axis, expected 2 or more")));
        }
    }
    Ok(lengths)
}

/// All indices from `low` to below `high`, the first one fastest.
fn boxes(low: [usize; 3], high: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let plane = move |k| (low[1]..high[1]).flat_map(move |j| (low[0]..high[0]).map(move |i| [i, j, k]));
    (low[2]..high[2]).flat_map(plane)
}

impl Lattice {
    /// The index of a vertex in the lists.
    fn vertex(&self, [i, j, k]: [usize; 3]) -> usize {
        self.first + i + self.lengths[0] * (j + self.lengths[1] * k)
    }

    fn cell(&self, [i, j, k]: [usize; 3], names: &[usize]) -> ListedElement {
        let high = [i + 2, j + 2, if self.dimension == 2 { k + 1 } else { k + 2 }];
        let nodes = boxes([i, j, k], high).map(|vertex| self.vertex(vertex)).collect();
        let shape = if self.dimension == 2 { Shape::Quadrilateral } else { Shape::Hexahedron };
        ListedElement { shape, degree: 1, nodes, names: names.to_vec() }
    }

    /// The corners of the face normal to `axis` with the lowest vertex `low`, around it.
    fn face(&self, low: [usize; 3], axis: usize) -> Face {
        let moved = |axes: &[usize]| {
            let mut vertex = low;
            axes.iter().for_each(|&axis| vertex[axis] += 1);
            self.vertex(vertex)
        };
        match (0..self.dimension).filter(|&other| other != axis).collect::<Vec<_>>()[..] {
            [a] => vec![moved(&[]), moved(&[a])],
            [a, b] => vec![moved(&[]), moved(&[a]), moved(&[a, b]), moved(&[b])],
            _ => Vec::new(),
        }
    }
}

fn read_condition(
    lists: &mut Lists,
    lattice: &Lattice,
    first_cell: usize,
    condition: &Condition,
) -> Result<(), CgnsError> {
    match (&condition.points, condition.location) {
        (_, Location::Cell) => {
            Err(condition.error("its GridLocation is CellCenter: in a structured zone save vertices or faces"))
        }
        (Points::Range(ends), location) => {
            let (axis, ends) = faces_of_range(lattice, condition, ends, location)?;
            lists.push_faces(condition, &faces_between(lattice, axis, ends));
            Ok(())
        }
        (Points::List(numbers), Location::Vertex) => {
            let vertices = numbers.chunks(lattice.dimension).map(|indices| listed_vertex(lattice, condition, indices));
            let chosen = vertices.collect::<Result<_, _>>()?;
            let outer = lists.outer_faces(first_cell);
            lists.push_faces(condition, unstructured::faces_between(&outer, condition, &chosen)?);
            Ok(())
        }
        (Points::List(_), Location::Element(_)) => {
            Err(condition.error("a PointList of faces in a structured zone is not supported: save a PointRange"))
        }
    }
}

/// The vertex with the given indices, which count from 1.
fn listed_vertex(lattice: &Lattice, condition: &Condition, indices: &[i64]) -> Result<usize, CgnsError> {
    let inside = |(&index, &length): (&i64, &usize)| usize::try_from(index).is_ok_and(|i| (1..=length).contains(&i));
    if indices.len() != lattice.dimension || !indices.iter().zip(&lattice.lengths).all(inside) {
        let problem = format!("there is no vertex {indices:?}, the zone has {:?}", lattice.lengths);
        return Err(condition.error(problem));
    }
    let mut vertex = [0; 3];
    vertex.iter_mut().zip(indices).for_each(|(entry, &index)| *entry = index as usize - 1);
    Ok(lattice.vertex(vertex))
}

/// The axis normal to the faces of a range, and along each axis the lowest and the highest vertex, from 0.
fn faces_of_range(
    lattice: &Lattice,
    condition: &Condition,
    ends: &[[i64; 2]],
    location: Location,
) -> Result<(usize, [[usize; 2]; 3]), CgnsError> {
    let dimension = lattice.dimension;
    let lengths = &lattice.lengths[..dimension];
    let wrong =
        |problem: &str| condition.error(format!("its range {ends:?} {problem}; the zone has {lengths:?} vertices"));
    if ends.len() != dimension {
        return Err(wrong("has the wrong number of indices"));
    }
    let constant: Vec<usize> = (0..dimension).filter(|&axis| ends[axis][0] == ends[axis][1]).collect();
    let axis = match (location, &constant[..]) {
        (Location::Element(Some(axis)), _) if constant.contains(&axis) => axis,
        (Location::Element(None) | Location::Vertex, &[axis]) => axis,
        (Location::Element(None), [_, _, ..]) => {
            return Err(wrong("has two constant indices: set GridLocation to IFaceCenter, JFaceCenter or KFaceCenter"));
        }
        _ => return Err(wrong("is no face: one index must be constant")),
    };
    let mut vertices = [[0; 2]; 3];
    for (other, [low, high]) in ends.iter().copied().enumerate() {
        // A range of faces ends at the last face, one before the last vertex.
        let high = if other != axis && location != Location::Vertex { high.saturating_add(1) } else { high };
        if low < 1 || usize::try_from(high).map_or(true, |high| high > lengths[other]) {
            return Err(wrong("is not inside the zone"));
        }
        vertices[other] = [low as usize - 1, high as usize - 1];
    }
    Ok((axis, vertices))
}

/// The faces normal to `axis` between the lowest and the highest vertices `ends`.
fn faces_between(lattice: &Lattice, axis: usize, ends: [[usize; 2]; 3]) -> Vec<Face> {
    let low = ends.map(|[low, _]| low);
    let high = std::array::from_fn(|other| match other {
        _ if other == axis || other >= lattice.dimension => low[other] + 1,
        _ => ends[other][1],
    });
    boxes(low, high).map(|vertex| lattice.face(vertex, axis)).collect()
}
