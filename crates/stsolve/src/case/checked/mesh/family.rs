//! What all generators have in common: where their errors point, and how large a mesh may be.

use crate::case::CaseError;
use crate::case::checker::{Checked, Checker};
use crate::case::error::Cause;
use crate::case::key::Key;
use ::mesh::MeshError;

/// Nodes of a mesh at most: coordinates of some gigabytes.
const MOST_NODES: usize = 1 << 28;

/// A generator of meshes.
pub(super) struct Family<'a> {
    pub(super) checker: &'a Checker<'a>,
    /// The key of its table.
    pub(super) key: Key,
    /// What its errors call a quantity, and the path of its key in the table.
    pub(super) parameters: &'static [(&'static str, &'static str)],
}

impl Family<'_> {
    /// The number of dimensions of a mesh given by vectors of `length` entries, of which the first is at `key`.
    pub(super) fn dimension(&self, key: &str, length: usize) -> Checked<usize> {
        let key = self.key.child(key);
        self.checker.require(&key, "the number of axes", (2..=3).contains(&length), "two or three entries")?;
        Ok(length)
    }

    /// An error at `key` if the product of `cells`, each with order^D nodes, is more than can be stored: to be asked before
    /// anything is allocated.
    pub(super) fn check_size<const D: usize>(&self, key: &str, cells: &[usize], order: usize) -> Checked<()> {
        let nodes = cells.iter().fold(order.pow(D as u32), |product, n| product.saturating_mul(*n));
        let accepted = "fewer cells: at most 2^28 nodes in all";
        self.checker.require(&self.key.child(key), "the size of the mesh", nodes <= MOST_NODES, accepted)
    }

    /// The error of the generator, at the key of the quantity that it names.
    pub(super) fn refused(&self, error: MeshError) -> Box<CaseError> {
        let path = match &error {
            MeshError::Parameter { quantity, .. } => self.parameters.iter().find(|(known, _)| known == quantity),
            _ => None,
        };
        let key = path.map_or_else(|| self.key.clone(), |(_, path)| self.key.descendant(path));
        self.refused_at(&key, error)
    }

    /// The error of the generator at `key`.
    pub(super) fn refused_at(&self, key: &Key, error: MeshError) -> Box<CaseError> {
        self.checker.error(key, Cause::Mesh(error))
    }
}
