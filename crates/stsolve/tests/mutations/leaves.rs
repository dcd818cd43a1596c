//! The values of a TOML text with their paths, read without any knowledge of cases.

use std::collections::BTreeMap;

/// Every value that is neither a table with keys nor a list with entries, by its path such as `mesh.generate.box.lower[0]`.
pub type Leaves = BTreeMap<String, toml::Value>;

/// The leaves of a text; None if it is not TOML.
pub fn leaves(text: &str) -> Option<Leaves> {
    let table: toml::Table = text.parse().ok()?;
    let mut leaves = Leaves::new();
    collect("", &toml::Value::Table(table), &mut leaves);
    Some(leaves)
}

fn collect(path: &str, value: &toml::Value, leaves: &mut Leaves) {
    match value {
        toml::Value::Table(table) if !table.is_empty() || path.is_empty() => {
            let dot = if path.is_empty() { "" } else { "." };
            table.iter().for_each(|(name, value)| collect(&format!("{path}{dot}{name}"), value, leaves));
        }
        toml::Value::Array(entries) if !entries.is_empty() => {
            let entries = entries.iter().enumerate();
            entries.for_each(|(index, value)| collect(&format!("{path}[{index}]"), value, leaves));
        }
        _ => drop(leaves.insert(path.to_owned(), value.clone())),
    }
}

/// Whether a number in quotes, which is a formula, has the same value as the other.
pub fn same_in_quotes(one: &toml::Value, other: &toml::Value) -> bool {
    let plain = |value: &toml::Value| match value.as_str().and_then(|text| text.trim().parse().ok()) {
        Some(number) => toml::Value::Float(number),
        None => value.clone(),
    };
    same(&plain(one), &plain(other))
}

/// Whether two values are the same text, or the same number written in two ways.
pub fn same(one: &toml::Value, other: &toml::Value) -> bool {
    let number = |value: &toml::Value| value.as_float().or_else(|| value.as_integer().map(|n| n as f64));
    match (number(one), number(other)) {
        (Some(one), Some(other)) => one.to_bits() == other.to_bits() || one == other,
        _ => one == other,
    }
}

/// The paths that only one text has, or that have different values.
pub fn differing(one: &Leaves, other: &Leaves) -> Vec<String> {
    let lacks = |a: &Leaves, b: &Leaves| -> Vec<String> {
        let differs = |(path, value): &(&String, &toml::Value)| b.get(*path).is_none_or(|found| !same(found, value));
        a.iter().filter(differs).map(|(path, _)| path.clone()).collect()
    };
    let mut paths = [lacks(one, other), lacks(other, one)].concat();
    paths.sort();
    paths.dedup();
    paths
}

/// The first name in a path or in the rest of one.
pub fn first_name(path: &str) -> &str {
    path.trim_start_matches('.').split(['.', '[']).next().unwrap_or_default()
}

/// The last name in a path, without the number of an entry.
pub fn last_name(path: &str) -> &str {
    let last = path.rsplit('.').next().unwrap_or(path);
    last.split('[').next().unwrap_or(last)
}
