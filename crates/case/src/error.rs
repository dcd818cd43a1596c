//! What can be wrong with a case, and where.

use crate::excerpt::{Excerpt, shortened};
use crate::expression::{ExpressionError, TableError};
use std::fmt;
use std::path::PathBuf;

/// How the parser begins to say that a choice is not one.
pub(super) const ONE_OF_SEVERAL: &str = "wanted exactly 1 element";

/// How the parser says that a choice is neither a text nor a table.
const NAME_OR_TABLE: &str = "wanted string or table";

/// Characters of an option that an error repeats at most.
const LONGEST_OPTION: usize = 300;

/// Characters of a name or a value that the sentence of an error repeats at most.
pub(super) const LONGEST_VALUE: usize = 60;

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
    /// The text is no TOML, or a key is missing.
    #[error("{0}")]
    Toml(String),
    /// A value of the wrong type.
    #[error("wrong type: {found}")]
    Type {
        /// What the value is.
        found: String,
        /// What is accepted.
        accepted: String,
    },
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
    #[error("wrong number of entries: {found}, in {dimension} dimensions")]
    Length {
        /// How many there are.
        found: usize,
        /// How many there should be.
        dimension: usize,
    },
    /// A list with more or fewer entries than it has a meaning for.
    #[error("wrong number of entries: {found}")]
    Entries {
        /// How many there are.
        found: usize,
        /// How many there must be.
        accepted: usize,
    },
    /// An entry of a list that is there before.
    #[error("{kind} `{name}` is listed twice")]
    Twice {
        /// What it names: a field, an axis, ...
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A boundary of the mesh without a condition.
    #[error("{}", without(.names, .kind))]
    NoCondition {
        /// The boundaries.
        names: Vec<String>,
        /// What they lack: a condition of the flow, a motion.
        kind: &'static str,
        /// Some that there are.
        choices: Vec<String>,
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
    /// A file that the case names cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// A file of the case that holds no mesh.
    #[error("{}: {error}", path.display())]
    MeshFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and in which line or byte.
        error: mesh::GmshError,
    },
    /// A table that is no function.
    #[error("{0}")]
    Table(#[source] TableError),
    /// A line of the file of a table that does not hold its numbers.
    #[error("{}:{line}: no numbers in columns 1 and {column} of `{found}`", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What it holds.
        found: String,
        /// The column of the values, from 1.
        column: usize,
    },
    /// A line of a file of coordinates that is not a point.
    #[error("{}:{line}: `{found}` is not a point", path.display())]
    Coordinates {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What it holds.
        found: String,
    },
}

impl CaseError {
    /// An error that concerns no key.
    pub(super) fn without_key(place: Place, cause: Cause) -> Box<Self> {
        Box::new(CaseError { place, key: String::new(), value: None, cause })
    }
}

impl Cause {
    /// The cause of a `message` of serde about `value`, or about a table with these `names`. Of an unknown name, the message
    /// lists what is known, all between backticks.
    /// `choices` are those of the schema.
    pub(super) fn from_serde(
        message: &str,
        value: Option<&str>,
        names: &[String],
        choices: impl FnOnce() -> Vec<String>,
    ) -> Self {
        for (start, kind) in [("unknown field `", "key"), ("unknown variant `", "choice")] {
            let mut names = message.split('`').skip(1).step_by(2).map(str::to_owned);
            if let (true, Some(name)) = (message.starts_with(start), names.next()) {
                return Cause::Unknown { kind, name, accepted: names.collect() };
            }
        }
        let described = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
        match described.and_then(|rest| rest.split_once(", expected ")) {
            Some(("unit variant", _)) => {
                let name = value.unwrap_or_default().trim_matches('"');
                let accepted = format!("its settings in a table: `{{ {name} = {{ ... }} }}`");
                Cause::Type { found: format!("`{name}` alone"), accepted }
            }
            Some((found, expected)) => {
                Cause::Type { found: shortened(found, LONGEST_VALUE), accepted: plain_type(expected) }
            }
            None if message.starts_with(ONE_OF_SEVERAL) => {
                let found =
                    if names.is_empty() { "there is none".to_owned() } else { format!("there are {}", quoted(names)) };
                let problem = format!("one choice is needed here, and only one: {found}");
                Cause::Combination {
                    problem,
                    accepted: format!("a table with a single key, the choice: {}", quoted(&choices())),
                }
            }
            None if message == NAME_OR_TABLE => {
                Cause::Type { found: "neither a name in quotes nor a table".to_owned(), accepted: quoted(&choices()) }
            }
            None if message.ends_with("value was too large") => Cause::OutOfRange {
                quantity: "the whole number".to_owned(),
                accepted: "a whole number below 2^63".to_owned(),
            },
            None => Cause::Toml(message.replace("missing field", "missing key")),
        }
    }

