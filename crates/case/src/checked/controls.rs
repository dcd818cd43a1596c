//! `[controls]`

use super::raw;
use crate::checker::{Checked, Checker};
use crate::expression::{ControlValue, Program};
use crate::key::Key;

/// A number in formulas that the run changes after every slab.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Its name.
    pub name: String,
    /// The column of history.csv that is measured.
    pub measure: String,
    /// The number in the first slab.
    pub initial: f64,
    /// The number in formulas.
    pub value: ControlValue,
    rate: Program,
}

impl Control {
    /// The number after a slab of length `dt` that ends at `t`:
    ///
    /// ```text
    /// c' = c + dt r(m, c, t)                                                                                          (control)
    /// ```
    ///
    /// with the rate r, what was `measured`, m, and the number c in that slab.
    pub fn next(&self, measured: f64, t: f64, dt: f64) -> f64 {
        let value = self.value.get();
        value + dt * self.rate.evaluate(&[measured, value], t)
    }
}

/// The control `name`.
pub(super) fn check(checker: &Checker<'_>, name: &str, raw: &raw::Control) -> Checked<Control> {
    let key = Key::new("controls").child(name);
    let initial = checker.number(&key.child("initial"), &raw.initial)?;
    let rate = checker.formula_of_control(&key.child("rate"), &raw.rate)?;
    let (name, measure, value) = (name.to_owned(), raw.measure.clone(), ControlValue::new(initial));
    Ok(Control { name, measure, initial, value, rate })
}
