//! Tables with entries for boundaries of the mesh.

use super::{Checked, Checker, OTHERS};
use crate::cause::Cause;
use crate::choices::choices;
use crate::error::collected;
use crate::key::Key;
use std::collections::BTreeMap;

impl Checker<'_> {
    /// The indices of the boundaries of the mesh with these `names`.
    pub(crate) fn boundaries(&self, key: &Key, names: &[String], known: &[String]) -> Checked<Vec<usize>> {
        let index = |(entry, name): (usize, &String)| {
            let unknown = || {
                let cause =
                    Cause::Unknown { kind: "boundary", name: name.clone(), accepted: known.to_vec(), belongs: None };
                self.error(&key.entry(entry), cause)
            };
            known.iter().position(|other| other == name).ok_or_else(unknown)
        };
        collected(self.distinct(key, "boundary", names)?.iter().enumerate().map(index))
    }

    /// For each of the `boundaries` of the mesh its entry in the table `given` at `key`, with the key of that entry.
    pub(crate) fn by_boundary<'b, T>(
        &self,
        key: &Key,
        kind: &'static str,
        given: &'b BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Checked<Vec<(Key, &'b T)>> {
        self.known_boundaries(key, given, boundaries)?;
        let entry = |boundary: &String| given.get_key_value(name_of(given, boundary));
        let names: Vec<String> = boundaries.iter().filter(|boundary| entry(boundary).is_none()).cloned().collect();
        if !names.is_empty() {
            let choices = choices(&key.child("others"));
            return Err(self.error(key, Cause::NoCondition { names, kind, choices }));
        }
        Ok(boundaries.iter().filter_map(entry).map(|(name, value)| (key.child(name), value)).collect())
    }

    /// The same if boundaries need no entry.
    pub(crate) fn by_boundary_or_default<T: Clone + Default>(
        &self,
        key: &Key,
        given: &BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Checked<Vec<(Key, T)>> {
        self.known_boundaries(key, given, boundaries)?;
        let entry = |boundary: &String| {
            let name = name_of(given, boundary);
            (key.child(name), given.get(name).cloned().unwrap_or_default())
        };
        Ok(boundaries.iter().map(entry).collect())
    }

    /// The same for those boundaries that have an entry; nothing is an error.
    pub(crate) fn entries_of_boundaries<'b, T>(
        &self,
        key: &Key,
        given: &'b BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Vec<(usize, Key, &'b T)> {
        let entry = |(index, boundary): (usize, &String)| {
            let (name, value) = given.get_key_value(name_of(given, boundary))?;
            Some((index, key.child(name), value))
        };
        boundaries.iter().enumerate().filter_map(entry).collect()
    }

    /// The entries of the table `given` that belong to no boundary of the mesh, with their keys.
    pub(crate) fn entries_of_none<'b, T>(
        &self,
        key: &Key,
        given: &'b BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Vec<(Key, &'b T)> {
        let is_unknown = |name: &String| *name != OTHERS && !boundaries.contains(name);
        given.iter().filter(|(name, _)| is_unknown(name)).map(|(name, value)| (key.child(name), value)).collect()
    }

    /// Checks that the table `given` names only boundaries of the mesh.
    pub(crate) fn known_boundaries<T>(
        &self,
        key: &Key,
        given: &BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Checked<()> {
        let accepted: Vec<String> = boundaries.iter().cloned().chain([OTHERS.to_owned()]).collect();
        let check = |name: &String| {
            let unknown =
                || Cause::Unknown { kind: "boundary", name: name.clone(), accepted: accepted.clone(), belongs: None };
            if accepted.contains(name) { Ok(()) } else { Err(self.error(&key.child(name), unknown())) }
        };
        collected(given.keys().map(check)).map(drop)
    }
}

/// The name under which `boundary` is found in the table `given`: its own, or the name for all others.
fn name_of<'b, T>(given: &BTreeMap<String, T>, boundary: &'b str) -> &'b str {
    if given.contains_key(boundary) { boundary } else { OTHERS }
}
