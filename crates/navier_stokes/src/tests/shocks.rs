//! The artificial viscosity, and walls that resist the velocity through them.

use super::*;

/// A gas of density 1, pressure 1 and the velocity gradient w_1,1 alone, which is `rate`.
fn squeezed<const D: usize, const M: usize>(rate: f64) -> ([f64; M], [[f64; M]; D]) {
    let state = Primitive { density: 1.0, velocity: [0.0; D], pressure: 1.0 };
    let mut gradient = [[0.0; M]; D];
    gradient[0][1] = rate;
    (state.pack(&gas()), gradient)
}

/// Cells of equal sides with distances between nodes of 0.1.
fn fine<const D: usize>() -> [[f64; D]; D] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 10.0 } else { 0.0 }))
}

fn viscosity_of_compression_alone<const D: usize, const M: usize>() {
    let (law, c) = (law::<D>(Riemann::Roe), 1.4_f64.sqrt());
    let beta = |rate: f64| {
        let (u, gradient) = squeezed::<D, M>(rate);
        law.artificial_viscosity(&u, &gradient, &fine())
    };
    // The viscosity is zero below the threshold of 0.02 and in expansions.
    for rate in [5.0, 0.0, -0.19 * c] {
        assert_eq!(beta(rate), 0.0, "{rate}");
    }
    // s = 0.12 and q = 0.1.
    let expected = 2.0 * 0.1 * c * 0.1 * 0.1 / 0.12;
    assert!((beta(-1.2 * c) / expected - 1.0).abs() < 1e-12);
}

/// The spacing is the one in the direction in which the density changes.
fn viscosity_of_flat_cells<const D: usize, const M: usize>() {
    let law = law::<D>(Riemann::Roe);
    let mut grid = fine::<D>();
    grid[1][1] = 1000.0;
    let of = |direction: usize| {
        let (u, mut gradient) = squeezed::<D, M>(-5.0);
        gradient[direction][0] = 1e6;
        law.artificial_viscosity(&u, &gradient, &grid)
    };
    assert!(of(0) > 0.0);
    let (u, mut gradient) = squeezed::<D, M>(-5.0);
    gradient[0][0] = 1e6;
    let coarse = law.artificial_viscosity(&u, &gradient, &fine());
    assert!((of(0) / coarse - 1.0).abs() < 1e-3);
    assert_eq!(of(1), 0.0);
}

/// F_a carries no mass, and produces entropy: w_k,k^2 and T_,i^2 with positive factors.
fn entropy_grows<const D: usize, const M: usize>() {
    let law = law::<D>(Riemann::Roe);
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let flux = law.artificial_flux(&p.minus, &p.gradient, 0.3);
        // Entropy variables by differences of eta = - rho ln(p / rho^gamma) / (gamma - 1).
        let gas = gas();
        let eta = |u: &[f64; M]| {
            let state = Primitive::<f64, D>::unpack(&gas, u);
            -state.density * (state.pressure / state.density.powf(1.4)).ln() / 0.4
        };
        let variable = |u: &[f64; M], m: usize| {
            let (mut ahead, mut behind) = (*u, *u);
            ahead[m] += 1e-4;
            behind[m] -= 1e-4;
            (eta(&ahead) - eta(&behind)) / 2e-4
        };
        let mut production = 0.0;
        for i in 0..D {
            assert_eq!(flux[i][0], 0.0);
            let along = |h: f64| -> [f64; M] { std::array::from_fn(|m| p.minus[m] + h * p.gradient[i][m]) };
            for m in 0..M {
                production += flux[i][m] * (variable(&along(1e-4), m) - variable(&along(-1e-4), m)) / 2e-4;
            }
        }
        assert!(production > -1e-4, "{seed}: {production:e}");
    }
}

/// The pressure on the wall is that behind the shock or the expansion which brings the gas to rest.
fn mirrored_walls<const D: usize, const M: usize>() {
    let (gas, law) = (gas(), NavierStokes { wall_flux: WallFlux::Mirrored, ..law::<D>(Riemann::Roe) });
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let state = Primitive::<f64, D>::unpack(&gas, &p.minus);
        let into = dot(&state.velocity, &p.n) - dot(&p.v, &p.n);
        let flux = law.impose(Boundary::SlipWall(SlipWall), &p.minus, at(&p.n, &p.v, &p.data)).flux;
        let force = Conserved::<f64, D>::unpack(&flux).momentum;
        let ratio = dot(&force, &p.n) / state.pressure;
        let c = gas.sound_speed(state.density, state.pressure);
        let expected = if ratio > 1.0 {
            // u / c = (r - 1) (2 / (gamma ((gamma + 1) r + gamma - 1)))^1/2, Rankine-Hugoniot.
            (ratio - 1.0) * (2.0 / (1.4 * (2.4 * ratio + 0.4))).sqrt()
        } else {
            5.0 * (ratio.powf(1.0 / 7.0) - 1.0)
        };
        assert!((into / c - expected).abs() < 1e-12, "{seed}: {} for {expected}", into / c);
        assert_eq!(flux[0], 0.0);
        assert!((flux[M - 1] - dot(&force, &p.v)).abs() < 1e-14 * (1.0 + flux[M - 1].abs()));
    }
}

in_both_dimensions!(viscosity_of_compression_alone, viscosity_of_flat_cells, entropy_grows, mirrored_walls);
