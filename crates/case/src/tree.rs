//! Keys of the tables of a document: whether they exist, and changes of them.

use super::key::Step;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Whether a table has a named key.
pub(super) fn contains(table: &DeTable<'_>, steps: &[Step]) -> bool {
    match steps {
        [Step::Name(name)] => table.contains_key(name.as_str()),
        [Step::Name(name), rest @ ..] => match table.get(name.as_str()).map(Spanned::get_ref) {
            Some(DeValue::Table(inner)) => contains(inner, rest),
            _ => false,
        },
        _ => false,
    }
}

/// Inserts the value of `text` into the table at `steps`; false if there is no such table.
pub(super) fn insert<'a>(tree: &mut Spanned<DeTable<'a>>, steps: &[Step], name: &str, text: &'a str) -> bool {
    let Ok(value) = DeValue::parse(text) else { return false };
    let mut table = tree.get_mut();
    for step in steps {
        let Step::Name(step) = step else { return false };
        match table.get_mut(step.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(inner)) => table = inner,
            _ => return false,
        }
    }
    table.insert(Spanned::new(0..0, name.to_owned().into()), value);
    true
}

/// Takes a named key out of a table.
pub(super) fn take_out(table: &mut DeTable<'_>, steps: &[Step]) -> bool {
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
pub(super) fn replace<'a>(tree: &mut Spanned<DeTable<'a>>, steps: &[Step], text: &'a str) {
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
