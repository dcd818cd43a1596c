//! The level of Q whose surface is shown.
//!
//! Four fifths of the integral of positive Q lie above the level q:
//!
//! ```text
//! int_{Q > q} Q dV = 4/5 int_{Q > 0} Q dV                                                                                       (level)
//! ```
//!
//! Regions without vortices do not count, however large they are. All times have the same weight. Boundary layers on curved walls also have
//! positive Q, larger than that of wakes; with a smaller part the wakes would be invisible.

use super::super::bounds::{Cuboid, in_space};
use super::region::PictureRegion;
use crate::pictures::scheme::PARTS;
use crate::pictures::snapshot::Snapshot;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The part of the integral of positive Q above the level.
const PART: f64 = 0.8;

/// Levels below this multiple of (U/L)^2, with the speed of the fastest wave and the length of the domain, are round-off.
const ROUND_OFF: f64 = 1e-8;

/// Entries of the histogram for a factor of two.
const PER_OCTAVE: f64 = 16.0;

/// The finest lattice for the integral, an entry of [`PARTS`].
const FINENESS: usize = 1;

/// The integral of positive Q over the volume where log2 Q lies in each interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram(BTreeMap<i32, f64>);

impl Histogram {
    /// Adds a volume with a value.
    fn add(&mut self, q: f64, volume: f64) {
        if q > 0.0 && q.is_finite() && volume > 0.0 {
            *self.0.entry((q.log2() * PER_OCTAVE).floor() as i32).or_default() += q * volume;
        }
    }

    fn join(&mut self, other: &Histogram) {
        other.0.iter().for_each(|(interval, sum)| *self.0.entry(*interval).or_default() += sum);
    }

    /// The value above which the given part of the integral lies; none without positive values.
    fn value_above(&self, part: f64) -> Option<f64> {
        let all: f64 = self.0.values().sum();
        let mut above = 0.0;
        let reached = |(_, sum): &(&i32, &f64)| {
            above += *sum;
            above >= part * all
        };
        let (interval, _) = self.0.iter().rev().find(reached)?;
        Some(((f64::from(*interval) + 0.5) / PER_OCTAVE).exp2())
    }
}

/// Q in the region of the pictures.
pub struct Samples {
    histogram: Histogram,
    /// For every snapshot the cells of the region with their largest Q.
    largest: Vec<Vec<(usize, f64)>>,
}

/// Evaluates Q in the region at all snapshots. M = D + 2.
pub fn samples<const D: usize, const M: usize>(region: &PictureRegion, snapshots: &[Snapshot<D>]) -> Samples {
    let of_snapshot = |snapshot: &Snapshot<D>| -> Vec<(usize, f64, Histogram)> {
        let cells: Vec<usize> = region.cells(snapshot).collect();
        cells.into_par_iter().filter_map(|cell| of_cell::<D, M>(snapshot, cell, region.outer)).collect()
    };
    let mut histogram = Histogram::default();
    let mut largest = Vec::new();
    for snapshot in snapshots {
        let cells = of_snapshot(snapshot);
        cells.iter().for_each(|(.., of_cell)| histogram.join(of_cell));
        largest.push(cells.into_iter().map(|(cell, largest, _)| (cell, largest)).collect());
    }
    Samples { histogram, largest }
}

/// Q at the points of a cell within a box: the largest value and the integral, by the trapezoidal rule.
fn of_cell<const D: usize, const M: usize>(
    snapshot: &Snapshot<D>,
    cell: usize,
    outer: Cuboid,
) -> Option<(usize, f64, Histogram)> {
    let fineness = FINENESS.min(snapshot.fineness_of_order());
    let q = snapshot.q_criterion::<M>(cell, fineness)?;
    let (points, determinants) = (snapshot.points(cell, fineness), snapshot.determinants(cell, fineness));
    let (mut histogram, mut largest) = (Histogram::default(), f64::NEG_INFINITY);
    for p in (0..q.len()).filter(|&p| outer.contains(&in_space(&points[p]))) {
        histogram.add(q[p], determinants[p] * weight::<D>(p, PARTS[fineness]));
        largest = largest.max(q[p]);
    }
    Some((cell, largest, histogram))
}

