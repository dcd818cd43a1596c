//! Bodies without a flow: free, heavy and about a fixed axis; what the integration in time keeps, and what it takes.

use basis::{Matrix, RadauTime};
use coupled::block::{Block, Body, BodyState, Exchange};
use coupled::blocks::rigid_body::{AddedMass, Coordinate, Freedom, RigidBodyData, Surface, SurfaceNode, Vec3};
use coupled::blocks::{RigidBody, SlabTimes};
use coupled::{Interval, State};
use fem::Clock;
use std::sync::Arc;
use tensor::{cross, dot, rotated};

const MOMENTS: Vec3 = [1.0, 2.0, 3.0];
const SPIN: Vec3 = [0.4, 1.0, 0.3];

fn coordinate(freedom: Freedom, rate_at_start: f64) -> Coordinate {
    let (stiffness, cubic_stiffness, damping, rest) = (0.0, 0.0, 0.0, 0.0);
    Coordinate { freedom, stiffness, cubic_stiffness, damping, stops: None, rest, rate_at_start, drive: None }
}

fn body(coordinates: Vec<Coordinate>, centre_of_mass: Vec3, weight: Vec3, order: usize, step: f64) -> RigidBody<3> {
    let area = Matrix::from_fn(coordinates.len(), coordinates.len(), |_, _| 0.0);
    let data = RigidBodyData {
        name: "top".into(),
        mass: 0.7,
        inertia: std::array::from_fn(|i| std::array::from_fn(|j| if i == j { MOMENTS[i] } else { 0.0 })),
        centre_of_mass,
        pivot: [0.0; 3],
        coordinates,
        force: Some(Arc::new(move |_| weight)),
        added_mass: AddedMass { density: 0.0, speed_of_sound: 1.0, depth: 1.0, area },
    };
    let node = SurfaceNode { node: 0, position: [1.0, 0.0, 0.0], weight: 1.0 };
    let surface = Surface { nodes: vec![node], loaded: vec![0], size: 1.0 };
    let time = RadauTime::new(order);
    RigidBody::new(data, surface, 0, SlabTimes { points: time.nodes().to_vec(), time, step })
}

/// A body in a vacuum over some slabs.
struct Flight {
    body: RigidBody<3>,
    state: State,
    exchange: Exchange,
    order: usize,
    /// The unknowns of the last slab.
    z: Vec<f64>,
}

impl Flight {
    fn new(coordinates: Vec<Coordinate>, centre_of_mass: Vec3, weight: Vec3, order: usize, step: f64) -> Self {
        let body = body(coordinates, centre_of_mass, weight, order, step);
        let mut state = State::new(0.0, Vec::new(), vec![0.0; 3]);
        state.bodies = vec![body.initial()];
        let exchange = Exchange { wall_displacement: vec![0.0; 3 * order], ..Exchange::default() };
        Flight { body, state, exchange, order, z: Vec::new() }
    }

    /// One slab by Newton's method: the preconditioner is the exact inverse here.
    fn advance(&mut self, dt: f64) {
        let start = self.state.time;
        let interval = Interval { start, end: start + dt, halvings: 0 };
        self.body.begin_slab(interval, Clock::running(start, dt), &self.state).unwrap();
        let mut z = vec![0.0; self.order * self.read().position.len()];
        self.body.guess(None, &mut self.exchange, &mut z);
        for _ in 0..8 {
            let (mut r, mut dz) = (vec![0.0; z.len()], vec![0.0; z.len()]);
            self.body.residual(&z, &mut self.exchange, &mut r).unwrap();
            self.body.receive(&self.exchange, &mut r);
            self.body.linearise(&z, &mut self.exchange, 0.0);
            self.body.precondition(&r, &mut self.exchange, &mut dz);
            z.iter_mut().zip(&dz).for_each(|(z, dz)| *z -= dz);
        }
        self.body.end_slab(&z, &mut self.state.bodies[0]);
        (self.state.time, self.z) = (start + dt, z);
    }

    fn read(&self) -> BodyState {
        self.body.read(&self.state.bodies[0])
    }
}

fn top(order: usize, slabs: usize, end: f64) -> Flight {
    let along = |axis: usize| std::array::from_fn(|i| f64::from(u8::from(i == axis)));
    let rotations = (0..3).map(|axis| coordinate(Freedom::Rotation(along(axis)), SPIN[axis])).collect();
    let step = end / slabs as f64;
    let mut flight = Flight::new(rotations, [0.0; 3], [0.0; 3], order, step);
    (0..slabs).for_each(|_| flight.advance(step));
    flight
}

/// Theta at the end of a flight.
fn theta(flight: &Flight) -> Vec3 {
    flight.read().position.try_into().unwrap()
}

/// The axes of the body and its angular velocity in these axes: e' = R (omega x .), J omega' = -omega x J omega.
#[derive(Clone, Copy)]
struct Euler {
    axes: [Vec3; 3],
    spin: Vec3,
}

