//! Fields by formulas.

use crate::expression::Program;

/// A field by a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldFormula {
    /// Its name.
    pub name: String,
    /// The formula in the coordinates, [`case_keys::Field::components_of_flow`] and the time.
    pub program: Program,
}
