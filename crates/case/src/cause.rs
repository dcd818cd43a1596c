//! The causes of errors of a case.

use crate::excerpt::shortened;
use crate::expression::{ExpressionError, TableError};
use std::path::PathBuf;

/// The beginning of the parser's message about an invalid choice.
pub(super) const ONE_OF_SEVERAL: &str = "wanted exactly 1 element";

/// The parser's message about a choice that is neither a text nor a table.
const NAME_OR_TABLE: &str = "wanted string or table";

/// The largest number of characters of a name or a value in the sentence of an error.
pub(super) const LONGEST_VALUE: usize = 60;

/// The cause of an error.
#[derive(Debug, thiserror::Error)]
pub enum Cause {
    /// Another error, which is reported with it.
    #[error("this cannot be checked because of another error")]
    Follows,
    /// The file cannot be read.
    #[error("cannot read the case: {0}")]
    Read(#[source] std::io::Error),
    /// The text is not TOML, or a key is missing.
    #[error("{0}")]
    Toml(String),
    /// A value of the wrong type.
    #[error("wrong type: {found}")]
    Type {
        /// The type of the value.
        found: String,
        /// The accepted types.
        accepted: String,
    },
    /// An unknown name.
    #[error("unknown {kind} `{name}`")]
    Unknown {
        /// The kind of the name: a key, a boundary, ...
        kind: &'static str,
        /// The name.
        name: String,
        /// The known names.
        accepted: Vec<String>,
        /// The known key whose table or choice accepts the name.
        belongs: Option<String>,
    },
    /// A value outside its range.
    #[error("{quantity} is out of range")]
    OutOfRange {
        /// The name of the quantity.
        quantity: String,
        /// The accepted values.
        accepted: String,
    },
    /// A number that is not positive.
    #[error("{quantity} is out of range")]
    NotPositive {
        /// The name of the quantity.
        quantity: String,
    },
    /// A key that the number of dimensions of the mesh excludes.
    #[error("{problem}")]
    Dimension {
        /// The conflict.
        problem: String,
        /// The accepted input.
        accepted: String,
    },
    /// An array that does not have one entry per axis.
    #[error("wrong number of entries: {found}, in {dimension} dimensions")]
    Length {
        /// The number of entries.
        found: usize,
        /// The number of dimensions.
        dimension: usize,
    },
    /// A list with a wrong number of entries.
    #[error("wrong number of entries: {found}")]
    Entries {
        /// The number of entries.
        found: usize,
        /// The required number.
        accepted: usize,
    },
    /// An entry that occurs twice in a list.
    #[error("{kind} `{name}` is listed twice")]
    Twice {
        /// The kind of the entry: a field, an axis, ...
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A boundary of the mesh without a condition.
    #[error("{}", without(.names, .kind))]
    NoCondition {
        /// The boundaries.
        names: Vec<String>,
        /// The missing item: a condition of the flow, a motion.
        kind: &'static str,
        /// Some of the choices.
        choices: Vec<String>,
    },
    /// A key that is needed because of another one, or keys that exclude each other.
    #[error("{problem}")]
    Combination {
        /// The conflict.
        problem: String,
        /// The accepted input.
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
        /// The position at rest.
        position: Vec<f64>,
        /// The component of the displacement.
        value: f64,
    },
    /// An impossible gas, state or boundary condition.
    #[error("{0}")]
    Physics(#[source] navier_stokes::InvalidParameter),
    /// An impossible mesh.
    #[error("{0}")]
    Mesh(#[source] mesh::MeshError),
    /// A file named in the case cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        error: std::io::Error,
    },
    /// A mesh file of the case that cannot be read.
    #[error("{}: {error}", path.display())]
    MeshFile {
        /// The file.
        path: PathBuf,
        /// The error, with its place in the file.
        error: crate::MeshFileError,
    },
    /// A table that does not define a function.
    #[error("{0}")]
    Table(#[source] TableError),
    /// A line in the file of a table without the required numbers.
    #[error("{}:{line}: no numbers in columns 1 and {column} of `{found}`", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The text of the line.
        found: String,
        /// The column of the values, from 1.
        column: usize,
    },
    /// A line in the file of a table with more or fewer entries than the first one.
    #[error("{}:{line}: {entries} entries in `{found}`, but {expected} in line {first_line}", path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The text of the line.
        found: String,
        /// The number of its entries.
        entries: usize,
        /// The number of entries in the first line of numbers.
        expected: usize,
        /// That line.
        first_line: usize,
    },
    /// A line of a file of coordinates that is not a point.
    #[error("{}:{line}: `{found}` is not a point", path.display())]
    Coordinates {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The text of the line.
        found: String,
    },
}

impl Cause {
    /// The cause of a `message` of serde about `value`, or about a table with these `names`. For an unknown name, the
    /// message lists the known names between backticks. `choices` are the choices of the schema, `choice_of_number` is the one whose only
    /// setting is a number, and `settings` gives an example of the value of a choice that is no table.
    pub(super) fn from_serde(
        message: &str,
        value: Option<&str>,
        names: &[String],
        choices: impl FnOnce() -> Vec<String>,
        choice_of_number: impl Fn() -> Option<String>,
        settings: impl FnOnce(&str) -> Option<&'static str>,
    ) -> Self {
        for (start, kind) in [("unknown field `", "key"), ("unknown variant `", "choice")] {
            let mut names = message.split('`').skip(1).step_by(2).map(str::to_owned);
            if let (true, Some(name)) = (message.starts_with(start), names.next()) {
                if is_formula(&name)
                    && let Some(choice) = choice_of_number()
                {
                    let accepted = format!("`{{ {choice} = \"{name}\" }}`, or else {}", quoted(&choices()));
                    return Cause::Type { found: "neither a name nor a table".to_owned(), accepted };
                }
                return Cause::Unknown { kind, name, accepted: names.collect(), belongs: None };
            }
        }
        let described = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
        match described.and_then(|rest| rest.split_once(", expected ")) {
            Some(("unit variant", _)) => {
                let name = value.unwrap_or_default().trim_matches('"');
                let accepted = match settings(name) {
                    Some(form) => format!("its value in a table: `{{ {name} = {form} }}`"),
                    None => format!("its settings in a table: `{{ {name} = {{ ... }} }}`"),
                };
                Cause::Type { found: format!("`{name}` alone"), accepted }
            }
            Some((found, _)) if found.ends_with("as i128") || found.ends_with("as u128") => too_large(),
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
                let number = value.filter(|value| value.parse::<f64>().is_ok());
                let meant =
                    number.and_then(|number| Some(format!("`{{ {} = {number} }}`, or else ", choice_of_number()?)));
                let accepted = meant.unwrap_or_default() + &quoted(&choices());
                Cause::Type { found: "neither a name in quotes nor a table".to_owned(), accepted }
            }
            None if message.ends_with("value was too large") => too_large(),
            None => Cause::Toml(message.replace("missing field", "missing key")),
        }
    }

    /// The accepted input as a sentence, if the message itself does not contain it.
    pub(super) fn accepted(&self) -> Option<String> {
        match self {
            Cause::Unknown { accepted, .. } if accepted.is_empty() => Some("nothing: there are none here".to_owned()),
            Cause::Unknown { accepted, .. } => Some(quoted(accepted)),
            Cause::Type { accepted, .. }
            | Cause::OutOfRange { accepted, .. }
            | Cause::Dimension { accepted, .. }
            | Cause::Combination { accepted, .. } => Some(accepted.clone()),
            Cause::NotPositive { .. } => Some("a positive number".to_owned()),
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
            Cause::Ragged { .. } => Some("the same number of entries in every line".to_owned()),
            Cause::Row { .. } => Some("the time and the values, numbers separated by semicolons, tabs, commas or blanks".to_owned()),
            Cause::MovedAtStart { .. } => Some(
                "a displacement that is zero everywhere at the start: subtract its value there, \"f(t) - f(0)\" for a start at 0; of `[tables]`, the value 0 at the start"
                    .to_owned(),
            ),
            _ => None,
        }
    }

    /// The accepted name that an unknown one probably means.
    pub(super) fn nearest(&self) -> Option<&str> {
        match self {
            Cause::Unknown { name, accepted, .. } => crate::nearest::nearest(name, accepted.iter().map(String::as_str)),
            _ => None,
        }
    }
}

/// Whether the name of a choice is rather the formula of a number.
fn is_formula(name: &str) -> bool {
    name.contains(|c: char| c.is_ascii_digit() || "+*/(".contains(c))
}

/// A whole number that no integer of TOML holds.
fn too_large() -> Cause {
    Cause::OutOfRange { quantity: "the whole number".to_owned(), accepted: "a whole number below 2^63".to_owned() }
}

/// The words of a case file for a type of Rust as serde names it.
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

/// The missing items of boundaries, as a sentence.
fn without(names: &[String], kind: &str) -> String {
    let (boundaries, have) = if names.len() == 1 { ("boundary", "has") } else { ("boundaries", "have") };
    format!("{boundaries} {} of the mesh {have} no {kind}", quoted(names))
}

/// `a`, `b`, `c`
fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
