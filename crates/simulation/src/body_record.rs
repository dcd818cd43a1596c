//! Amplitudes, frequencies and energies of the bodies of a run so far.

use coupled::block::BodyState;

/// Turning points that are kept of a coordinate: ten periods.
const KEPT: usize = 21;

/// A coordinate rests if its rate takes it so little of its range in a slab. A motion that dwells turns at the end of the rest.
const REST: f64 = 1e-10;

/// The motion of one coordinate so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Oscillation {
    /// Time, value and rate at the end of the last slab; the least and the largest value at the ends of slabs. While the coordinate rests, the
    /// rate is tiny and has the sign of its last motion.
    last: Option<[f64; 5]>,
    /// Times and values of the last turning points.
    turns: Vec<[f64; 2]>,
}

impl Oscillation {
    /// Adds the value `q` and the rate `w` at the time `t`.
    fn add(&mut self, t: f64, q: f64, w: f64) {
        let (mut low, mut high) = (q, q);
        if let Some([t0, q0, w0, least, largest]) = self.last {
            (low, high) = (least.min(q), largest.max(q));
            if (w * (t - t0)).abs() <= REST * (high - low) {
                self.last = Some([t, q, if w0 == 0.0 { 0.0 } else { f64::MIN_POSITIVE.copysign(w0) }, low, high]);
                return;
            }
            if w0 < 0.0 && w > 0.0 || w0 > 0.0 && w < 0.0 {
                if self.turns.len() == KEPT {
                    self.turns.remove(0);
                }
                self.turns.push(turning_point([t0, q0, w0], [t, q, w]));
            }
        }
        self.last = Some([t, q, w, low, high]);
    }

    /// The distance of the least and the largest value.
    pub fn range(&self) -> f64 {
        self.last.map_or(0.0, |[.., low, high]| high - low)
    }

    /// Amplitude and frequency. A way of at most `least` between two turning points is rounding.
    pub fn figures(&self, least: f64) -> output::Oscillation {
        let turns = self.turns_beyond(least);
        output::Oscillation { amplitude: amplitude(&turns), frequency: frequency(&turns) }
    }

    /// The turning points without pairs that are at most `least` apart: the coordinate goes on in its direction after them.
    fn turns_beyond(&self, least: f64) -> Vec<[f64; 2]> {
        let mut turns: Vec<[f64; 2]> = Vec::new();
        for turn in &self.turns {
            match turns.last() {
                Some(before) if (turn[1] - before[1]).abs() <= least => {
                    turns.pop();
                }
                _ => turns.push(*turn),
            }
        }
        turns
    }

    fn numbers(&self) -> Vec<f64> {
        let last = self.last.map_or(Vec::new(), |last| last.to_vec());
        [vec![self.turns.len() as f64, last.len() as f64], last, self.turns.concat()].concat()
    }
}

/// Half of the distance between the means of upper and lower turning points; none before there are two.
fn amplitude(turns: &[[f64; 2]]) -> Option<f64> {
    let steps: Vec<f64> = turns.windows(2).map(|pair| (pair[1][1] - pair[0][1]).abs()).collect();
    (!steps.is_empty()).then(|| 0.5 * steps.iter().sum::<f64>() / steps.len() as f64)
}

/// Periods per time, between turning points of the same kind: the ways up and down may take different times. None before there are three
/// turning points.
fn frequency(turns: &[[f64; 2]]) -> Option<f64> {
    let periods = turns.len().checked_sub(1)? / 2;
    let (first, last) = (turns[turns.len() - 1 - 2 * periods], turns[turns.len() - 1]);
    (periods > 0).then(|| periods as f64 / (last[0] - first[0]))
}