    /// What would be accepted, as a sentence, where the message itself does not say.
    fn accepted(&self) -> Option<String> {
        match self {
            Cause::Unknown { accepted, .. } if accepted.is_empty() => Some("nothing: there are none here".to_owned()),
            Cause::Unknown { accepted, .. } => Some(quoted(accepted)),
            Cause::Type { accepted, .. } | Cause::OutOfRange { accepted, .. } | Cause::Combination { accepted, .. } => {
                Some(accepted.clone())
            }
            Cause::Length { found: 3, dimension: 2 } => Some(
                "2 entries, one per axis; `mesh.extrude = { depth = .., layers = .. }` gives the mesh a third".to_owned(),
            ),
            Cause::Length { dimension, .. } => Some(format!("{dimension} entries, one per axis")),
            Cause::Entries { accepted, .. } => Some(format!("{accepted} entries")),
            Cause::Twice { .. } => Some("each name once: remove this one".to_owned()),
            Cause::NoCondition { names, choices, .. } => Some(format!(
                "a key {} in this table, or `others` for all boundaries that are not named: {}; none where the mesh is `periodic`",
                quoted(names),
                quoted(choices)
            )),
            Cause::Mesh(mesh::MeshError::Inverted { .. }) => {
                Some("cells that are less curved: a smaller amplitude, more cells, or a higher order".to_owned())
            }
            Cause::Coordinates { .. } => Some("two numbers, x and y, in each line; # begins a comment".to_owned()),
            Cause::Row { .. } => Some("the time and the values, numbers separated by commas or blanks".to_owned()),
            Cause::MovedAtStart { .. } => Some(
                "a displacement that is zero everywhere at the start: subtract its value there, \"f(t) - f(0)\"; of `[tables]`, the value 0 at the start"
                    .to_owned(),
            ),
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

/// A type of Rust, as serde names it, in the words of a case file.
fn plain_type(expected: &str) -> String {
    match expected {
        "usize" | "u64" => "a whole number, 0 or more".to_owned(),
        "f64" => "a number".to_owned(),
        "a string" => "a text in quotes".to_owned(),
        "a sequence" => "a list in brackets, [ ... ]".to_owned(),
        "a map" => "a table".to_owned(),
        "path string" => "a path in quotes".to_owned(),
        _ if expected.starts_with("struct ") => "a table, { ... }".to_owned(),
        _ if expected.starts_with("string or table") => "a name in quotes, or a table".to_owned(),
        _ => expected.to_owned(),
    }
}

/// What boundaries lack, as a sentence.
fn without(names: &[String], kind: &str) -> String {
    let (boundaries, have) = if names.len() == 1 { ("boundary", "has") } else { ("boundaries", "have") };
    format!("{boundaries} {} of the mesh {have} no {kind}", quoted(names))
}

/// `a`, `b`, `c`
fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::File { path, line, column, .. } => write!(f, "{}:{line}:{column}: ", path.display())?,
            Place::Option(option) if option.len() <= LONGEST_OPTION => write!(f, "--set {option}: ")?,
            Place::Option(option) => write!(f, "--set {}: ", shortened(option, LONGEST_OPTION))?,
            Place::Nowhere { path } => write!(f, "{}: ", path.display())?,
        }
        // An option that sets just this key says key and value itself.
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
        write!(f, "\n {margin} |\n")?;
        let excerpt = Excerpt { line: text, position: column - 1, length: *length };
        excerpt.write(f, &format!(" {line} | "), &format!(" {margin} | "))
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
