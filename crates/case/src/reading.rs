//! From the document to the raw case: all errors of keys and types at once, and formulas where numbers are needed.
//!
//! A key with an error is removed, and the rest is read again. An error that follows from a missing key is not reported.

use super::checker::{Checked, Checker};
use super::document::Document;
use super::error::{CaseError, Errors};
use super::key::{Key, Step};
use super::magnitude;
use super::raw::{self, Formula};
use super::shape::{self, NumberText};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

/// Sections on which no other section depends.
const INDEPENDENT: [&str; 3] = ["output", "parallel", "solver"];

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
}

/// Reads the document.
pub(super) fn read(document: &Document) -> Result<Read, Box<CaseError>> {
    // Integers of TOML have 64 bits with a sign. The parser accepts longer ones, its own tables do not.
    document.check_integers()?;
    let mut reader = Reader { document, errors: Errors::default(), removed: Vec::new(), of_constants: None };
    let shape = shape::compare(document.tree()?.get_ref());
    let values = reader.numbers(document.tree()?.get_ref(), &shape.numbers);
    let mut tree = document.tree()?;
    for (key, value) in &values {
        replace(&mut tree, &key.0, value);
    }
    for (key, cause) in shape.misfits {
        reader.errors.add(document.error(&key, cause));
        reader.remove(&mut tree, &key);
    }
    let case = reader.deserialised(&mut tree);
    if let Some((key, cause)) = magnitude::first_extreme(tree.get_ref()) {
        reader.errors.add(document.error(&key, cause));
        reader.removed.push(named(&key));
    }
    let case = case.filter(|_| reader.rest_is_whole());
    // Whoever checks the case finds this error. Without a case it is told here.
    reader.of_constants.filter(|_| case.is_none()).into_iter().for_each(|error| reader.errors.add(error));
    Ok(Read { case, errors: reader.errors })
}

struct Reader<'a> {
    document: &'a Document,
    errors: Errors,
    /// The keys that were removed.
    removed: Vec<Key>,
    /// The errors of the constants that numbers need.
    of_constants: Option<Box<CaseError>>,
}

impl Reader<'_> {
    /// The values of the formulas of constants in `texts`, as text.
    fn numbers(&mut self, tree: &DeTable<'_>, texts: &[NumberText]) -> Vec<(Key, String)> {
        if texts.is_empty() {
            return Vec::new();
        }
        let constants = tree.get("constants").map_or(Ok(BTreeMap::new()), |table| {
            BTreeMap::<String, Formula>::deserialize(table.clone().into_deserializer())
        });
        // Constants of a wrong type are an error of the whole case.
        let checker = constants.ok().map(|all| Checker::new(self.document, &all));
        let checker = match checker {
            Some(Ok(checker)) => checker,
            failed => {
                self.of_constants = failed.and_then(Result::err);
                self.removed.extend(texts.iter().map(|text| named(&text.key)));
                return Vec::new();
            }
        };
        let mut values = Vec::new();
        for text in texts {
            match self.errors.note(value_of(&checker, text)) {
                Some(value) => values.push((text.key.clone(), value)),
                None => self.removed.push(named(&text.key)),
            }
        }
        values
    }

    /// The case; None if a required part has an error.
    fn deserialised(&mut self, tree: &mut Spanned<DeTable<'_>>) -> Option<raw::Case> {
        for key in self.removed.clone() {
            take_out(tree.get_mut(), &key.0);
        }
        loop {
            let (key, error) = match raw::Case::deserialize(Deserializer::from(tree.clone())) {
                Ok(case) => return Some(case),
                Err(error) => self.document.located(&error),
            };
            let key = named(&key);
            // What lacks a key that was taken out is taken out, too.
            let follows = self.removed.iter().any(|removed| removed.0.starts_with(&key.0));
            if !follows {
                self.errors.add(error);
            }
            if key.0.is_empty() || !self.remove(tree, &key) {
                return None;
            }
        }
    }

    /// Removes a key from the tree; false if it is not there.
    fn remove(&mut self, tree: &mut Spanned<DeTable<'_>>, key: &Key) -> bool {
        let key = named(key);
        let found = take_out(tree.get_mut(), &key.0);
        self.removed.push(key);
        found
    }

    /// Whether all sections on which others depend are as written.
    fn rest_is_whole(&self) -> bool {
        let section =
            |key: &Key| matches!(key.0.first(), Some(Step::Name(name)) if INDEPENDENT.contains(&name.as_str()));
        self.removed.iter().all(section)
    }
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

/// Takes a named key out of a table.
fn take_out(table: &mut DeTable<'_>, steps: &[Step]) -> bool {
    match steps {
        [Step::Name(name)] => table.remove(name.as_str()).is_some(),
        [Step::Name(name), rest @ ..] => match table.get_mut(name.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(inner)) => take_out(inner, rest),
            _ => false,
        },
        _ => false,
    }
}

/// Replaces the value at a key, in its place.
fn replace<'a>(tree: &mut Spanned<DeTable<'a>>, steps: &[Step], text: &'a str) {
    let Some((Step::Name(first), rest)) = steps.split_first() else { return };
    let mut value = tree.get_mut().get_mut(first.as_str());
    for step in rest {
        value = match (value.map(Spanned::get_mut), step) {
            (Some(DeValue::Table(table)), Step::Name(name)) => table.get_mut(name.as_str()),
            (Some(DeValue::Array(entries)), Step::Entry(index)) => entries.get_mut(*index),
            _ => None,
        };
    }
    if let (Some(value), Ok(number)) = (value, DeValue::parse(text)) {
        *value = Spanned::new(value.span(), number.into_inner());
    }
}
