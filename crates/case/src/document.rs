//! The TOML document of a case, with the place of every key and value.

use super::brackets;
use super::cause::{Cause, LONGEST_VALUE, ONE_OF_SEVERAL};
use super::choices::{choice_of_number, choices, example};
use super::error::{CaseError, Place};
use super::key::{Key, Step};
use crate::excerpt::shortened;
use crate::input_file;
use crate::tree::{contains, take_out};
use serde::Deserialize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The largest size of a case file in bytes: longer tables have files of their own.
const LARGEST: u64 = 16_000_000;

/// A case file with `--set` options written over it.
///
/// An option is parsed as a line of its own after the file, padded with as many spaces as there is text before it. So every
/// value has a place, and a place beyond the end of the file belongs to an option.
#[derive(Clone, Debug)]
pub struct Document {
    path: PathBuf,
    /// The file, then the padded options.
    texts: Vec<String>,
}

/// Keys that stand for each other: an option with one of them takes the place of the other one in the file.
const EITHER: [[&str; 2]; 1] = [["time.step", "time.slabs"]];

type Table<'a> = DeTable<'a>;
type Value<'a> = Spanned<DeValue<'a>>;

/// The contents of the document at a key.
struct Found {
    /// The place of the key, or of the innermost table around it.
    key: Range<usize>,
    /// The place of its value; None for a table, which may be scattered, and for a key that does not exist.
    value: Option<Range<usize>>,
    /// Whether the key exists.
    exists: bool,
    /// The keys in it, if it is a table.
    names: Vec<String>,
}

impl Found {
    /// The key is missing in the table at `place`.
    fn nothing_in(place: Range<usize>) -> Self {
        Found { key: place, value: None, exists: false, names: Vec::new() }
    }
}

impl Document {
    /// Reads the file at `path` and writes `options`, each `key.path=value`, over it.
    ///
    /// # Errors
    /// A file that cannot be read, is not a regular file, is too large or is not TOML; an option that is not KEY=VALUE.
    pub fn read(path: &Path, options: &[String]) -> Result<Self, Box<CaseError>> {
        let text = input_file::read_text(path, LARGEST).map_err(|error| {
            let place = Place::Nowhere { path: path.to_owned() };
            CaseError::without_key(place, Cause::Read(error))
        })?;
        Self::parse(path, text, options)
    }

    /// As [`Document::read`], from the `text` of the file.
    ///
    /// # Errors
    /// As [`Document::read`], except for errors of reading.
    pub fn parse(path: &Path, text: String, options: &[String]) -> Result<Self, Box<CaseError>> {
        let mut document = Document { path: path.to_owned(), texts: vec![text] };
        document.tree()?;
        for option in options {
            let end = document.texts.last().map_or(0, String::len) + 1;
            document.texts.push(" ".repeat(end) + &understood(option));
            document.tree()?;
        }
        Ok(document)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Checks that integers are not too long.
    pub(super) fn check_integers(&self) -> Result<(), Box<CaseError>> {
        let table = toml::Table::deserialize(toml::de::Deserializer::from(self.tree()?));
        table.map(drop).map_err(|error| self.toml_error(&error))
    }

    /// An error at `key`, or at the innermost existing table around it.
    pub(super) fn error(&self, key: &Key, cause: Cause) -> Box<CaseError> {
        let found = self.find(key);
        let value = found.value.as_ref().map(|span| self.excerpt(span));
        // An unknown name concerns the key, any other error the value.
        let at = found.value.filter(|_| !matches!(cause, Cause::Unknown { .. })).unwrap_or(found.key);
        Box::new(CaseError { place: self.place(&at), key: key.to_string(), value, cause, also: Vec::new() })
    }

    /// The position of the key, which increases along the text; None if it is missing.
    pub(super) fn position(&self, key: &Key) -> Option<usize> {
        let found = self.find(key);
        found.exists.then_some(found.key.start)
    }

    /// Whether an option, and not the file, has the key.
    pub(super) fn is_only_an_option(&self, key: &Key) -> bool {
        self.without_options().position(key).is_none() && self.position(key).is_some()
    }

    /// The names in the table `section` of the file.
    pub(super) fn names_in_file(&self, section: &str) -> Vec<String> {
        self.without_options().find(&Key::new(section)).names
    }

    fn without_options(&self) -> Document {
        Document { path: self.path.clone(), texts: self.texts[..1].to_vec() }
    }

    /// The file with the options written over it. It is parsed anew for each use, because it borrows from the text.
    pub(super) fn tree(&self) -> Result<Spanned<Table<'_>>, Box<CaseError>> {
        let mut root = self.parse_text(&self.texts[0])?;
        for text in &self.texts[1..] {
            let option = self.parse_text(text)?.into_inner();
            take_out_others(root.get_mut(), &option);
            overwrite(root.get_mut(), option, depth(text)).map_err(|problem| {
                CaseError::without_key(Place::Option(text.trim().to_owned()), Cause::Toml(problem))
            })?;
        }
        Ok(root)
    }

