//! A built-in turbine blade.

use super::ClosedCurve;
use crate::MeshError;

/// Points of a spline fitted, by least squares of the distances, to the measured coordinates of the T106 low-pressure
/// turbine blade (R. D. Stieger, PhD thesis, Cambridge 2002, table I-2). The largest distance is 5e-4 chords. Chord 1,
/// x axial, y along the cascade; from the trailing edge over the suction side.
const T106: [[f64; 2]; 28] = [
    [0.84829, -0.49997],
    [0.85768, -0.49614],
    [0.85609, -0.48207],
    [0.80176, -0.34891],
    [0.74239, -0.21536],
    [0.67854, -0.09160],
    [0.60828, 0.01856],
    [0.53407, 0.10403],
    [0.45653, 0.16081],
    [0.36812, 0.19410],
    [0.27924, 0.20019],
    [0.19095, 0.17977],
    [0.10564, 0.13217],
    [0.01327, 0.03983],
    [0.00568, 0.02792],
    [0.00354, 0.00138],
    [0.01022, 0.00008],
    [0.02824, 0.00747],
    [0.13847, 0.06016],
    [0.23697, 0.07598],
    [0.33277, 0.06845],
    [0.43995, 0.03280],
    [0.52406, -0.01867],
    [0.60936, -0.09818],
    [0.68512, -0.19586],
    [0.75171, -0.30985],
    [0.81654, -0.44283],
    [0.83972, -0.49033],
];

/// A low-pressure turbine blade close to the T106, of chord 1; x is the axis of the turbine. In its cascade the pitch is
/// 0.798, the flow enters at +37.7 degrees and leaves at -63.2 degrees from the axis.
pub fn low_pressure_turbine_profile() -> Result<ClosedCurve, MeshError> {
    ClosedCurve::through(&T106)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::closed_curve::distance;
    use super::*;

    #[test]
    fn the_blade_has_its_chord_and_perimeter() {
        let curve = low_pressure_turbine_profile().unwrap();
        let x = (0..5000).map(|k| curve.position(2e-4 * f64::from(k) * curve.length())[0]);
        let [front, rear] = x.fold([1.0_f64, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
        assert!((rear - front - 170.0 / 198.0).abs() < 2e-3, "axial chord {}", rear - front);
        assert!((curve.length() - (264.7 + 230.0) / 198.0).abs() < 0.02, "{}", curve.length());
    }

    /// Compares with the table named by STSOLVE_T106_TABLE: lines of x and y, # for comments.
    #[test]
    #[allow(clippy::print_stderr)]
    fn the_blade_is_the_measured_one() {
        let Some(path) = std::env::var_os("STSOLVE_T106_TABLE") else {
            eprintln!("skipped: STSOLVE_T106_TABLE names no table of the blade's coordinates");
            return;
        };
        let table = std::fs::read_to_string(path).unwrap();
        let curve = low_pressure_turbine_profile().unwrap();
        let mut worst = 0.0_f64;
        for line in table.lines().filter(|line| !line.starts_with('#')) {
            let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
            worst = worst.max(distance(&curve, [numbers[0], numbers[1]]));
        }
        assert!(worst > 0.0 && worst < 5e-4, "{worst:e}");
    }
}
