//! The load of the flow on a rigid body, and its energy.
//!
//! ```text
//! Q_a,k = sum_q phi_a(s_q) sum_i L_q,i . e_k                          translations along e_k
//!       = sum_q phi_a(s_q) sum_i n . ( (x_i - p - h) x L_q,i )          the rotation
//!         + e W_a / (sum_b W_b^2 + slow^2),    e = work of the wall - work of the moments                                     (rigid load)
//! ```
//!
//! Between the time nodes the wall is a polynomial in time, not a rigid body. The last term, of the order of the error in time, gives the
//! body exactly the energy that the flow loses.

use super::{RigidBody, Vec3};
use crate::block::Ledger;
use crate::blocks::instants::at_each_point;
use tensor::{cross, dot};

/// The load without the correction, and what the wall does.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    /// `[a][k]`
    pub(super) moments: Vec<f64>,
    /// sum_q,i L_q,i . v_i(s_q)
    pub(super) wall_work: f64,
    /// The coordinate that rotates.
    rotation: Option<usize>,
    /// A rate at which the body hardly turns in a slab.
    slow: f64,
}

/// The angle that a body turns in a slab at such a rate.
const HARDLY: f64 = 1e-5;

impl Loads {
    /// sum_b W_b^2 of coordinate `k` and a rate so slow that e is round-off.
    fn squares(&self, w: &[f64], k: usize, count: usize) -> f64 {
        w.iter().skip(k).step_by(count).map(|w| w * w).sum::<f64>() + self.slow * self.slow
    }

    /// e W_a / sum_b W_b^2 has this factor before W_a, for the rates `w` of `count` coordinates.
    fn factor(&self, w: &[f64], count: usize) -> f64 {
        let Some(k) = self.rotation else { return 0.0 };
        let work: f64 = self.moments.iter().zip(w).map(|(q, w)| q * w).sum();
        (self.wall_work - work) / self.squares(w, k, count)
    }

    /// Q with the correction, at the rates `w`.
    pub(super) fn total(&self, w: &[f64], count: usize) -> Vec<f64> {
        let (mut total, factor) = (self.moments.clone(), self.factor(w, count));
        let Some(k) = self.rotation else { return total };
        total.iter_mut().zip(w).skip(k).step_by(count).for_each(|(q, w)| *q += factor * w);
        total
    }

    /// The derivative of Q where `along` is that of the moments and of the work of the wall, and `x` that of the rates `w`.
    pub(super) fn derivative(&self, along: &Loads, w: &[f64], x: &[f64], count: usize) -> Vec<f64> {
        let mut total = along.moments.clone();
        let Some(k) = self.rotation else { return total };
        let factor = self.factor(w, count);
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let turning: f64 = w.iter().zip(x).skip(k).step_by(count).map(|(w, x)| w * x).sum();
        let error = along.wall_work - dot(&along.moments, w) - dot(&self.moments, x);
        let dfactor = (error - 2.0 * factor * turning) / self.squares(w, k, count);
        let entries = total.iter_mut().zip(w.iter().zip(x)).skip(k).step_by(count);
        entries.for_each(|(q, (w, x))| *q += dfactor * w + factor * x);
        total
    }
}

impl<const D: usize> RigidBody<D> {
    /// Takes the motion of the wall and its load at the point of linearisation and evaluation.
    pub(super) fn set_loads(&mut self) {
        self.wall = self.wall_in_time();
        self.loads = self.load(&self.flow_loads);
    }

    /// Q = 0.
    fn no_load(&self) -> Loads {
        let (count, n) = (self.count(), self.time().order());
        let rotation = (0..count).find(|k| self.data.coordinates[*k].direction.is_none());
        Loads { moments: vec![0.0; n * count], wall_work: 0.0, rotation, slow: HARDLY / self.slab.dt }
    }

    /// Q of the nodal loads `l`, `[time point][loaded node][component]`, on the wall as it moves.
    pub(super) fn load(&self, l: &[f64]) -> Loads {
        let (count, mut loads) = (self.count(), self.no_load());
        for (point, l) in at_each_point(l, self.points.len()).enumerate() {
            let (force, moment, work) = self.resultants(&self.wall, point, l);
            loads.wall_work += work;
            for (i, q) in loads.moments.iter_mut().enumerate() {
                let of_mode = self.data.coordinates[i % count].direction.map_or(moment, |mode| dot(&mode, &force));
                *q += self.at_points[(point, i / count)] * of_mode;
            }
        }
        loads
    }

