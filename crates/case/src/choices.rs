//! The choices that the case file offers at a key, from its schema.

use super::key::{Key, Step};
use super::raw;
use serde_json::Value;

/// The names of the choices at `key`; empty if there is no choice.
pub(super) fn choices(key: &Key) -> Vec<String> {
    let schema = raw::schema().to_value();
    at(&schema, key).into_iter().flat_map(names).collect()
}

/// The choice at `key` whose only setting is a number, if there is one: a number alone probably meant this choice.
pub(super) fn choice_of_number(key: &Key) -> Option<String> {
    let schema = raw::schema().to_value();
    let is_number = |value: &Value| {
        alternatives(&schema, value).iter().any(|value| matches!(value["type"].as_str(), Some("number" | "integer")))
    };
    at(&schema, key).into_iter().find_map(|value| {
        let [name] = &names(value)[..] else { return None };
        is_number(&value["properties"][name]).then(|| name.clone())
    })
}

/// A value of the type that the schema has at `key`, as text, if that is a number, a text or a list of numbers.
pub(super) fn stand_in(key: &Key) -> Option<&'static str> {
    let schema = raw::schema().to_value();
    at(&schema, key).into_iter().find_map(|value| match type_of(value)? {
        "integer" => Some("4"),
        "number" => Some("1.0"),
        "string" if !value["enum"].is_array() && !value["const"].is_string() => Some("\"x\""),
        "array" => Some(match value["minItems"].as_u64() {
            None => "[]",
            Some(2) => "[4, 4]",
            Some(_) => "[4, 4, 4]",
        }),
        _ => None,
    })
}

/// An example of a value at `key`, if it is no table.
pub(super) fn example(key: &Key) -> Option<&'static str> {
    let schema = raw::schema().to_value();
    let found = at(&schema, key);
    let is_table = found.iter().any(|value| type_of(value) == Some("object"));
    found.into_iter().filter(|_| !is_table).find_map(|value| match type_of(value)? {
        "integer" => Some("8"),
        "number" => Some("1.0"),
        "string" => Some("\"...\""),
        "array" => Some("[...]"),
        _ => None,
    })
}

/// The first type of a value of the schema.
fn type_of(value: &Value) -> Option<&str> {
    value["type"].as_str().or_else(|| value["type"][0].as_str())
}

/// What the schema has at `key`.
fn at<'a>(schema: &'a Value, key: &Key) -> Vec<&'a Value> {
    let start = alternatives(schema, schema);
    key.0.iter().fold(start, |values, step| {
        values
            .into_iter()
            .filter_map(|value| inside(value, step))
            .flat_map(|value| alternatives(schema, value))
            .collect()
    })
}

/// `value` itself, or the value it refers to, and the alternatives that it lists.
fn alternatives<'a>(schema: &'a Value, value: &'a Value) -> Vec<&'a Value> {
    if let Some(name) = value["$ref"].as_str().and_then(|reference| reference.strip_prefix("#/$defs/")) {
        return alternatives(schema, &schema["$defs"][name]);
    }
    let lists = ["anyOf", "oneOf"].iter().filter_map(|kind| value[kind].as_array());
    std::iter::once(value).chain(lists.flatten().flat_map(|inner| alternatives(schema, inner))).collect()
}

/// The value at the `step` from `value`.
fn inside<'a>(value: &'a Value, step: &Step) -> Option<&'a Value> {
    let parts = match step {
        Step::Name(name) => [&value["properties"][name.as_str()], &value["additionalProperties"]],
        Step::Entry(index) => [&value["prefixItems"][*index], &value["items"]],
    };
    parts.into_iter().find(|part| part.is_object())
}

/// The names of an alternative: a choice without settings, or the one key that it needs.
fn names(value: &Value) -> Vec<String> {
    let texts = |list: &Value| -> Vec<String> {
        list.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let required = texts(&value["required"]);
    let alone = value["properties"].as_object().is_some_and(|properties| properties.len() == 1 && required.len() == 1);
    let mut names = texts(&value["enum"]);
    names.extend(value["const"].as_str().map(str::to_owned));
    names.extend(if alone { required } else { Vec::new() });
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_found_by_key() {
        let of = |key: &str| choices(&Key::new(key));
        assert!(["box", "airfoil"].iter().all(|name| of("mesh.generate").contains(&(*name).to_owned())));
        assert!(["fixed", "rigid"].iter().all(|name| of("motion.boundary.airfoil").contains(&(*name).to_owned())));
        assert!(of("flow.boundary.far").contains(&"far_field".to_owned()));
        assert_eq!(of("time.end"), Vec::<String>::new());
        assert_eq!(of("no.such.key"), Vec::<String>::new());
        assert_eq!(choice_of_number(&Key::new("flow.gas.viscosity")), Some("constant".to_owned()));
        assert_eq!(choice_of_number(&Key::new("flow.riemann")), None);
    }
}
