//! The gas, its states, its stresses, its scales.

use super::*;
use crate::exact::{Vortex, Waves};
use tensor::Dual;

fn states_convert_back<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let primitive = random.primitive::<D>();
        let u: [f64; M] = primitive.pack(&gas());
        assert_eq!(Conserved::<f64, D>::unpack(&u).pack(), u);
        let back: [f64; M] = Primitive::<f64, D>::unpack(&gas(), &u).pack(&gas());
        assert!(difference(&back, &u) <= 1e-15);
        let pressure = Primitive::<f64, D>::unpack(&gas(), &u).pressure;
        assert!((pressure - primitive.pressure).abs() <= 1e-14);
    }
}

#[test]
fn of_air() {
    let viscosity = Viscosity::Sutherland { viscosity: 1.716e-5, temperature: 273.15, constant: 110.4 };
    let air = Gas::new(1.4, 287.05, 0.71, viscosity).unwrap();
    let (density, pressure) = (1.225, 101_325.0);
    let temperature = air.temperature(density, pressure);
    assert!((temperature - 288.15).abs() < 0.02);
    assert!((air.density(pressure, temperature) - density).abs() < 1e-12);
    assert!((air.sound_speed(density, pressure) - 340.29).abs() < 0.02);
    // U.S. Standard Atmosphere: 1.789e-5 Pa s at sea level.
    assert!((air.dynamic_viscosity(288.15_f64) - 1.789e-5).abs() < 0.005e-5);
}

/// A gas in rigid rotation at a uniform temperature has no viscous stress and conducts no heat.
fn rigid_rotation<const D: usize, const M: usize>() {
    let gas = gas();
    let state = |x: [Dual<f64>; D]| -> [Dual<f64>; M] {
        let mut velocity = [x[0].zero(); D];
        (velocity[0], velocity[1]) = (-x[1] + 0.3, x[0] - 0.2);
        let density = x[0] * x[1] + 2.0;
        Primitive { density, velocity, pressure: density * 1.7 }.pack(&gas)
    };
    let at = |axis: usize| state(std::array::from_fn(|i| Dual::new(0.4, if i == axis { 1.0 } else { 0.0 })));
    let gradient = std::array::from_fn(|i| at(i).map(|u| u.derivative));
    let flux = law::<D>(Riemann::Roe).viscous_flux(&at(0).map(|u| u.value), &gradient);
    assert!(flux.iter().flatten().all(|f| f.abs() <= 1e-15), "{flux:?}");
}

/// Plane shear w = (y, 0): tau_xy = mu; and dilation w = x: tau = mu (2 - 2 D / 3) I.
fn shear_and_dilation<const D: usize, const M: usize>() {
    let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Constant(0.3)).unwrap();
    let law = NavierStokes { gas, ..law::<D>(Riemann::Roe) };
    let u = Primitive { density: 2.0, velocity: [0.0; D], pressure: 1.0 }.pack::<M>(&gas);

    let mut shear = [[0.0; M]; D];
    shear[1][1] = 2.0; // d(rho w_x)/dy = rho
    let flux = law.viscous_flux(&u, &shear);
    assert!((flux[1][1] - 0.3).abs() <= 1e-15 && (flux[0][2] - 0.3).abs() <= 1e-15 && flux[0][1] == 0.0);

    let mut dilation = [[0.0; M]; D];
    for i in 0..D {
        dilation[i][1 + i] = 2.0;
    }
    let flux = law.viscous_flux(&u, &dilation);
    for i in 0..D {
        assert!((flux[i][1 + i] - 0.3 * (2.0 - 2.0 * D as f64 / 3.0)).abs() <= 1e-15);
    }
}

