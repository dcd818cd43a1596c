//! The parts of a slab between the limits of averages.

use case::{Averages, Phases};

/// A part of a slab that lies in one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The phase, from 0.
    pub phase: usize,
    /// Its start.
    pub start: f64,
    /// Its end.
    pub end: f64,
}

/// The parts of the slab from `start` to `end` that are averaged, in the order of time.
pub fn parts(wanted: &Averages, start: f64, end: f64) -> Vec<Part> {
    let round_off = Averages::ROUND_OFF * (end - start);
    let (start, end) = (start.max(wanted.from), wanted.to.map_or(end, |to| end.min(to)));
    match wanted.phases {
        _ if end - start <= round_off => Vec::new(),
        None => vec![Part { phase: 0, start, end }],
        Some(phases) => by_phase(phases, wanted.from, [start, end], round_off),
    }
}

/// The parts from `start` to `end` by phases, none of them shorter than `round_off`.
fn by_phase(Phases { period, count }: Phases, from: f64, [start, end]: [f64; 2], round_off: f64) -> Vec<Part> {
    let length = period / count as f64;
    let (mut parts, mut begin, mut number) = (Vec::new(), start, ((start - from) / length).floor().max(0.0) as usize);
    while begin < end {
        let limit = from + (number + 1) as f64 * length;
        let limit = if end - limit <= round_off { end } else { limit };
        // Round-off may put the start before or behind the limit of its phase.
        if limit - begin > round_off {
            parts.push(Part { phase: number % count, start: begin, end: limit });
            begin = limit;
        }
        number += 1;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use case::Average;

    fn averages(to: Option<f64>, phases: Option<Phases>) -> Averages {
        Averages { from: 1.0, to, phases, along: Vec::new(), fields: vec![Average::Pressure] }
    }

    #[test]
    fn a_slab_is_cut_at_the_start_and_at_the_end() {
        let wanted = averages(Some(2.0), None);
        assert_eq!(parts(&wanted, 0.0, 1.0), []);
        assert_eq!(parts(&wanted, 0.5, 1.5), [Part { phase: 0, start: 1.0, end: 1.5 }]);
        assert_eq!(parts(&wanted, 1.5, 2.5), [Part { phase: 0, start: 1.5, end: 2.0 }]);
        assert_eq!(parts(&wanted, 2.0, 3.0), []);
        // These were averages over 1e-16, without a warning.
        assert_eq!(parts(&wanted, 0.5, 1.0 + 1e-15), []);
    }

    #[test]
    fn a_slab_is_cut_at_every_limit_of_a_phase() {
        let wanted = averages(None, Some(Phases { period: 1.0, count: 4 }));
        let cut = |start: f64, end: f64| {
            parts(&wanted, start, end).iter().map(|part| (part.phase, part.start, part.end)).collect::<Vec<_>>()
        };
        assert_eq!(cut(0.9, 1.6), [(0, 1.0, 1.25), (1, 1.25, 1.5), (2, 1.5, 1.6)]);
        assert_eq!(cut(1.75, 2.25), [(3, 1.75, 2.0), (0, 2.0, 2.25)]);
        // Phases that are reached by round-off alone had averages over 1e-16.
        assert_eq!(cut(1.1, 1.25 + 1e-15), [(0, 1.1, 1.25 + 1e-15)]);
        assert_eq!(cut(1.25 - 1e-15, 1.4), [(1, 1.25 - 1e-15, 1.4)]);
    }

    /// Whatever the lengths, the parts of all slabs together are the whole time, and every phase has its share.
    #[test]
    fn nothing_is_lost_between_slabs() {
        let wanted = averages(None, Some(Phases { period: 0.7, count: 3 }));
        let mut durations = [0.0; 3];
        for slab in 0..90 {
            let parts = parts(&wanted, 0.07 * f64::from(slab), 0.07 * f64::from(slab + 1));
            parts.iter().for_each(|part| durations[part.phase] += part.end - part.start);
        }
        let whole: f64 = durations.iter().sum();
        assert!((whole - 5.3).abs() < 1e-12, "{whole}");
        // Seven periods and 0.4 of the next one.
        for (found, exact) in
            durations.iter().zip([8.0 * 0.7 / 3.0, 7.0 * 0.7 / 3.0 + 0.4 - 0.7 / 3.0, 7.0 * 0.7 / 3.0])
        {
            assert!((found - exact).abs() < 1e-12, "{found} {exact}");
        }
    }
}
