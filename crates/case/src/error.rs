//! Errors of a case, and their places.

use crate::cause::Cause;
use crate::consequences::Damage;
use crate::excerpt::{Excerpt, shortened};
use std::collections::BTreeSet;
use std::fmt;
use std::path::PathBuf;

/// The largest number of characters of an option in an error.
const LONGEST_OPTION: usize = 300;

/// An error of a case: the place, the key and its value, the cause, the accepted values.
#[derive(Debug)]
pub struct CaseError {
    /// The place of the key or value.
    pub place: Place,
    /// The key, for instance `flow.boundary.left`; empty if the text is not TOML.
    pub key: String,
    /// The value as written, if there is one.
    pub value: Option<String>,
    /// The cause.
    pub cause: Cause,
    /// Errors in other parts of the case.
    pub also: Vec<CaseError>,
}

/// The largest number of errors that are reported.
const MOST_ERRORS: usize = 20;

/// The errors of parts of a case that do not depend on each other.
#[derive(Default)]
pub(super) struct Errors(Vec<CaseError>);

impl Errors {
    /// Keeps an error, and those that came with it.
    pub(super) fn add(&mut self, mut error: Box<CaseError>) {
        let also = std::mem::take(&mut error.also);
        self.0.push(*error);
        also.into_iter().for_each(|error| self.add(Box::new(error)));
    }

    /// Keeps the errors of another part.
    pub(super) fn extend(&mut self, others: Errors) {
        self.0.extend(others.0);
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Drops the errors that `damage` explains.
    pub(super) fn without_consequences_of(mut self, damage: &Damage) -> Self {
        self.0.retain(|error| !damage.explains(error));
        self
    }

    /// Keeps the error of a part.
    pub(super) fn note<T>(&mut self, part: Result<T, Box<CaseError>>) -> Option<T> {
        part.map_err(|error| self.add(error)).ok()
    }

    /// Keeps the error of a list, which is then empty.
    pub(super) fn list<T>(&mut self, part: Result<Vec<T>, Box<CaseError>>) -> Vec<T> {
        self.note(part).unwrap_or_default()
    }

    /// All of them in one, each once and in the order of their lines, if there are any.
    pub(super) fn all(self) -> Result<(), Box<CaseError>> {
        let mut errors = self.0;
        // Another error has caused those that follow. It may be in another part.
        let follows = |error: &CaseError| matches!(error.cause, Cause::Follows);
        if !errors.iter().all(follows) {
            errors.retain(|error| !follows(error));
        }
        // A key that stands for many boundaries is checked for each of them.
        let mut told = BTreeSet::new();
        errors.retain(|error| told.insert(error.to_string()));
        // Those of options stay behind.
        errors.sort_by_key(|error| match error.place {
            Place::File { line, .. } => line,
            Place::Option(_) | Place::Nowhere { .. } => usize::MAX,
        });
        let mut errors = errors.into_iter();
        let Some(mut first) = errors.next() else { return Ok(()) };
        first.also.extend(errors);
        Err(Box::new(first))
    }
}

/// The values of two parts, or the errors of both.
pub(super) fn both<A, B>(
    first: Result<A, Box<CaseError>>,
    second: Result<B, Box<CaseError>>,
) -> Result<(A, B), Box<CaseError>> {
    match (first, second) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        (Err(error), Ok(_)) | (Ok(_), Err(error)) => Err(error),
        (Err(mut error), Err(other)) => {
            error.also.push(*other);
            Err(error)
        }
    }
}

/// The values of parts of a case, or all their errors.
pub(super) fn collected<T>(parts: impl Iterator<Item = Result<T, Box<CaseError>>>) -> Result<Vec<T>, Box<CaseError>> {
    let mut errors = Errors::default();
    let values: Vec<T> = parts.filter_map(|part| errors.note(part)).collect();
    errors.all().map(|()| values)
}

/// A place in the input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the case file.
    File {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The first character in the line, from 1.
        column: usize,
        /// The line itself.
        text: String,
        /// The number of marked characters.
        length: usize,
    },
    /// In a `--set` option, as it was interpreted.
    Option(String),
    /// In no line of the case file.
    Nowhere {
        /// The file.
        path: PathBuf,
    },
}

impl CaseError {
    /// An error without a key.
    pub(super) fn without_key(place: Place, cause: Cause) -> Box<Self> {
        Box::new(CaseError { place, key: String::new(), value: None, cause, also: Vec::new() })
    }
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::File { path, line, column, .. } => write!(f, "{}:{line}:{column}: ", path.display())?,
            Place::Option(option) if option.len() <= LONGEST_OPTION => write!(f, "--set {option}: ")?,
            Place::Option(option) => write!(f, "--set {}: ", shortened(option, LONGEST_OPTION))?,
            Place::Nowhere { path } => write!(f, "{}: ", path.display())?,
        }
        // An option that sets just this key already contains key and value.
        let said =
            matches!(&self.place, Place::Option(option) if option.split('=').next().map(str::trim) == Some(&self.key));
        match (&self.key, &self.value) {
            (key, Some(value)) if !said && !key.is_empty() => write!(f, "`{key} = {value}`: ")?,
            (key, None) if !said && !key.is_empty() => write!(f, "`{key}`: ")?,
            _ => {}
        }
        write!(f, "{}", self.cause)?;
        self.write_excerpt(f)?;
        if let Some(accepted) = self.cause.accepted() {
            write!(f, "\n  accepted: {accepted}")?;
        }
        if let Cause::Unknown { name, belongs: Some(table), .. } = &self.cause {
            write!(f, "\n  `{name}` belongs into `{table}`: `{table} = {{ {name} = ... }}`")?;
        } else if let Some(nearest) = self.cause.nearest() {
            write!(f, "\n  did you mean `{nearest}`?")?;
        }
        self.also.iter().take(MOST_ERRORS - 1).try_for_each(|error| write!(f, "\nerror: {error}"))?;
        match self.also.len().saturating_sub(MOST_ERRORS - 1) {
            0 => Ok(()),
            more => write!(f, "\nand {more} more errors"),
        }
    }
}

impl CaseError {
    /// The line, and carets below the place.
    fn write_excerpt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place::File { line, column, text, length, .. } = &self.place else { return Ok(()) };
        let margin = " ".repeat(line.to_string().len());
        write!(f, "\n {margin} |\n")?;
        let excerpt = Excerpt { line: text, position: column - 1, length: *length };
        excerpt.write(f, &format!(" {line} | "), &format!(" {margin} | "))
    }
}

impl std::error::Error for CaseError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.cause {
            // The message contains it already, but not the chain of errors below it.
            Cause::Read(error) => error.source(),
            _ => None,
        }
    }
}
