//! A rigid body that the flow moves: translations and rotations, up to six, free or driven.
//!
//! ```text
//! x(X) = p + h + R(w Theta) (X - p) + (w - 1) h,      h = sum_k q_k e_k,      Theta = sum_k q_k a_k                (rigid motion)
//! v_c = h' + Omega x R(Theta) c,      Omega = T(Theta) Theta',      g_k = dv_c/dq_k',      G_k = T(Theta) a_k
//! ```
//!
//! p is the pivot at rest, h the translation, Theta the rotation vector, and c the centre of mass relative to the pivot. R turns by the
//! angle
//! |Theta| about Theta, see [`tensor::rotated`] and [`tensor::angular_velocity`]. A rotation about a fixed axis has one a_k.
//! The weight w is one on the body and less in the mesh that follows. The unknowns W are the rates of the coordinates q at the time nodes.
//! With H = R J R^T Omega, the angular momentum about the centre of mass,
//!
//! ```text
//! R_a,k = g_k(s_a) . m [ sum_b T_ab v_c,b - phi_a(0) v_c,n ] + G_k(s_a) . [ sum_b T_ab H_b - phi_a(0) H_n ]
//!         + dt omega_a ( c_k W_a,k + f_k(q_a) - g_k(s_a) . b(s_a) ) - Q_a,k = 0                                    (rigid body)
//! ```
//!
//! J is the tensor of inertia at rest, c_k damps, f_k is the force of springs, b an outer force, and Q the load of the flow, see `loads`.
//! About a fixed axis n, the second term contains the moment of inertia n . J n. A body without forces keeps H exactly. The sum of R_a,k
//! W_a,k is the balance of energy, see `energy`.
//!
//! T is singular at |Theta| = 2 pi unless the axis is fixed. A slab that begins close to that is refused.

mod coordinate;
mod data;
mod dynamics;
mod energy;
mod geometry;
mod loads;
mod surface_motion;

pub use coordinate::{Coordinate, Drive, Freedom, Stops};
pub use data::{AddedMass, RigidBodyData};
pub use geometry::{BodyPosition, Surface, SurfaceNode};
use loads::Loads;
use surface_motion::SurfaceDerivatives;

use crate::block::{Block, Body, BodyState, Couplings, Exchange, Ledger, Quantity};
use crate::blocks::{SlabTimes, jump, last_digits};
use crate::slab_error::SlabError;
use crate::state::{Interval, State, extend};
use basis::{Matrix, RadauTime, TemporalModes};
use elasticity::SlabMotion;
use fem::Clock;
use newton_krylov::problem::Inadmissible;
use std::f64::consts::TAU;
use tensor::{Dual, Transcendental};

/// A vector of space; in two dimensions its last component is zero.
pub type Vec3 = [f64; 3];

/// A velocity and an angular velocity, or a force and a moment.
type Six<T> = [T; 6];

/// The slab that is being solved, and the body at its bottom.
#[derive(Clone, Debug, Default)]
struct Slab {
    /// The times of drives and outer forces.
    clock: Clock,
    dt: f64,
    /// q_n
    position: Vec<f64>,
    /// The rates w_n at the top of the slab before.
    rate: Vec<f64>,
    /// Displacement of the surface at the bottom, `[node][component]`.
    surface: Vec<f64>,
}

/// A rigid body as a block.
pub struct RigidBody<const D: usize> {
    data: RigidBodyData,
    surface: Surface<D>,
    number: usize,
    motion: SlabMotion,
    /// phi_a at the quadrature points of the flow in time, `[point][a]`.
    at_points: Matrix,
    /// s at these points.
    points: Vec<f64>,
    /// The mean |lambda|.
    mean_eigenvalue: f64,
    slab: Slab,
    /// W at the point of linearisation and evaluation.
    w: Vec<f64>,
    /// The displacement of the surface there, `[time node][node][component]`.
    surface_displacement: Vec<f64>,
    /// The derivatives of the surface there, `[b][k]`, once they are needed.
    surface_derivatives: Option<Vec<SurfaceDerivatives>>,
    /// The loads of the flow at that point, `[time point][loaded node][component]`.
    flow_loads: Vec<f64>,
    /// Q at that point.
    loads: Loads<f64>,
    /// The derivatives of Q there along every rate, at fixed nodal loads, once they are needed.
    load_columns: Option<Vec<Vec<f64>>>,
    inverse: Option<Matrix>,
    inverse_pseudo_time: f64,
    /// The length of most slabs; the weights refer to it.
    step: f64,
}

/// A rotation vector is accurate up to this length, a little less than 2 pi.
const LARGEST_TURN: f64 = 6.1;

/// The largest part of its energy that the time integration may give to a body on its stops in a slab.
const LARGEST_GAIN: f64 = 0.01;

