//! One step of a file, and whether it fits the layout.

use crate::error::OutputError;
use crate::layout::{ArraySpec, FieldSpec, FileLayout};

/// One step: the grid and the solution at one time.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Time.
    pub time: f64,
    /// Points, `[cell][lattice point, lexicographic][3]`.
    pub points: &'a [f64],
    /// Every field of the layout, in any order: its name and
    /// `[cell][lattice point, lexicographic][component]`.
    pub fields: &'a [(&'a str, &'a [f64])],
    /// Every array of coefficients of the layout, in any order: its name and its values, last axis fastest.
    pub exact: &'a [(&'a str, &'a [f64])],
}

/// Arrays of values in the order of the layout.
type Values<'a> = Vec<&'a [f64]>;

impl<'a> Step<'a> {
    /// Fields and coefficients in the order of the `layout`, all lengths checked.
    pub(crate) fn in_order(&self, layout: &FileLayout) -> Result<(Values<'a>, Values<'a>), OutputError> {
        let points = layout.grid.points();
        checked("points", self.points, 3 * points)?;
        let field = |field: &FieldSpec| find(self.fields, &field.name, field.components * points);
        let array = |array: &ArraySpec| find(self.exact, &array.name, array.len());
        let fields = layout.fields.iter().map(field).collect::<Result<_, _>>()?;
        let exact = layout.exact.iter().map(array).collect::<Result<_, _>>()?;
        Ok((fields, exact))
    }
}

fn find<'a>(arrays: &[(&str, &'a [f64])], name: &str, length: usize) -> Result<&'a [f64], OutputError> {
    match arrays.iter().find(|array| array.0 == name) {
        Some(&(_, values)) => checked(name, values, length),
        None => Err(OutputError::Absent { name: name.to_owned() }),
    }
}

/// The `values` of the array `name`, if there are as many as expected.
pub(crate) fn checked<'a>(name: &str, values: &'a [f64], expected: usize) -> Result<&'a [f64], OutputError> {
    match values.len() {
        found if found == expected => Ok(values),
        found => Err(OutputError::Length { name: name.to_owned(), expected, found }),
    }
}
