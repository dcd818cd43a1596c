//! The comparison of a document with the schema.
//!
//! The deserialiser misses three errors, or finds them too late. It takes the entries of a list that it needs and ignores the others. It
//! fills tables from lists by position. And it may report a missing key in one table before it meets the misspelt name of another. So
//! the whole document is first compared with the schema. All other errors of values are left to the deserialiser. It also finds the texts
//! where numbers are needed: formulas of constants.

use super::cause::Cause;
use super::key::Key;
use super::raw;
use serde_json::Value as Schema;
use std::sync::OnceLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The comparison of a document with the schema.
pub(super) struct Shape {
    /// The keys that do not fit, and their errors.
    pub(super) misfits: Vec<(Key, Cause)>,
    /// The texts where numbers are needed.
    pub(super) numbers: Vec<NumberText>,
}

/// A text where a number is needed.
#[derive(Clone)]
pub(super) struct NumberText {
    pub(super) key: Key,
    pub(super) text: String,
    /// Whether the number must be whole.
    pub(super) whole: bool,
}

/// Compares a document with the schema.
pub(super) fn compare(document: &DeTable<'_>) -> Shape {
    static SCHEMA: OnceLock<Schema> = OnceLock::new();
    let root = SCHEMA.get_or_init(|| raw::schema().to_value());
    let mut walk = Walk { root, misfits: Vec::new(), numbers: Vec::new() };
    walk.table(&walk.alternatives(root), document, &Key::default());
    walk.misfits.sort_by_key(|misfit| misfit.offset);
    let misfits = walk.misfits.into_iter().map(|misfit| (misfit.key, misfit.cause)).collect();
    Shape { misfits, numbers: walk.numbers }
}

/// A part of the document that does not fit.
struct Misfit {
    /// The place in the text.
    offset: usize,
    key: Key,
    cause: Cause,
}

/// A traversal of a document along its schema.
struct Walk<'a> {
    root: &'a Schema,
    misfits: Vec<Misfit>,
    numbers: Vec<NumberText>,
}

impl<'a> Walk<'a> {
    fn value(&mut self, schema: &'a Schema, value: &Spanned<DeValue<'_>>, key: &Key) {
        let alternatives = self.alternatives(schema);
        match value.get_ref() {
            DeValue::Table(table) => self.table(&alternatives, table, key),
            DeValue::Array(entries) => self.list(&alternatives, value.span().start, entries, key),
            DeValue::String(text) => self.text(&alternatives, text, key),
            _ => {}
        }
    }

    /// The `text` at `key`: a formula where a number is needed.
    fn text(&mut self, alternatives: &[&Schema], text: &str, key: &Key) {
        let any = needs(alternatives, "number");
        if any || needs(alternatives, "integer") {
            self.numbers.push(NumberText { key: key.clone(), text: text.to_owned(), whole: !any });
        }
    }

