//! From the document to the raw case: all errors of keys and types at once, and formulas where numbers are needed.
//!
//! A key with an error is removed, or replaced by a value of the right type where one is needed, and the rest is read again. What was removed
//! or replaced is the [`Damage`]. An error that follows from it is not reported.

use super::cause::Cause;
use super::checker::{Checked, Checker, Sound};
use super::choices;
use super::consequences::Damage;
use super::document::Document;
use super::error::{CaseError, Errors};
use super::key::{Key, Step};
use super::magnitude;
use super::raw::{self, Formula};
use super::shape::{self, NumberText};
use super::tree::{contains, insert, replace, take_out};
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Sections that every case has, and what stands for them if they cannot be read.
const NEEDED: [(&str, &str); 2] = [
    ("mesh", "{ order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [1, 1] } }"),
    ("time", "{ order = 1, end = 1, slabs = 1 }"),
];

/// The most numbers of an impossible size that are reported.
const MOST_EXTREMES: usize = 20;

/// A number is whole if it is off by less than this, relative to its size.
const WHOLE: f64 = 1e-9;

/// Double precision cannot distinguish larger whole numbers.
const MOST: f64 = 9e15;

/// A raw case, as far as it can be read, and the errors on the way.
pub(super) struct Read {
    /// The case; None if nothing more can be said about it.
    pub(super) case: Option<raw::Case>,
    /// The errors of keys and types.
    pub(super) errors: Errors,
    /// The parts of the case that are not as the user meant them.
    pub(super) damage: Damage,
}

/// Reads the document.
///
/// # Errors
/// A text that is not TOML. All other errors are in the result.
pub(super) fn read(document: &Document) -> Result<Read, Box<CaseError>> {
    // Integers of TOML have 64 bits with a sign. The parser accepts longer ones, its own tables do not.
    document.check_integers()?;
    let as_written = document.tree()?;
    let mut reader = Reader { document, errors: Errors::default(), damage: Damage::default(), misspelt: Vec::new() };
    let shape = shape::compare(as_written.get_ref());
    let values = reader.numbers(as_written.get_ref(), &shape.numbers);
    let mut tree = document.tree()?;
    for (key, value) in &values {
        replace(&mut tree, &key.0, value);
    }
    for key in reader.damage.keys().to_vec() {
        take_out(tree.get_mut(), &key.0);
    }
    for (key, cause) in shape.misfits {
        reader.note_misspelt(&tree, &key, &cause);
        reader.errors.add(document.error(&key, cause));
        reader.remove(&mut tree, &key);
    }
    let is_computable = reader.replace_extremes(&mut tree);
    let case = reader.deserialised(&mut tree).filter(|_| is_computable);
    Ok(Read { case, errors: reader.errors, damage: reader.damage })
}

struct Reader<'a> {
    document: &'a Document,
    errors: Errors,
    damage: Damage,
    /// The tables with an unknown key, and the key that was probably meant.
    misspelt: Vec<(Key, Option<String>)>,
}

