//! Inflow and outflow: the gas that enters, the gas that leaves, and the continuity of the flux between both.

use super::consistency::normal_flux;
use super::*;

const P_0: f64 = 2.0;
const T_0: f64 = 2.5;

/// The gas that crosses a facet at rest with the normal along -x (inflow) or x (outflow), computed from its flux.
struct Crossing {
    pressure: f64,
    velocity: [f64; 2],
    density: f64,
}

impl Crossing {
    /// From a flux [m, m w_x + p n_x, m w_y, ..., m H] whose pressure follows from H and the velocity.
    fn new<const M: usize>(flux: &[f64; M], n_x: f64) -> Self {
        let gas = gas();
        let (mass, w_y) = (flux[0], flux[2] / flux[0]);
        let enthalpy = flux[M - 1] / mass;
        let others: f64 = (3..M - 1).map(|i| (flux[i] / mass).powi(2)).sum();
        // p = rho R T, rho = m / (w_x n_x), c_p T = H - w^2 / 2: a quadratic equation for w_x, with the subsonic root.
        let push = flux[1] / mass;
        let ratio = (gas.gamma() - 1.0) / gas.gamma();
        let still = enthalpy - 0.5 * (w_y * w_y + others);
        // w_x + ratio (still - w_x^2 / 2) / w_x = push
        let (a, b, c) = (1.0 - 0.5 * ratio, -push, ratio * still);
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
        let w_x = if roots[0].abs() < roots[1].abs() { roots[0] } else { roots[1] };
        let density = mass / (w_x * n_x);
        Crossing { pressure: (flux[1] - mass * w_x) / n_x, velocity: [w_x, w_y], density }
    }

    fn entropy(&self) -> f64 {
        self.pressure / self.density.powf(gas().gamma())
    }

    fn mach(&self) -> f64 {
        self.velocity[0].abs() / gas().sound_speed(self.density, self.pressure)
    }
}

pub(super) fn along_x<const D: usize>(sign: f64) -> [f64; D] {
    std::array::from_fn(|i| if i == 0 { sign } else { 0.0 })
}

fn flux_of<const D: usize, const M: usize>(
    condition: Boundary<D>,
    inside: &Primitive<f64, D>,
    n: &[f64; D],
) -> [f64; M] {
    let u: [f64; M] = inside.pack(&gas());
    law::<D>(Riemann::Roe).impose(condition, &u, at(n, &[0.0; D], &u)).flux
}

/// The gas of `inside` at the pressure `p`, at its own entropy: its sound speed, and w_n + 2 c / (gamma - 1) of the gas inside.
pub(super) fn invariant<const D: usize>(inside: &Primitive<f64, D>, w_n: f64, p: f64) -> (f64, f64) {
    let gas = gas();
    let c = gas.sound_speed(inside.density, inside.pressure);
    let at_p = c * (p / inside.pressure).powf(0.5 * (gas.gamma() - 1.0) / gas.gamma());
    (at_p, w_n + 2.0 * c / (gas.gamma() - 1.0))
}

/// Gas that comes from the reservoir passes the inflow unchanged, from any angle below 80 degrees and at any Mach number below 0.9.
fn of_inflow<const D: usize, const M: usize>() {
    let gas = gas();
    let mut tried = 0;
    for seed in 0..200 {
        let mut random = Random(seed);
        let (n, direction, v): ([f64; D], [f64; D], [f64; D]) = (random.unit(), random.unit(), random.vector(1.0));
        if dot(&n, &direction) > -0.17 {
            continue;
        }
        tried += 1;
        let mach = random.between(0.0, 0.9);
        let t = T_0 / (1.0 + 0.5 * (gas.gamma() - 1.0) * mach * mach);
        let pressure = P_0 * (t / T_0).powf(gas.gamma() / (gas.gamma() - 1.0));
        let density = gas.density(pressure, t);
        let q = mach * gas.sound_speed(density, pressure);
        let u: [f64; M] = Primitive { density, velocity: direction.map(|d| q * d), pressure }.pack(&gas);
        let inflow = Boundary::Inflow(Inflow::new(P_0, T_0, direction.map(|d| 3.0 * d)).unwrap());
        let flux = law::<D>(Riemann::Roe).impose(inflow, &u, at(&n, &v, &u)).flux;
        assert!(difference(&flux, &normal_flux(&u, &n, &v)) <= 1e-12, "Mach number {mach}");
        let target_state = inflow.target_state(&law(Riemann::Roe), &u, at(&n, &v, &u));
        assert!(difference(&target_state, &u) <= 1e-12, "Mach number {mach}");
    }
    assert!(tried > 50);
}

