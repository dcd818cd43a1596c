//! Times for reading, in messages.

/// A time without its last digits, which contain round-off.
pub fn rounded_time(time: f64) -> f64 {
    format!("{time:.11e}").parse().unwrap_or(time)
}

/// A slab may begin this part of its length beside an event that it should meet: cases are checked up to half of it.
const MEETS: f64 = 2e-6;

/// Whether `time`, the beginning of a slab, is before the `event`, by more than rounding. Most slabs have the length `step`.
pub fn is_before(time: f64, event: f64, step: f64) -> bool {
    event - time > MEETS * step + 4.0 * f64::EPSILON * event.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive that ended at t = 0 went on for a slab: the slab before ended at -1.1e-16, and the tolerance was a part of zero.
    #[test]
    fn a_slab_that_ends_beside_zero_has_reached_it() {
        let time = -0.9 + 0.3 * 3.0;
        assert!(time < 0.0 && !is_before(time, 0.0, 0.3));
        assert!(is_before(-0.3, 0.0, 0.3) && is_before(1e6, 1e6 + 1e-3, 1e-3) && !is_before(1e6 - 1e-10, 1e6, 1e-3));
    }

    #[test]
    fn times_are_told_without_round_off() {
        assert_eq!(
            [0.1 * 3.0, 125_f64.sqrt(), 0.0].map(|t| rounded_time(t).to_string()),
            ["0.3", "11.1803398875", "0"]
        );
    }
}