/// Time and value where the cubic through two values and rates turns.
fn turning_point([t0, q0, w0]: [f64; 3], [t1, q1, w1]: [f64; 3]) -> [f64; 2] {
    let dt = t1 - t0;
    // q(s) = q0 + w0 dt s + a s^2 + b s^3
    let (a, b) = (3.0 * (q1 - q0) - (2.0 * w0 + w1) * dt, (w0 + w1) * dt - 2.0 * (q1 - q0));
    let (value, slope) =
        (|s: f64| q0 + s * (w0 * dt + s * (a + s * b)), |s: f64| w0 * dt + s * (2.0 * a + 3.0 * s * b));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) * w0 > 0.0 { low = middle } else { high = middle }
    }
    [t0 + low * dt, value(low)]
}

/// What a body has done so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyRecord {
    /// Kinetic and potential energy at the start.
    pub energy_at_start: f64,
    /// Each coordinate.
    pub coordinates: Vec<Oscillation>,
}

impl BodyRecord {
    /// A body at the start of a run, at the time `t`.
    pub fn start(state: &BodyState, t: f64) -> Self {
        let energy_at_start = state.energy();
        let mut record =
            BodyRecord { energy_at_start, coordinates: vec![Oscillation::default(); state.position.len()] };
        record.add(state, t);
        record
    }

    /// Adds the state at the end of a slab, the time `t`.
    pub fn add(&mut self, state: &BodyState, t: f64) {
        for (coordinate, (q, w)) in self.coordinates.iter_mut().zip(state.position.iter().zip(&state.rate)) {
            coordinate.add(t, *q, *w);
        }
    }

    /// Keeps the coordinates of observed points, D of each: for every point of a run its place among those so far, or none for a new one.
    pub fn keep<const D: usize>(&mut self, places: &[Option<usize>]) {
        let so_far = |place: &Option<usize>| place.and_then(|place| self.coordinates.get(place * D..(place + 1) * D));
        let kept =
            places.iter().map(|place| so_far(place).map_or_else(|| vec![Oscillation::default(); D], <[_]>::to_vec));
        self.coordinates = kept.flatten().collect();
    }

    /// The energy of the body in excess of its ledger, without the work of the flow.
    pub fn gained(&self, state: &BodyState) -> f64 {
        let ledger = &state.ledger;
        let energy = state.energy() - self.energy_at_start;
        energy - ledger.force - ledger.drive + ledger.damped + ledger.numerical
    }

    /// As numbers.
    pub fn numbers(&self) -> Vec<f64> {
        let coordinates = self.coordinates.iter().flat_map(Oscillation::numbers);
        [self.energy_at_start, self.coordinates.len() as f64].into_iter().chain(coordinates).collect()
    }

