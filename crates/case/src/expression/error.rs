//! What can be wrong with a formula, and where.

use crate::excerpt::Excerpt;
use std::fmt;

/// A formula that cannot be compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct ExpressionError {
    /// The formula.
    pub text: String,
    /// Where in the formula, in characters from 0.
    pub position: usize,
    /// How many characters are concerned, at least 1.
    pub length: usize,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong at one place of a formula.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A character that no formula contains.
    #[error("unexpected character `{0}`")]
    Character(char),
    /// Something that looks like a number and is none.
    #[error("`{0}` is not a number")]
    Number(String),
    /// A token at a place where the grammar wants another.
    #[error("expected {expected}, found {found}")]
    Unexpected {
        /// What the grammar wants.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A name that means nothing here.
    #[error("unknown name `{name}`{}; known here: {}", did_you_mean(.nearest), .known.join(", "))]
    UnknownName {
        /// The name.
        name: String,
        /// The known name that is spelt most like it.
        nearest: Option<String>,
        /// All that is known.
        known: Vec<String>,
    },
    /// A function without its parentheses, or a variable with some.
    #[error("`{name}` is a {is}: write {write}")]
    Misused {
        /// The name.
        name: String,
        /// What it is.
        is: &'static str,
        /// How it is used.
        write: String,
    },
    /// A function called with too few or too many arguments.
    #[error("`{name}` takes {takes} argument(s), found {found}")]
    Arguments {
        /// The function.
        name: String,
        /// How many it takes.
        takes: usize,
        /// How many there are.
        found: usize,
    },
    /// More operations than a formula may have.
    #[error("too long: at most {0} operations; `[tables]` give a function by points")]
    TooLong(usize),
    /// More nesting than the evaluation has room for.
    #[error("too deeply nested: at most {0} levels")]
    TooDeep(usize),
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

/// The problem, then the formula on a line of its own with carets below the place.
impl fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line: String = self.text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        writeln!(f, "at character {}: {}", self.position + 1, self.problem)?;
        Excerpt { line: &line, position: self.position, length: self.length }.write(f, "    ", "    ")
    }
}
