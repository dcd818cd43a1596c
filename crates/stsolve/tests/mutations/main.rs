//! 1,000 random edits of the shipped case files: each is refused with its line and key, or is provably no error.
//!
//! The effect of an edit is found by comparing the TOML of both texts, without any knowledge of cases (`leaves`). A damaged
//! case may be accepted in three ways only. Its values equal those of the original. Or a changed value is legal by its meaning
//! (`legal`) and the checked case holds just this value. Or a missing key has a default, which the checked case lists as
//! taken.

#![allow(clippy::unwrap_used)]

#[path = "../common/random.rs"]
mod random;

mod damage;
mod leaves;
mod legal;

use case::{AnyCase, CaseError, Document, Place};
use damage::{Damaged, damage};
use leaves::{Leaves, differing, first_name, last_name, leaves, same_in_quotes};
use legal::is_legal_number;
use random::Random;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The number of damaged files.
const FILES: usize = 1000;

/// Cases whose mesh takes long to build, and a replacement that makes it coarser without moving any line.
const COARSER: [(&str, &str, &str); 2] =
    [("turbine_blade_roughness", "order = 8", "order = 3"), ("turbine_blade_roughness_3d", "order = 4", "order = 3")];

/// The treatment of a damaged file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Treatment {
    /// Refused at the damaged line, with the damaged key if the file is still TOML.
    RefusedThere,
    /// Refused where the damage has its effect, with its name.
    RefusedByName,
    /// Accepted: the values equal those of the original.
    Equal,
    /// Accepted: another legal value, which the checked case holds.
    OtherValue,
    /// Accepted: a key with a default is missing.
    Default,
}

#[test]
fn every_slip_is_refused_at_its_place_or_is_none() {
    let mut random = Random(4);
    let mut counts = BTreeMap::<_, usize>::new();
    let mut problems = Vec::new();
    let cases: Vec<_> = case_files().into_iter().map(|path| (path.clone(), original(&path))).collect();
    for number in 0..FILES {
        let (path, original) = &cases[number % cases.len()];
        let damaged = damage(original, &mut random);
        match judge(path, original, &damaged) {
            Ok(treatment) => *counts.entry((damaged.kind, treatment)).or_default() += 1,
            Err(problem) => {
                let line = damaged.text.lines().nth(damaged.line - 1).unwrap_or_default();
                let (file, number) = (path.file_name().unwrap().display(), damaged.line);
                problems.push(format!("{file}, {:?} in line {number}, `{line}`:\n{problem}", damaged.kind));
            }
        }
    }
    print_counts(&counts);
    assert!(problems.is_empty(), "{} of {FILES}:\n{}", problems.len(), problems.join("\n\n"));
    let refused = |treatment: &Treatment| matches!(treatment, Treatment::RefusedThere | Treatment::RefusedByName);
    let refusals: usize = counts.iter().filter(|((_, treatment), _)| refused(treatment)).map(|(_, n)| n).sum();
    assert!(refusals > 3 * FILES / 4, "{refusals} of {FILES} refused: the damage is too mild to show anything");
}

fn case_files() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|file| file.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

/// The text of a shipped case.
fn original(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let name = path.file_stem().unwrap().to_str().unwrap();
    let Some((_, from, to)) = COARSER.iter().find(|(case, ..)| *case == name) else { return text };
    assert!(text.contains(from), "{name}: no `{from}`");
    text.replacen(from, to, 1)
}

#[allow(clippy::print_stdout)]
fn print_counts(counts: &BTreeMap<(damage::Kind, Treatment), usize>) {
    for ((kind, treatment), count) in counts {
        println!("{:10} {:14} {count:4}", format!("{kind:?}"), format!("{treatment:?}"));
    }
}

fn check(path: &Path, text: &str) -> Result<AnyCase, Box<CaseError>> {
    AnyCase::check(&Document::parse(path, text.to_owned(), &[])?)
}

/// The treatment of a damaged file, or the error in its treatment.
fn judge(path: &Path, original: &str, damaged: &Damaged) -> Result<Treatment, String> {
    let before = leaves(original).ok_or("the original is no TOML")?;
    match (check(path, &damaged.text), leaves(&damaged.text)) {
        (Ok(_), None) => Err("accepted, and no TOML".to_owned()),
        (Ok(case), Some(after)) => accepted(&case, &before, &after),
        (Err(error), None) => refused_as_text(&error, damaged),
        (Err(error), Some(after)) => refused(&error, damaged, &differing(&before, &after)),
    }
}

/// The place of an error in the file: its line and the text of that line.
fn place(error: &CaseError) -> Result<(usize, &str), String> {
    match &error.place {
        Place::File { line, text, .. } => Ok((*line, text)),
        other => Err(format!("refused at {other:?}: {error}")),
    }
}

