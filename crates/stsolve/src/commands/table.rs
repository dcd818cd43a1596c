//! Tables of keys and values, for people and for programs.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// A titled table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    title: String,
    rows: Vec<(String, Value, String)>,
}

impl Table {
    pub(super) fn new(title: &str) -> Self {
        Table { title: title.to_owned(), rows: Vec::new() }
    }

    /// Adds a row; in text a unit or remark follows the value.
    pub(super) fn row(&mut self, key: &str, value: impl Into<Value>, unit: impl Into<String>) -> &mut Self {
        self.rows.push((key.to_owned(), value.into(), unit.into()));
        self
    }

    /// Whether there are no rows.
    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The rows as an object with the title as key. Values of one key are a list.
    pub(super) fn json(&self) -> (String, Value) {
        let mut rows: BTreeMap<&String, Vec<&Value>> = BTreeMap::new();
        self.rows.iter().for_each(|(key, value, _)| rows.entry(key).or_default().push(value));
        let one_or_all = |values: Vec<&Value>| if let [value] = values[..] { value.clone() } else { json!(values) };
        let rows: Map<String, Value> =
            rows.into_iter().map(|(key, values)| (key.clone(), one_or_all(values))).collect();
        (self.title.clone(), Value::Object(rows))
    }

    /// The title, then the rows, keys and values aligned.
    pub(super) fn text(&self) -> String {
        let width = self.rows.iter().map(|(key, ..)| key.chars().count()).max().unwrap_or(0);
        let line = |(key, value, unit): &(String, Value, String)| {
            let padding = " ".repeat(width - key.chars().count());
            format!("  {key}{padding}  {} {unit}", plain(value)).trim_end().to_owned()
        };
        std::iter::once(self.title.clone()).chain(self.rows.iter().map(line)).collect::<Vec<_>>().join("\n")
    }
}

/// Short numbers, texts without quotes, arrays as lists.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => short(number.as_f64().unwrap_or(f64::NAN)),
        Value::Array(entries) => entries.iter().map(plain).collect::<Vec<_>>().join(", "),
        Value::Null => "-".to_owned(),
        other => other.to_string(),
    }
}

/// Six digits, with an exponent if that is shorter.
fn short(value: f64) -> String {
    with_digits(value, 6)
}

/// Two numbers with six digits, or with as many as tell them apart.
pub(super) fn apart([a, b]: [f64; 2]) -> [String; 2] {
    let both = |digits| [a, b].map(|value| with_digits(value, digits));
    (6..17).map(both).find(|[a, b]| a != b).unwrap_or_else(|| both(17))
}

/// So many digits, with an exponent if that is shorter.
fn with_digits(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "-".to_owned();
    }
    let decimals = digits - 1;
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.decimals$e}");
    }
    // The logarithm of a number just below 1e6 is 6.
    let digits = decimals.saturating_sub(value.abs().max(1.0).log10().floor() as usize);
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of several warnings about one thing the last one was left.
    #[test]
    fn rows_with_one_key_are_a_list() {
        let mut table = Table::new("warnings");
        table.row("opening", "a", "").row("mesh", "b", "").row("opening", "c", "");
        assert_eq!(table.json(), ("warnings".to_owned(), json!({ "mesh": "b", "opening": ["a", "c"] })));
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.5, "0.5"),
            (1.0 / 3.0, "0.33333"),
            (123456.7, "123457"),
            // It ended `check` in a panic.
            (999999.9999999999, "1000000"),
            (1e-5, "1.00000e-5"),
            (-2.5e7, "-2.50000e7"),
            (100.0, "100"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    /// `compare` printed figures that differ with the same digits.
    #[test]
    fn numbers_that_differ_are_told_apart() {
        assert_eq!(apart([1.0, 2.5]), ["1", "2.5"]);
        assert_eq!(apart([-30.769_312, -30.769_298]), ["-30.76931", "-30.7693"]);
        assert_eq!(apart([1e-7, 1.000_000_1e-7]), ["1.0000000e-7", "1.0000001e-7"]);
        assert_eq!(apart([0.1, 0.1 + 1e-15]), ["0.1", "0.100000000000001"]);
        assert_eq!(apart([0.5, 0.5]), ["0.5", "0.5"]);
    }

    #[test]
    fn a_table_aligns_its_values() {
        let mut table = Table::new("mesh");
        table.row("cells", 100, "").row("smallest cell", 0.25, "m");
        assert_eq!(table.text(), "mesh\n  cells          100\n  smallest cell  0.25 m");
    }
}