impl Euler {
    /// Axes are columns of R: the column i changes by R (omega x e_i).
    fn rate(&self) -> Euler {
        let turned = |v: &Vec3| -> Vec3 { std::array::from_fn(|d| (0..3).map(|i| self.axes[i][d] * v[i]).sum()) };
        let momentum: Vec3 = std::array::from_fn(|i| MOMENTS[i] * self.spin[i]);
        let torque = cross(&momentum, &self.spin);
        let unit = |axis: usize| -> Vec3 { std::array::from_fn(|i| f64::from(u8::from(i == axis))) };
        Euler {
            axes: std::array::from_fn(|i| turned(&cross(&self.spin, &unit(i)))),
            spin: std::array::from_fn(|i| torque[i] / MOMENTS[i]),
        }
    }
    fn plus(&self, step: f64, rate: &Euler) -> Euler {
        let sum = |a: &Vec3, b: &Vec3| std::array::from_fn(|i| a[i] + step * b[i]);
        Euler { axes: std::array::from_fn(|i| sum(&self.axes[i], &rate.axes[i])), spin: sum(&self.spin, &rate.spin) }
    }
    /// The classical method of Runge and Kutta.
    fn advanced(self, step: f64) -> Euler {
        let first = self.rate();
        let second = self.plus(0.5 * step, &first).rate();
        let third = self.plus(0.5 * step, &second).rate();
        let fourth = self.plus(step, &third).rate();
        let ends = self.plus(step / 6.0, &first).plus(step / 6.0, &fourth);
        ends.plus(step / 3.0, &second).plus(step / 3.0, &third)
    }
}

/// The axes of the body at time `end`.
fn reference(end: f64) -> [Vec3; 3] {
    let steps = 20_000;
    let axes = std::array::from_fn(|axis| std::array::from_fn(|i| f64::from(u8::from(i == axis))));
    (0..steps).fold(Euler { axes, spin: SPIN }, |top, _| top.advanced(end / f64::from(steps))).axes
}

/// Errors of the axes and of the kinetic energy, and of the angular momentum in space.
fn errors(flight: &Flight, axes: &[Vec3; 3]) -> [f64; 3] {
    let (theta, state) = (theta(flight), flight.read());
    let turned = axes.map(|axis| rotated(&theta.map(|x| -x), &axis));
    let off = |i: usize, j: usize| (turned[i][j] - f64::from(u8::from(i == j))).abs();
    let orientation = (0..9).map(|k| off(k / 3, k % 3)).fold(0.0, f64::max);
    let energy: f64 = (0..3).map(|i| 0.5 * MOMENTS[i] * SPIN[i] * SPIN[i]).sum();
    let rate: Vec3 = state.rate.clone().try_into().unwrap();
    let spin = rotated(&theta.map(|x| -x), &tensor::angular_velocity(&theta, &rate));
    let momentum: Vec3 = rotated(&theta, &std::array::from_fn(|i| MOMENTS[i] * spin[i]));
    let lost = (0..3).map(|i| (momentum[i] - MOMENTS[i] * SPIN[i]).abs()).fold(0.0, f64::max);
    [orientation, (state.kinetic_energy - energy).abs(), lost]
}

/// Angular momentum is kept to round-off; orientation and kinetic energy have the order 2 N_t - 1 at the ends of slabs.
#[test]
fn a_free_top_keeps_its_angular_momentum() {
    let end = 2.0;
    let axes = reference(end);
    for (order, slabs) in [(1, 256), (2, 16), (3, 8)] {
        let of = |slabs: usize| errors(&top(order, slabs, end), &axes);
        let (coarse, fine) = (of(slabs), of(2 * slabs));
        let rate = |i: usize| (coarse[i] / fine[i]).log2();
        println!("N_t = {order}: {coarse:?}, {fine:?}, orders {} and {}", rate(0), rate(1));
        let expected = (2 * order - 1) as f64;
        assert!((rate(0) - expected).abs() < 0.4 && rate(1) > expected - 0.4, "N_t = {order}: {coarse:?}, {fine:?}");
        assert!(coarse[2] < 1e-12 && fine[2] < 1e-12, "N_t = {order}: {coarse:?}, {fine:?}");
    }
}

/// The energy that a free top loses is the dissipation of the ledger.
#[test]
fn the_ledger_of_a_free_top_closes() {
    let state = top(2, 16, 2.0).read();
    let start: f64 = (0..3).map(|i| 0.5 * MOMENTS[i] * SPIN[i] * SPIN[i]).sum();
    let end = state.kinetic_energy + state.ledger.numerical - state.ledger.defect;
    assert!((start - end).abs() < 1e-13, "{start}, {end}");
}

