//! `[tables]`

use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::expression::{Ends, Table, TableError};
use crate::input_file::{self, LARGEST_TABLE};
use crate::key::Key;
use crate::raw::{self, Column};
use std::collections::BTreeMap;
use std::path::Path;

const ONE_OF_TWO: &str = "`t` and `values`, or `file`";

/// The table at `key`.
pub(crate) fn check(checker: &Checker<'_>, key: &Key, raw: &raw::Table) -> Checked<Table> {
    let (t, values, values_key) = match (&raw.t, &raw.values, &raw.file) {
        (Some(_), Some(_), None) if raw.column.is_some() => {
            let problem = "`column` is that of a file, and there is none";
            return Err(checker.combination(&key.child("column"), problem, "`file` instead of `t` and `values`"));
        }
        (Some(t), Some(values), None) => (t.clone(), values.clone(), key.child("values")),
        (None, None, Some(file)) => {
            let (t, values) = read(checker, key, file, raw.column.as_ref())?;
            (t, values, key.child("file"))
        }
        (None, None, None) => return Err(checker.combination(key, "the table is empty", ONE_OF_TWO)),
        (_, _, Some(_)) => return Err(checker.combination(key, "the table is given twice", ONE_OF_TWO)),
        _ => return Err(checker.combination(key, "half of the table is missing", ONE_OF_TWO)),
    };
    let ends = match raw.ends {
        raw::Ends::Free => Ends::Free,
        raw::Ends::AtRest => Ends::AtRest,
        raw::Ends::Periodic => Ends::Periodic,
    };
    let of_file = raw.file.is_some();
    let times_are_finite = t.iter().all(|t| t.is_finite());
    Table::new(t, values, ends).map_err(|error| {
        let of_times = match error {
            TableError::NotIncreasing { .. } => true,
            TableError::NotFinite(_) => !times_are_finite,
            _ => false,
        };
        let key = if of_times && !of_file { key.child("t") } else { values_key };
        checker.error(&key, Cause::Table(error))
    })
}

/// The tables, with the data of their files in place of the files.
pub(crate) fn written_out(checker: &Checker<'_>, raw: &BTreeMap<String, raw::Table>) -> BTreeMap<String, raw::Table> {
    let written = |(name, table): (&str, &Table)| {
        let (t, values) = table.points();
        let ends = raw.get(name)?.ends;
        let table = raw::Table { t: Some(t.to_vec()), values: Some(values.to_vec()), file: None, column: None, ends };
        Some((name.to_owned(), table))
    };
    checker.tables().filter_map(written).collect()
}

/// The first column of `file` and another one.
fn read(checker: &Checker<'_>, key: &Key, file: &Path, column: Option<&Column>) -> Checked<(Vec<f64>, Vec<f64>)> {
    let (file_key, path) = (key.child("file"), checker.beside_case(file));
    let refused = |cause| checker.error(&file_key, cause);
    let text = input_file::read_text(&path, LARGEST_TABLE)
        .map_err(|error| refused(Cause::File { path: path.clone(), error }))?;
    let (names_line, names) = heading(&text);
    let lines = text.lines().enumerate().map(|(index, line)| ((index + 1, line.trim()), entries(line)));
    let lines = lines.filter(|(_, entries)| !entries.is_empty()).skip_while(|(_, entries)| has_no_number(entries));
    let by_name = matches!(column, Some(Column::Name(_)));
    let column = column.map_or(Ok(1), |column| place(checker, &key.child("column"), column, &names))?;
    let (mut t, mut values) = (Vec::new(), Vec::new());
    // Names that are more or fewer than the numbers below are not those of their columns. A separator may end their line.
    let named = names.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1)..=names.len();
    let fits = |count: usize| !by_name || named.contains(&count);
    let mut first = None;
    for ((line, found), entries) in lines {
        let of_first = if fits(entries.len()) { [line, entries.len()] } else { [names_line, names.len()] };
        let [first_line, expected] = *first.get_or_insert(of_first);
        if entries.len() != expected {
            let (found, entries) = (found.to_owned(), entries.len());
            return Err(refused(Cause::Ragged { path, line, found, entries, expected, first_line }));
        }
        let number = |index: usize| entries.get(index).and_then(|entry| number(entry));
        let (Some(time), Some(value)) = (number(0), number(column)) else {
            let found = found.to_owned();
            return Err(refused(Cause::Row { path, line, found, column: column + 1 }));
        };
        t.push(time);
        values.push(value);
    }
    Ok((t, values))
}