/// The weight of a point of the trapezoidal rule with `parts` parts on [-1, 1]^D.
fn weight<const D: usize>(p: usize, parts: usize) -> f64 {
    let on_axis = |axis: usize| {
        let place = p / (parts + 1).pow(axis as u32) % (parts + 1);
        if place == 0 || place == parts { 1.0 / parts as f64 } else { 2.0 / parts as f64 }
    };
    (0..D).map(on_axis).product()
}

impl Samples {
    /// The level, with two digits; `None` if Q is zero up to round-off.
    pub fn level<const D: usize, const M: usize>(&self, snapshots: &[Snapshot<D>], domain: Cuboid) -> Option<f64> {
        let level = rounded(self.histogram.value_above(PART)?);
        let fastest = snapshots.iter().map(Snapshot::fastest_wave::<M>).fold(0.0, f64::max);
        (level > ROUND_OFF * (fastest / domain.length()).powi(2)).then_some(level)
    }

    /// Boxes around the parts of cells with Q above a level, at any time. M = D + 2.
    pub fn vortices<const D: usize, const M: usize>(&self, level: f64, snapshots: &[Snapshot<D>]) -> Vec<Cuboid> {
        let boxes = |(snapshot, cells): (&Snapshot<D>, &Vec<(usize, f64)>)| -> Vec<Cuboid> {
            let above: Vec<usize> =
                cells.iter().filter(|(_, largest)| *largest >= level).map(|(cell, _)| *cell).collect();
            above.into_par_iter().map(|cell| part_above::<D, M>(snapshot, cell, level)).collect()
        };
        snapshots.iter().zip(&self.largest).flat_map(boxes).collect()
    }
}

/// The box around the points of a cell with Q above a level, and half the way to the next ones.
fn part_above<const D: usize, const M: usize>(snapshot: &Snapshot<D>, cell: usize, level: f64) -> Cuboid {
    let fineness = FINENESS.min(snapshot.fineness_of_order());
    let q = snapshot.q_criterion::<M>(cell, fineness).unwrap_or_default();
    let points = snapshot.points(cell, fineness);
    let above = Cuboid::of(points.iter().zip(&q).filter(|(_, q)| **q >= level).map(|(x, _)| in_space(x)));
    above.grown([0.5 * Cuboid::of_cell(snapshot, cell).length() / PARTS[fineness] as f64; 3])
}

/// A number with two digits, as the page shows it.
fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q = 1 - r^2 in a ball: int_{r < R} Q dV ~ R^3/3 - R^5/5, and four fifths of 2/15 lie in R = 0.8067, above Q = 0.3492.
    #[test]
    fn most_of_the_positive_part_lies_above_the_level() {
        let mut histogram = Histogram::default();
        let shells = 10_000;
        for k in 0..2 * shells {
            let r = (f64::from(k) + 0.5) / f64::from(shells);
            histogram.add(1.0 - r * r, r * r);
        }
        // Empty space does not count.
        histogram.add(0.0, 1e9);
        histogram.add(f64::NAN, 1.0);
        let level = histogram.value_above(PART).unwrap_or(f64::NAN);
        let width = 2_f64.powf(1.0 / PER_OCTAVE);
        let exact = 0.3492;
        assert!(level > exact / width && level < exact * width, "{level}");
        assert_eq!(Histogram::default().value_above(PART), None);
    }

    #[test]
    fn the_weights_add_up_to_the_volume() {
        let sum: f64 = (0..125).map(|p| weight::<3>(p, 4)).sum();
        assert!((sum - 8.0).abs() < 1e-13);
        assert_eq!((rounded(0.012_345), rounded(9.99)), (0.012, 10.0));
    }
}
