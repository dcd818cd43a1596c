//! Checks that a displacement has a value of reasonable size, and a rate.

use crate::checker::{Checked, Checker};
use crate::error::CaseError;
use crate::key::Key;
use std::fmt::Arguments;

/// The largest displacement in units of the size of the mesh. Coordinates have 16 digits; beyond this, too few are left
/// for the cells.
const FARTHEST: f64 = 1e6;

/// Checks that the displacement `d` of the point `x` at `t`, given at `key`, is finite and not too large relative to the `size` of
/// the mesh.
pub(super) fn check_displacement<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    x: &[f64; D],
    d: &[f64; D],
    t: f64,
    size: f64,
) -> Checked<()> {
    if d.iter().any(|d| !d.is_finite()) {
        return Err(undefined(checker, key, x, t));
    }
    let largest = d.iter().fold(0.0_f64, |largest, d| largest.max(d.abs()));
    if largest <= FARTHEST * size {
        return Ok(());
    }
    let problem = format!(
        "the displacement at {x:?}, t = {t}, is {largest:.3e}, which is {:.1e} times the size of the mesh, {size:.3e}: coordinates so large keep \
         too few digits to tell the nodes of a cell apart",
        largest / size
    );
    Err(checker.combination(key, &problem, &format!("a displacement below {:.1e}", FARTHEST * size)))
}

/// Checks that the `rate` of `motion`, given at `key`, is finite at `t`.
pub(super) fn check_rate(checker: &Checker<'_>, key: &Key, motion: Arguments<'_>, t: f64, rate: f64) -> Checked<()> {
    if rate.is_finite() {
        return Ok(());
    }
    let quantity = format!("the rate of {motion} at t = {t}, {rate},");
    let accepted = "a formula whose rate is finite over the whole run";
    checker.require_of_formula(key, &quantity, false, accepted)
}

/// The error of a displacement that has no value at `x` and `t`.
pub(super) fn undefined<const D: usize>(checker: &Checker<'_>, key: &Key, x: &[f64; D], t: f64) -> Box<CaseError> {
    // A table that goes on beyond its ends has a value everywhere.
    let ends = checker.tables().filter(|(_, table)| table.evaluate(t).is_nan());
    let ranges = ends.map(|(name, table)| {
        let (first, last) = table.range();
        format!("; table `{name}` reaches from {first} to {last}")
    });
    let problem = format!("the displacement has no value at {x:?}, t = {t}{}", ranges.collect::<String>());
    let remedy = "a formula with a value over the whole run; a table that covers it, or one whose `ends` are \"at_rest\" or \"periodic\"";
    checker.combination(key, &problem, remedy)
}