/// The weight of a heavy top.
const WEIGHT: Vec3 = [0.5, 0.0, -3.0];

/// A top that stands on the pivot: its energy, with that of its weight, at the end, and what its ledger leaves open.
fn heavy_top(order: usize, slabs: usize) -> [f64; 2] {
    let along = |axis: usize| std::array::from_fn(|i| f64::from(u8::from(i == axis)));
    let rotations = (0..3).map(|axis| coordinate(Freedom::Rotation(along(axis)), SPIN[axis])).collect();
    let (c, step) = ([0.3, -0.2, 0.9], 1.5 / slabs as f64);
    let mut flight = Flight::new(rotations, c, WEIGHT, order, step);
    let start = flight.read().kinetic_energy;
    (0..slabs).for_each(|_| flight.advance(step));
    let (state, lever) = (flight.read(), rotated(&theta(&flight), &c));
    let kinetic = state.kinetic_energy - start;
    let open = kinetic + state.ledger.numerical - state.ledger.force - state.ledger.defect;
    [kinetic - dot(&WEIGHT, &lever) + dot(&WEIGHT, &c), open]
}

/// A heavy top keeps its energy to the order 2 N_t - 1, and its ledger closes.
#[test]
fn a_heavy_top_keeps_its_energy() {
    for (order, slabs) in [(1, 512), (2, 16), (3, 8)] {
        let (coarse, fine) = (heavy_top(order, slabs), heavy_top(order, 2 * slabs));
        let rate = (coarse[0] / fine[0]).abs().log2();
        println!("N_t = {order}: {coarse:?}, {fine:?}, order {rate}");
        assert!(rate > (2 * order - 1) as f64 - 0.4, "N_t = {order}: {coarse:?}, {fine:?}");
        assert!(coarse[1].abs() < 1e-11 && fine[1].abs() < 1e-11, "N_t = {order}: {coarse:?}, {fine:?}");
    }
}

/// A balanced wheel keeps its spin about a fixed axis over many turns.
#[test]
fn a_rotation_about_a_fixed_axis_may_be_of_any_angle() {
    let axis = [0.6, 0.0, 0.8];
    let wheel = vec![coordinate(Freedom::Rotation(axis), 40.0)];
    let mut flight = Flight::new(wheel, axis.map(|a| 0.5 * a), [0.0; 3], 2, 0.05);
    (0..40).for_each(|_| flight.advance(0.05));
    let state = flight.read();
    assert!((state.position[0] - 80.0).abs() < 1e-11 && (state.rate[0] - 40.0).abs() < 1e-11, "{state:?}");
}

/// Of a body with translations and one rotation the time integration takes the energy of the jumps of v_c and of the spin.
#[test]
fn the_dissipation_of_a_fixed_axis_is_that_of_the_jumps() {
    let (axis, c) = ([0.6, 0.0, 0.8], [0.3, -0.1, 0.5]);
    let freedoms = [(Freedom::Translation([0.0, 1.0, 0.0]), 0.3), (Freedom::Rotation(axis), 2.0)];
    let coordinates = freedoms.map(|(freedom, rate)| coordinate(freedom, rate)).to_vec();
    let (order, dt) = (3, 0.3);
    let time = RadauTime::new(order);
    let moment = (0..3).map(|i| axis[i] * MOMENTS[i] * axis[i]).sum::<f64>();
    // v_c and the spin where the coordinates are q and their rates w.
    let motion = |q: &[f64], w: &[f64]| -> [f64; 4] {
        let v = cross(&axis, &rotated(&axis.map(|a| a * q[1]), &c)).map(|v| v * w[1]);
        [v[0], v[1] + w[0], v[2], w[1]]
    };
    let (mut flight, mut dissipated) = (Flight::new(coordinates, c, [0.0; 3], order, dt), 0.0);
    for _ in 0..5 {
        let before = flight.read();
        flight.advance(dt);
        let mut jump = motion(&before.position, &before.rate).map(|v| -v);
        for (a, phi) in time.values(0.0).iter().enumerate() {
            let grown =
                |k: usize| -> f64 { (0..order).map(|b| time.collocation()[(a, b)] * flight.z[2 * b + k]).sum() };
            let q: Vec<f64> = (0..2).map(|k| before.position[k] + dt * grown(k)).collect();
            let v = motion(&q, &flight.z[2 * a..2 * a + 2]);
            (0..4).for_each(|i| jump[i] += phi * v[i]);
        }
        let [x, y, z, spin] = jump;
        dissipated += 0.5 * 0.7 * dot(&[x, y, z], &[x, y, z]) + 0.5 * moment * spin * spin;
    }
    let numerical = flight.read().ledger.numerical;
    println!("{numerical:e} and {dissipated:e}");
    assert!(dissipated > 1e-9 && (numerical - dissipated).abs() < 1e-13, "{numerical:e} and {dissipated:e}");
}