impl Reader<'_> {
    /// The values of the formulas of constants in `texts`, as text. Those with an error become a part of the damage.
    fn numbers(&mut self, tree: &DeTable<'_>, texts: &[NumberText]) -> Vec<(Key, String)> {
        if texts.is_empty() {
            return Vec::new();
        }
        let (constants, lost) = constants(tree);
        let Sound { checker, errors } = Checker::of_constants(self.document, &constants, lost);
        self.errors.extend(errors);
        let mut values = Vec::new();
        for text in texts {
            match self.errors.note(value_of(&checker, text)) {
                Some(value) => values.push((text.key.clone(), value)),
                None => self.damage.add(named(&text.key)),
            }
        }
        values
    }

    /// Remembers the table of an unknown key, and what was probably meant. If that is missing it is a part of the damage.
    fn note_misspelt(&mut self, tree: &Spanned<DeTable<'_>>, key: &Key, cause: &Cause) {
        let Cause::Unknown { .. } = cause else { return };
        let table = key.parent();
        let meant = cause.nearest().map(str::to_owned);
        if let Some(meant) = meant.as_ref().map(|meant| table.child(meant))
            && !contains(tree.get_ref(), &meant.0)
        {
            self.damage.add(meant);
        }
        self.misspelt.push((table, meant));
    }

    /// Reports numbers that the program cannot compute with, and replaces them. False if there are very many.
    fn replace_extremes(&mut self, tree: &mut Spanned<DeTable<'_>>) -> bool {
        for _ in 0..MOST_EXTREMES {
            let Some((key, cause)) = magnitude::first_extreme(tree.get_ref()) else { return true };
            self.errors.add(self.document.error(&key, cause));
            self.damage.add(named(&key));
            replace(tree, &key.0, "1.0");
        }
        false
    }

    /// The case; None if a required part has an error and nothing can stand for it.
    fn deserialised(&mut self, tree: &mut Spanned<DeTable<'_>>) -> Option<raw::Case> {
        loop {
            let error = match raw::read_case(tree.clone()) {
                Ok(case) => return Some(case),
                Err(error) => error,
            };
            let (key, located) = self.document.located(&error);
            let key = named(&key);
            let goes_on = match missing(error.message()) {
                Some(name) => self.supply(tree, &key, name, located),
                None => {
                    // What lacks a key that was removed is removed, too.
                    if !self.damage.keys().iter().any(|damaged| damaged.0.starts_with(&key.0)) {
                        self.errors.add(located);
                    }
                    !key.0.is_empty() && self.remove(tree, &key)
                }
            };
            if !goes_on {
                return None;
            }
        }
    }

    /// Supplies the key `name` that is missing in `table`, or else removes the table. The `error` is reported unless it follows from an error
    /// before it. False if there is no way on.
    fn supply(&mut self, tree: &mut Spanned<DeTable<'_>>, table: &Key, name: &str, error: Box<CaseError>) -> bool {
        let key = table.child(name);
        if !self.is_explained(table, &key) {
            self.errors.add(error);
        }
        self.damage.add(key.clone());
        let stand_in = stand_in(&key);
        let supplied = stand_in.is_some_and(|text| insert(tree, &table.0, name, text));
        supplied || !table.0.is_empty() && self.remove(tree, table)
    }

    /// Whether `key` is missing in `table` because of another error: it was removed, or its name is misspelt.
    fn is_explained(&self, table: &Key, key: &Key) -> bool {
        let is_meant = |meant: &Option<String>| meant.as_ref().is_none_or(|meant| table.child(meant) == *key);
        self.damage.keys().iter().any(|damaged| damaged == key || damaged == table)
            || self.misspelt.iter().any(|(of, meant)| of == table && is_meant(meant))
    }

    /// Removes a key from the tree; false if it is not there.
    fn remove(&mut self, tree: &mut Spanned<DeTable<'_>>, key: &Key) -> bool {
        let key = named(key);
        let found = take_out(tree.get_mut(), &key.0);
        self.damage.add(key);
        found
    }
}

/// The constants that have the right type. The others are lost; the deserialiser reports them.
fn constants(tree: &DeTable<'_>) -> (BTreeMap<String, Formula>, Damage) {
    let (section, mut constants, mut lost) = (Key::new("constants"), BTreeMap::new(), Damage::default());
    match tree.get("constants").map(Spanned::get_ref) {
        None => {}
        Some(DeValue::Table(given)) => {
            for (name, value) in given.iter() {
                match raw::read_formula(value.clone()) {
                    Ok(formula) => drop(constants.insert(name.get_ref().to_string(), formula)),
                    Err(_) => lost.add(section.child(name.get_ref())),
                }
            }
        }
        Some(_) => lost.add(section),
    }
    (constants, lost)
}

/// The name of the missing key in a message of serde.
fn missing(message: &str) -> Option<&str> {
    message.strip_prefix("missing field `")?.strip_suffix('`')
}

/// A value of the right type for the required `key`, as text.
fn stand_in(key: &Key) -> Option<&'static str> {
    let section = NEEDED.iter().find(|(name, _)| Key::new(name) == *key).map(|(_, text)| *text);
    section.or_else(|| choices::stand_in(key))
}

/// The value of a formula where a number is needed, as text.
fn value_of(checker: &Checker<'_>, NumberText { key, text, whole }: &NumberText) -> Checked<String> {
    let value = checker.number(key, &Formula::Text(text.clone()))?;
    checker.computable(key, "the number", value)?;
    if !whole {
        return Ok(format!("{value:?}"));
    }
    let is_whole = (value - value.round()).abs() <= WHOLE * value.abs().max(1.0) && value.abs() < MOST;
    checker.require(key, &format!("the number, {value},"), is_whole, "a formula whose value is a whole number")?;
    Ok(format!("{}", value.round() as i64))
}

/// The key without the entry of a list.
fn named(key: &Key) -> Key {
    Key(key.0.iter().take_while(|step| matches!(step, Step::Name(_))).cloned().collect())
}
