//! Zones of sections.

use crate::base::{count, read_vertices};
use crate::condition::{Condition, Location, Points};
use crate::lists::Lists;
use crate::node::Node;
use crate::section::{SectionReader, Vertices};
use crate::{CgnsError, faces};
use mesh::{ListedElement, Numbers};
use std::collections::{BTreeMap, BTreeSet};

/// Elements of dimension D - 1.
struct Face {
    section: usize,
    element: ListedElement,
}

/// Appends a zone.
pub(crate) fn read(
    lists: &mut Lists,
    zone: &Node,
    conditions: &[Condition],
    cell_names: &[usize],
) -> Result<(), CgnsError> {
    let [vertices, _, _] = zone.numbers()?;
    let vertices = count(zone, vertices)?;
    let (first_vertex, first_cell) = (read_vertices(lists, zone, vertices)?, lists.lists.elements.len());
    let mut reader = SectionReader::new(lists.dimension, Vertices { first: first_vertex, count: vertices });
    let sections = zone.of_label("Elements_t")?;
    let (mut faces, mut ranges) = (BTreeMap::new(), Vec::new());
    for (index, section) in sections.iter().enumerate() {
        let range = reader.read(section, |number, mut element| {
            if element.shape.dimension() == lists.dimension {
                element.names = cell_names.to_vec();
                lists.push_numbered(&section.path, number, element);
            } else {
                faces.insert(number, Face { section: index, element });
            }
        })?;
        ranges.push(range);
    }
    check_ranges(zone, &mut ranges)?;
    if lists.lists.elements.len() == first_cell {
        let kinds = if lists.dimension == 2 { "quadrilaterals" } else { "hexahedra" };
        return Err(zone.error(format!("it has no cells of dimension {}: save sections of {kinds}", lists.dimension)));
    }
    name_faces(lists, &mut faces, conditions, &sections)?;
    for (number, face) in faces.into_iter().filter(|(_, face)| !face.element.names.is_empty()) {
        lists.push_numbered(&sections[face.section].path, number, face.element);
    }
    let of_vertices = conditions.iter().filter(|condition| condition.location == Location::Vertex);
    for condition in of_vertices {
        let chosen = condition.numbers("vertex", vertices)?.into_iter().map(|number| first_vertex + number - 1);
        push_faces_between(lists, condition, first_cell, chosen.collect())?;
    }
    Ok(())
}

/// Every element has a number of its own.
fn check_ranges(zone: &Node, ranges: &mut [[i64; 2]]) -> Result<(), CgnsError> {
    ranges.sort_unstable();
    match ranges.windows(2).find(|pair| pair[1][0] <= pair[0][1]) {
        Some(pair) => Err(zone.error(format!("two of its sections have an element {}", pair[1][0]))),
        None => Ok(()),
    }
}

/// Gives faces the names of their conditions. In a zone without conditions they have the name of their section.
fn name_faces(
    lists: &mut Lists,
    faces: &mut BTreeMap<i64, Face>,
    conditions: &[Condition],
    sections: &[Node],
) -> Result<(), CgnsError> {
    if conditions.is_empty() {
        faces.values_mut().for_each(|face| face.element.names = vec![lists.name(&sections[face.section].name)]);
    }
    for condition in conditions.iter().filter(|condition| condition.location != Location::Vertex) {
        let name = lists.name(&condition.name);
        match &condition.points {
            Points::List(numbers) => {
                for &number in numbers {
                    let face = faces.get_mut(&number).ok_or_else(|| no_face(condition, number))?;
                    face.element.names.push(name);
                }
            }
            Points::Range(ends) => name_range(faces, condition, ends, name)?,
        }
    }
    Ok(())
}

fn name_range(
    faces: &mut BTreeMap<i64, Face>,
    condition: &Condition,
    ends: &[[i64; 2]],
    name: usize,
) -> Result<(), CgnsError> {
    let &[[low, high]] = ends else {
        return Err(condition.error(format!("its range has {} indices, expected 1", ends.len())));
    };
    let mut next = low;
    for (&number, face) in faces.range_mut(low..=high) {
        if number != next {
            break;
        }
        face.element.names.push(name);
        next = number.saturating_add(1);
    }
    if next > high { Ok(()) } else { Err(no_face(condition, next)) }
}

fn no_face(condition: &Condition, number: i64) -> CgnsError {
    let problem = format!(
        "element {number} is no face in a section of the zone: save the faces of boundaries as sections, as BAR_2 or \
         QUAD_4, or set GridLocation to Vertex if the numbers are those of vertices"
    );
    condition.error(problem)
}

/// Appends the outer faces of the cells from `first_cell` on all of whose corners are in `chosen`.
pub(crate) fn push_faces_between(
    lists: &mut Lists,
    condition: &Condition,
    first_cell: usize,
    chosen: BTreeSet<usize>,
) -> Result<(), CgnsError> {
    let outer = faces::outer(&lists.lists.elements[first_cell..], lists.dimension);
    let within: Vec<_> = outer.into_iter().filter(|face| face.iter().all(|vertex| chosen.contains(vertex))).collect();
    if within.is_empty() {
        let problem = format!("there is no outer face between its {} vertices: check its GridLocation", chosen.len());
        return Err(condition.error(problem));
    }
    let name = lists.name(&condition.name);
    lists.begin(format!("{}, face", condition.path), Numbers::From(1));
    within.iter().for_each(|face| lists.push(faces::element(face, vec![name])));
    Ok(())
}
