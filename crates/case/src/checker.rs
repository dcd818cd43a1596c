//! Checks used by several sections of a case. Every method names the key of its error.

mod boundaries;
mod formulas;

use super::cause::Cause;
use super::consequences::Damage;
use super::document::Document;
use super::error::{CaseError, Errors};
use super::key::Key;
use super::magnitude::{self, is_computable};
use super::names_in_use;
use super::raw::{Axis, Formula};
use crate::checked::Control;
use crate::expression::{Names, Program, Table};
use navier_stokes::InvalidParameter;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The result of a check.
pub(super) type Checked<T> = Result<T, Box<CaseError>>;

/// The document for the places of errors, and the constants and tables for formulas.
pub(super) struct Checker<'a> {
    document: &'a Document,
    names: Names,
    controls: Vec<Control>,
    /// The names of those that formulas contain.
    used_controls: RefCell<BTreeSet<String>>,
    defaults: RefCell<Vec<(String, String)>>,
    damage: Damage,
}

/// A checker that knows the sound constants, and the errors of the others.
pub(super) struct Sound<'a> {
    pub(super) checker: Checker<'a>,
    pub(super) errors: Errors,
}

/// The name for all boundaries that are not named.
pub(super) const OTHERS: &str = "others";

const FREE_NAME: &str = "another name, of letters, digits and _; not x, y, z, s, t, pi, a function or a constant";

