//! The numbers that the program can compute with.

use super::cause::Cause;
use super::key::Key;
use toml::de::{DeTable, DeValue};

/// The equations multiply up to five numbers of a case: density, three velocities and an area, for instance. Products of five numbers of
/// these sizes fit into a double, which ends at 1.8e308 and 2.2e-308.
const SMALLEST: f64 = 1e-60;
const LARGEST: f64 = 1e60;

/// Which numbers are accepted.
pub(super) const ACCEPTED: &str =
    "0, or a finite number from 1e-60 to 1e60 in size, for products of five must be numbers too; other units help";

/// Whether products of `value` neither overflow nor vanish.
pub(super) fn is_computable(value: f64) -> bool {
    value == 0.0 || (SMALLEST..=LARGEST).contains(&value.abs())
}

/// Whether the value of a formula may be used. Values near zero are accepted, such as the tail of exp(-x^2), because the program does not
/// divide by them.
pub(super) fn is_bounded(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Whether a `distance` is zero up to round-off of the `size` of the mesh.
pub(super) fn is_round_off(distance: f64, size: f64) -> bool {
    distance.abs() <= 1e-12 * size
}

/// The first number of the document that is not accepted, and what is wrong with it.
pub(super) fn first_extreme(document: &DeTable<'_>) -> Option<(Key, Cause)> {
    let key = extreme_in_table(document, &Key::default())?;
    Some((key, Cause::OutOfRange { quantity: "the number".to_owned(), accepted: ACCEPTED.to_owned() }))
}

fn extreme_in_table(table: &DeTable<'_>, key: &Key) -> Option<Key> {
    table.iter().find_map(|(name, value)| extreme_in(value.get_ref(), &key.child(name.get_ref())))
}

fn extreme_in(value: &DeValue<'_>, key: &Key) -> Option<Key> {
    match value {
        DeValue::Table(table) => extreme_in_table(table, key),
        DeValue::Array(entries) => {
            entries.iter().enumerate().find_map(|(index, entry)| extreme_in(entry.get_ref(), &key.entry(index)))
        }
        // A text that is no number is left to the deserialiser.
        DeValue::Float(number) => {
            number.as_str().parse().is_ok_and(|number| !is_computable(number)).then(|| key.clone())
        }
        _ => None,
    }
}
