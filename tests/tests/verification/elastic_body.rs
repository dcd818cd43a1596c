//! A gas and an elastic bar that move each other.

use elasticity::{Damping, Law};
use navier_stokes::{Boundary, Compiled, NavierStokes};
use newton_krylov::problem::NonlinearProblem;
use verification::strip::{PRESSURE, Strip, coupled_energy};
use verification::{Noise, relative_difference};

/// A wave in the bar that is at x at t = 0.
fn pulse(x: f64) -> f64 {
    0.05 * (-((x + 1.0) / 0.18).powi(2)).exp()
}

/// V by (elastic piston) of `strip`.
fn piston_velocity(impedance: f64, wave: f64) -> f64 {
    let f = |v: f64| impedance * (2.0 * wave - v) - PRESSURE * ((1.0 + 0.2 * v).powi(7) - 1.0);
    let (mut low, mut high) = (0.0, 2.0 * wave);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// A soft bar in few cells.
fn soft(law: Law) -> Strip {
    Strip {
        order: 4,
        time_order: 2,
        cells: [3, 3],
        lengths: [1.0, 2.0],
        law,
        damping: Damping { mass: 0.3, stiffness: 0.02 },
        impedance: 2.0,
        wave_speed: 1.0,
        end: 0.2,
        slabs: 1,
    }
}

#[test]
fn derivatives_of_gas_and_bar_match_differences() {
    for law in [Law::Linear, Law::StVenantKirchhoff, Law::NeoHookean] {
        derivatives_match_differences::<2, 4>(&soft(law));
        derivatives_match_differences::<3, 5>(&Strip { order: 3, cells: [2, 2], ..soft(law) });
    }
}

fn derivatives_match_differences<const D: usize, const M: usize>(strip: &Strip)
where
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let mut march = strip.march::<D, M>(|_| 0.0, |x| 0.1 * x);
    let interval = coupled::Interval { start: 0.0, end: 0.2, halvings: 0 };
    let state = march.state.clone();
    let (mut z, _) = march.solver.guess(&state, interval).unwrap();
    let (system, mut noise) = (&mut march.solver.system, Noise::new(5));
    z.iter_mut().for_each(|z| *z += 0.01 * noise.number());
    let (flow, direction) = (system.flow_range(), noise.vector(z.len(), 1.0));
    let fields = system.fields().len();
    system.linearise(&z, &vec![0.0; fields]).unwrap();
    let mut product = vec![0.0; z.len()];
    system.jacobian_product(&direction, &mut product);
    let mut at = |a: f64| {
        let mut r = vec![0.0; z.len()];
        let moved: Vec<f64> = z.iter().zip(&direction).map(|(z, x)| z + a * x).collect();
        system.residual(&moved, &mut r).unwrap();
        r
    };
    let (plus, minus) = (at(1e-5), at(-1e-5));
    let difference: Vec<f64> = plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / 2e-5).collect();
    for range in [0..flow.start, flow] {
        let error = relative_difference(&product[range.clone()], &difference[range.clone()]);
        assert!(error <= 1e-7, "{D}-D, {:?}, entries {range:?}: {error:e}", strip.law);
    }
}

/// A bar of large strain that is damped hits the gas: nothing of the energy is lost track of.
#[test]
fn gas_and_a_rubber_bar_keep_their_energy() {
    let strip = Strip { order: 5, time_order: 3, end: 0.8, slabs: 8, ..soft(Law::NeoHookean) };
    let mut march = strip.march(|_| 0.0, |x| 0.3 * (1.0 - (1.0 + x).powi(4)));
    let (start, mut largest) = (coupled_energy(&march), 0.0_f64);
    while !march.is_done() {
        march.advance().unwrap();
        largest = largest.max((coupled_energy(&march) - start).abs());
    }
    let ledger = march.bodies()[0].ledger;
    println!("energy {:.2e}, {ledger:?}", largest / start);
    assert!(ledger.damped > 1e-4 * start && ledger.flow < -1e-3 * start, "{ledger:?}");
    assert!(largest <= 1e-11 * start, "{:e}", largest / start);
}

/// The wave in the bar meets the gas: the velocity of the interface is exact, and gas and bar keep their energy in every slab.
#[test]
fn an_elastic_piston_has_the_exact_velocity() {
    let strip = Strip {
        order: 8,
        time_order: 4,
        cells: [10, 14],
        lengths: [1.2, 2.1],
        law: Law::Linear,
        damping: Damping::default(),
        impedance: 10.0,
        wave_speed: 1.0,
        end: 1.0,
        slabs: 40,
    };
    // f'(t - x): the wave comes to x = 0 at t = 1, and compresses on its way.
    let displacement = |x: f64| integral_of_pulse(0.0) - integral_of_pulse(x);
    let mut march = strip.march(displacement, pulse);
    let (start, mut largest, mut iterations) = (coupled_energy(&march), 0.0_f64, 0);
    while !march.is_done() {
        let report = march.advance().unwrap();
        largest = largest.max((coupled_energy(&march) - start).abs());
        iterations += report.newton.krylov_iterations;
    }
    let exact = piston_velocity(10.0, 0.05);
    let error = strip.interface_velocity(&march) - exact;
    println!("V = {exact:.12} + {error:.2e}, energy {:.2e}, {iterations} iterations", largest / start);
    assert!((exact - 0.09044915185).abs() < 1e-11);
    assert!(error.abs() <= 1e-6, "{error:e}");
    assert!(largest <= 1e-11 * start, "{:e}", largest / start);
}

/// The integral of the pulse from x = -2 to x.
fn integral_of_pulse(x: f64) -> f64 {
    let (rule, panels) = (basis::gauss(12), 40);
    let half = 0.5 * (x + 2.0) / panels as f64;
    let centre = |panel: usize| -2.0 + half * (2 * panel + 1) as f64;
    let points = (0..panels).flat_map(|panel| rule.points.iter().map(move |xi| centre(panel) + half * xi));
    points.zip(rule.weights.iter().cycle()).map(|(x, weight)| half * weight * pulse(x)).sum()
}
