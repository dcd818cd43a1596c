//! The elements of a zone by their numbers.

use crate::condition::{Condition, Points, Role};
use crate::lists::Lists;
use crate::node::Node;
use crate::{CgnsError, faces};
use mesh::ListedElement;
use std::collections::BTreeMap;

/// An element of dimension D - 1.
struct Face {
    section: usize,
    element: ListedElement,
}

/// Cells are in the lists already. Faces follow when their names are known.
#[derive(Default)]
pub(crate) struct Numbered {
    faces: BTreeMap<i64, Face>,
    /// Runs of cells: for the number of the first one its index in the lists and the number of cells.
    cells: BTreeMap<i64, (usize, usize)>,
    /// The first and the last number of each section.
    ranges: Vec<[i64; 2]>,
}

impl Numbered {
    /// The cell that was just appended to the lists has the number `number`.
    pub(crate) fn push_cell(&mut self, number: i64, index: usize) {
        match self.cells.last_entry() {
            Some(mut run) if run.key().checked_add(run.get().1 as i64) == Some(number) => run.get_mut().1 += 1,
            _ => drop(self.cells.insert(number, (index, 1))),
        }
    }

    pub(crate) fn push_face(&mut self, number: i64, section: usize, element: ListedElement) {
        self.faces.insert(number, Face { section, element });
    }

    /// A section has elements with the numbers of `range`, which no other one has.
    pub(crate) fn push_range(&mut self, zone: &Node, range: [i64; 2]) -> Result<(), CgnsError> {
        let twice = self.ranges.iter().find(|other| other[0] <= range[1] && range[0] <= other[1]);
        if let Some(other) = twice {
            return Err(zone.error(format!("two of its sections have an element {}", other[0].max(range[0]))));
        }
        self.ranges.push(range);
        Ok(())
    }

    /// Names all faces by their sections.
    pub(crate) fn name_by_section(&mut self, lists: &mut Lists, sections: &[Node]) {
        self.faces.values_mut().for_each(|face| face.element.names = vec![lists.name(&sections[face.section].name)]);
    }

    /// Names the elements of a condition: faces belong to a boundary, cells to a region.
    pub(crate) fn name(&mut self, lists: &mut Lists, condition: &Condition) -> Result<(), CgnsError> {
        let names = lists.names(&condition.names);
        match &condition.points {
            Points::List(numbers) => {
                numbers.iter().try_for_each(|&number| self.name_one(lists, condition, number, &names))
            }
            Points::Range(ends) => match ends[..] {
                [[low, high]] => (low..=high).try_for_each(|number| self.name_one(lists, condition, number, &names)),
                _ => Err(condition.error(format!("its range has {} indices, expected 1", ends.len()))),
            },
        }
    }

    /// Elements of dimension D - 2 and less are ignored.
    fn name_one(
        &mut self,
        lists: &mut Lists,
        condition: &Condition,
        number: i64,
        names: &[usize],
    ) -> Result<(), CgnsError> {
        if let Some(face) = self.faces.get_mut(&number) {
            match condition.role {
                Role::Interface => drop(lists.joined.insert(faces::key(&faces::corners(&face.element)))),
                Role::Periodic if !face.element.names.is_empty() => {}
                _ => face.element.names.extend(names),
            }
            return Ok(());
        }
        let run = self.cells.range(..=number).next_back();
        if let Some((first, (index, _))) = run.filter(|(first, (_, count))| number - **first < *count as i64) {
            if condition.role == Role::Boundary {
                lists.lists.elements[index + (number - first) as usize].names.extend(names);
            }
            return Ok(());
        }
        match self.ranges.iter().any(|[first, last]| (*first..=*last).contains(&number)) {
            true => Ok(()),
            false => Err(condition.error(format!(
                "no section of the zone has an element {number}: save the faces of boundaries as sections, as BAR_2 or \
                 QUAD_4, or set GridLocation to Vertex if the numbers are those of vertices"
            ))),
        }
    }

    /// Appends the faces with a name to the lists.
    pub(crate) fn push_named_faces(self, lists: &mut Lists, sections: &[Node]) {
        for (number, face) in self.faces.into_iter().filter(|(_, face)| !face.element.names.is_empty()) {
            if lists.joined.contains(&faces::key(&faces::corners(&face.element))) {
                continue;
            }
            lists.push_numbered(&sections[face.section].path, number, face.element);
        }
    }
}
