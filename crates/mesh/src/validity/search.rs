//! Bisection of a box in space and time, the box with the lowest bound first.

use super::bernstein::{Direction, Enclosure, Polynomial};
use super::{Bound, SHARPNESS, SlabPoint, Validity};
use crate::lattice::Lattice;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The largest number of bisections before a cell counts as undecided.
const BISECTIONS: usize = 400;

/// The search for the minimum of f, or of f / g with g > 0.
pub(super) struct Search<const D: usize> {
    parts: BinaryHeap<Part>,
    sampled_min: f64,
    sampled_max: f64,
    /// The place of the smallest sampled value, in [-1, 1]^(D+1).
    at: Vec<f64>,
}

/// Part of the box [-1, 1]^(D+1).
struct Part {
    /// The proved lower bound in this part.
    lower: f64,
    /// The place of the lowest coefficient, which is a good place to sample.
    suspect: Vec<f64>,
    f: Polynomial,
    g: Option<Polynomial>,
    centre: Vec<f64>,
    half_width: Vec<f64>,
}

impl<const D: usize> Search<D> {
    /// Starts with the values on the grid and the polynomials of f and, if there is one, g.
    pub(super) fn new(directions: &[Direction], f: (Lattice, Polynomial), g: Option<(Lattice, Polynomial)>) -> Self {
        let ratio = |i: usize| f.0.values[i] / g.as_ref().map_or(1.0, |g| g.0.values[i]);
        let (mut lowest, mut sampled_max) = (0, f64::NEG_INFINITY);
        for i in 0..f.0.values.len() {
            sampled_max = sampled_max.max(ratio(i));
            // A NaN counts as lowest.
            if ratio(i).is_nan() || ratio(i) < ratio(lowest) {
                lowest = i;
            }
        }
        let at = f.0.digits(lowest).iter().zip(directions).map(|(&j, direction)| direction.points[j]).collect();
        let sampled_min = ratio(lowest);
        let whole = Part::new(directions, f.1, g.map(|g| g.1), vec![0.0; D + 1], vec![1.0; D + 1]);
        Search { parts: BinaryHeap::from([whole]), sampled_min, sampled_max, at }
    }

    /// The present bound.
    pub(super) fn bound(&self) -> Bound<D> {
        let lower = self.parts.peek().map_or(f64::NEG_INFINITY, |part| part.lower);
        let at = SlabPoint { xi: std::array::from_fn(|a| self.at[a]), s: 0.5 + 0.5 * self.at[D] };
        Bound { lower, sampled_min: self.sampled_min, sampled_max: self.sampled_max, at }
    }

    /// Bisects until the sign is decided and the bound is sharp; `elsewhere` is the smallest value sampled in other
    /// cells.
    pub(super) fn decide(mut self, directions: &[Direction], elsewhere: f64) -> Validity<D> {
        for _ in 0..BISECTIONS {
            match self.answer(SHARPNESS * self.sampled_min.min(elsewhere)) {
                Validity::Undecided(_) => self.bisect_lowest(directions),
                settled => return settled,
            }
        }
        self.answer(0.0)
    }

    /// The decision by the present bounds, if the lower one must reach `target`.
    fn answer(&self, target: f64) -> Validity<D> {
        let bound = self.bound();
        if bound.sampled_min.is_nan() || bound.sampled_min <= 0.0 {
            Validity::Invalid(bound)
        } else if bound.lower > 0.0 && bound.lower >= target {
            Validity::Valid(bound)
        } else {
            Validity::Undecided(bound)
        }
    }

    /// Halves the part with the lowest bound along the direction of largest curvature.
    fn bisect_lowest(&mut self, directions: &[Direction]) {
        let Some(part) = self.parts.pop() else { return };
        let axis = part.longest_axis(directions);
        for side in [0, 1] {
            let half = part.half(directions, axis, side);
            self.sample(&half);
            self.parts.push(half);
        }
    }

    fn sample(&mut self, part: &Part) {
        let value = part.value(&part.suspect);
        self.sampled_max = self.sampled_max.max(value);
        if value < self.sampled_min {
            self.sampled_min = value;
            self.at = (0..=D).map(|a| part.centre[a] + part.half_width[a] * part.suspect[a]).collect();
        }
    }
}

