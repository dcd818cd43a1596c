//! Checks used by several sections of a case. Every method names the key of its error.

use super::cause::Cause;
use super::choices::choices;
use super::consequences::Damage;
use super::document::Document;
use super::error::{CaseError, Errors, collected};
use super::key::Key;
use super::magnitude::{self, is_computable};
use super::raw::{Axis, Field, Formula};
use super::vector::Vector;
use crate::checked::Control;
use crate::expression::{ExpressionError, Names, Problem, Program, Table};
use navier_stokes::InvalidParameter;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The result of a check.
pub(super) type Checked<T> = Result<T, Box<CaseError>>;

/// The document for the places of errors, and the constants and tables for formulas.
pub(super) struct Checker<'a> {
    document: &'a Document,
    names: Names,
    controls: Vec<Control>,
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

/// Where formulas may contain controls.
const CONTROLLED: [&str; 2] = ["flow.source", "flow.boundary"];

const FREE_NAME: &str = "another name, of letters, digits and _; not x, y, z, s, t, pi, a function or a constant";

impl<'a> Checker<'a> {
    /// A checker of `document` with those of its `constants` that have no error, and the errors of the others.
    pub(super) fn of_constants(
        document: &'a Document,
        constants: &BTreeMap<String, Formula>,
        damage: Damage,
    ) -> Sound<'a> {
        let (names, defaults) = (Names::constants_only(), RefCell::default());
        let mut checker = Checker { document, names, controls: Vec::new(), defaults, damage };
        let (mut errors, table) = (Errors::default(), Key::new("constants"));
        // In the order of the text, so that a constant may use those above it.
        let mut ordered: Vec<_> = constants.iter().map(|(name, formula)| (table.child(name), name, formula)).collect();
        ordered.sort_by_key(|(key, ..)| document.position(key));
        for (key, name, formula) in ordered {
            if errors.note(checker.define_constant(&key, name, formula)).is_none() {
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

    /// The controls.
    pub(super) fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Whether the mesh is an elastic body, or is moved as one.
    pub(super) fn is_elastic(&self) -> bool {
        let has = |key: &str| self.document.position(&Key::new(key)).is_some();
        has("structure") || has("motion.boundary")
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

    /// A formula in the position.
    pub(super) fn formula_of_position<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D))
    }

    /// A formula in position and time.
    pub(super) fn formula<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D).with_time())
    }

    /// A formula in what a control measures, its value and the time.
    pub(super) fn formula_of_control(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_fields(["measured", "value"].into_iter()).with_time())
    }

    /// A formula in time.
    pub(super) fn formula_of_time(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_time())
    }

    /// A formula in position, time and the arc length s.
    pub(super) fn formula_on_boundary<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        self.program(key, formula, &self.names.with_coordinates(D).with_time().with_arc_length())
    }

    /// A formula in position, time and the fields of a flow.
    pub(super) fn formula_of_fields<const D: usize>(&self, key: &Key, formula: &Formula) -> Checked<Program> {
        let names = self.names.with_coordinates(D).with_time().with_fields(Field::components_of_flow(D));
        self.program(key, formula, &names)
    }

    /// A formula in position and time for each axis.
    pub(super) fn formulas<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_coordinates(D).with_time())
    }

    /// A formula in the position for each axis.
    pub(super) fn formulas_of_position<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_coordinates(D))
    }

    /// A formula in time for each axis.
    pub(super) fn formulas_of_time<const D: usize>(&self, key: &Key, formulas: &[Formula]) -> Checked<Vector<D>> {
        self.programs(key, formulas, &self.names.with_time())
    }

    /// The value of a formula of constants.
    pub(super) fn number(&self, key: &Key, formula: &Formula) -> Checked<f64> {
        Ok(self.program(key, formula, &self.names)?.evaluate(&[], 0.0))
    }

    fn programs<const D: usize>(&self, key: &Key, formulas: &[Formula], names: &Names) -> Checked<Vector<D>> {
        let formulas: [Formula; D] = self.vector(key, formulas)?;
        let program = |(axis, formula): (usize, &Formula)| self.program(&key.entry(axis), formula, names);
        let programs = collected(formulas.iter().enumerate().map(program))?;
        Ok(Vector::new(self.vector(key, &programs)?))
    }

    fn program(&self, key: &Key, formula: &Formula, names: &Names) -> Checked<Program> {
        match formula {
            Formula::Number(value) => Ok(Program::constant(*value)),
            Formula::Text(text) => {
                let may_be_controlled = CONTROLLED.iter().any(|section| key.to_string().starts_with(section));
                let controls = self.controls.iter().filter(|_| may_be_controlled);
                let names = names.with_controls(controls.map(|control| (control.name.clone(), control.value.clone())));
                let program = Program::compile(text, &names).map_err(|error| self.wrong_formula(key, error))?;
                // Where a formula has no value, the place where one is needed is told.
                let constant = program.as_constant().filter(|value| value.is_finite());
                self.computable(key, "the formula", constant.unwrap_or(0.0))?;
                Ok(program)
            }
        }
    }

    /// The error of a formula. A name whose definition has an error is not an error of the formula.
    fn wrong_formula(&self, key: &Key, error: ExpressionError) -> Box<CaseError> {
        match &error.problem {
            Problem::UnknownName { name, .. } if self.damage.hides_name(name) => self.follows(key),
            _ => self.error(key, Cause::Expression(error)),
        }
    }

    /// The indices of the boundaries of the mesh with these `names`.
    pub(super) fn boundaries(&self, key: &Key, names: &[String], known: &[String]) -> Checked<Vec<usize>> {
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
    pub(super) fn by_boundary<'b, T>(
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
    pub(super) fn by_boundary_or_default<T: Clone + Default>(
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
    pub(super) fn entries_of_boundaries<'b, T>(
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
    pub(super) fn entries_of_none<'b, T>(
        &self,
        key: &Key,
        given: &'b BTreeMap<String, T>,
        boundaries: &[String],
    ) -> Vec<(Key, &'b T)> {
        let is_unknown = |name: &String| *name != OTHERS && !boundaries.contains(name);
        given.iter().filter(|(name, _)| is_unknown(name)).map(|(name, value)| (key.child(name), value)).collect()
    }

    /// Checks that the table `given` names only boundaries of the mesh.
    fn known_boundaries<T>(&self, key: &Key, given: &BTreeMap<String, T>, boundaries: &[String]) -> Checked<()> {
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