/// If a text is not TOML, the error must show where it stops being TOML: in the damaged line, or in the next non-empty one. Or it
/// shows the unclosed bracket before the damaged line.
fn refused_as_text(error: &CaseError, damaged: &Damaged) -> Result<Treatment, String> {
    let (line, _) = place(error)?;
    let filled = |text: &&str| !text.trim().is_empty() && !text.trim_start().starts_with('#');
    let between = damaged.text.lines().take(line.saturating_sub(1)).skip(damaged.line).filter(filled).count();
    let message = error.to_string();
    let bracket = message.split("the bracket of line ").nth(1).and_then(|rest| rest.split(' ').next()?.parse().ok());
    let unclosed = bracket.is_some_and(|bracket: usize| bracket <= damaged.line);
    if line == damaged.line {
        Ok(Treatment::RefusedThere)
    } else if line > damaged.line && (between == 0 || unclosed) {
        Ok(Treatment::RefusedByName)
    } else {
        Err(format!("refused at line {line}: {error}"))
    }
}

/// A refusal must concern one of the `differing` paths, and show it.
fn refused(error: &CaseError, damaged: &Damaged, differing: &[String]) -> Result<Treatment, String> {
    let (line, _) = place(error)?;
    let concerns = |path: &String| within(path, &error.key) || within(&error.key, path);
    let message = error.to_string();
    // If a table is missing, its own name is reported, not the names of its keys.
    let missing = |path: &str| path.strip_prefix(&error.key).is_some_and(|rest| is_named(&message, first_name(rest)));
    // If a table that the user has named has another name, that name is reported in quotes.
    let renamed = |path: &str| {
        path.rsplit_once('.').is_some_and(|(table, _)| message.contains(&format!("\"{}\"", last_name(table))))
    };
    let named = |path: &String| is_named(&message, last_name(path)) || missing(path) || renamed(path);
    if line == damaged.line && differing.iter().any(concerns) {
        Ok(Treatment::RefusedThere)
    } else if differing.iter().any(named) {
        Ok(Treatment::RefusedByName)
    } else {
        Err(format!("refused, but not by what differs, {differing:?}: {error}"))
    }
}

/// Whether `inner` is `outer` or lies in it. Everything lies in the whole document, which does not count.
fn within(inner: &str, outer: &str) -> bool {
    let rest = inner.strip_prefix(outer).filter(|_| !outer.is_empty());
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// Whether `name` occurs in `text` as a word.
fn is_named(text: &str, name: &str) -> bool {
    let of_a_word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(name).any(|(at, _)| {
        !name.is_empty() && !text[..at].ends_with(of_a_word) && !text[at + name.len()..].starts_with(of_a_word)
    })
}

/// An accepted case must hold the written values, and these must be legal.
fn accepted(case: &AnyCase, before: &Leaves, after: &Leaves) -> Result<Treatment, String> {
    let resolved = leaves(&case.about().resolved).ok_or("the resolved case is no TOML")?;
    let lost = |(path, value): &(&String, &toml::Value)| !is_empty(value) && !holds(&resolved, path, value);
    if let Some((path, value)) = after.iter().find(lost) {
        return Err(format!("accepted, but the checked case does not hold {path} = {value}"));
    }
    let mut differing = differing(before, after);
    differing.retain(|path| !matches!((before.get(path), after.get(path)), (Some(a), Some(b)) if same_in_quotes(a, b)));
    if differing.is_empty() {
        return Ok(Treatment::Equal);
    }
    if let Some(path) = differing.iter().find(|path| after.get(*path).is_some_and(|v| !is_legal_number(path, v))) {
        return Err(format!("accepted, but {path} = {} makes no sense", after[path]));
    }
    let (written, missing): (Vec<_>, Vec<_>) = differing.into_iter().partition(|path| after.contains_key(path));
    let defaults = &case.about().defaults;
    let has_default = |path: &String| {
        resolved.get(path).is_none_or(|value| value.as_str() == Some(""))
            || defaults.iter().any(|(key, _)| within(path, key) || within(key, path))
    };
    match (written.is_empty(), missing.iter().all(has_default)) {
        (_, false) => Err(format!("accepted without {missing:?}, which have no default")),
        (true, true) => Ok(Treatment::Default),
        (false, true) => Ok(Treatment::OtherValue),
    }
}

/// An empty table or list may stand for all of its defaults.
fn is_empty(value: &toml::Value) -> bool {
    value.as_table().is_some_and(toml::Table::is_empty) || value.as_array().is_some_and(Vec::is_empty)
}

fn holds(resolved: &Leaves, path: &str, value: &toml::Value) -> bool {
    resolved.get(path).is_some_and(|found| same_in_quotes(found, value))
}
