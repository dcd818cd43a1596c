//! Which names of `[constants]` and `[tables]` the formulas of a case contain.

use super::cause::Cause;
use super::checker::{Checked, Checker};
use super::document::Document;
use super::key::Key;
use super::raw::{Case, to_table};
use std::collections::BTreeSet;
use toml::de::DeValue;

/// The words of a text that may be names in a formula.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// The names in the table `section` of a document that no text of it contains, but perhaps their own definition.
pub(super) fn unused(document: &Document, section: &str) -> Vec<String> {
    let Ok(tree) = document.tree() else { return Vec::new() };
    let root = tree.get_ref();
    let Some(defined) = root.get(section).and_then(|table| table.get_ref().as_table()) else { return Vec::new() };
    let texts_of = |value: &DeValue<'_>| {
        let mut found = BTreeSet::new();
        collect_words(value, &mut found);
        found
    };
    let mut elsewhere = BTreeSet::new();
    root.iter()
        .filter(|(name, _)| name.get_ref() != section)
        .for_each(|(_, value)| collect_words(value.get_ref(), &mut elsewhere));
    let inside: Vec<_> = defined.iter().map(|(name, value)| (name.get_ref(), texts_of(value.get_ref()))).collect();
    let is_used = |name: &str| {
        elsewhere.contains(name) || inside.iter().any(|(other, words)| other.as_ref() != name && words.contains(name))
    };
    inside.iter().map(|(name, _)| name.to_string()).filter(|name| !is_used(name)).collect()
}

fn collect_words(value: &DeValue<'_>, found: &mut BTreeSet<String>) {
    match value {
        DeValue::String(text) => found.extend(words(text).map(str::to_owned)),
        DeValue::Array(entries) => entries.iter().for_each(|entry| collect_words(entry.get_ref(), found)),
        DeValue::Table(table) => table.values().for_each(|value| collect_words(value.get_ref(), found)),
        _ => {}
    }
}

/// An option `--set constants.NAME` must be of use: a misspelt name would be a new constant, and the run that of the file.
pub(super) fn check_options(checker: &Checker<'_>, document: &Document) -> Checked<()> {
    let section = Key::new("constants");
    for name in unused(document, "constants") {
        let key = section.child(&name);
        if document.is_only_an_option(&key) {
            let accepted = document.names_in_file("constants");
            return Err(
                checker.error(&key, Cause::Unknown { kind: "constant, in no formula:", name, accepted, belongs: None })
            );
        }
    }
    Ok(())
}

/// The constants of a resolved case that its formulas contain. Numbers are computed there, so that those for numbers alone are not among them.
pub(super) fn retain_used_constants(case: &mut Case) {
    let constants = std::mem::take(&mut case.constants);
    let mut used = words_of(&toml::Value::Table(to_table(case)));
    let text =
        |name: &String| constants.get(name).map(|formula| toml::Value::try_from(formula).map(|value| words_of(&value)));
    // Constants in the formulas of constants that are used.
    let mut waiting: Vec<String> = used.iter().cloned().collect();
    while let Some(name) = waiting.pop() {
        let Some(Ok(words)) = text(&name) else { continue };
        waiting.extend(words.iter().filter(|word| used.insert((*word).clone())).cloned().collect::<Vec<_>>());
    }
    case.constants = constants.into_iter().filter(|(name, _)| used.contains(name)).collect();
}

fn words_of(value: &toml::Value) -> BTreeSet<String> {
    match value {
        toml::Value::String(text) => words(text).map(str::to_owned).collect(),
        toml::Value::Array(entries) => entries.iter().flat_map(words_of).collect(),
        toml::Value::Table(table) => table.values().flat_map(words_of).collect(),
        _ => BTreeSet::new(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const TEXT: &str = "constants = { a = 1, b = \"2*a\", c = \"c\", d = 3, n = 4 }\n\
                        motion.prescribed = [\"b*x\", 0]\n\
                        time.slabs = \"n\"\n\
                        tables = { way = { t = [0, 1], values = [0, 1] }, other = { t = [0, 1], values = [0, 1] } }\n\
                        bodies.foil.y = { motion = \"way(t)\" }\n";

    #[test]
    fn a_name_is_used_by_formulas_other_than_its_own() {
        let document = Document::parse("case.toml".as_ref(), TEXT.to_owned(), &[]).unwrap();
        assert_eq!(unused(&document, "constants"), ["c", "d"]);
        assert_eq!(unused(&document, "tables"), ["other"]);
        assert_eq!(unused(&document, "controls"), [""; 0]);
    }
}
