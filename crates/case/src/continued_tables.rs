//! Tables of a run that goes on: a longer one may take the place of an earlier one where both agree so far.

use crate::expression::{Ends, Table, is_taken_at_time_alone};
use crate::raw::{self, Case};

/// Two splines agree if they differ by less than this part of their largest value: round-off.
const ROUND_OFF: f64 = 1e-13;

/// Places in each piece of both splines at which they are compared. Two cubics that agree at four places are the same.
const PLACES: usize = 4;

/// Replaces the tables of `now` that agree with those of `before` up to the time `reached` by them.
pub(super) fn take_back(now: &mut Case, before: &Case, reached: f64) {
    let agreeing: Vec<String> = now
        .tables
        .iter()
        .filter(|(name, table)| before.tables.get(*name).is_some_and(|earlier| agree(earlier, table, reached)))
        .map(|(name, _)| name.clone())
        .filter(|name| is_of_time(now, name))
        .collect();
    for name in agreeing {
        now.tables.insert(name.clone(), before.tables[&name].clone());
    }
}

/// Whether no formula of the case takes the table `name` at anything but the present time.
fn is_of_time(case: &Case, name: &str) -> bool {
    // What TOML cannot write has been refused before.
    toml::Value::try_from(case).is_ok_and(|case| texts_hold(&case, &|text| is_taken_at_time_alone(text, name)))
}

/// Whether all texts in `value` satisfy `holds`.
fn texts_hold(value: &toml::Value, holds: &impl Fn(&str) -> bool) -> bool {
    match value {
        toml::Value::String(text) => holds(text),
        toml::Value::Array(entries) => entries.iter().all(|entry| texts_hold(entry, holds)),
        toml::Value::Table(table) => table.values().all(|value| texts_hold(value, holds)),
        _ => true,
    }
}

/// Whether the splines of both tables have the same values up to `reached`.
fn agree(one: &raw::Table, other: &raw::Table, reached: f64) -> bool {
    let (Some(one), Some(other)) = (spline(one), spline(other)) else { return false };
    let places = places(&one, &other, reached);
    let size = places.iter().map(|t| one.evaluate(*t).abs()).fold(0.0, f64::max);
    let is_same = |t: f64| {
        let (a, b) = (one.evaluate(t), other.evaluate(t));
        (a - b).abs() <= ROUND_OFF * size || (a.is_nan() && b.is_nan())
    };
    places.windows(2).all(|piece| {
        let at = |k: usize| piece[0] + (piece[1] - piece[0]) * k as f64 / (PLACES - 1) as f64;
        (0..PLACES).all(|k| is_same(at(k)))
    })
}

/// The ends of the pieces of both splines up to `reached`, and that time itself.
fn places(one: &Table, other: &Table, reached: f64) -> Vec<f64> {
    let knots = one.points().0.iter().chain(other.points().0).copied();
    let last = knots.clone().fold(f64::NEG_INFINITY, f64::max);
    let first = knots.clone().fold(f64::INFINITY, f64::min);
    let end = reached.min(last);
    let mut places: Vec<f64> = knots.filter(|t| *t < end).chain([end, end.min(first)]).collect();
    places.sort_by(f64::total_cmp);
    places
}

/// The spline of a table whose values are written out.
fn spline(raw: &raw::Table) -> Option<Table> {
    let ends = match raw.ends {
        raw::Ends::Free => Ends::Free,
        raw::Ends::AtRest => Ends::AtRest,
        raw::Ends::Periodic => Ends::Periodic,
    };
    Table::new(raw.t.clone()?, raw.values.clone()?, ends).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sin at 0, 0.1, ..., up to `end`.
    fn sine(end: usize, ends: raw::Ends) -> raw::Table {
        let t: Vec<f64> = (0..=end).map(|k| 0.1 * k as f64).collect();
        let values = t.iter().map(|t| t.sin()).collect();
        raw::Table { t: Some(t), values: Some(values), file: None, column: None, ends }
    }

    /// An end changes the slopes of a spline by a factor of 2 + sqrt(3) less with every point from it.
    #[test]
    fn a_longer_spline_is_the_same_far_from_its_former_end() {
        for ends in [raw::Ends::Free, raw::Ends::AtRest] {
            let (short, long) = (sine(60, ends), sine(90, ends));
            assert!(agree(&short, &long, 3.0) && agree(&long, &short, 3.0), "{ends:?}");
            assert!(!agree(&short, &long, 6.0) && !agree(&short, &long, 7.0), "{ends:?}");
            let mut other = long.clone();
            other.values.iter_mut().flatten().skip(10).take(1).for_each(|value| *value += 1e-6);
            assert!(!agree(&short, &other, 3.0) && agree(&short, &other, -1.0), "{ends:?}");
        }
    }
}
