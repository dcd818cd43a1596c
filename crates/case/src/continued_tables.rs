//! Tables of a run that goes on: a longer one may take the place of an earlier one where both agree so far.

use crate::expression::{Ends, Table, is_taken_at_time_alone};
use crate::raw::{self, Case};
use coupled::rounded_time;
use std::fmt;

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

/// The points of a table after which the spline before them does not notice a new point at its end, to round-off.
const POINTS_BEFORE_END: usize = 20;

/// A table with more points at its end that cannot take the place of the shorter one, because the run has used what they change.
#[derive(Clone, Debug, PartialEq)]
pub struct LongerTable {
    /// Its name.
    pub name: String,
    /// The time that the run has reached.
    pub reached: f64,
    /// The end of the shorter table.
    pub former_end: f64,
    /// The points of the shorter table after the time reached.
    pub points_between: usize,
    /// Whether formulas take the table at the present time alone.
    pub is_of_time: bool,
}

impl fmt::Display for LongerTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LongerTable { name, points_between, is_of_time, .. } = self;
        let [reached, end] = [self.reached, self.former_end].map(rounded_time);
        if !is_of_time {
            return write!(
                f,
                "the table `{name}` has new points, and formulas take it at more than the present time `t`"
            );
        }
        let points = if *points_between == 1 { "point" } else { "points" };
        write!(
            f,
            "the new points of the table `{name}` change its spline before the checkpoint at t = {reached} too: the table ended at \
             t = {end}, {points_between} {points} after the checkpoint, and about {POINTS_BEFORE_END} are needed"
        )
    }
}

/// The tables of `now` that are those of `before` with more points at the end, and are not the same up to the time `reached`.
pub(super) fn longer(now: &Case, before: &Case, reached: f64) -> Vec<LongerTable> {
    let table = |(name, table): (&String, &raw::Table)| {
        let former = former_times(before.tables.get(name)?, table)?;
        Some(LongerTable {
            name: name.clone(),
            reached,
            former_end: *former.last()?,
            // A point at the checkpoint is not after it, whatever its last digits.
            points_between: former.iter().filter(|t| rounded_time(**t) > rounded_time(reached)).count(),
            is_of_time: is_of_time(now, name),
        })
    };
    now.tables.iter().filter_map(table).collect()
}

/// The times of the table `before`, if `now` has these points and more after them. The end of a periodic table is no end.
fn former_times<'a>(before: &'a raw::Table, now: &raw::Table) -> Option<&'a [f64]> {
    let ([t, values], [more_t, more_values]) = (points(before)?, points(now)?);
    let same_ends = before.ends == now.ends && now.ends != raw::Ends::Periodic;
    let is_longer = more_t.len() > t.len() && more_t.starts_with(t) && more_values.starts_with(values);
    (same_ends && is_longer).then_some(t)
}

fn points(table: &raw::Table) -> Option<[&[f64]; 2]> {
    Some([table.t.as_deref()?, table.values.as_deref()?])
}

/// Whether no formula of the case takes the table `name` at anything but the present time.
fn is_of_time(case: &Case, name: &str) -> bool {
    texts_hold(&toml::Value::Table(raw::to_table(case)), &|text| is_taken_at_time_alone(text, name))
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
    #![allow(clippy::unwrap_used)]
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

    #[test]
    fn a_table_is_longer_if_it_has_more_points_at_its_end() {
        let (short, long) = (sine(60, raw::Ends::Free), sine(90, raw::Ends::Free));
        assert_eq!(former_times(&short, &long).unwrap().len(), 61);
        assert!(former_times(&long, &short).is_none() && former_times(&short, &short).is_none());
        assert!(former_times(&sine(60, raw::Ends::AtRest), &long).is_none());
        assert!(former_times(&sine(60, raw::Ends::Periodic), &sine(90, raw::Ends::Periodic)).is_none());
        let mut other = long.clone();
        other.values.iter_mut().flatten().take(1).for_each(|value| *value += 1.0);
        assert!(former_times(&short, &other).is_none());
    }
}
