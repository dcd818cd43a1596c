//! Axes of a chart: positions of values, and the labels of ticks.

use super::html::texts_on_scale;

/// An axis for values between `lower` and `upper`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The value at the first end.
    pub lower: f64,
    /// The value at the second end.
    pub upper: f64,
    /// The values with labels.
    pub ticks: Vec<f64>,
    first: f64,
    second: f64,
    logarithmic: bool,
}

/// The approximate number of ticks on an axis.
const TICKS: f64 = 5.0;

impl Axis {
    /// An axis from position `first` to `second` that shows `values` with a margin; `None` if there are no numbers.
    pub fn linear(values: impl Iterator<Item = f64>, first: f64, second: f64) -> Option<Self> {
        let (lower, upper) = extent(values)?;
        // A constant is drawn as a line in the middle; its last digits are not enlarged.
        let size = lower.abs().max(upper.abs());
        let constant = upper - lower <= 1e-5 * size;
        let margin = match size {
            0.0 => 1.0,
            size if constant => 0.1 * size,
            _ => 0.06 * (upper - lower),
        };
        let (lower, upper) = (lower - margin, upper + margin);
        Some(Axis { lower, upper, ticks: linear_ticks(lower, upper), first, second, logarithmic: false })
    }

    /// The same without a margin.
    pub fn linear_tight(values: impl Iterator<Item = f64>, first: f64, second: f64) -> Option<Self> {
        let (lower, upper) = extent(values)?;
        let upper = if upper > lower { upper } else { lower + lower.abs().max(1.0) };
        Some(Axis { lower, upper, ticks: linear_ticks(lower, upper), first, second, logarithmic: false })
    }

    /// A logarithmic axis, from one power of ten to another. Values that are not positive are not shown.
    pub fn logarithmic(values: impl Iterator<Item = f64>, first: f64, second: f64) -> Option<Self> {
        let (lower, upper) = extent(values.filter(|value| *value > 0.0))?;
        let lowest = lower.log10().floor() as i32;
        let highest = (upper.log10().ceil() as i32).max(lowest + 1);
        let stride = (f64::from(highest - lowest) / TICKS).ceil() as usize;
        let power = |exponent: i32| format!("1e{exponent}").parse().unwrap_or(f64::NAN);
        let ticks = (lowest..=highest).step_by(stride).map(power).collect();
        Some(Axis { lower: power(lowest), upper: power(highest), ticks, first, second, logarithmic: true })
    }

    /// The ticks with their labels.
    pub fn labels(&self) -> impl Iterator<Item = (f64, String)> {
        let power = |tick: &f64| if *tick == 1.0 { "1".into() } else { format!("{tick:e}").replace('-', "\u{2212}") };
        let labels = match self.logarithmic {
            true => self.ticks.iter().map(power).collect(),
            false => texts_on_scale(&self.ticks, 6),
        };
        self.ticks.iter().copied().zip(labels)
    }

    /// The position of a value.
    pub fn place(&self, value: f64) -> f64 {
        let part = if self.logarithmic {
            (value / self.lower).log10() / (self.upper / self.lower).log10()
        } else {
            (value - self.lower) / (self.upper - self.lower)
        };
        self.first + part * (self.second - self.first)
    }
}

/// The smallest and the largest of the finite values.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let extend = |extent: Option<(f64, f64)>, value: f64| {
        let (lower, upper) = extent.unwrap_or((value, value));
        Some((lower.min(value), upper.max(value)))
    };
    values.filter(|value| value.is_finite()).fold(None, extend)
}

/// Multiples of 1, 2 or 5 times a power of ten.
pub fn linear_ticks(lower: f64, upper: f64) -> Vec<f64> {
    let rough = (upper - lower) / TICKS;
    if !(rough.is_finite() && rough > 0.0) {
        return vec![lower];
    }
    let power = 10_f64.powi(rough.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough).unwrap_or(10.0 * power);
    let numbers = (lower / step - 1e-9).ceil() as i64..=(upper / step + 1e-9).floor() as i64;
    // From the decimal digits, so that 3 steps of 0.1 are 0.3.
    numbers.map(|n| format!("{:.10e}", n as f64 * step).parse().unwrap_or(f64::NAN)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(linear_ticks(0.0, 1.0), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(linear_ticks(-0.13, 0.41), [0.0, 0.2, 0.4]);
        assert_eq!(linear_ticks(99.9, 100.1), [99.9, 99.95, 100.0, 100.05, 100.1]);
        assert_eq!(linear_ticks(3.0, 3.0), [3.0]);
    }

    #[test]
    fn decades_are_equally_far_apart() {
        let axis = Axis::logarithmic([1e-9, 3e-2, 0.0, -1.0].into_iter(), 0.0, 8.0).unwrap();
        assert_eq!((axis.lower, axis.upper), (1e-9, 0.1));
        assert_eq!(axis.ticks, [1e-9, 1e-7, 1e-5, 1e-3, 1e-1]);
        let labels: Vec<String> = axis.labels().map(|(_, label)| label).collect();
        assert_eq!(labels, ["1e\u{2212}9", "1e\u{2212}7", "1e\u{2212}5", "1e\u{2212}3", "1e\u{2212}1"]);
        assert!((axis.place(1e-6) - 3.0).abs() < 1e-12 && axis.place(0.0).is_infinite());
    }

    #[test]
    fn a_constant_is_in_the_middle() {
        let axis = Axis::linear([2.0, 2.0, f64::NAN].into_iter(), 0.0, 10.0).unwrap();
        assert!((axis.place(2.0) - 5.0).abs() < 1e-6, "{axis:?}");
        let zero = Axis::linear([0.0].into_iter(), 0.0, 10.0).unwrap();
        assert_eq!((zero.lower, zero.upper), (-1.0, 1.0));
        assert!(Axis::linear([f64::NAN].into_iter(), 0.0, 1.0).is_none());
    }
}