/// Gas that flows in has the total enthalpy, the total pressure and the direction of the reservoir, and is subsonic. Gas that is pushed
/// back leaves at the static pressure p_0, unless it is sonic, with its own entropy and tangential velocity, not with those of the
/// reservoir.
fn inflow_keeps_the_total_state<const D: usize, const M: usize>() {
    let (gas, n) = (gas(), along_x::<D>(-1.0));
    let exponent = gas.gamma() / (gas.gamma() - 1.0);
    let mut direction = [0.0; D];
    (direction[0], direction[1]) = (0.8, 0.6);
    let inflow = Boundary::Inflow(Inflow::new(P_0, T_0, direction).unwrap());
    let (mut entered, mut left) = (0, 0);
    for seed in 0..200 {
        let mut random = Random(seed);
        let inside = Primitive { velocity: random.vector(3.0), ..random.primitive::<D>() };
        let flux: [f64; M] = flux_of(inflow, &inside, &n);
        let (c_s, plus) = invariant(&inside, -inside.velocity[0], P_0);
        if plus < 2.0 * c_s / (gas.gamma() - 1.0) {
            entered += 1;
            let mass = flux[0];
            assert!(mass < 0.0);
            // Tangential momentum gives the speed, normal momentum then the pressure.
            let q = flux[2] / mass / direction[1];
            let p = (flux[1] - mass * q * direction[0]) / n[0];
            let t = T_0 - 0.5 * q * q / gas.heat_capacity();
            assert!((flux[M - 1] / mass / (gas.heat_capacity() * T_0) - 1.0).abs() <= 1e-11);
            assert!((p / (P_0 * (t / T_0).powf(exponent)) - 1.0).abs() <= 1e-10);
            assert!((mass / (gas.density(p, t) * q * n[0] * direction[0]) - 1.0).abs() <= 1e-10);
            assert!(q * direction[0] <= gas.sound_speed(gas.density(p, t), p) * (1.0 + 1e-12));
        } else if flux[0] > 1e-3 {
            left += 1;
            let out = Crossing::new(&flux, n[0]);
            let entropy = inside.pressure / inside.density.powf(gas.gamma());
            assert!((out.entropy() / entropy - 1.0).abs() <= 1e-6, "{seed}");
            assert!((out.velocity[1] - inside.velocity[1]).abs() <= 1e-10);
            assert!(out.mach() <= 1.0 + 1e-5);
            assert!(out.mach() > 0.999 || (out.pressure / P_0 - 1.0).abs() <= 1e-6, "{} {}", out.mach(), out.pressure);
        }
    }
    assert!(entered > 50 && left > 20, "{entered} {left}");
}

/// Gas leaves at the pressure outside, with its entropy and acoustic invariant from inside.
fn outflow_keeps_what_leaves<const D: usize, const M: usize>() {
    let (gas, p, n) = (gas(), 0.9, along_x::<D>(1.0));
    let outflow = Boundary::Outflow(Outflow::new(p, 1.5).unwrap());
    for seed in 0..100 {
        let mut random = Random(seed);
        let mut inside = random.primitive::<D>();
        inside.velocity[0] = random.between(0.2, 0.5);
        inside.pressure = random.between(0.95, 1.5);
        let flux: [f64; M] = flux_of(outflow, &inside, &n);
        let w_n = (flux[1] - p) / flux[0];
        let density = flux[0] / w_n;
        let entropy = |p: f64, density: f64| p / density.powf(gas.gamma());
        let invariant = |w_n: f64, c: f64| w_n + 2.0 * c / (gas.gamma() - 1.0);
        let (c_in, c_out) = (gas.sound_speed(inside.density, inside.pressure), gas.sound_speed(density, p));
        assert!((entropy(p, density) / entropy(inside.pressure, inside.density) - 1.0).abs() <= 1e-11);
        assert!((invariant(w_n, c_out) / invariant(inside.velocity[0], c_in) - 1.0).abs() <= 1e-12);
        assert!((flux[2] / flux[0] - inside.velocity[1]).abs() <= 1e-12);
    }
}