impl<'a> Checker<'a> {
    /// A checker of `document` with those of its `constants` that have no error, and the errors of the others.
    pub(super) fn of_constants(
        document: &'a Document,
        constants: &BTreeMap<String, Formula>,
        damage: Damage,
    ) -> Sound<'a> {
        let (names, defaults) = (Names::constants_only(), RefCell::default());
        let mut checker =
            Checker { document, names, controls: Vec::new(), used_controls: RefCell::default(), defaults, damage };
        let (mut errors, table) = (Errors::default(), Key::new("constants"));
        let mut waiting: Vec<_> = constants.keys().map(|name| (table.child(name), name.as_str())).collect();
        // In the order of the text, but a constant waits for those that it uses.
        waiting.sort_by_cached_key(|(key, _)| document.position(key));
        let uses = |name: &str| -> BTreeSet<&str> {
            let Some(Formula::Text(text)) = constants.get(name) else { return BTreeSet::new() };
            names_in_use::words(text).filter(|word| *word != name && constants.contains_key(*word)).collect()
        };
        let uses: BTreeMap<&str, BTreeSet<&str>> = constants.keys().map(|name| (name.as_str(), uses(name))).collect();
        let mut done = BTreeSet::new();
        while !waiting.is_empty() {
            let ready = waiting.iter().position(|(_, name)| uses[name].is_subset(&done));
            // Constants that wait for each other have an error, which the first one tells.
            let (key, name) = waiting.remove(ready.unwrap_or(0));
            done.insert(name);
            if errors.note(checker.define_constant(&key, name, &constants[name])).is_none() {
                checker.damage.add(key);
            }
        }
        Sound { checker, errors }
    }

    fn define_constant(&mut self, key: &Key, name: &str, formula: &Formula) -> Checked<()> {
        let value = self.program(key, formula, &self.names)?.evaluate(&[], 0.0);
        self.computable(key, "the constant", value)?;
        if self.names.define(name, value) {
            return Ok(());
        }
        Err(self.combination(key, &format!("a constant cannot be called `{name}`"), FREE_NAME))
    }

    /// The definition of a name for formulas, at `key`, has an error: formulas with this name have no error of their own.
    pub(super) fn lose(&mut self, key: Key) {
        self.damage.add(key);
    }

    /// The parts of the case that are not as the user meant them.
    pub(super) fn damage(&self) -> &Damage {
        &self.damage
    }

    /// The error of a value that cannot be checked because of another error.
    pub(super) fn follows(&self, key: &Key) -> Box<CaseError> {
        self.error(key, Cause::Follows)
    }

    /// Defines the function `name` of `table` for formulas.
    pub(super) fn define_table(&mut self, key: &Key, name: &str, table: Table) -> Checked<()> {
        if self.names.define_table(name, table) {
            return Ok(());
        }
        Err(self.combination(key, &format!("a table cannot be called `{name}`"), FREE_NAME))
    }

    /// Makes `control` known to the formulas that may contain one.
    pub(super) fn define_control(&mut self, control: Control) -> Checked<()> {
        if self.names.is_free(&control.name) {
            self.controls.push(control);
            return Ok(());
        }
        let (key, problem) = (Key::new("controls").child(&control.name), "a control cannot have this name");
        Err(self.combination(&key, problem, FREE_NAME))
    }

    /// Whether a formula that was checked contains `control`.
    pub(super) fn uses(&self, control: &Control) -> bool {
        self.used_controls.borrow().contains(&control.name)
    }

    /// The controls.
    pub(super) fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Whether the mesh is an elastic body, or is moved as one.
    pub(super) fn is_elastic(&self) -> bool {
        self.is_given("structure") || self.is_given("motion.boundary")
    }

    /// Whether the document has a key, which has no default then.
    pub(super) fn is_given(&self, key: &str) -> bool {
        self.document.position(&Key::new(key)).is_some()
    }

    /// The constants of formulas, in words, since the error of a formula may come from one of them. Empty if there are none.
    pub(super) fn constants_in_words(&self) -> String {
        let constants: Vec<_> = self.names.constants().map(|(name, value)| format!("{name} = {value}")).collect();
        if constants.is_empty() { String::new() } else { format!("; the constants are {}", constants.join(", ")) }
    }

    /// The tables of formulas, by name.
    pub(super) fn tables(&self) -> impl Iterator<Item = (&str, &Table)> {
        self.names.tables()
    }

    /// `path` as seen from the directory of the case file.
    pub(super) fn beside_case(&self, path: &Path) -> PathBuf {
        self.document.path().parent().unwrap_or(Path::new("")).join(path)
    }

    /// Records a default that follows from other keys, with its value.
    pub(super) fn note_default(&self, key: &Key, taken: &str) {
        let (mut defaults, default) = (self.defaults.borrow_mut(), (key.to_string(), taken.to_owned()));
        if !defaults.contains(&default) {
            defaults.push(default);
        }
    }

    /// The recorded defaults.
    pub(super) fn noted_defaults(&self) -> Vec<(String, String)> {
        self.defaults.borrow().clone()
    }

    /// An error at `key`.
    pub(super) fn error(&self, key: &Key, cause: Cause) -> Box<CaseError> {
        self.document.error(key, cause)
    }

    /// An error unless `holds` is true.
    pub(super) fn require(&self, key: &Key, quantity: &str, holds: bool, accepted: &str) -> Checked<()> {
        if holds {
            return Ok(());
        }
        Err(self.error(key, Cause::OutOfRange { quantity: quantity.to_owned(), accepted: accepted.to_owned() }))
    }

    /// The same for the value of a formula. The cause may be a constant, so the error shows all of them.
    pub(super) fn require_of_formula(&self, key: &Key, quantity: &str, holds: bool, accepted: &str) -> Checked<()> {
        if holds {
            return Ok(());
        }
        self.require(key, quantity, false, &format!("{accepted}{}", self.constants_in_words()))
    }

    /// Requires that `formula` has a value somewhere.
    pub(super) fn require_finite_somewhere(&self, key: &Key, quantity: &str, formula: &Program) -> Checked<()> {
        let accepted = "a formula that is finite somewhere; a part of this one never is, such as 1/0";
        self.require_of_formula(key, quantity, !formula.is_finite_nowhere(), accepted)
    }

    /// `value`, if it is positive and finite.
    pub(super) fn positive(&self, key: &Key, quantity: &str, value: f64) -> Checked<f64> {
        let is_positive = value > 0.0 && value.is_finite();
        is_positive
            .then_some(value)
            .ok_or_else(|| self.error(key, Cause::NotPositive { quantity: quantity.to_owned() }))
    }

    /// Whether the program can compute with the `value` of a formula.
    pub(super) fn computable(&self, key: &Key, quantity: &str, value: f64) -> Checked<()> {
        self.require(key, &format!("{quantity}, {value:e},"), is_computable(value), magnitude::ACCEPTED)
    }

    /// Poisson's ratio, where the elastic energy is definite.
    pub(super) fn poisson_ratio(&self, key: &Key, nu: f64) -> Checked<f64> {
        let accepted = "a number above -1 and below 0.5 (0.5 would be incompressible)";
        self.require(key, "Poisson's ratio", nu > -1.0 && nu < 0.5, accepted)?;
        Ok(nu)
    }

    /// For each axis of the mesh, whether it is listed.
    pub(super) fn axes<const D: usize>(&self, key: &Key, axes: &[Axis]) -> Checked<[bool; D]> {
        let mut listed = [false; D];
        for (index, axis) in self.distinct(key, "axis", axes)?.iter().enumerate() {
            let place = *axis as usize;
            self.require(&key.entry(index), "the axis", place < D, "`x`, `y`: the mesh is two-dimensional")?;
            listed[place] = true;
        }
        Ok(listed)
    }

    /// `entries` of the list at `key`, if none occurs twice.
    pub(super) fn distinct<'b, T: Serialize + PartialEq>(
        &self,
        key: &Key,
        kind: &'static str,
        entries: &'b [T],
    ) -> Checked<&'b [T]> {
        let repeated = (0..entries.len()).find(|&index| entries[..index].contains(&entries[index]));
        let Some(index) = repeated else { return Ok(entries) };
        // A name of the case file, as written by serde.
        let name = serde_json::to_string(&entries[index]).unwrap_or_default().trim_matches('"').to_owned();
        Err(self.error(&key.entry(index), Cause::Twice { kind, name }))
    }

    /// `value`, if it is 1 or more.
    pub(super) fn at_least_one(&self, key: &Key, quantity: &str, value: usize) -> Checked<usize> {
        self.require(key, quantity, value >= 1, "1 or more")?;
        Ok(value)
    }

    /// An error of two keys that exclude or need each other.
    pub(super) fn combination(&self, key: &Key, problem: &str, accepted: &str) -> Box<CaseError> {
        self.error(key, Cause::Combination { problem: problem.to_owned(), accepted: accepted.to_owned() })
    }

    /// An error of a key that the number of dimensions of the mesh excludes.
    pub(super) fn dimension(&self, key: &Key, problem: &str, accepted: &str) -> Box<CaseError> {
        self.error(key, Cause::Dimension { problem: problem.to_owned(), accepted: accepted.to_owned() })
    }

    /// One entry per axis.
    pub(super) fn vector<T: Clone, const D: usize>(&self, key: &Key, entries: &[T]) -> Checked<[T; D]> {
        let length = || self.error(key, Cause::Length { found: entries.len(), dimension: D });
        <[T; D]>::try_from(entries.to_vec()).map_err(|_| length())
    }

    /// A finite number per axis.
    pub(super) fn finite_vector<const D: usize>(
        &self,
        key: &Key,
        quantity: &str,
        entries: &[f64],
    ) -> Checked<[f64; D]> {
        let vector: [f64; D] = self.vector(key, entries)?;
        for (axis, entry) in vector.iter().enumerate() {
            self.require(&key.entry(axis), quantity, entry.is_finite(), "a finite number")?;
        }
        Ok(vector)
    }

    /// A finite number per axis, zeros if there are none.
    pub(super) fn vector_or_zero<const D: usize>(
        &self,
        key: &Key,
        quantity: &str,
        entries: Option<&Vec<f64>>,
    ) -> Checked<[f64; D]> {
        entries.map_or(Ok([0.0; D]), |entries| self.finite_vector(key, quantity, entries))
    }

    /// The value of a check of the physics, with the error at `key`.
    pub(super) fn physics<T>(&self, key: &Key, result: Result<T, InvalidParameter>) -> Checked<T> {
        result.map_err(|error| self.error(key, Cause::Physics(error)))
    }
}
