//! The lists while they are made.

use crate::CgnsError;
use crate::condition::{Condition, Role};
use crate::faces::{self, Face, Key};
use mesh::{ListedElement, MeshLists, Numbers, Span};
use std::collections::BTreeSet;

/// Lists that grow zone by zone.
pub(crate) struct Lists {
    pub(crate) lists: MeshLists,
    /// The dimension D of the cells.
    pub(crate) dimension: usize,
    /// Faces of interfaces, which are joined to others.
    pub(crate) joined: BTreeSet<Key>,
    /// The faces in the lists.
    pub(crate) named: BTreeSet<Key>,
    /// The number of the last element, if it has one.
    last: Option<i64>,
}

impl Lists {
    pub(crate) fn new(dimension: usize) -> Lists {
        Lists { lists: MeshLists::default(), dimension, joined: BTreeSet::new(), named: BTreeSet::new(), last: None }
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

    /// Begins a list of elements. Messages call them `label` and their number in `numbers`.
    pub(crate) fn begin(&mut self, label: String, numbers: Numbers) {
        self.last = None;
        self.lists.element_places.push(Span { first: self.lists.elements.len(), label, numbers });
    }

    /// Appends an element to the list that was begun last.
    pub(crate) fn push(&mut self, element: ListedElement) {
        if element.shape.dimension() < self.dimension {
            self.named.insert(faces::key(&faces::corners(&element)));
        }
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

    /// Appends the faces of a condition, or notes that they are joined to others.
    pub(crate) fn push_faces<'a>(&mut self, condition: &Condition, faces: impl IntoIterator<Item = &'a Face>) {
        if condition.role == Role::Interface {
            self.joined.extend(faces.into_iter().map(|face| faces::key(face)));
            return;
        }
        let belongs = |face: &&Face| self.may_name(condition.role, &faces::key(face));
        let faces: Vec<&Face> = faces.into_iter().filter(belongs).collect();
        if faces.is_empty() {
            return;
        }
        let names = self.names(&condition.names);
        self.begin(format!("{}, face", condition.path), Numbers::From(1));
        faces.into_iter().for_each(|face| self.push(faces::element(face, names.clone())));
    }

    /// Whether a condition may name a face. A boundary does not name faces that are joined. A periodic interface names neither these nor
    /// faces that have a name already.
    pub(crate) fn may_name(&self, role: Role, face: &Key) -> bool {
        !self.joined.contains(face) && (role == Role::Boundary || !self.named.contains(face))
    }

    /// The faces of one of the cells from `first` on.
    pub(crate) fn outer_faces(&self, first: usize) -> Vec<Face> {
        faces::outer(&self.lists.elements[first..], self.dimension)
    }

    /// The indices of names.
    pub(crate) fn names(&mut self, names: &[String]) -> Vec<usize> {
        names.iter().map(|name| self.name(name)).collect()
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