impl<const D: usize> RigidBody<D> {
    /// Body number `number` of a run with the slabs of `times`.
    pub fn new(data: RigidBodyData, surface: Surface<D>, number: usize, times: SlabTimes) -> Self {
        let at_points = times.test_functions();
        let SlabTimes { time, points, step } = times;
        RigidBody {
            at_points,
            points,
            mean_eigenvalue: TemporalModes::new(&time).mean_shift(),
            slab: Slab::default(),
            w: vec![0.0; time.order() * data.coordinates.len()],
            surface_displacement: Vec::new(),
            surface_derivatives: None,
            flow_loads: Vec::new(),
            loads: Loads::default(),
            load_columns: None,
            inverse: None,
            inverse_pseudo_time: 0.0,
            data,
            surface,
            number,
            motion: SlabMotion::new(time),
            step,
        }
    }

    /// Checks that the rotation vector of the coordinates `q` is no longer than `largest`. A rotation about one axis has no end.
    fn check_turn(&self, q: &[f64], largest: f64) -> Result<(), SlabError> {
        let several = self.data.coordinates.iter().filter(|coordinate| coordinate.freedom.rotates()).count() > 1;
        let angle = tensor::norm(&self.data.rotation_vector(q));
        if several && angle > largest {
            return Err(SlabError::FullTurn { body: self.data.name.clone(), angle });
        }
        Ok(())
    }

    fn time(&self) -> &RadauTime {
        self.motion.time()
    }

    /// The number of coordinates.
    fn count(&self) -> usize {
        self.data.coordinates.len()
    }

    /// Coordinates at the time nodes, `[a][k]`.
    fn positions<T: Transcendental>(&self, w: &[T]) -> Vec<T> {
        let (bottom, mut q) = (lifted(&self.slab.position), w.to_vec());
        for (a, q) in q.chunks_exact_mut(bottom.len()).enumerate() {
            self.motion.displacement_at_node(self.slab.dt, &bottom, w, a, q);
        }
        q
    }

    /// The coordinates at the top of the slab, with the rates `w` in it, and those rates there.
    fn at_top(&self, w: &[f64]) -> [Vec<f64>; 2] {
        let q = self.positions(w);
        [&q, w].map(|of_nodes| of_nodes[of_nodes.len() - self.count()..].to_vec())
    }

    /// The rate of a driven coordinate at the top. That of (prescribed) has the order of the error in time.
    fn exact_rate(&self, k: usize) -> Option<f64> {
        let drive = self.data.coordinates[k].drive.as_ref()?;
        Some((drive.rate)(self.slab.clock.time(1.0))).filter(|rate| rate.is_finite())
    }
}

/// Constants, with zero derivatives.
fn lifted<T: Transcendental>(numbers: &[f64]) -> Vec<T> {
    numbers.iter().map(|number| T::from(*number)).collect()
}

/// Numbers with the derivatives `x`.
fn along<T: Transcendental>(numbers: &[T], x: &[T]) -> Vec<Dual<T>> {
    numbers.iter().zip(x).map(|(number, x)| Dual::new(*number, *x)).collect()
}

/// The derivatives of `numbers`.
fn derivatives<T: Transcendental>(numbers: &[Dual<T>]) -> Vec<T> {
    numbers.iter().map(|number| number.derivative).collect()
}

impl<const D: usize> Block for RigidBody<D> {
    fn field(&self) -> &'static str {
        "body"
    }

    fn couplings(&self) -> Couplings {
        Couplings { reads: &[Quantity::WallLoads], writes: &[Quantity::WallDisplacement] }
    }

    /// An impulse R moves a coordinate by about R dt / m in a slab, here in units of length, or of one for the rotation.
    fn weights(&self) -> Vec<f64> {
        let n = self.time().order();
        let count = (n * self.count()) as f64;
        let mass = self.inertia_with_fluid(self.step);
        let weight =
            |k: usize| (self.step / mass[(k, k)] / self.surface.length(&self.data.coordinates[k])).powi(2) / count;
        (0..n).flat_map(|_| (0..self.count()).map(weight)).collect()
    }

    fn begin_slab(&mut self, interval: Interval, clock: Clock, state: &State) -> Result<(), SlabError> {
        let stored = &state.bodies[self.number];
        let count = self.count();
        self.slab = Slab {
            clock,
            dt: interval.length(),
            position: stored[..count].to_vec(),
            rate: stored[count..2 * count].to_vec(),
            surface: self.data.displacement(&self.surface.nodes, &stored[..count]),
        };
        (self.inverse, self.surface_derivatives, self.load_columns) = (None, None, None);
        self.surface_displacement.clear();
        self.check_turn(&self.slab.position, LARGEST_TURN)
    }

    fn residual(&mut self, z: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible> {
        self.set_rates(z, exchange);
        r.copy_from_slice(&self.dynamics(z));
        Ok(())
    }

    fn receive(&mut self, exchange: &Exchange, r: &mut [f64]) {
        self.flow_loads.clone_from(&exchange.wall_loads);
        self.set_loads();
        self.subtract_loads(&self.total(&self.loads, &self.w), r);
    }

    fn linearise(&mut self, z: &[f64], exchange: &mut Exchange, inverse_pseudo_time: f64) {
        self.set_rates(z, exchange);
        self.set_loads();
        self.inverse_pseudo_time = inverse_pseudo_time;
        self.inverse = None;
    }

    fn product(&mut self, x: &[f64], _tangent: &mut Exchange, out: &mut [f64]) {
        out.copy_from_slice(&self.dynamics_product(x));
        let moved = self.load_derivative_of_motion(x);
        self.subtract_loads(&moved, out);
    }

    fn receive_product(&mut self, tangent: &Exchange, out: &mut [f64]) {
        self.subtract_loads(&self.load_derivative(&tangent.wall_loads), out);
    }

    fn precondition(&mut self, r: &[f64], _tangent: &mut Exchange, x: &mut [f64]) {
        if self.inverse.is_none() {
            self.inverse = self.preconditioner();
        }
        match &self.inverse {
            Some(inverse) => inverse.apply(r, x),
            None => x.copy_from_slice(r),
        }
    }

    /// (1/dtau) omega_a (M + added mass) dt.
    fn add_pseudo_time(&mut self, x: &[f64], out: &mut [f64]) {
        let (count, mass) = (self.count(), self.inertia_with_fluid(self.slab.dt));
        for (a, weight) in self.time().weights().iter().enumerate() {
            for k in 0..count {
                let inertia: f64 = (0..count).map(|l| mass[(k, l)] * x[a * count + l]).sum();
                out[a * count + k] += self.inverse_pseudo_time * weight * self.slab.dt * inertia;
            }
        }
    }
}

