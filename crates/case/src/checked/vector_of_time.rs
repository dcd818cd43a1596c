//! Vectors by formulas in time.

use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::magnitude::is_bounded;
use crate::raw;
use crate::vector::Vector;

/// The vector by the `formulas` in time at `key`, which must be defined over the whole run. Errors call a component `quantity`.
pub(super) fn vector_of_time<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    quantity: &str,
    formulas: &[raw::Formula],
    time: &Time,
) -> Checked<Vector<D>> {
    let vector = checker.formulas_of_time(key, formulas)?;
    for t in time.check_times() {
        for (axis, value) in vector.evaluate(&[0.0; D], t).into_iter().enumerate() {
            let quantity = format!("{quantity} at t = {t}, {value},");
            checker.require_of_formula(
                &key.entry(axis),
                &quantity,
                is_bounded(value),
                "a formula that is finite over the whole run",
            )?;
        }
    }
    Ok(vector)
}
