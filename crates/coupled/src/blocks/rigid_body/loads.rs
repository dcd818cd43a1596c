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

use super::geometry::{cross, dot};
use super::{RigidBody, Vec3};
use crate::block::Ledger;

/// The load without the correction, and what the wall does.
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
    /// Q of the nodal loads `l`, `[time point][loaded node][component]`.
    pub(super) fn load(&self, l: &[f64]) -> Loads {
        let (count, n) = (self.count(), self.time.order());
        let rotation = (0..count).find(|k| self.data.coordinates[*k].direction.is_none());
        let mut loads = Loads { moments: vec![0.0; n * count], wall_work: 0.0, rotation, slow: HARDLY / self.slab.dt };
        let walls = self.wall_in_time();
        for (point, l) in l.chunks_exact(l.len() / self.points.len().max(1)).enumerate() {
            let (force, moment, work) = self.resultants(&walls, point, l);
            loads.wall_work += work;
            for a in 0..n {
                for k in 0..count {
                    let of_mode =
                        self.data.coordinates[k].direction.map_or(moment, |direction| dot(&direction, &force));
                    loads.moments[a * count + k] += self.at_points[(point, a)] * of_mode;
                }
            }
        }
        loads
    }

    /// Force, moment about the pivot and power of the nodal loads `l` at a time point.
    fn resultants(&self, walls: &WallInTime, point: usize, l: &[f64]) -> (Vec3, f64, f64) {
        let (mut force, mut moment, mut power) = ([0.0; 3], 0.0, 0.0);
        for (i, loaded) in self.surface.loaded.iter().enumerate() {
            let load: Vec3 = std::array::from_fn(|d| if d < D { l[loaded * D + d] } else { 0.0 });
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
        let mut velocities: Vec<f64> =
            q.chunks_exact(count).flat_map(|q| self.surface.wall_displacement(&self.data, q)).collect();
        elasticity::SlabMotion::new(self.time.clone()).velocities(self.slab.dt, &self.slab.surface, &mut velocities);
        let rest = |i: usize| self.data.arm(&self.surface.nodes[i].position);
        let coordinates = |integrals: &[f64]| self.moved(&self.slab.position, &self.w, integrals);
        self.in_time(&velocities, &self.slab.surface, rest, coordinates)
    }

    /// Arms `rest` + d(s) - h(s) and velocities v(s) at the time points, where d grows from `bottom` by `velocities`, `[b][node][component]`,
    /// and `coordinates` gives those of the body from the integrals of the time basis.
    fn in_time(
        &self,
        velocities: &[f64],
        bottom: &[f64],
        rest: impl Fn(usize) -> Vec3,
        coordinates: impl Fn(&[f64]) -> Vec<f64>,
    ) -> WallInTime {
        let (wall, n) = (self.surface.loaded.len(), self.time.order());
        let mut walls = WallInTime { wall, arms: Vec::new(), velocities: Vec::new() };
        for (point, s) in self.points.iter().enumerate() {
            let integrals = self.time.integrals(*s);
            let (h, _) = self.data.motion(&coordinates(&integrals));
            for i in 0..wall {
                let sum = |weight: &dyn Fn(usize) -> f64, d: usize| -> f64 {
                    (0..n).map(|b| weight(b) * velocities[(b * wall + i) * D + d]).sum()
                };
                let (rest, in_space) = (rest(i), |f: &dyn Fn(usize) -> f64| -> Vec3 {
                    std::array::from_fn(|d| if d < D { f(d) } else { 0.0 })
                });
                let displacement = |d: usize| bottom[i * D + d] + self.slab.dt * sum(&|b| integrals[b], d);
                walls.arms.push(in_space(&|d| rest[d] + displacement(d) - h[d]));
                walls.velocities.push(in_space(&|d| sum(&|b| self.at_points[(point, b)], d)));
            }
        }
        walls
    }

    /// `bottom` + dt sum_b integrals[b] w[b]
    fn moved(&self, bottom: &[f64], w: &[f64], integrals: &[f64]) -> Vec<f64> {
        let count = self.count();
        let moved = |k: usize| -> f64 { integrals.iter().enumerate().map(|(b, i)| i * w[b * count + k]).sum() };
        (0..count).map(|k| bottom[k] + self.slab.dt * moved(k)).collect()
    }

    /// The derivative of Q along the rates `x`, at fixed nodal loads: the arms and the velocity of the wall change.
    pub(super) fn load_derivative_of_motion(&self, x: &[f64]) -> Vec<f64> {
        let (count, n) = (self.count(), self.time.order());
        let here = self.load(&self.flow_loads);
        let mut along =
            Loads { moments: vec![0.0; n * count], wall_work: 0.0, rotation: here.rotation, slow: here.slow };
        let Some(rotation) = here.rotation else { return along.moments };
        let moved = self.wall_derivative_in_time(x);
        for (point, l) in self.flow_loads.chunks_exact(self.flow_loads.len() / self.points.len()).enumerate() {
            let (_, moment, work) = self.resultants(&moved, point, l);
            along.wall_work += work;
            (0..n).for_each(|a| along.moments[a * count + rotation] += self.at_points[(point, a)] * moment);
        }
        here.derivative(&along, &self.w, x, count)
    }

    /// The derivative of [`Self::wall_in_time`] along the rates `x`.
    fn wall_derivative_in_time(&self, x: &[f64]) -> WallInTime {
        let (q, count) = (self.positions(&self.w), self.count());
        let still = vec![0.0; count];
        let dq = self.at_nodes(&still, x);
        let at_nodes = q.chunks_exact(count).zip(dq.chunks_exact(count));
        let mut velocities: Vec<f64> =
            at_nodes.flat_map(|(q, dq)| self.surface.wall_derivative(&self.data, q, dq)).collect();
        let bottom = vec![0.0; self.slab.surface.len()];
        elasticity::SlabMotion::new(self.time.clone()).velocities(self.slab.dt, &bottom, &mut velocities);
        self.in_time(&velocities, &bottom, |_| [0.0; 3], |integrals| self.moved(&still, x, integrals))
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
        let (count, n, weights) = (self.count(), self.time.order(), self.time.weights());
        let mut r = vec![0.0; z.len()];
        self.free_dynamics(z, &mut r);
        let q = self.load(&self.flow_loads).total(z, count);
        let positions = self.positions(z);
        let driven: Vec<usize> = self.driven().collect();
        let flow: f64 = q.iter().zip(z).map(|(q, w)| q * w).sum();
        let mut ledger = Ledger { flow: before.flow + flow, ..before };
        let mut springs = 0.0;
        for a in 0..n {
            let (w, here) = (&z[a * count..][..count], &positions[a * count..][..count]);
            let weight = self.slab.dt * weights[a];
            ledger.force += weight * dot(&self.outer_force_at(a), &self.velocity_of_mass(here, w));
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

    fn outer_force_at(&self, a: usize) -> Vec3 {
        let t = self.slab.start + self.time.nodes()[a] * self.slab.dt;
        self.data.force.as_ref().map_or([0.0; 3], |force| force(t))
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
        let (count, n, phi) = (self.count(), self.time.order(), self.time.values(0.0));
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

/// Arms and velocities of the wall nodes at the time points, `[point][node]`.
struct WallInTime {
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
