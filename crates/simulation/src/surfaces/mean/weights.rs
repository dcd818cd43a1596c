//! The weights of the snapshots of a wall in a mean over time.

use super::PARTS;

/// w_k of every snapshot over the interval of the averages, and over each of [`PARTS`] parts of it.
pub(super) struct TimeWeights {
    pub(super) whole: Vec<f64>,
    /// None if there are fewer times than parts.
    pub(super) parts: Option<Vec<Vec<f64>>>,
}

impl TimeWeights {
    /// None if the interval and that from the first to the last of the `times` have nothing in common but one time.
    pub(super) fn new(times: &[f64], interval: [f64; 2]) -> Option<Self> {
        let (first, last) = (*times.first()?, *times.last()?);
        let (from, to) = (interval[0].max(first), interval[1].min(last));
        // Distributions at slab ends may miss a limit of the interval by round-off.
        let round_off = 1e-9 * (last - first);
        if to - from <= round_off {
            return None;
        }
        let at = |part: usize| from + (to - from) * part as f64 / PARTS as f64;
        let of_parts = || (0..PARTS).map(|part| hat_integrals(times, [at(part), at(part + 1)])).collect();
        let inside = times.iter().filter(|time| (from..=to).contains(*time)).count();
        Some(TimeWeights { whole: hat_integrals(times, [from, to]), parts: (inside >= PARTS).then(of_parts) })
    }
}

/// The integral of h_k from `from` to `to`, for every one of the `times`.
fn hat_integrals(times: &[f64], [from, to]: [f64; 2]) -> Vec<f64> {
    let mut integrals = vec![0.0; times.len()];
    for (k, pair) in times.windows(2).enumerate().filter(|(_, pair)| pair[1] > pair[0]) {
        let length = pair[1] - pair[0];
        let [a, b] = [from, to].map(|t| ((t - pair[0]) / length).clamp(0.0, 1.0));
        // int s ds, where s goes from 0 at the first time to 1 at the second.
        let rising = 0.5 * (b - a) * (a + b);
        integrals[k] += length * (b - a - rising);
        integrals[k + 1] += length * rising;
    }
    integrals
}