    fn parse_text<'a>(&self, text: &'a str) -> Result<Spanned<Table<'a>>, Box<CaseError>> {
        Table::parse(text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            let (at, line_of) = (span.start, |at: usize| text[..at].matches('\n').count() + 1);
            let open = brackets::open_at(text, at).map(line_of).filter(|line| *line < line_of(at));
            let hint = open.map_or(String::new(), |line| format!("; the bracket of line {line} is not closed"));
            CaseError::without_key(self.place(&span), Cause::Toml(error.message().to_owned() + &hint))
        })
    }

    fn find(&self, key: &Key) -> Found {
        let Ok(root) = self.tree() else { return Found::nothing_in(0..0) };
        let (mut place, mut table) = (0..0, Some(root.get_ref()));
        let mut value: Option<&Value<'_>> = None;
        for step in &key.0 {
            let next = match step {
                Step::Name(name) => table.and_then(|t| t.get_key_value(name.as_str())).map(|(k, v)| (k.span(), v)),
                Step::Entry(index) => value.and_then(|v| v.get_ref().get(*index)).map(|v| (v.span(), v)),
            };
            let Some((span, next)) = next else { return Found::nothing_in(place) };
            (place, value, table) = (span, Some(next), next.get_ref().as_table());
        }
        let names = table.into_iter().flat_map(|table| table.keys()).map(|name| name.get_ref().to_string()).collect();
        let value = value.filter(|v| !v.get_ref().is_table()).map(Spanned::span);
        Found { key: place, value, exists: true, names }
    }

    fn toml_error(&self, error: &toml::de::Error) -> Box<CaseError> {
        self.located(error).1
    }

    /// An error of deserialisation, with its key.
    pub(super) fn located(&self, error: &toml::de::Error) -> (Key, Box<CaseError>) {
        let span = error.span().unwrap_or(0..0);
        let mut key = Key::default();
        if let Ok(root) = self.tree() {
            descend(root.get_ref(), span.start, &mut key);
        }
        if error.message().starts_with(ONE_OF_SEVERAL) {
            key = self.outermost(key, span.start);
        }
        let Found { value, names, .. } = self.find(&key);
        let value = value.map(|span| self.excerpt(&span));
        let (message, settings) = (error.message(), |choice: &str| example(&key.child(choice)));
        let cause =
            Cause::from_serde(message, value.as_deref(), &names, || choices(&key), || choice_of_number(&key), settings);
        let place = self.place(&span);
        let error = CaseError { place, key: key.to_string(), value, cause, also: Vec::new() };
        (key, Box::new(error))
    }

    /// The first part of `key` that was written at `offset`, since the header of a table may name several.
    fn outermost(&self, key: Key, offset: usize) -> Key {
        let mut parts = (1..=key.0.len()).map(|steps| Key(key.0[..steps].to_vec()));
        parts.find(|part| self.find(part).key.start == offset).unwrap_or(key)
    }

    /// The text at `span`, on one line, cut if it is long.
    fn excerpt(&self, span: &Range<usize>) -> String {
        shortened(self.text_at(span.start).1.get(span.clone()).unwrap_or_default(), LONGEST_VALUE)
    }

    /// The text that contains `offset`, and its number.
    fn text_at(&self, offset: usize) -> (usize, &str) {
        let index = self.texts.iter().position(|text| offset <= text.len()).unwrap_or(self.texts.len() - 1);
        (index, &self.texts[index])
    }

    fn place(&self, span: &Range<usize>) -> Place {
        let (index, text) = self.text_at(span.start);
        if index > 0 {
            return Place::Option(text.trim().to_owned());
        }
        let before = text.get(..span.start).unwrap_or(text);
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = text[start..].lines().next().unwrap_or_default();
        let marked = text.get(span.clone()).unwrap_or_default().lines().next().unwrap_or_default();
        Place::File {
            path: self.path.clone(),
            line: before.matches('\n').count() + 1,
            column: before[start..].chars().count() + 1,
            text: line.to_owned(),
            length: marked.chars().count(),
        }
    }
}

