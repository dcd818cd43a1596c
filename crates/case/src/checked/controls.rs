//! `[controls]`

use super::raw;
use crate::checker::{Checked, Checker};
use crate::expression::{ControlValue, Program};
use crate::key::Key;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as ValueError, StrDeserializer};
use std::collections::BTreeMap;

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
    rate: Rate,
    /// Whether a formula of the flow contains it.
    pub is_used: bool,
}

/// How a control changes.
#[derive(Clone, Debug, PartialEq)]
enum Rate {
    /// By a formula.
    Formula(Program),
    /// It follows the measured value with this time constant.
    Memory(f64),
}

impl Control {
    /// The number after a slab of length `dt` that ends at `t`:
    ///
    /// ```text
    /// c' = c + dt r(m, c, t)                     by a formula                                                         (control)
    /// c' = c + (1 - exp(-dt / T)) (m - c)        with a memory T
    /// ```
    ///
    /// with the rate r, what was `measured`, m, and the number c in that slab.
    pub fn next(&self, measured: f64, t: f64, dt: f64) -> f64 {
        let value = self.value.get();
        match &self.rate {
            Rate::Formula(rate) => value + dt * rate.evaluate(&[measured, value], t),
            Rate::Memory(time) => value - (-dt / time).exp_m1() * (measured - value),
        }
    }

    /// This control, `is_used` or not.
    pub(super) fn with_use(&self, is_used: bool) -> Self {
        Control { is_used, ..self.clone() }
    }

    /// A control that follows the column `measure` with the time constant `time`.
    pub(super) fn with_memory(name: String, measure: String, initial: f64, time: f64) -> Self {
        Control { name, measure, initial, value: ControlValue::new(initial), rate: Rate::Memory(time), is_used: true }
    }
}

/// The control `name` of a case whose history.csv has `integrals`.
pub(super) fn check(
    checker: &Checker<'_>,
    name: &str,
    raw: &raw::Control,
    integrals: &[raw::Integral],
) -> Checked<Control> {
    let key = Key::new("controls").child(name);
    has_integral(checker, &key.child("measure"), &raw.measure, integrals)?;
    let initial = checker.number(&key.child("initial"), &raw.initial)?;
    let rate = checker.formula_of_control(&key.child("rate"), &raw.rate)?;
    checker.require_finite_somewhere(&key.child("rate"), "the rate", &rate)?;
    let rate = Rate::Formula(rate);
    let (name, measure, value) = (name.to_owned(), raw.measure.clone(), ControlValue::new(initial));
    Ok(Control { name, measure, initial, value, rate, is_used: false })
}

/// Checks that an integral over the flow is among `integrals` if a control measures it: only those are columns of history.csv.
fn has_integral(checker: &Checker<'_>, key: &Key, measure: &str, integrals: &[raw::Integral]) -> Checked<()> {
    let name: StrDeserializer<'_, ValueError> = measure.into_deserializer();
    match raw::Integral::deserialize(name) {
        Ok(integral) if !integrals.contains(&integral) => {
            let problem =
                format!("history.csv has no column \"{measure}\", because `output.integrals` does not list it");
            let accepted = format!("this control together with `output.integrals = [\"{measure}\"]`");
            Err(checker.combination(key, &problem, &accepted))
        }
        _ => Ok(()),
    }
}

/// Checks that only a case with a flow has controls.
pub(super) fn need_a_flow(
    checker: &Checker<'_>,
    controls: &BTreeMap<String, raw::Control>,
    has_flow: bool,
) -> Checked<()> {
    match controls.keys().next() {
        Some(control) if !has_flow => {
            let (key, problem) = (Key::new("controls").child(control), "only formulas of a flow contain controls");
            Err(checker.combination(&key, problem, "this section together with [flow]"))
        }
        _ => Ok(()),
    }
}
