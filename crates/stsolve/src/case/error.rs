//! What can be wrong with a case, and where.

use crate::expression::ExpressionError;
use std::fmt;
use std::path::PathBuf;

/// Something wrong with a case: where, the key and its value, what is wrong, what is accepted.
#[derive(Debug)]
pub struct CaseError {
    /// Where it was written.
    pub place: Place,
    /// The key, for instance `flow.boundary.left`; empty if the text is no TOML.
    pub key: String,
    /// The value as it was written, where there is one.
    pub value: Option<String>,
    /// What is wrong with it.
    pub cause: Cause,
}

/// Where something was written.
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
        /// The number of characters concerned.
        length: usize,
    },
    /// In a `--set` option, given here as it was understood.
    Option(String),
    /// In no line of the case file.
    Nowhere {
        /// The file.
        path: PathBuf,
    },
}

/// What is wrong.
#[derive(Debug, thiserror::Error)]
pub enum Cause {
    /// The file cannot be read.
    #[error("cannot read the case: {0}")]
    Read(#[source] std::io::Error),
    /// The text is no TOML, or a value has the wrong type, or a key is missing.
    #[error("{0}")]
    Toml(String),
    /// A name that is not known here.
    #[error("unknown {kind} `{name}`")]
    Unknown {
        /// What it should name: a key, a boundary, ...
        kind: &'static str,
        /// The name.
        name: String,
        /// The names that are known.
        accepted: Vec<String>,
    },
    /// A value outside its range.
    #[error("{quantity} is out of range")]
    OutOfRange {
        /// What the value is.
        quantity: String,
        /// What is accepted.
        accepted: String,
    },
    /// An array that does not have one entry per axis.
    #[error("{found} entries in {dimension} dimensions")]
    Length {
        /// How many there are.
        found: usize,
        /// How many there should be.
        dimension: usize,
    },
    /// A boundary of the mesh without a condition.
    #[error("boundary `{name}` of the mesh has no {kind}")]
    NoCondition {
        /// The boundary.
        name: String,
        /// What it lacks: a condition of the flow, a motion.
        kind: &'static str,
    },
    /// A key that is needed because of another one, or keys that exclude each other.
    #[error("{problem}")]
    Combination {
        /// What does not fit together.
        problem: String,
        /// What to write.
        accepted: String,
    },
    /// A formula that cannot be compiled.
    #[error("{0}")]
    Expression(#[source] ExpressionError),
    /// A displacement that is not zero at the start.
    #[error("the displacement at the start, t = {time}, is {value:e} at {position:?}: it must be zero there")]
    MovedAtStart {
        /// The start.
        time: f64,
        /// Where.
        position: Vec<f64>,
        /// The component of the displacement.
        value: f64,
    },
    /// A gas, state or boundary condition that cannot be.
    #[error("{0}")]
    Physics(#[source] navier_stokes::InvalidParameter),
    /// A mesh that cannot be.
    #[error("{0}")]
    Mesh(#[source] mesh::MeshError),
}

impl Cause {
    /// The cause of a message of serde. Of an unknown name, it lists what is known, all between backticks.
    pub(super) fn from_serde(message: &str) -> Self {
        let kind = ["field", "variant"].into_iter().find(|kind| message.starts_with(&format!("unknown {kind} `")));
        let mut names = message.split('`').skip(1).step_by(2).map(str::to_owned);
        match (kind, names.next()) {
            (Some(kind), Some(name)) => {
                let kind = if kind == "field" { "key" } else { "choice" };
                Cause::Unknown { kind, name, accepted: names.collect() }
            }
            _ => Cause::Toml(message.to_owned()),
        }
    }

    /// What would be accepted, as a sentence, where the message itself does not say.
    fn accepted(&self) -> Option<String> {
        match self {
            Cause::Unknown { accepted, .. } if accepted.is_empty() => Some("nothing: there are none here".to_owned()),
            Cause::Unknown { accepted, .. } => Some(quoted(accepted)),
            Cause::OutOfRange { accepted, .. } | Cause::Combination { accepted, .. } => Some(accepted.clone()),
            Cause::Length { dimension, .. } => Some(format!("{dimension} entries, one per axis")),
            Cause::NoCondition { name, .. } => Some(format!(
                "a key `{name}` in this table, or `others` for all boundaries that are not named"
            )),
            Cause::MovedAtStart { .. } => Some("a displacement that is zero everywhere at the start".to_owned()),
            _ => None,
        }
    }

    fn nearest(&self) -> Option<&str> {
        match self {
            Cause::Unknown { name, accepted, .. } => crate::nearest::nearest(name, accepted.iter().map(String::as_str)),
            _ => None,
        }
    }
}

/// `a`, `b`, `c`
fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::File { path, line, column, .. } => write!(f, "{}:{line}:{column}: ", path.display())?,
            Place::Option(option) => write!(f, "--set {option}: ")?,
            Place::Nowhere { path } => write!(f, "{}: ", path.display())?,
        }
        match (&self.key, &self.value) {
            (key, Some(value)) if !key.is_empty() => write!(f, "`{key} = {value}`: ")?,
            (key, None) if !key.is_empty() => write!(f, "`{key}`: ")?,
            _ => {}
        }
        write!(f, "{}", self.cause)?;
        self.write_excerpt(f)?;
        if let Some(accepted) = self.cause.accepted() {
            write!(f, "\n  accepted: {accepted}")?;
        }
        if let Some(nearest) = self.cause.nearest() {
            write!(f, "\n  did you mean `{nearest}`?")?;
        }
        Ok(())
    }
}

impl CaseError {
    /// The line, and carets below the place.
    fn write_excerpt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place::File { line, column, text, length, .. } = &self.place else { return Ok(()) };
        let margin = " ".repeat(line.to_string().len());
        // Tabs stay tabs, so that the carets stay below what they mark.
        let indent: String = text.chars().take(column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        write!(f, "\n {margin} |\n {line} | {text}\n {margin} | {indent}{}", "^".repeat((*length).max(1)))
    }
}

impl std::error::Error for CaseError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.cause {
            // The message contains it already, the chain below it does not.
            Cause::Read(error) => error.source(),
            _ => None,
        }
    }
}
