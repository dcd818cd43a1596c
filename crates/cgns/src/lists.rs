//! The lists while they are made.

use crate::CgnsError;
use mesh::{ListedElement, MeshLists, Numbers, Span};

/// Lists that grow zone by zone.
pub(crate) struct Lists {
    pub(crate) lists: MeshLists,
    /// The dimension D of the cells.
    pub(crate) dimension: usize,
    /// The number of the last element, if it has one.
    last: Option<i64>,
}

impl Lists {
    pub(crate) fn new(dimension: usize) -> Lists {
        Lists { lists: MeshLists::default(), dimension, last: None }
    }

    /// Appends the vertices of a zone; the index of the first one.
    pub(crate) fn push_nodes(&mut self, zone: &str, positions: Vec<[f64; 3]>) -> Result<usize, CgnsError> {
        let first = self.lists.nodes.len();
        if u32::try_from(first + positions.len()).is_err() {
            return Err(CgnsError::at(zone, "the mesh has more than 2^32 vertices, which is too many"));
        }
        self.lists.nodes.extend(positions);
        self.lists.node_places.push(Span { first, label: format!("{zone}, vertex"), numbers: Numbers::From(1) });
        Ok(first)
    }

    /// Begins a list of elements, whose places are `label` with `numbers`.
    pub(crate) fn begin(&mut self, label: String, numbers: Numbers) {
        self.last = None;
        self.lists.element_places.push(Span { first: self.lists.elements.len(), label, numbers });
    }

    /// Appends an element to the list that was begun last.
    pub(crate) fn push(&mut self, element: ListedElement) {
        self.lists.elements.push(element);
    }

    /// Appends the element of a section with a number.
    pub(crate) fn push_numbered(&mut self, section: &str, number: i64, element: ListedElement) {
        let follows = self.last == Some(number - 1)
            && self
                .lists
                .element_places
                .last()
                .is_some_and(|span| span.label.strip_suffix(", element") == Some(section));
        if !follows {
            self.begin(format!("{section}, element"), Numbers::From(number.unsigned_abs()));
        }
        self.last = Some(number);
        self.push(element);
    }

    /// The index of a name.
    pub(crate) fn name(&mut self, name: &str) -> usize {
        let names = &mut self.lists.names;
        names.iter().position(|other| other == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        })
    }
}