/// Gas that comes back through an outflow is gas of the reservoir outside: its total enthalpy and total pressure are data. It has no
/// tangential velocity, and it is subsonic. With the entropy and the tangential velocity of the gas inside it would be unbounded.
fn what_comes_back_through_an_outflow_is_given<const D: usize, const M: usize>() {
    let (gas, n) = (gas(), along_x::<D>(1.0));
    let outflow = Boundary::Outflow(Outflow::new(P_0, T_0).unwrap());
    let mut came_back = 0;
    for seed in 0..100 {
        let mut random = Random(seed);
        let mut inside = random.primitive::<D>();
        inside.velocity[0] = random.between(-6.0, -0.3);
        let flux: [f64; M] = flux_of(outflow, &inside, &n);
        if flux[0] >= 0.0 {
            continue;
        }
        came_back += 1;
        let back = Crossing::new(&flux, n[0]);
        let t = gas.temperature(back.density, back.pressure);
        let total_pressure = back.pressure * (T_0 / t).powf(gas.gamma() / (gas.gamma() - 1.0));
        assert!((flux[M - 1] / flux[0] / (gas.heat_capacity() * T_0) - 1.0).abs() <= 1e-12);
        assert!((total_pressure / P_0 - 1.0).abs() <= 1e-6, "{total_pressure}");
        assert!(back.velocity[1].abs() <= 1e-13 && back.mach() <= 1.0 + 1e-5);
    }
    assert!(came_back > 80, "{came_back}");
}

/// Sound that leaves a stream passes an outflow that knows the velocity outside, and comes back from one that does not. The state on the facet is
/// then the state inside, but for terms of second order.
fn sound_passes_an_outflow_of_velocity<const D: usize, const M: usize>() {
    const AMPLITUDE: f64 = 1e-4;
    let (gas, law) = (gas(), law::<D>(Riemann::Roe));
    for seed in 0..100 {
        let mut random = Random(seed);
        let rest = random.primitive::<D>();
        let c = gas.sound_speed(rest.density, rest.pressure);
        let (n, v): ([f64; D], [f64; D]) = (random.unit(), random.vector(0.05 * c));
        let stream = Primitive { velocity: n.map(|n| n * c * random.between(0.2, 0.7)), ..rest };
        let inside: Primitive<f64, D> = Primitive {
            density: stream.density * (1.0 + AMPLITUDE),
            velocity: std::array::from_fn(|i| stream.velocity[i] + AMPLITUDE * c * n[i]),
            pressure: stream.pressure * (1.0 + gas.gamma() * AMPLITUDE),
        };
        let u: [f64; M] = inside.pack(&gas);
        let data = values(stream.pressure, stream.velocity, T_0);
        let jump = |outflow| {
            let here = Boundary::Outflow(outflow).target_state(&law, &u, at(&n, &v, &data));
            (Primitive::<f64, D>::unpack(&gas, &here).pressure / inside.pressure - 1.0).abs() / AMPLITUDE
        };
        let (passes, comes_back) = (jump(Outflow::of_velocity()), jump(Outflow::at_points()));
        assert!(passes < 10.0 * AMPLITUDE && (comes_back - gas.gamma()).abs() < 10.0 * AMPLITUDE, "{passes:e}");
    }
}

/// The total pressure of gas that comes back is bounded by the pressure outside, for any gas inside.
fn what_comes_back_through_an_outflow_of_velocity_is_bounded<const D: usize, const M: usize>() {
    let (gas, n, law) = (gas(), along_x::<D>(1.0), law::<D>(Riemann::Roe));
    let (mut came_back, mut bounds) = (0, [0, 0]);
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut inside = random.primitive::<D>();
        inside.velocity[0] = random.between(-6.0, -0.3);
        inside.pressure = random.between(0.1, 9.0);
        let data: [f64; M] = values(P_0, n.map(|n| random.between(-3.0, 3.0) * n), T_0);
        let u: [f64; M] = inside.pack(&gas);
        let here = Boundary::Outflow(Outflow::of_velocity()).target_state(&law, &u, at(&n, &[0.0; D], &data));
        let here = Primitive::<f64, D>::unpack(&gas, &here);
        if here.velocity[0] >= 0.0 {
            continue;
        }
        came_back += 1;
        let t = gas.temperature(here.density, here.pressure);
        assert!((t + 0.5 * dot(&here.velocity, &here.velocity) / gas.heat_capacity() - T_0).abs() <= 1e-12);
        assert!((1..D).all(|i| here.velocity[i].abs() <= 1e-13));
        let ratio = here.pressure * (T_0 / t).powf(gas.gamma() / (gas.gamma() - 1.0)) / P_0;
        assert!(ratio > 0.5 - 1e-12 && ratio < 2.0 + 1e-12, "{ratio}");
        bounds[0] += usize::from(ratio < 0.5 + 1e-12);
        bounds[1] += usize::from(ratio > 0.5 + 1e-12);
    }
    assert!(came_back > 50 && bounds[0] > 5 && bounds[1] > 5, "{came_back} {bounds:?}");
}