    /// Force, moment about the pivot and power of the nodal loads `l` at a time point.
    fn resultants(&self, walls: &WallInTime, point: usize, l: &[f64]) -> (Vec3, f64, f64) {
        let (mut force, mut moment, mut power) = ([0.0; 3], 0.0, 0.0);
        for (i, loaded) in self.surface.loaded.iter().enumerate() {
            let load = in_space(&l[loaded * D..(loaded + 1) * D], |_, l| l);
            let (arm, velocity) = walls.at(point, i);
            (0..3).for_each(|d| force[d] += load[d]);
            moment += dot(&self.data.axis, &cross(arm, &load));
            power += dot(&load, velocity);
        }
        (force, moment, power)
    }

    /// The positions of the wall nodes relative to the pivot and their velocities at the time points, as the mesh moves.
    fn wall_in_time(&self) -> WallInTime {
        let (q, count) = (self.positions(&self.w), self.count());
        let d = q.chunks_exact(count).flat_map(|q| self.surface.wall_displacement(&self.data, q)).collect();
        let rest = |i: usize| self.data.arm(&self.surface.nodes[i].position);
        self.in_time(d, &self.slab.surface, rest, &self.slab.position, &self.w)
    }

    /// Its derivative along the rates `x`.
    fn wall_derivative_in_time(&self, x: &[f64]) -> WallInTime {
        let (count, wall, body) = (self.count(), vec![0.0; self.slab.surface.len()], vec![0.0; self.count()]);
        let (q, dq) = (self.positions(&self.w), self.at_nodes(&body, x));
        let at_nodes = q.chunks_exact(count).zip(dq.chunks_exact(count));
        let d = at_nodes.flat_map(|(q, dq)| self.surface.wall_derivative(&self.data, q, dq)).collect();
        self.in_time(d, &wall, |_| [0.0; 3], &body, x)
    }

    /// Arms `rest` + d(s) - h(s) and velocities d'(s) at the time points. d has the value `wall` at the bottom and `d` at the time nodes. The
    /// coordinates grow from `body` by the rates `w`.
    fn in_time(&self, d: Vec<f64>, wall: &[f64], rest: impl Fn(usize) -> Vec3, body: &[f64], w: &[f64]) -> WallInTime {
        let (dt, mut rates) = (self.slab.dt, d);
        self.motion.velocities(dt, wall, &mut rates);
        let (mut d, mut q) = (wall.to_vec(), body.to_vec());
        let mut walls = WallInTime { wall: wall.len() / D, ..WallInTime::default() };
        for (point, s) in self.points.iter().enumerate() {
            self.motion.displacement(dt, wall, &rates, *s, &mut d);
            self.motion.displacement(dt, body, w, *s, &mut q);
            let (h, _) = self.data.motion(&q);
            let arm = |(i, d): (usize, &[f64])| -> Vec3 { in_space(d, |k, d| rest(i)[k] + d - h[k]) };
            walls.arms.extend(d.chunks_exact(D).enumerate().map(arm));
            let phi = self.at_points.row(point);
            let v: Vec<f64> = (0..d.len())
                .map(|i| phi.iter().zip(rates.chunks_exact(d.len())).map(|(phi, rate)| phi * rate[i]).sum())
                .collect();
            walls.velocities.extend(v.chunks_exact(D).map(|v| in_space(v, |_, v| v)));
        }
        walls
    }

    /// The derivative of Q along the rates `x`, at fixed nodal loads: the arms and the velocity of the wall change.
    pub(super) fn load_derivative_of_motion(&self, x: &[f64]) -> Vec<f64> {
        let (count, mut along) = (self.count(), self.no_load());
        let Some(rotation) = along.rotation else { return along.moments };
        let moved = self.wall_derivative_in_time(x);
        for (point, l) in at_each_point(&self.flow_loads, self.points.len()).enumerate() {
            let (_, moment, work) = self.resultants(&moved, point, l);
            along.wall_work += work;
            let moments = along.moments.iter_mut().skip(rotation).step_by(count).enumerate();
            moments.for_each(|(a, q)| *q += self.at_points[(point, a)] * moment);
        }
        self.loads.derivative(&along, &self.w, x, count)
    }