fn viscous_fluxes_are_linear_in_the_gradient<const D: usize, const M: usize>() {
    let mut random = Random(5);
    let (a, b) = (Point::<f64, f64, D, M>::random(&mut random), Point::<f64, f64, D, M>::random(&mut random));
    let sum = std::array::from_fn(|i| std::array::from_fn(|c| a.gradient[i][c] - 2.0 * b.gradient[i][c]));
    let law = law::<D>(Riemann::Roe);
    for condition in Conditions::<D>::sample().list() {
        let through = |gradient| law.boundary_viscous_flux(condition, &a.minus, gradient, at(&a.n, &a.v, &a.data));
        let (of_a, of_b) = (through(&a.gradient), through(&b.gradient));
        let expected = std::array::from_fn(|c| of_a[c] - 2.0 * of_b[c]);
        assert!(difference(&through(&sum), &expected) <= 1e-14, "{condition:?}");
    }
}

fn admissible_states<const D: usize, const M: usize>() {
    let law = law::<D>(Riemann::Roe);
    let good = Primitive { density: 1.0, velocity: [0.5; D], pressure: 0.25 }.pack::<M>(&law.gas);
    assert!((law.admissibility(&good) - 0.25).abs() <= 1e-15);
    assert_eq!(law.inadmissible(&good), None);
    let cases = [("density", 0, -1.0), ("density", 0, 0.0), ("density", 0, f64::NAN), ("pressure", M - 1, 0.1)];
    for (quantity, component, value) in cases {
        let mut bad = good;
        bad[component] = value;
        let admissibility = law.admissibility(&bad);
        assert!(admissibility.is_nan() || admissibility <= 0.0, "{quantity} {value}");
        assert_eq!(law.inadmissible(&bad).map(|(name, _)| name), Some(quantity));
    }
}

/// Mach number 0.2 with rho = U = 1: the scales that balance the Krylov norms of a heaving airfoil, 0.2, 1, 1, 12.5.
#[test]
fn acoustic_scales() {
    let gas = Gas::new(1.4, 1.0, 0.72, Viscosity::Constant(1e-3)).unwrap();
    let reference = Reference::new(&gas, 1.0, 1.0, 25.0 / 1.4).unwrap();
    let scales: [f64; 4] = reference.scales(&gas);
    assert!(difference(&scales, &[0.2, 1.0, 1.0, 12.5]) <= 1e-15);
    assert!((reference.mach() - 0.2).abs() <= 1e-15);
    assert!((reference.reynolds(&gas, 1.0) - 1000.0).abs() <= 1e-9);
}

/// Every error names the quantity and its value.
#[test]
fn bad_parameters() {
    let still = Primitive { density: 1.0, velocity: [1.0, 0.0], pressure: 1.0 };
    let errors = [
        Gas::new(1.0, 1.0, 1.0, Viscosity::Inviscid).unwrap_err(),
        Gas::new(1.4, -1.0, 1.0, Viscosity::Inviscid).unwrap_err(),
        Gas::new(1.4, 1.0, 0.0, Viscosity::Inviscid).unwrap_err(),
        Gas::new(1.4, 1.0, 1.0, Viscosity::Constant(f64::NAN)).unwrap_err(),
        Reference::new(&gas(), 1.0, 0.0, 1.0).unwrap_err(),
        FarField::new(Primitive { pressure: -1.0, ..still }).unwrap_err(),
        AdiabaticWall::new([f64::INFINITY, 0.0]).unwrap_err(),
        IsothermalWall::new(0.0, [0.0, 0.0]).unwrap_err(),
        Inflow::new(1.0, 1.0, [0.0, 0.0]).unwrap_err(),
        Outflow::<2>::new(-2.0, 1.0).unwrap_err(),
        Outflow::<2>::new(1.0, 0.0).unwrap_err(),
        Vortex::new(gas(), still, [0.0, 0.0], 1.0, 1e3, None).unwrap_err(),
        Waves::new(gas(), still, 1.0, 1.0).unwrap_err(),
    ];
    for error in errors {
        assert!(error.to_string().contains("must"), "{error}");
    }
    let message = Outflow::<2>::new(-2.0, 1.0).unwrap_err().to_string();
    assert_eq!(message, "the pressure of the outflow is -2, but it must be positive and finite");
}

in_both_dimensions!(
    states_convert_back,
    rigid_rotation,
    shear_and_dilation,
    viscous_fluxes_are_linear_in_the_gradient,
    admissible_states,
);
