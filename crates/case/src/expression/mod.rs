//! Formulas of a case file: text, compiled once to a flat program that runs on any number type.
//!
//! ```text
//! comparison = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]        1 if true, 0 if not
//! sum        = product { ("+" | "-") product }
//! product    = signed { ("*" | "/") signed }
//! signed     = { "-" | "+" } power                                        so that -x^2 = -(x^2)
//! power      = atom [ "^" signed ]                                        so that x^y^z = x^(y^z)
//! atom       = number | name | name "(" comparison { "," comparison } ")" | "(" comparison ")"
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `lexer` | text to tokens |
//! | `calls` | which arguments a formula gives to a table |
//! | `names` | the meaning of names: variables, constants, functions |
//! | `parser` | tokens to a program, by the grammar above |
//! | `program` | the program and its evaluation |
//! | `finite` | formulas that have a finite value nowhere |
//! | `control` | numbers that a run changes between slabs |
//! | `table` | functions given by tables: cubic splines |
//! | `error` | errors of a formula, and their places |

mod calls;
mod control;
mod error;
mod finite;
mod lexer;
mod names;
mod parser;
mod program;
mod table;
#[cfg(test)]
mod tests;

pub use calls::is_taken_at_time_alone;
pub use control::ControlValue;
pub use error::{ExpressionError, Problem};
pub use names::{Names, Variable, is_variable};
pub use program::Program;
pub use table::{Ends, Overshoot, Table, TableError};

impl Program {
    /// Compiles `text`, in which the variables and constants of `names` may occur.
    ///
    /// # Errors
    /// Violations of the grammar, and unknown names, with their place in the text.
    pub fn compile(text: &str, names: &Names) -> Result<Program, ExpressionError> {
        parser::parse(text, names)
    }
}
