//! Times for reading, in messages.

/// A time without its last digits, which contain round-off.
pub fn rounded_time(time: f64) -> f64 {
    format!("{time:.11e}").parse().unwrap_or(time)
}

/// Whether `time` is before the `event`, by more than rounding.
pub fn is_before(time: f64, event: f64) -> bool {
    event - time > 1e-9 * event.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_without_round_off() {
        assert_eq!(
            [0.1 * 3.0, 125_f64.sqrt(), 0.0].map(|t| rounded_time(t).to_string()),
            ["0.3", "11.1803398875", "0"]
        );
    }
}
