//! Zones of sections.

use crate::CgnsError;
use crate::base::{count, read_vertices};
use crate::condition::{Condition, Location, Role};
use crate::faces::Face;
use crate::lists::Lists;
use crate::node::Node;
use crate::numbered::Numbered;
use crate::section::{SectionReader, Vertices};
use std::collections::BTreeSet;

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
    let sections = zone.of_label("Elements_t")?;
    let vertices = Vertices { first: first_vertex, count: vertices };
    let mut numbered = read_sections(lists, zone, &sections, vertices, cell_names)?;
    if lists.lists.elements.len() == first_cell {
        let kinds = if lists.dimension == 2 { "quadrilaterals" } else { "hexahedra" };
        return Err(zone.error(format!("it has no cells of dimension {}: save sections of {kinds}", lists.dimension)));
    }
    if conditions.iter().all(|condition| condition.role != Role::Boundary) {
        numbered.name_by_section(lists, &sections);
    }
    let (of_vertices, of_elements): (Vec<_>, Vec<_>) =
        conditions.iter().partition(|condition| condition.location == Location::Vertex);
    for condition in of_elements {
        let named = numbered.name(lists, condition);
        // Zones are joined by positions.
        if condition.role == Role::Boundary {
            named?;
        }
    }
    let outer = if of_vertices.is_empty() { Vec::new() } else { lists.outer_faces(first_cell) };
    let (interfaces, others): (Vec<_>, Vec<_>) =
        of_vertices.into_iter().partition(|condition| condition.role == Role::Interface);
    let push_faces = |lists: &mut Lists, condition: &Condition| {
        let numbers = condition.numbers("vertex", vertices.count)?;
        let chosen = numbers.into_iter().map(|number| first_vertex + number - 1).collect();
        lists.push_faces(condition, faces_between(&outer, condition, &chosen)?);
        Ok(())
    };
    interfaces.into_iter().try_for_each(|condition| push_faces(lists, condition))?;
    numbered.push_named_faces(lists, &sections);
    others.into_iter().try_for_each(|condition| push_faces(lists, condition))
}

/// Appends the cells of all sections, in the order of their names.
fn read_sections(
    lists: &mut Lists,
    zone: &Node,
    sections: &[Node],
    vertices: Vertices,
    cell_names: &[usize],
) -> Result<Numbered, CgnsError> {
    let mut reader = SectionReader::new(lists.dimension, vertices);
    let mut numbered = Numbered::default();
    for (index, section) in sections.iter().enumerate() {
        let range = reader.read(section, |number, mut element| {
            if element.shape.dimension() < lists.dimension {
                return numbered.push_face(number, index, element);
            }
            element.names = cell_names.to_vec();
            numbered.push_cell(number, lists.lists.elements.len());
            lists.push_numbered(&section.path, number, element);
        })?;
        numbered.push_range(zone, range)?;
    }
    Ok(numbered)
}

/// The outer faces whose corners are all in `chosen`.
pub(crate) fn faces_between<'a>(
    outer: &'a [Face],
    condition: &Condition,
    chosen: &BTreeSet<usize>,
) -> Result<Vec<&'a Face>, CgnsError> {
    let within: Vec<&Face> = outer.iter().filter(|face| face.iter().all(|vertex| chosen.contains(vertex))).collect();
    if within.is_empty() && condition.role == Role::Boundary {
        let problem = format!("there is no outer face between its {} vertices: check its GridLocation", chosen.len());
        return Err(condition.error(problem));
    }
    Ok(within)
}
