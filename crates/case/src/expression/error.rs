//! Errors of a formula, and their places.

use crate::excerpt::Excerpt;
use std::fmt;

/// A formula that cannot be compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct ExpressionError {
    /// The formula.
    pub text: String,
    /// The place in the formula, in characters from 0.
    pub position: usize,
    /// The number of characters concerned, at least 1.
    pub length: usize,
    /// The problem at this place.
    pub problem: Problem,
}

/// A problem at one place of a formula.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A character that no formula contains.
    #[error("unexpected character `{character}`{}", instead_of(*.character))]
    Character {
        /// The character.
        character: char,
    },
    /// An invalid number.
    #[error("`{0}` is not a number")]
    Number(String),
    /// An unexpected token.
    #[error("expected {expected}, found {found}")]
    Unexpected {
        /// The expected input.
        expected: &'static str,
        /// The token found.
        found: String,
    },
    /// An unknown name.
    #[error("unknown name `{name}`{}; known here: {}", did_you_mean(.nearest), .known.join(", "))]
    UnknownName {
        /// The name.
        name: String,
        /// The known name with the most similar spelling.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// A function without its parentheses, or a variable with some.
    #[error("`{name}` is a {is}: write {write}")]
    Misused {
        /// The name.
        name: String,
        /// Its kind.
        is: &'static str,
        /// Its correct use.
        write: String,
    },
    /// A function called with too few or too many arguments.
    #[error("`{name}` takes {takes} argument(s), found {found}")]
    Arguments {
        /// The function.
        name: String,
        /// The number of arguments that it takes.
        takes: usize,
        /// The number of arguments found.
        found: usize,
    },
    /// More operations than a formula may have.
    #[error("too long: at most {0} operations; `[tables]` give a function by points")]
    TooLong(usize),
    /// More nesting than the evaluation supports.
    #[error("too deeply nested: at most {0} levels")]
    TooDeep(usize),
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

/// How to write what other languages write with a character that is unknown here.
fn instead_of(character: char) -> &'static str {
    match character {
        '&' | '|' => ": `a*b` is 1 where both comparisons hold, `max(a, b)` where one does",
        '%' => ": `a - b*floor(a/b)` is the remainder",
        _ => "",
    }
}

/// The problem, then the formula on a line of its own with carets below the place.
impl fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line: String = self.text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        writeln!(f, "at character {}: {}", self.position + 1, self.problem)?;
        Excerpt { line: &line, position: self.position, length: self.length }.write(f, "    ", "    ")
    }
}