/// An outflow that is supersonic relative to the boundary imposes nothing.
fn of_supersonic_outflow<const D: usize, const M: usize>() {
    for seed in 0..100 {
        let p = Point::<f64, f64, D, M>::random(&mut Random(seed));
        let v = p.n.map(|n| -6.0 * n);
        for outflow in [Outflow::new(10.0, 1.0).unwrap(), Outflow::of_velocity()] {
            let flux =
                law::<D>(Riemann::Roe).impose(Boundary::Outflow(outflow), &p.minus, at(&p.n, &v, &p.values)).flux;
            assert!(difference(&flux, &normal_flux(&p.minus, &p.n, &v)) <= 1e-14);
        }
    }
}

/// When the flow relative to a moving facet reverses, the flux does not jump.
fn openings_are_continuous<const D: usize, const M: usize>() {
    /// A change of a velocity, and the allowed change of a flux.
    const STEP: f64 = 1e-9;
    let gas = gas();
    for seed in 0..100 {
        let mut random = Random(seed);
        let (n, v): ([f64; D], [f64; D]) = (random.unit(), random.vector(0.5));
        let d: [f64; D] = random.unit();
        let direction = std::array::from_fn(|i| 0.8 * d[i] - n[i]);
        let inside = random.primitive::<D>();
        let conditions = [
            (Boundary::Inflow(Inflow::new(P_0, T_0, direction).unwrap()), 0.0),
            (Boundary::Outflow(Outflow::new(P_0, T_0).unwrap()), dot(&v, &n)),
        ];
        for (condition, frame) in conditions {
            let (c_s, plus) = invariant(&inside, 0.0, P_0);
            // The normal velocity at which nothing crosses a facet at rest, and one at which the gas is as fast as the facet.
            let still = frame + 2.0 * c_s / (gas.gamma() - 1.0) - plus;
            for turning in [still, still + (dot(&v, &n) - frame).max(0.0)] {
                let with = |w_n: f64| {
                    let gain = w_n - dot(&inside.velocity, &n);
                    let velocity = std::array::from_fn(|i| inside.velocity[i] + gain * n[i]);
                    let u: [f64; M] = Primitive { velocity, ..inside }.pack(&gas);
                    law::<D>(Riemann::Roe).impose(condition, &u, at(&n, &v, &u)).flux
                };
                let jump = difference(&with(turning + STEP), &with(turning - STEP));
                assert!(jump <= 200.0 * STEP, "{condition:?}: {jump:e}");
            }
        }
    }
}

/// Directions in the facet or out of the domain, and almost vanishing gas, give finite numbers.
fn openings_are_numbers_everywhere<const D: usize, const M: usize>() {
    use tensor::Dual;
    let (gas, n) = (gas(), along_x::<D>(1.0));
    let mut across = [0.0; D];
    across[1] = 1.0;
    for direction in [across, n, n.map(|n| -n)] {
        let inflow = Boundary::Inflow(Inflow::new(P_0, T_0, direction).unwrap());
        let outflow = Boundary::Outflow(Outflow::new(P_0, T_0).unwrap());
        for (w_n, pressure) in [(0.0, P_0), (-50.0, 1e-6), (50.0, 1e-6), (-50.0, 1e6), (50.0, 1e6), (1e-300, 1.0)] {
            let velocity = n.map(|n| w_n * n);
            let u: [f64; M] = Primitive { density: gas.density(pressure, T_0), velocity, pressure }.pack(&gas);
            let dual = u.map(|u| Dual::new(u, 1.0));
            let outflow_of_velocity = Boundary::Outflow(Outflow::of_velocity());
            let data = values(P_0, n.map(|n| 0.3 * n), T_0);
            for condition in [inflow, outflow, outflow_of_velocity] {
                let flux = law::<D>(Riemann::Roe).impose(condition, &dual, at(&n, &[0.0; D], &data)).flux;
                assert!(flux.iter().all(|f| f.value.is_finite() && f.derivative.is_finite()), "{flux:?}");
            }
        }
    }
}

in_both_dimensions!(
    of_inflow,
    inflow_keeps_the_total_state,
    outflow_keeps_what_leaves,
    what_comes_back_through_an_outflow_is_given,
    sound_passes_an_outflow_of_velocity,
    what_comes_back_through_an_outflow_of_velocity_is_bounded,
    of_supersonic_outflow,
    openings_are_continuous,
    openings_are_numbers_everywhere,
);
