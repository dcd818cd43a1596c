//! Points at which the flow is observed.

use super::mesh_crate::Mesh;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;

/// A point at which the flow is observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe<const D: usize> {
    /// Its name.
    pub name: String,
    /// Its position, that at rest if the mesh carries it.
    pub at: [f64; D],
    /// Whether it moves with the mesh.
    pub carried: bool,
}

/// Checks `[output.probes]`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: &raw::Output,
    mesh: &Mesh<D>,
    has_flow: bool,
) -> Checked<Vec<Probe<D>>> {
    let key = Key::new("output").child("probes");
    if !has_flow && !raw.probes.is_empty() {
        let accepted = "this section together with [flow]; `structure.points` observe a structure";
        return Err(checker.combination(&key, "without a flow there is nothing to observe", accepted));
    }
    let probe = |(name, probe): (&String, &raw::Probe)| {
        let key = key.child(name);
        check_name(checker, &key, name)?;
        let at: [f64; D] = checker.finite_vector(&key.child("at"), "the coordinate", &probe.at)?;
        let accepted = "a point inside the mesh at rest, or on its boundary";
        checker.require(&key.child("at"), "the point", mesh.locate(&at).is_some(), accepted)?;
        Ok(Probe { name: name.clone(), at, carried: probe.carried })
    };
    raw.probes.iter().map(probe).collect()
}

/// A name becomes a part of the first line of history.csv.
pub(super) fn check_name(checker: &Checker<'_>, key: &Key, name: &str) -> Checked<()> {
    let is_printable = !name.is_empty() && !name.contains(char::is_control);
    checker.require(key, "the name of the point", is_printable, "a name of printable characters, on one line")
}
