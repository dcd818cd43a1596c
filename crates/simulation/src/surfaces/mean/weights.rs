//! The weights of the snapshots of a wall in a mean over time.

use super::PARTS;

/// w_k of every snapshot over the interval of the averages, and over each of [`PARTS`] parts of it.
pub(super) struct TimeWeights {
    pub(super) whole: Vec<f64>,
    /// None if there are fewer times than parts.
    pub(super) parts: Option<Vec<Vec<f64>>>,
}

impl TimeWeights {
    /// None if the interval has no time in common with that from the first to the last of the `times`.
    pub(super) fn new(times: &[f64], interval: [f64; 2]) -> Option<Self> {
        let (first, last) = (*times.first()?, *times.last()?);
        let (from, to) = (interval[0].max(first), interval[1].min(last));
        // Distributions at slab ends may miss a limit of the interval by round-off.
        let round_off = 1e-9 * (last - first);
        if to < from - round_off {
            return None;
        }
        let is_long = to - from > round_off;
        let at = |part: usize| from + (to - from) * part as f64 / PARTS as f64;
        let of_parts = || (0..PARTS).map(|part| hat_integrals(times, [at(part), at(part + 1)])).collect();
        let inside = times.iter().filter(|time| (from..=to).contains(*time)).count();
        // A single time has no length.
        let whole = if is_long { hat_integrals(times, [from, to]) } else { alone(times, from) };
        Some(TimeWeights { whole, parts: (is_long && inside >= PARTS).then(of_parts) })
    }
}

/// 1 for the first of the `times` that is nearest to `time`, 0 for the others.
fn alone(times: &[f64], time: f64) -> Vec<f64> {
    let distance = |k: usize| (times[k] - time).abs();
    let nearest = (0..times.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    (0..times.len()).map(|k| f64::from(u8::from(Some(k) == nearest))).collect()
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
