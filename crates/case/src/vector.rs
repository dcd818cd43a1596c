//! A vector prescribed by formulas.

use crate::expression::{ControlValue, Program};
use fem::VectorField;
use tensor::{Dual, Transcendental};

/// A vector, a formula per axis in position and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector<const D: usize> {
    components: [Program; D],
}

impl<const D: usize> Vector<D> {
    /// The vector with these components.
    pub fn new(components: [Program; D]) -> Self {
        Vector { components }
    }

    /// The zero vector.
    pub fn zero() -> Self {
        Vector { components: std::array::from_fn(|_| Program::constant(0.0)) }
    }

    /// The vector + A (x - centre), with the rows of A.
    pub(crate) fn plus_linear(self, rows: &[[f64; D]; D], centre: &[f64; D]) -> Self {
        let mut rows = rows.iter();
        let sum = |formula: Program| formula.plus_linear(rows.next().map_or(&[][..], |row| row), centre);
        Vector { components: self.components.map(sum) }
    }

    /// The vector + normal (value - start), with a number that the run changes.
    pub(crate) fn plus_change(self, normal: &[f64; D], value: &ControlValue, start: f64) -> Self {
        let mut normal = normal.iter();
        let changed = |formula: Program| match normal.next() {
            Some(&n) if n != 0.0 => formula.plus_change(n, value, start),
            _ => formula,
        };
        Vector { components: self.components.map(changed) }
    }

    /// The first component that depends on time, or on a number that the run changes.
    pub(crate) fn changes_in_time(&self) -> Option<usize> {
        self.components.iter().position(Program::changes_in_time)
    }

    /// The number of operations of an evaluation.
    pub fn operations(&self) -> usize {
        self.components.iter().map(Program::operations).sum()
    }

    /// The vector, if it is the same at all points and times.
    pub fn as_constant(&self) -> Option<[f64; D]> {
        let mut vector = [0.0; D];
        for (number, component) in vector.iter_mut().zip(&self.components) {
            *number = component.as_constant()?;
        }
        Some(vector)
    }

    /// The vector at `x` and `t`.
    pub fn evaluate<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; D] {
        std::array::from_fn(|axis| self.components[axis].evaluate(x, t))
    }
}

impl<const D: usize> VectorField<D> for Vector<D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; D] {
        self.evaluate(x, t)
    }
    fn rate(&self, x: &[f64; D], t: f64) -> [f64; D] {
        self.evaluate(&x.map(Dual::from), Dual::new(t, 1.0)).map(|component| component.derivative)
    }
}
