//! The description of a case.

use super::tables;
use crate::checker::Checker;
use crate::continuation::lasting;
use crate::document::Document;
use crate::expression::Table;
use crate::key::Key;
use crate::names_in_use::unused;
use crate::raw::{self, to_table, to_toml};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The description of a case, without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// The name of the file without its extension.
    pub name: String,
    /// A title in one line.
    pub title: String,
    /// The resolved case with all defaults and the contents of its tables, which can be run again.
    pub resolved: String,
    /// The part of `resolved` that the states of a run depend on: equal for cases that may continue each other.
    pub lasting: String,
    /// Every key that was left to its default, and the value taken.
    pub defaults: Vec<(String, String)>,
    /// The tables, by name.
    pub tables: Vec<(String, Table)>,
    /// The constants and tables that no formula contains.
    pub unused: Vec<String>,
}

impl About {
    pub(super) fn new(checker: &Checker<'_>, document: &Document, raw: &raw::Case) -> Self {
        let name = document.path().file_stem().map_or_else(|| "case".into(), |stem| stem.to_string_lossy());
        let whole = raw::Case { tables: tables::written_out(checker, &raw.tables), ..raw.clone() };
        About {
            name: name.into_owned(),
            title: raw.title.clone(),
            resolved: to_toml(&whole),
            lasting: to_toml(&lasting(&whole)),
            defaults: defaults_taken(document, raw).into_iter().chain(checker.noted_defaults()).collect(),
            tables: checker.tables().map(|(name, table)| (name.to_owned(), table.clone())).collect(),
            unused: ["constants", "tables"].iter().flat_map(|section| unused(document, section)).collect(),
        }
    }
}

/// The keys of the resolved case that are not in the document.
fn defaults_taken(document: &Document, raw: &raw::Case) -> Vec<(String, String)> {
    let mut defaults = Vec::new();
    if let Ok(given) = document.tree() {
        collect_defaults(&Key::default(), &to_table(raw), Some(given.get_ref()), &mut defaults);
    }
    defaults
}

/// Adds the keys of `full` that are not in the table `given` at the same `key`.
fn collect_defaults(key: &Key, full: &toml::Table, given: Option<&DeTable<'_>>, defaults: &mut Vec<(String, String)>) {
    for (name, value) in full {
        let (key, given) = (key.child(name), given.and_then(|given| given.get(name.as_str())).map(Spanned::get_ref));
        match value {
            toml::Value::Table(table) => collect_defaults(&key, table, given.and_then(DeValue::as_table), defaults),
            toml::Value::String(text) if text.is_empty() => {}
            _ if given.is_none() => {
                // Rust writes small numbers shorter than TOML does.
                let text = value.as_float().map_or_else(|| value.to_string(), |number| format!("{number:?}"));
                defaults.push((key.to_string(), text));
            }
            _ => {}
        }
    }
}
