//! The reference of the case file, generated from its schema.

use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt::Write;

const TITLE: &str = "# Keys of a case file\n\nThis page is the output of `stsolve schema --markdown`.\n";

/// All keys of the JSON `schema` as a page in Markdown. Each table and each choice has a section, named by the shortest key of it.
pub(super) fn markdown(schema: &Value) -> String {
    let mut page = Page { schema, keys: BTreeMap::new() };
    page.find_keys();
    let mut text = format!("{TITLE}\n{}\n", description(schema).replace('*', "\\*"));
    page.table(&mut text, schema);
    let mut sections: Vec<(&str, &str)> = page.keys.iter().map(|(name, keys)| (keys[0].as_str(), *name)).collect();
    sections.sort_unstable();
    sections.into_iter().for_each(|(_, name)| page.section(&mut text, name));
    text
}

struct Page<'a> {
    schema: &'a Value,
    /// The keys of a definition, the shortest first.
    keys: BTreeMap<&'a str, Vec<String>>,
}

impl<'a> Page<'a> {
    /// Finds the keys of definitions, level by level, so that the first key is a short one.
    fn find_keys(&mut self) {
        let mut level = vec![(String::new(), self.schema)];
        while !level.is_empty() {
            let mut next = Vec::new();
            for (key, value) in level {
                match self.definition(value) {
                    None => inside(&key, value, &mut next),
                    Some(name) => {
                        let keys = self.keys.entry(name).or_default();
                        keys.push(key.clone());
                        if keys.len() == 1 {
                            inside(&key, &self.schema["$defs"][name], &mut next);
                        }
                    }
                }
            }
            level = next;
        }
    }

    /// The definition that `value` refers to, if it has a section of its own.
    fn definition<'b>(&self, value: &'b Value) -> Option<&'b str> {
        let name = value["$ref"].as_str()?.strip_prefix("#/$defs/")?;
        let definition = &self.schema["$defs"][name];
        let has_section = definition["properties"].is_object() || definition["oneOf"].is_array();
        has_section.then_some(name)
    }

    fn section(&self, text: &mut String, name: &str) {
        let (keys, definition) = (&self.keys[name], &self.schema["$defs"][name]);
        let level = if keys[0].contains('.') { "###" } else { "##" };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{level} `{}`\n\n{}", keys[0], description(definition));
        if keys.len() > 1 {
            let others: Vec<String> = keys[1..].iter().map(|key| format!("`{key}`")).collect();
            let _ = writeln!(text, "\nThe same at {}.", others.join(", "));
        }
        if definition["oneOf"].is_array() {
            self.choices(text, definition);
        } else {
            self.table(text, definition);
        }
    }

    /// The keys of a table.
    fn table(&self, text: &mut String, value: &Value) {
        let _ = writeln!(text, "\n| key | value | default | meaning |\n|---|---|---|---|");
        let required: Vec<&str> = list(value, "required").filter_map(Value::as_str).collect();
        for (name, property) in entries(value, "properties") {
            let default = match &property["default"] {
                _ if required.contains(&name.as_str()) => "required".to_owned(),
                // The keys of a table are listed in its own section.
                Value::Null | Value::Object(_) => String::new(),
                default => format!("`{default}`").replace(",\"", ", \""),
            };
            let (kind, meaning) = (self.kind(property), one_line(&description(property)));
            let _ = writeln!(text, "| `{name}` | {kind} | {default} | {meaning} |");
        }
    }

    /// The choices of a value: names, or tables of one key.
    fn choices(&self, text: &mut String, value: &Value) {
        let _ = writeln!(text, "\n| choice | meaning |\n|---|---|");
        for choice in list(value, "oneOf") {
            let meaning = one_line(&description(choice));
            for name in choice["const"].as_str().into_iter().chain(list(choice, "enum").filter_map(Value::as_str)) {
                let _ = writeln!(text, "| `\"{name}\"` | {meaning} |");
            }
            for (name, settings) in entries(choice, "properties") {
                let inner: Vec<String> = entries(settings, "properties")
                    .map(|(key, value)| format!("`{key}`, a {}: {}", self.kind(value), one_line(&description(value))))
                    .collect();
                let value = if inner.is_empty() {
                    format!("Value: {}.", self.kind(settings))
                } else {
                    format!("Keys: {}", inner.join(" "))
                };
                let _ = writeln!(text, "| `{{ {name} = ... }}` | {meaning} {value} |");
            }
        }
    }

    /// The type of a value, in words.
    fn kind(&self, value: &Value) -> String {
        if let Some(name) = self.definition(value) {
            let key = self.keys.get(name).and_then(|keys| keys.first()).map_or(name, String::as_str);
            return format!("[`{key}`](#{})", anchor(key));
        }
        if value["$ref"] == "#/$defs/Formula" {
            return "formula".to_owned();
        }
        if let Some(inner) = list(value, "anyOf").find(|inner| inner["type"] != "null") {
            return self.kind(inner);
        }
        let first = list(value, "type").next().unwrap_or(&value["type"]);
        match first.as_str() {
            Some("array") => format!("list of {}", self.kind(&value["items"])),
            Some("object") => format!("table of {} by name", self.kind(&value["additionalProperties"])),
            Some("integer") => "whole number".to_owned(),
            Some("boolean") => "true or false".to_owned(),
            Some("string") => "text".to_owned(),
            _ => "number".to_owned(),
        }
    }
}

/// The values inside of `value`, at `key`, with their keys.
fn inside<'a>(key: &str, value: &'a Value, found: &mut Vec<(String, &'a Value)>) {
    found.extend(entries(value, "properties").map(|(name, property)| (below(key, name), property)));
    found.extend(["oneOf", "anyOf"].iter().flat_map(|kind| list(value, kind)).map(|choice| (key.to_owned(), choice)));
    let parts = [("items", format!("{key}[]")), ("additionalProperties", below(key, "NAME"))];
    found.extend(parts.into_iter().filter(|(part, _)| value[part].is_object()).map(|(part, key)| (key, &value[part])));
}

fn below(key: &str, name: &str) -> String {
    if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") }
}

fn entries<'a>(value: &'a Value, name: &str) -> impl Iterator<Item = (&'a String, &'a Value)> + use<'a> {
    value[name].as_object().into_iter().flat_map(Map::iter)
}

fn list<'a>(value: &'a Value, name: &str) -> impl Iterator<Item = &'a Value> + use<'a> {
    value[name].as_array().into_iter().flatten()
}

fn description(value: &Value) -> String {
    value["description"].as_str().unwrap_or_default().to_owned()
}

/// For a cell of a table. Outside of backticks a star is escaped.
fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    let part = |(index, part): (usize, &str)| if index % 2 == 0 { part.replace('*', "\\*") } else { part.to_owned() };
    line.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
}

/// The Markdown anchor of a heading.
fn anchor(key: &str) -> String {
    key.to_lowercase().chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
}