    /// r -= Q where the coordinate is not driven.
    pub(super) fn subtract_loads(&self, q: &[f64], r: &mut [f64]) {
        let count = self.count();
        let driven: Vec<usize> = self.driven().collect();
        let free = |i: &usize| !driven.contains(&(i % count));
        (0..r.len()).filter(free).for_each(|i| r[i] -= q[i]);
    }

    /// The ledger after a slab with the rates `z`.
    pub(super) fn closed(&self, z: &[f64], before: Ledger) -> Ledger {
        let (count, n, weights) = (self.count(), self.time().order(), self.time().weights());
        let mut r = vec![0.0; z.len()];
        self.free_dynamics(z, &mut r);
        let q = self.loads.total(z, count);
        let positions = self.positions(z);
        let driven: Vec<usize> = self.driven().collect();
        let flow: f64 = q.iter().zip(z).map(|(q, w)| q * w).sum();
        let mut ledger = Ledger { flow: before.flow + flow, ..before };
        let mut springs = 0.0;
        for a in 0..n {
            let (w, here) = (&z[a * count..][..count], &positions[a * count..][..count]);
            let weight = self.slab.dt * weights[a];
            ledger.force += weight * dot(&self.outer_force(a), &self.velocity_of_mass(here, w));
            for k in 0..count {
                let power = (r[a * count + k] - q[a * count + k]) * w[k];
                if driven.contains(&k) {
                    ledger.drive += power
                } else {
                    ledger.defect += power
                }
                ledger.damped += weight * self.data.coordinates[k].damping * w[k] * w[k];
                springs += weight * self.data.coordinates[k].spring_force(here[k]) * w[k];
            }
        }
        let stored = self.spring_energy(&positions[(n - 1) * count..]) - self.spring_energy(&self.slab.position);
        ledger.numerical += self.kinetic_jump(z) + springs - stored;
        ledger
    }

    /// m v_c^2 / 2 + I theta'^2 / 2
    pub fn kinetic_energy(&self, q: &[f64], w: &[f64]) -> f64 {
        let v = self.velocity_of_mass(q, w);
        let (_, spin) = self.data.motion(w);
        0.5 * self.data.mass * dot(&v, &v) + 0.5 * self.data.moment_of_inertia * spin * spin
    }

    /// The energy in springs.
    pub fn spring_energy(&self, q: &[f64]) -> f64 {
        self.data.coordinates.iter().zip(q).map(|(coordinate, q)| coordinate.spring_energy(*q)).sum()
    }

    /// The kinetic energy of the jumps at the bottom.
    fn kinetic_jump(&self, z: &[f64]) -> f64 {
        let (count, n, phi) = (self.count(), self.time().order(), self.time().values(0.0));
        let positions = self.positions(z);
        let mut jump = self.velocity_of_mass(&self.slab.position, &self.slab.rate).map(|v| -v);
        let mut spin = -self.data.motion(&self.slab.rate).1;
        for a in 0..n {
            let (q, w) = (&positions[a * count..][..count], &z[a * count..][..count]);
            let v = self.velocity_of_mass(q, w);
            (0..3).for_each(|i| jump[i] += phi[a] * v[i]);
            spin += phi[a] * self.data.motion(w).1;
        }
        0.5 * self.data.mass * dot(&jump, &jump) + 0.5 * self.data.moment_of_inertia * spin * spin
    }
}

/// A vector of as many components as there are, as one of space: `value` of each component and its number.
fn in_space(components: &[f64], value: impl Fn(usize, f64) -> f64) -> Vec3 {
    std::array::from_fn(|k| components.get(k).map_or(0.0, |c| value(k, *c)))
}

/// Arms and velocities of the wall nodes at the time points, `[point][node]`.
#[derive(Clone, Debug, Default)]
pub(super) struct WallInTime {
    wall: usize,
    arms: Vec<Vec3>,
    velocities: Vec<Vec3>,
}

impl WallInTime {
    fn at(&self, point: usize, node: usize) -> (&Vec3, &Vec3) {
        let i = point * self.wall + node;
        (&self.arms[i], &self.velocities[i])
    }
}
