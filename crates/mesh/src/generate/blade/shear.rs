//! Coordinates in which the passage is straight.
//!
//! They are (x, Y) with Y = y - C(x), where C follows the flow through the passage:
//!
//! ```text
//! C(x) = c + m x + h w ln cosh((x - x_m) / w),    C' = m + h tanh((x - x_m) / w)                          (shear)
//! ```

use super::{BladeMesh, Point};

/// Y = y - C(x), see (shear).
pub(super) struct Shear {
    /// c, m, h, x_m, w.
    constant: f64,
    mean_slope: f64,
    half_change: f64,
    middle: f64,
    width: f64,
}

impl Shear {
    /// The slope of C changes from the inflow's to the outflow's over the blade. C passes through the mean of the
    /// blade's highest and lowest point at mid-chord.
    pub(super) fn new(mesh: &BladeMesh) -> Self {
        let samples = (0..1000).map(|k| mesh.profile.position(1e-3 * f64::from(k) * mesh.profile.length()));
        let points: Vec<[f64; 2]> = samples.collect();
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let [front, rear] = range(&mut points.iter().map(|x| x[0]));
        let (middle, width) = (0.5 * (front + rear), SHEAR_WIDTH * (rear - front));
        let [enters, leaves] = mesh.slopes;
        let (mean_slope, half_change) = (0.5 * (enters + leaves), 0.5 * (leaves - enters));
        let shear = Shear { constant: 0.0, mean_slope, half_change, middle, width };
        let [low, high] = range(&mut points.iter().map(|&x| shear.straightened(x)[1]));
        Shear { constant: 0.5 * (low + high), ..shear }
    }

    /// C(x)
    pub(super) fn line(&self, x: f64) -> f64 {
        let r = ((x - self.middle) / self.width).abs();
        // ln cosh r without overflow.
        let ln_cosh = r + (0.5 + 0.5 * (-2.0 * r).exp()).ln();
        self.constant + self.mean_slope * x + self.half_change * self.width * ln_cosh
    }

    /// (x, y) to (x, Y)
    pub(super) fn straightened(&self, [x, y]: Point) -> Point {
        [x, y - self.line(x)]
    }

    /// (x, Y) to (x, y)
    pub(super) fn bent(&self, [x, y]: Point) -> Point {
        [x, y + self.line(x)]
    }
}

/// w of (shear) as a fraction of the axial chord: C' reaches 90 % of its change at the ends of the blade.
const SHEAR_WIDTH: f64 = 0.34;
