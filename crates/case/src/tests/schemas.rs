//! The schema of the keys, and the one for editors.

use super::*;

#[test]
fn the_schema_describes_every_key() {
    let schema = serde_json::to_value(schema()).unwrap();
    let mut keys = 0;
    undescribed(&schema, "case", &mut keys);
    assert!(keys > 100, "{keys} keys");
    let text = schema.to_string();
    for key in [
        "poisson_ratio",
        "newton_tolerance",
        "checkpoint_every",
        "far_field",
        "strength",
        "inverse_jacobian",
        "lax_friedrichs",
    ] {
        assert!(text.contains(&format!("\"{key}\"")), "{key}");
    }
    assert_eq!(schema["$defs"]["Gas"]["properties"]["gamma"]["default"], 1.4);
    assert_eq!(schema["$defs"]["Gas"]["additionalProperties"], false);
}

/// Counts properties and choices, each of which must have a description.
fn undescribed(schema: &serde_json::Value, path: &str, keys: &mut usize) {
    if let Some(properties) = schema["properties"].as_object() {
        for (name, property) in properties {
            let described = property["description"].is_string() || schema["description"].is_string();
            assert!(described, "{path}.{name} has no description");
            *keys += 1;
        }
    }
    for choice in schema["oneOf"].as_array().into_iter().flatten() {
        assert!(choice["description"].is_string(), "a choice of {path} has no description: {choice}");
    }
    let inner = schema.as_object().into_iter().flatten().filter(|(name, _)| *name != "default");
    for (name, value) in inner {
        match value {
            serde_json::Value::Object(_) => undescribed(value, &format!("{path}.{name}"), keys),
            serde_json::Value::Array(entries) => entries.iter().for_each(|entry| undescribed(entry, path, keys)),
            _ => {}
        }
    }
}

#[test]
fn the_schema_for_editors_accepts_formulas_for_numbers() {
    let text = serde_json::to_string(&crate::editor_schema()).unwrap();
    for kind in ["number", "integer"] {
        let (alone, both) = (format!("\"type\":\"{kind}\""), format!("\"type\":[\"{kind}\",\"string\"]"));
        assert!(!text.contains(&alone) && text.contains(&both), "{kind}");
    }
    assert!(text.contains("\"$id\""));
}