impl Part {
    fn new(
        directions: &[Direction],
        f: Polynomial,
        g: Option<Polynomial>,
        centre: Vec<f64>,
        half_width: Vec<f64>,
    ) -> Self {
        let enclosure = f.enclose(directions);
        let denominator = g.as_ref().map(|g| g.enclose(directions));
        let ratios = (0..enclosure.bernstein.values.len()).map(|i| lower_ratio(&enclosure, denominator.as_ref(), i));
        let (lowest, lower) = ratios.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NEG_INFINITY));
        // Coefficient i of degree q belongs to the point -1 + 2 i / q.
        let place = |(i, n): (usize, &usize)| if *n == 1 { 0.0 } else { 2.0 * i as f64 / (n - 1) as f64 - 1.0 };
        let digits = enclosure.bernstein.digits(lowest);
        let suspect = digits.into_iter().zip(&enclosure.bernstein.shape).map(place).collect();
        Part { lower, suspect, f, g, centre, half_width }
    }

    fn half(&self, directions: &[Direction], axis: usize, side: usize) -> Self {
        let (mut centre, mut half_width) = (self.centre.clone(), self.half_width.clone());
        half_width[axis] *= 0.5;
        centre[axis] += [-1.0, 1.0][side] * half_width[axis];
        let halved = |p: &Polynomial| p.half(directions, axis, side);
        Part::new(directions, halved(&self.f), self.g.as_ref().map(halved), centre, half_width)
    }

    /// The axis along which f and g together have the largest curvature; the first one among equals.
    fn longest_axis(&self, directions: &[Direction]) -> usize {
        let mut curvature = self.f.curvature(directions);
        if let Some(g) = &self.g {
            // f - r g is bounded, with the lowest ratio r.
            let g_curvature = g.curvature(directions);
            curvature.iter_mut().zip(g_curvature).for_each(|(f, g)| *f += self.lower.abs().min(1.0) * g);
        }
        (1..curvature.len()).fold(0, |best, axis| if curvature[axis] > curvature[best] { axis } else { best })
    }

    /// f or f / g at a point of this part, in its own coordinates.
    fn value(&self, x: &[f64]) -> f64 {
        self.f.value(x) / self.g.as_ref().map_or(1.0, |g| g.value(x))
    }
}

/// A number r_i such that f >= (min_i r_i) g on the box. Without a reference, r_i = b_i - margin. With g it is the smallest f over the
/// largest g if f is positive, otherwise over the smallest g. There is no bound if g is not proved positive.
fn lower_ratio(f: &Enclosure, g: Option<&Enclosure>, i: usize) -> f64 {
    let smallest = f.bernstein.values[i] - f.margin;
    let Some(g) = g else { return smallest };
    let (low, high) = (g.bernstein.values[i] - g.margin, g.bernstein.values[i] + g.margin);
    match (low > 0.0, smallest > 0.0) {
        (false, _) => f64::NEG_INFINITY,
        (true, true) => smallest / high,
        (true, false) => smallest / low,
    }
}

/// The part with the lowest bound is the greatest. Equal bounds are ordered by place, so the order never depends on the
/// heap.
impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_place = || self.centre.iter().map(|x| x.to_bits()).cmp(other.centre.iter().map(|x| x.to_bits()));
        other.lower.total_cmp(&self.lower).then_with(by_place)
    }
}
impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Part {}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(value: f64, margin: f64) -> Enclosure {
        Enclosure { bernstein: Lattice::new(vec![1], vec![value]), margin }
    }

    #[test]
    fn the_ratio_takes_the_worse_end_of_the_denominator() {
        let g = constant(1.0, 0.5);
        assert_eq!(lower_ratio(&constant(2.5, 0.25), None, 0), 2.25);
        assert_eq!(lower_ratio(&constant(2.5, 0.25), Some(&g), 0), 2.25 / 1.5);
        assert_eq!(lower_ratio(&constant(-2.0, 0.25), Some(&g), 0), -2.25 / 0.5);
        assert_eq!(lower_ratio(&constant(2.0, 0.0), Some(&constant(1.0, 1.0)), 0), f64::NEG_INFINITY);
    }
}
