//! The derivative of every point function against central differences.

use super::*;
use tensor::Dual;

const STEP: f64 = 1e-5;
const SAMPLES: u64 = 40;

/// Changes the state alone (`geometry` = 0) or state and geometry (1).
fn differences<const D: usize, const M: usize>(
    conditions: &[Boundary<D>],
    p: &Point<f64, f64, D, M>,
    direction: &Point<f64, f64, D, M>,
    geometry: f64,
) -> Vec<(String, [f64; M])> {
    let at = |h: f64| evaluate(conditions, &p.zip(direction, |a, d| a + h * d, |a, d| a + geometry * h * d));
    let slope = |(plus, minus): ((String, [f64; M]), (String, [f64; M]))| {
        (plus.0, std::array::from_fn(|c| (plus.1[c] - minus.1[c]) / (2.0 * STEP)))
    };
    at(STEP).into_iter().zip(at(-STEP)).map(slope).collect()
}

fn compare<const M: usize>(duals: Vec<(String, [Dual<f64>; M])>, differences: Vec<(String, [f64; M])>) {
    for ((name, value), (_, expected)) in duals.into_iter().zip(differences) {
        let error = difference(&value.map(|v| v.derivative), &expected);
        assert!(error <= 1e-7, "{name}: {error:e}");
    }
}

fn in_state_and_geometry<const D: usize, const M: usize>() {
    let conditions = Conditions::<D>::sample().list();
    for seed in 0..SAMPLES {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let direction = Point::direction(&mut random);
        let duals = evaluate(&conditions, &p.zip(&direction, Dual::new, Dual::new));
        compare(duals, differences(&conditions, &p, &direction, 1.0));
    }
}

fn in_the_state_on_a_fixed_geometry<const D: usize, const M: usize>() {
    let conditions = Conditions::<D>::sample().list();
    for seed in 0..SAMPLES {
        let mut random = Random(seed);
        let p = Point::<f64, f64, D, M>::random(&mut random);
        let direction = Point::direction(&mut random);
        let duals = evaluate(&conditions, &p.zip(&direction, Dual::new, |g, _| g));
        compare(duals, differences(&conditions, &p, &direction, 0.0));
    }
}

/// Roe's flux where a wave speed relative to the facet is almost zero and its smoothing acts.
fn of_smoothed_wave_speeds<const D: usize, const M: usize>() {
    for seed in 0..SAMPLES {
        let mut random = Random(seed);
        let mut p = Point::<f64, f64, D, M>::random(&mut random);
        let velocity = Conserved::<f64, D>::unpack(&p.minus).velocity();
        p.plus = p.minus.map(|u| u * (1.0 + random.between(-1e-4, 1e-4)));
        p.v = velocity.map(|w| w + random.between(0.0, 5e-3));
        let direction = Point::direction(&mut random);
        let mut duals = evaluate(&[], &p.zip(&direction, Dual::new, Dual::new));
        let mut differences = differences(&[], &p, &direction, 1.0);
        duals.retain(|(name, _)| name == "Roe");
        differences.retain(|(name, _)| name == "Roe");
        assert_eq!((duals.len(), differences.len()), (1, 1));
        compare(duals, differences);
    }
}

in_both_dimensions!(in_state_and_geometry, in_the_state_on_a_fixed_geometry, of_smoothed_wave_speeds);