/// The line and the names of the columns: the first line above the numbers, which a line of units may follow. If all lines there are comments,
/// the last of them.
fn heading(text: &str) -> (usize, Vec<String>) {
    let lines = text.lines().enumerate().take_while(|(_, line)| has_no_number(&entries(line)));
    let named = |(index, line): (usize, &str)| {
        let names: Vec<String> = entries(line).into_iter().map(str::to_owned).collect();
        (!names.is_empty()).then_some((index + 1, names))
    };
    let uncommented = |(index, line)| (index, str::trim_start(line).trim_start_matches('#'));
    lines.clone().find_map(named).or_else(|| lines.map(uncommented).filter_map(named).last()).unwrap_or_default()
}

fn has_no_number(entries: &[&str]) -> bool {
    entries.iter().all(|entry| number(entry).is_none())
}

/// The index of a column, by its number from 1 or by its name, with or without the unit behind it.
fn place(checker: &Checker<'_>, key: &Key, column: &Column, names: &[String]) -> Checked<usize> {
    match column {
        Column::Number(number) => {
            checker.require(
                key,
                "the number of the column",
                *number >= 1,
                "1 or more; the first column is the time",
            )?;
            Ok(number - 1)
        }
        Column::Name(name) => {
            let all = |is: &dyn Fn(&str) -> bool| (0..names.len()).filter(|&i| is(&names[i])).collect::<Vec<usize>>();
            let exact = all(&|known| known == name);
            let found = if exact.is_empty() { all(&|known| without_unit(known) == name) } else { exact };
            match found[..] {
                [] => {
                    let cause =
                        Cause::Unknown { kind: "column", name: name.clone(), accepted: names.to_vec(), belongs: None };
                    Err(checker.error(key, cause))
                }
                [column] => Ok(column),
                [first, second, ..] => {
                    let problem = format!("columns {} and {} are called \"{name}\"", first + 1, second + 1);
                    Err(checker.combination(key, &problem, "the number of the column"))
                }
            }
        }
    }
}

/// `heave` of `heave [m]`, `heave (m)` and `heave/m`.
fn without_unit(name: &str) -> &str {
    name.split(['[', '(', '/']).next().unwrap_or(name).trim()
}

/// The entries of a line without its comment. They are separated by semicolons if there are any, otherwise by tabs, commas or blanks. Commas within
/// numbers that blanks separate are decimal points.
fn entries(line: &str) -> Vec<&str> {
    let quoted = quoted(line);
    let comment = line.bytes().zip(&quoted).position(|(c, quoted)| c == b'#' && !quoted).unwrap_or(line.len());
    let line = &line[..comment];
    let separates = |c: char| line.bytes().zip(&quoted).any(|(byte, quoted)| byte == c as u8 && !quoted);
    let has_decimal_commas = line.split(',').any(|part| part.trim().contains(char::is_whitespace))
        && line.split_whitespace().all(|word| !word.ends_with(',') && number(word).is_some());
    let separators = if has_decimal_commas { &[';', '\t'][..] } else { &[';', '\t', ','] };
    let (separator, parts) = match separators.iter().copied().find(|c| separates(*c)) {
        Some(separator) => (Some(separator), split(line, &quoted, |c| c == separator)),
        None => (None, split(line, &quoted, char::is_whitespace)),
    };
    let mut parts: Vec<&str> = parts.into_iter().map(|entry| entry.trim().trim_matches('"')).collect();
    parts.retain(|entry| separator.is_some() || !entry.is_empty());
    parts
}

/// Whether each byte of a line stands in quotation marks, which enclose an entry: they separate nothing. A mark inside of an entry, as of
/// inches, is a character like others.
fn quoted(line: &str) -> Vec<bool> {
    let bytes = line.as_bytes();
    let is_end = |i: usize| bytes.get(i).is_none_or(|c| b" \t,;#\r".contains(c));
    let mut inside = false;
    let mark = |i: usize| {
        match (bytes[i], inside) {
            (b'"', false) if i == 0 || is_end(i - 1) => inside = bytes[i + 1..].contains(&b'"'),
            (b'"', true) if is_end(i + 1) => inside = false,
            _ => {}
        }
        inside
    };
    (0..bytes.len()).map(mark).collect()
}

/// The parts of a line between separators outside of quotation marks.
fn split<'a>(line: &'a str, quoted: &[bool], is_separator: impl Fn(char) -> bool) -> Vec<&'a str> {
    let mut start = 0;
    let mut parts = Vec::new();
    for (i, c) in line.char_indices().filter(|(i, c)| is_separator(*c) && !quoted[*i]) {
        parts.push(&line[start..i]);
        start = i + c.len_utf8();
    }
    parts.push(&line[start..]);
    parts
}

/// The number of an entry. Where commas do not separate entries, one may stand for the decimal point.
fn number(entry: &str) -> Option<f64> {
    entry.parse().or_else(|_| entry.trim_end_matches(',').replacen(',', ".", 1).parse()).ok()
}