/// An option as a line of TOML: `order=4` is one, `riemann=hllc` becomes `riemann = "hllc"`.
fn understood(option: &str) -> String {
    match key_and_value(option) {
        Some((key, value)) if Table::parse(option).is_err() => {
            let quoted = format!("{} = {}", key.trim(), toml::Value::String(value.trim().to_owned()));
            if Table::parse(&quoted).is_ok() { quoted } else { option.to_owned() }
        }
        _ => option.to_owned(),
    }
}

/// The parts of an option before and after its first `=` that does not lie in a quoted name.
fn key_and_value(option: &str) -> Option<(&str, &str)> {
    let parts = |(at, _)| (&option[..at], &option[at + 1..]);
    let is_key = |text: &str| Table::parse(&format!("{text}=0")).is_ok();
    option.match_indices('=').map(parts).find(|(key, _)| is_key(key))
}

/// The number of names in the key of an option: 2 in `a.b={c=1}`.
fn depth(option: &str) -> usize {
    let Some((key, _)) = key_and_value(option) else { return 0 };
    let probe = format!("{key}=0");
    let Ok(parsed) = Table::parse(&probe) else { return 0 };
    let mut table = Some(parsed.get_ref());
    let mut depth = 0;
    while let Some(inner) = table {
        depth += 1;
        table = inner.values().next().and_then(|value| value.get_ref().as_table());
    }
    depth
}

/// Writes the one value of `option`, below a key of `depth` names, into `table`.
fn overwrite<'a>(table: &mut Table<'a>, option: Table<'a>, depth: usize) -> Result<(), String> {
    let mut entries = option.into_iter();
    let (Some((key, value)), None) = (entries.next(), entries.next()) else {
        return Err("an option sets one key: `--set key=value`".to_owned());
    };
    let span = value.span();
    match (table.get_mut(key.get_ref().as_ref()), value.into_inner()) {
        (Some(old), DeValue::Table(inner)) if depth > 1 => match old.get_mut() {
            DeValue::Table(old) => overwrite(old, inner, depth - 1),
            _ => Err(format!("`{}` is not a table: it has no keys", key.get_ref())),
        },
        (old, value) => {
            // The place of a table is the place of its key. Otherwise the key stays, because constants are defined in
            // its order.
            if value.is_table() || old.is_none() {
                table.remove(key.get_ref().as_ref());
            }
            table.insert(key, Spanned::new(span, value));
            Ok(())
        }
    }
}

/// Takes the keys out of `table` for which `option` stands.
fn take_out_others(table: &mut Table<'_>, option: &Table<'_>) {
    for [one, other] in EITHER.into_iter().flat_map(|[a, b]| [[a, b], [b, a]]) {
        if contains(option, &Key::new(one).0) {
            take_out(table, &Key::new(other).0);
        }
    }
}

/// Extends `key` to the innermost entry of `table` whose key or value was written at `offset`.
fn descend(table: &Table<'_>, offset: usize, key: &mut Key) -> bool {
    let at = |span: Range<usize>| span.contains(&offset) || span.start == offset;
    table.iter().any(|(name, value)| {
        let outer = key.clone();
        *key = key.child(name.get_ref());
        let found = descend_value(value, offset, key) || at(name.span()) || at(value.span());
        if !found {
            *key = outer;
        }
        found
    })
}

fn descend_value(value: &Value<'_>, offset: usize, key: &mut Key) -> bool {
    match value.get_ref() {
        DeValue::Table(table) => descend(table, offset, key),
        DeValue::Array(entries) => entries.iter().enumerate().any(|(index, entry)| {
            let inside = entry.span().contains(&offset);
            if inside {
                *key = key.entry(index);
                descend_value(entry, offset, key);
            }
            inside
        }),
        _ => false,
    }
}