    /// The `table` at `key`: with the keys of a section, with names chosen by the user, or with one choice.
    fn table(&mut self, alternatives: &[&'a Schema], table: &DeTable<'_>, key: &Key) {
        let named: Vec<&'a Schema> = alternatives.iter().copied().filter(|a| a["properties"].is_object()).collect();
        if let Some(any) = alternatives.iter().copied().map(|a| &a["additionalProperties"]).find(|any| any.is_object())
        {
            return table.iter().for_each(|(name, value)| self.value(any, value, &key.child(name.get_ref())));
        }
        if let [(name, value)] = &table.iter().collect::<Vec<_>>()[..]
            && is_alone(alternatives, name.get_ref())
        {
            // The deserialiser accepts an empty table of settings.
            if !value.get_ref().as_table().is_some_and(DeTable::is_empty) {
                self.add(name.span().start, key.child(name.get_ref()), without_settings(name.get_ref()));
            }
            return;
        }
        // Each of several choices in one table may be valid; the deserialiser reports that there are several.
        if named.is_empty() || named.len() > 1 && table.len() != 1 {
            return;
        }
        for (name, value) in table.iter() {
            let key = key.child(name.get_ref());
            let of_name = |a: &'a Schema| &a["properties"][&**name.get_ref()];
            match named.iter().copied().map(of_name).find(|found| found.is_object()) {
                Some(inner) => self.value(inner, value, &key),
                None => {
                    let mut cause = unknown(name.get_ref(), alternatives);
                    if let Cause::Unknown { belongs, .. } = &mut cause {
                        *belongs = self
                            .table_with(&named, name.get_ref())
                            .or_else(|| self.inner_table_with(&named, name.get_ref()));
                    }
                    self.add(name.span().start, key, cause);
                }
            }
        }
    }

    /// The key among `tables` in whose table, or as whose choice, `name` is accepted; None if there are none or several.
    fn table_with(&self, tables: &[&'a Schema], name: &str) -> Option<String> {
        let keys = tables.iter().filter_map(|a| a["properties"].as_object()).flatten();
        let accepts = |schema: &'a Schema| {
            let inner = self.alternatives(schema);
            inner.iter().any(|a| a["properties"][name].is_object()) || is_alone(&inner, name)
        };
        only(keys.filter(|(_, schema)| accepts(schema)).map(|(key, _)| key.clone()))
    }

    /// The same, one table further inside.
    fn inner_table_with(&self, tables: &[&'a Schema], name: &str) -> Option<String> {
        let keys = tables.iter().filter_map(|a| a["properties"].as_object()).flatten();
        let inner = |(key, schema)| Some(format!("{key}.{}", self.table_with(&self.alternatives(schema), name)?));
        only(keys.filter_map(inner))
    }

    fn list(&mut self, alternatives: &[&'a Schema], offset: usize, entries: &[Spanned<DeValue<'_>>], key: &Key) {
        let Some(list) = alternatives.iter().copied().find(|a| has_type(a, "array")) else {
            // A single name would be valid instead of the table, but the deserialiser's message does not say that
            // better.
            if alternatives.iter().any(|a| has_type(a, "object")) {
                self.add(offset, key.clone(), a_list(alternatives));
            }
            return;
        };
        let bound = |name: &str| list[name].as_u64().map(|bound| bound as usize);
        let (least, most) = (bound("minItems").unwrap_or(0), bound("maxItems").unwrap_or(usize::MAX));
        if !(least..=most).contains(&entries.len()) {
            self.add(offset, key.clone(), Cause::Entries { found: entries.len(), accepted: most });
        }
        for (index, entry) in entries.iter().enumerate() {
            let schema = [&list["prefixItems"][index], &list["items"]].into_iter().find(|schema| schema.is_object());
            schema.into_iter().for_each(|schema| self.value(schema, entry, &key.entry(index)));
        }
    }

    fn add(&mut self, offset: usize, key: Key, cause: Cause) {
        self.misfits.push(Misfit { offset, key, cause });
    }

    /// `schema`, or the schema it refers to, and the alternatives that it lists.
    fn alternatives(&self, schema: &'a Schema) -> Vec<&'a Schema> {
        if let Some(name) = schema["$ref"].as_str().and_then(|reference| reference.strip_prefix("#/$defs/")) {
            return self.alternatives(&self.root["$defs"][name]);
        }
        let lists = ["anyOf", "oneOf"].iter().filter_map(|kind| schema[kind].as_array());
        let inner = lists.flatten().flat_map(|inner| self.alternatives(inner));
        std::iter::once(schema).chain(inner).collect()
    }
}

/// The only one of `found`; None if there are none or several.
fn only(mut found: impl Iterator<Item = String>) -> Option<String> {
    found.next().filter(|_| found.next().is_none())
}

/// Whether `name` is a choice without settings.
fn is_alone(alternatives: &[&Schema], name: &str) -> bool {
    let is_listed = |a: &&Schema| a["enum"].as_array().is_some_and(|names| names.iter().any(|known| known == name));
    alternatives.iter().any(|a| a["const"] == name || is_listed(a))
}

/// Settings of a choice that has none.
fn without_settings(name: &str) -> Cause {
    Cause::Combination {
        problem: format!("the choice `{name}` has no settings"),
        accepted: format!("its name alone, \"{name}\""),
    }
}

/// An unknown key or choice.
fn unknown(name: &str, alternatives: &[&Schema]) -> Cause {
    let is_choice = alternatives.iter().any(|a| a["oneOf"].is_array());
    let keys = alternatives.iter().filter_map(|a| a["properties"].as_object()).flat_map(|keys| keys.keys());
    let alone = alternatives.iter().filter_map(|a| a["const"].as_str());
    let listed = alternatives.iter().filter_map(|a| a["enum"].as_array()).flatten().filter_map(Schema::as_str);
    let accepted = keys.map(String::as_str).chain(alone).chain(listed).map(str::to_owned).collect();
    Cause::Unknown { kind: if is_choice { "choice" } else { "key" }, name: name.to_owned(), accepted, belongs: None }
}

/// A list in the place of a table.
fn a_list(alternatives: &[&Schema]) -> Cause {
    let keys: Vec<&String> =
        alternatives.iter().filter_map(|a| a["properties"].as_object()).flat_map(|k| k.keys()).collect();
    let names = keys.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let keys = if names.is_empty() { String::new() } else { format!(", with keys among {names}") };
    Cause::Type { found: "a list".to_owned(), accepted: format!("a table, {{ key = value, ... }}{keys}") }
}

/// Whether this type of number is accepted, and no text.
fn needs(alternatives: &[&Schema], number: &str) -> bool {
    let is_text = |a: &&Schema| has_type(a, "string") || a["const"].is_string() || a["enum"].is_array();
    alternatives.iter().any(|a| has_type(a, number)) && !alternatives.iter().any(is_text)
}

fn has_type(schema: &Schema, name: &str) -> bool {
    schema["type"] == name || schema["type"].as_array().is_some_and(|types| types.iter().any(|t| t == name))
}