impl<const D: usize> Body for RigidBody<D> {
    fn initial(&self) -> Vec<f64> {
        let rates = self.data.coordinates.iter().map(|coordinate| coordinate.rate_at_start);
        vec![0.0; self.count()].into_iter().chain(rates).chain(Ledger::default().numbers()).collect()
    }

    fn read(&self, stored: &[f64]) -> BodyState {
        let (position, rest) = stored.split_at(self.count());
        let (rate, ledger) = rest.split_at(self.count());
        BodyState {
            kinetic_energy: self.kinetic_energy(position, rate),
            potential_energy: self.spring_energy(position),
            position: position.to_vec(),
            rate: rate.to_vec(),
            ledger: Ledger::read(ledger),
            reactions: Vec::new(),
        }
    }

    fn travel(&self, z: &[f64]) -> f64 {
        let length = |number: usize| self.surface.length(&self.data.coordinates[number % self.count()]);
        let ways = z.iter().enumerate().map(|(number, rate)| (self.step * rate / length(number)).powi(2));
        (ways.sum::<f64>() / z.len() as f64).sqrt()
    }

    fn jump(&self, z: &[f64]) -> f64 {
        let mut jump = jump(self.time(), z, &self.slab.rate);
        // A prescribed motion is known: its jumps are no error of the body.
        self.driven().for_each(|k| jump[k] = 0.0);
        2.0 * self.kinetic_energy(&self.slab.position, &jump)
    }

    fn last_digits(&self, z: &[f64]) -> Vec<f64> {
        last_digits(z, &self.slab.position, self.slab.dt)
    }

    fn guess(&mut self, past: Option<(&[f64], f64)>, exchange: &mut Exchange, z: &mut [f64]) {
        match past {
            Some((past, dt)) => extend(self.time(), self.slab.dt / dt, past, z),
            None => z.chunks_exact_mut(self.count()).for_each(|z| z.copy_from_slice(&self.slab.rate)),
        }
        self.prescribe_rates(z);
        self.set_rates(z, exchange);
    }

    fn move_walls(&mut self, x: &[f64], displacement: &mut [f64]) {
        let derivatives = self.surface_derivatives.take().unwrap_or_else(|| self.derivatives_of_surface());
        self.add_to_fields(&self.displacement_along(&derivatives, x), displacement);
        self.surface_derivatives = Some(derivatives);
    }

    fn nodes_with_velocity_at_top(&self) -> Vec<usize> {
        self.surface.nodes.iter().map(|node| node.node).collect()
    }

    fn add_velocity_at_top(&self, z: &[f64], velocity: &mut [f64]) {
        let [q, mut rates] = self.at_top(z);
        for k in self.driven() {
            self.exact_rate(k).into_iter().for_each(|rate| rates[k] = rate);
        }
        let of_surface = derivatives(&self.data.displacement(&self.surface.nodes, &along(&q, &rates)));
        self.surface.add_to_field(&of_surface, velocity);
    }

    fn check_slab(&self, z: &[f64]) -> Result<(), SlabError> {
        // The slab may pass the end that its bottom is short of.
        self.positions(z).chunks_exact(self.count()).try_for_each(|q| self.check_turn(q, TAU))?;
        match self.energy_gain(z) {
            gain if gain > LARGEST_GAIN => Err(SlabError::EnergyGain { body: self.data.name.clone(), gain }),
            _ => Ok(()),
        }
    }

    fn end_slab(&mut self, z: &[f64], stored: &mut Vec<f64>) {
        let ledger = self.closed(z, Ledger::read(&stored[2 * self.count()..]));
        let [q, rates] = self.at_top(z);
        stored.clear();
        stored.extend(q.iter().chain(&self.released(&q, rates)).chain(&ledger.numbers()));
    }
}
