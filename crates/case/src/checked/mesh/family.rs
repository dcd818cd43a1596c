//! Common parts of all generators: the keys of errors, and the limit of the size of a mesh.

use crate::CaseError;
use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::memory;
use ::mesh::MeshError;

/// The largest number of nodes of a mesh if the system does not report its memory.
const MOST_NODES: usize = 1 << 28;

/// Bytes per node of an elastic mesh: its C0 numbering, positions and the proof of validity.
const BYTES_TO_MOVE: usize = 130;

/// Bytes per corner of a cell for vertices, facets and the maps that join them.
const BYTES_TO_JOIN: usize = 80;

/// A generator of meshes.
pub(super) struct Family<'a> {
    pub(super) checker: &'a Checker<'a>,
    /// The key of its table.
    pub(super) key: Key,
    /// The names of quantities in errors, and the paths of their keys in the table.
    pub(super) parameters: &'static [(&'static str, &'static str)],
}

impl Family<'_> {
    /// The number of dimensions of a mesh given by vectors of `length` entries, the first of which is at `key`.
    pub(super) fn dimension(&self, key: &str, length: usize) -> Checked<usize> {
        let key = self.key.child(key);
        self.checker.require(&key, "the number of axes", (2..=3).contains(&length), "two or three entries")?;
        Ok(length)
    }

    /// An error at `key` if the product of `cells`, each with order^D nodes, is more than can be stored. It is called
    /// before anything is allocated.
    pub(super) fn check_size<const D: usize>(&self, key: &str, cells: &[usize], order: usize) -> Checked<()> {
        let cells = cells.iter().fold(1, |product: usize, n| product.saturating_mul(*n));
        check_size::<D>(self.checker, &self.key.child(key), cells, order)
    }

    /// The error of the generator, at the key of the quantity that it names.
    pub(super) fn refused(&self, error: MeshError) -> Box<CaseError> {
        let path = match &error {
            MeshError::Parameter { quantity, .. } => self.parameters.iter().find(|(known, _)| known == quantity),
            _ => None,
        };
        let key = path.map_or_else(|| self.key.clone(), |(_, path)| self.key.descendant(path));
        match error {
            MeshError::Inverted { .. } if !self.parameters.is_empty() => {
                self.checker.combination(&key, &error.to_string(), &self.less_curved())
            }
            error => self.refused_at(&key, error),
        }
    }

    /// The quantities to change if together they make a cell that is inverted.
    fn less_curved(&self) -> String {
        let mut keys: Vec<&str> = self.parameters.iter().filter_map(|(_, path)| path.split('.').next()).collect();
        keys.dedup();
        let named = |key: &&str| match *key {
            "profile" => "`profile` (points closer to each other at the nose)".to_owned(),
            key => format!("`{key}`"),
        };
        let named: Vec<String> = keys.iter().map(named).collect();
        format!("cells that are less curved: other values of {}, or another order", named.join(", "))
    }

    /// The error of the generator at `key`.
    pub(super) fn refused_at(&self, key: &Key, error: MeshError) -> Box<CaseError> {
        self.checker.error(key, Cause::Mesh(error))
    }
}

/// An error at `key` if a mesh with this number of `cells` of an order does not fit into memory: the memory needed and
/// available.
pub(super) fn check_size<const D: usize>(checker: &Checker<'_>, key: &Key, cells: usize, order: usize) -> Checked<()> {
    let (nodes, needed) = (cells.saturating_mul(order.pow(D as u32)), bytes::<D>(cells, order, checker.is_elastic()));
    let problem = match (memory::shortage(needed as u64), memory::available()) {
        (Some(shortage), _) => shortage,
        (None, None) if nodes > MOST_NODES => format!("about {} are needed", memory::in_words(needed as u64)),
        _ => return Ok(()),
    };
    let problem =
        format!("a mesh of {cells} cells with {} nodes each does not fit into memory: {problem}", order.pow(D as u32));
    Err(checker.combination(key, &problem, "fewer cells, or a lower `mesh.order`"))
}

/// Bytes of a mesh while it is built, measured for 2 to 16 nodes per direction: coordinates twice, and the data that join the
/// cells.
fn bytes<const D: usize>(cells: usize, order: usize, is_elastic: bool) -> usize {
    let per_node = 16 * D + if is_elastic { BYTES_TO_MOVE } else { 0 };
    cells.saturating_mul(order.pow(D as u32) * per_node + (BYTES_TO_JOIN << D))
}