    /// Records back from the numbers of all bodies, one after the other; none if they do not fit.
    pub fn read_all(numbers: &[f64]) -> Option<Vec<Self>> {
        let (mut rest, mut records) = (numbers, Vec::new());
        while !rest.is_empty() {
            let ([energy_at_start, count], after) = rest.split_first_chunk::<2>()?;
            rest = after;
            let mut coordinates = Vec::new();
            for _ in 0..*count as usize {
                let ([turns, last], after) = rest.split_first_chunk::<2>()?;
                let (last, after) = after.split_at_checked(*last as usize)?;
                let (turns, after) = after.split_at_checked(2 * *turns as usize)?;
                rest = after;
                coordinates.push(Oscillation { last: last.try_into().ok(), turns: turns.as_chunks().0.to_vec() });
            }
            records.push(BodyRecord { energy_at_start: *energy_at_start, coordinates });
        }
        Some(records)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn amplitude_and_frequency_of_a_sine_are_found() {
        let mut record = BodyRecord { energy_at_start: 2.0, coordinates: vec![Oscillation::default(); 2] };
        for k in 0..200 {
            let t = 0.05 * f64::from(k);
            let state = BodyState {
                position: vec![0.3 + 0.7 * (3.0 * t).sin(), t],
                rate: vec![2.1 * (3.0 * t).cos(), 1.0],
                ..BodyState::default()
            };
            record.add(&state, t);
        }
        let [sine, line] = &record.coordinates[..] else { panic!("two coordinates") };
        let figures = sine.figures(0.0);
        assert!((figures.amplitude.unwrap() - 0.7).abs() < 1e-5, "{figures:?}");
        assert!((figures.frequency.unwrap() - 1.5 / std::f64::consts::PI).abs() < 1e-4, "{figures:?}");
        assert_eq!(line.figures(0.0), output::Oscillation::default());
        assert!((sine.range() - 1.4).abs() < 1e-2 && (line.range() - 9.95).abs() < 1e-12);
        let both = [record.numbers(), record.numbers()].concat();
        assert_eq!(BodyRecord::read_all(&both).unwrap(), [record.clone(), record]);
        assert_eq!(BodyRecord::read_all(&both[..both.len() - 1]), None);
    }

    /// The ways up and down take different times; half periods were counted, so that the frequency was up to 2 % off for ever.
    #[test]
    fn the_frequency_is_that_of_whole_periods() {
        use std::f64::consts::TAU;
        let mut coordinate = Oscillation::default();
        for k in 0..250 {
            let t = 0.05 * f64::from(k);
            let q = (TAU * t).sin() + 0.3 * (2.0 * TAU * t).sin();
            let w = TAU * ((TAU * t).cos() + 0.6 * (2.0 * TAU * t).cos());
            coordinate.add(t, q, w);
            let frequency = coordinate.figures(0.0).frequency;
            assert!(frequency.is_none_or(|frequency| (frequency - 1.0).abs() < 1e-6), "{frequency:?} at {t}");
        }
    }

    /// Up within 1, at rest for 1, down within 1, at rest for 1: where the rate was zero the turn was lost, or found where rounding changed its sign.
    #[test]
    fn a_motion_that_dwells_has_its_period() {
        let rise = |t: f64| {
            if t <= 0.0 {
                [0.0, 0.0]
            } else if t >= 1.0 {
                [1.0, 0.0]
            } else {
                [t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)]
            }
        };
        for (step, rounding) in [(0.05, 0.0), (0.04, 1e-31), (0.0625, 0.0), (0.1, 1e-17)] {
            let mut coordinate = Oscillation::default();
            for k in 0..=(16.0_f64 / step).round() as usize {
                let (t, noise) = (step * k as f64, if k % 3 == 0 { rounding } else { -rounding });
                let (mut q, mut w) = (0.0, noise);
                for turn in 0..8 {
                    let ([height, rate], sign) =
                        (rise(t - 2.0 * f64::from(turn)), if turn % 2 == 0 { 0.1 } else { -0.1 });
                    (q, w) = (q + sign * height, w + sign * rate);
                }
                coordinate.add(t, q, w);
            }
            let output::Oscillation { amplitude, frequency } = coordinate.figures(0.0);
            assert!((frequency.unwrap() - 0.25).abs() < 1e-3, "{frequency:?} by steps of {step}");
            assert!((amplitude.unwrap() - 0.05).abs() < 1e-6, "{amplitude:?} by steps of {step}");
        }
    }

    /// A coordinate that rests up to rounding before it moves counted the turns of rounding.
    #[test]
    fn turns_of_rounding_are_none() {
        let mut coordinate = Oscillation::default();
        (0..9).for_each(|k| coordinate.add(f64::from(k), 0.0, if k % 2 == 0 { 1e-20 } else { -1e-20 }));
        (0..9).for_each(|k| coordinate.add(9.0 + f64::from(k), f64::from(k), 1.0));
        assert!(coordinate.figures(0.0).amplitude.is_none_or(|amplitude| amplitude < 1e-19));
        assert_eq!(coordinate.figures(8e-10), output::Oscillation::default());
    }

    /// Coordinates of observed points went by their number to other points.
    #[test]
    fn points_keep_their_own_record() {
        let at = |q: f64| Oscillation { last: Some([1.0, q, 0.0, q, q]), ..Oscillation::default() };
        let mut record = BodyRecord { energy_at_start: 2.0, coordinates: [1.0, 2.0, 3.0, 4.0].map(at).to_vec() };
        record.keep::<2>(&[None, Some(1)]);
        assert_eq!(record.coordinates, [Oscillation::default(), Oscillation::default(), at(3.0), at(4.0)]);
    }
}
