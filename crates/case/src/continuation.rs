//! Conditions for continuing the run of another case.

use super::checked::length_of_slabs;
use super::continued_tables::{self, LongerTable};
use super::names_in_use::retain_used_constants;
use super::raw::{Adaptive, Case, Output, Solver, Steady, Time, from_toml, to_table, to_toml};
use std::collections::BTreeMap;
use std::fmt;

/// The part of a case that a run must share with the run that it continues, because the states depend on it. Tolerances and limits
/// of the solver, the end of the run and the intervals of output are left out, and constants that serve for nothing else.
pub(super) fn lasting(case: &Case) -> Case {
    let Time { start, end, .. } = case.time;
    let step = case.time.step.or(case.time.slabs.map(|slabs| length_of_slabs(end - start, slabs)));
    let adaptive = case.time.adaptive.as_ref().map(|_| Adaptive { tolerance: 0.0, smallest: None, largest: None });
    let mut lasting = Case {
        title: String::new(),
        time: Time { end: 0.0, slabs: None, step, adaptive, ..case.time },
        // The existence of a steady start is kept, and what is in equilibrium there.
        solver: Solver {
            steady: case.solver.steady.map(|Steady { bodies, .. }| Steady { bodies, ..Steady::default() }),
            ..Solver::default()
        },
        // They are the columns of history.csv and the fields of the result.
        output: Output {
            fields: case.output.fields.clone(),
            probes: case.output.probes.clone(),
            formulas: case.output.formulas.clone(),
            integrals: case.output.integrals.clone(),
            averages: case.output.averages.clone(),
            // The former default, which is in the fingerprints of runs of earlier versions.
            checkpoint_every: Some(10),
            ..Output::default()
        },
        ..case.clone()
    };
    retain_used_constants(&mut lasting);
    lasting
}

/// The characters of a text that is shown as a whole.
const LONGEST: usize = 60;

/// A key with different values in two cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The key.
    pub key: String,
    /// Its value in the first case; None if it is missing.
    pub before: Option<String>,
    /// Its value in the second.
    pub now: Option<String>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, now] = self.shortened();
        write!(f, "`{}` was {before} and is {now}", self.key)
    }
}

impl Difference {
    /// Both values, long ones cut so that they show where they begin to differ.
    pub fn shortened(&self) -> [String; 2] {
        let values = [&self.before, &self.now].map(|value| value.as_deref().unwrap_or("not there"));
        let same = values[0].chars().zip(values[1].chars()).take_while(|(a, b)| a == b).count();
        let from = if same > LONGEST / 2 { same - LONGEST / 4 } else { 0 };
        values.map(|value| {
            let rest: String = value.chars().skip(from).collect();
            if from > 0 { format!("... {}", cut(&rest)) } else { cut(&rest) }
        })
    }
}

/// All differences of two cases, and those of the lasting part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    /// In any key.
    pub all: Vec<Difference>,
    /// In the part that the states depend on.
    pub lasting: Vec<Difference>,
    /// Longer tables among those of `lasting`.
    pub longer_tables: Vec<LongerTable>,
}

impl Differences {
    /// The longer table that has caused `difference`.
    pub fn longer_table(&self, difference: &Difference) -> Option<&LongerTable> {
        self.longer_tables.iter().find(|table| difference.key.starts_with(&format!("tables.{}.", table.name)))
    }
}

/// The differences between the resolved cases `before` and `now`, as text.
///
/// # Errors
/// The error of a text, which another version of the program may have written.
pub fn differences(before: &str, now: &str) -> Result<Differences, String> {
    differences_after(before, now, f64::INFINITY)
}

/// The differences for a run of `before` that has reached a time. In the lasting part, tables that agree up to that time do not differ.
///
/// # Errors
/// As [`differences`].
pub fn differences_after(before: &str, now: &str, reached: f64) -> Result<Differences, String> {
    let (before, now) = (from_toml(before)?, from_toml(now)?);
    let mut lasting_now = lasting(&now);
    continued_tables::take_back(&mut lasting_now, &before, reached);
    // A constant that the formulas of one case alone contain is told by these formulas.
    let is_of_one =
        |found: &Difference| found.key.starts_with("constants.") && (found.before.is_none() || found.now.is_none());
    let mut lasting = compared(&lasting(&before), &lasting_now);
    lasting.retain(|found| !is_of_one(found));
    Ok(Differences {
        all: compared(&before, &now),
        lasting,
        longer_tables: continued_tables::longer(&lasting_now, &before, reached),
    })
}

/// The values of a resolved case by their keys, as text.
///
/// # Errors
/// As [`differences`].
pub fn values(resolved: &str) -> Result<BTreeMap<String, String>, String> {
    let mut values = BTreeMap::new();
    put_values("", &to_table(&from_toml(resolved)?), &mut values);
    Ok(values)
}

/// The key `name` of the table at `path`.
fn key_at(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

fn put_values(path: &str, table: &toml::Table, values: &mut BTreeMap<String, String>) {
    for (name, value) in table {
        let key = key_at(path, name);
        match value {
            toml::Value::Table(table) => put_values(&key, table, values),
            value => _ = values.insert(key, whole_text(value)),
        }
    }
}

/// The part of a resolved case that a run must share with the run that it continues, as text.
///
/// # Errors
/// As [`differences`].
pub fn lasting_of(resolved: &str) -> Result<String, String> {
    from_toml(resolved).map(|case| to_toml(&lasting(&case)))
}

fn compared(before: &Case, now: &Case) -> Vec<Difference> {
    let mut differences = Vec::new();
    collect("", &to_table(before), &to_table(now), &mut differences);
    differences
}

/// The differences of two tables at `path`, in the order of their keys.
fn collect(path: &str, before: &toml::Table, now: &toml::Table, differences: &mut Vec<Difference>) {
    let added = now.keys().filter(|key| !before.contains_key(*key));
    for name in before.keys().chain(added) {
        let key = key_at(path, name);
        match (before.get(name), now.get(name)) {
            (Some(toml::Value::Table(before)), Some(toml::Value::Table(now))) => {
                collect(&key, before, now, differences)
            }
            (before, now) if before != now => {
                differences.push(Difference { key, before: before.map(whole_text), now: now.map(whole_text) });
            }
            _ => {}
        }
    }
}

/// A value on a line. Rust writes small numbers shorter than TOML does.
fn whole_text(value: &toml::Value) -> String {
    value.as_float().map_or_else(|| value.to_string(), |number| format!("{number:?}"))
}

/// The beginning of a long text.
pub fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text.to_owned(),
    }
}
