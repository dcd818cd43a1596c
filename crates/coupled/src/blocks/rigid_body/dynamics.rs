//! (rigid body) without the loads of the flow, its derivative, and the preconditioner.

use super::{AddedMass, RigidBody, Vec3};
use basis::Matrix;
use tensor::{cross, dot};

/// The motion of the centre of mass at the time nodes of a slab.
struct Motion {
    /// q_a, `[a][k]`.
    q: Vec<f64>,
    /// m [ sum_b T_ab v_c,b - phi_a(0) v_c,n ]
    momentum: Vec<Vec3>,
}

impl<const D: usize> RigidBody<D> {
    /// v_c at the coordinates `q` and their rates `w`.
    pub(super) fn velocity_of_mass(&self, q: &[f64], w: &[f64]) -> Vec3 {
        let mut v = [0.0; 3];
        for (k, w) in w.iter().enumerate() {
            let mode = self.data.mode(k, q);
            (0..3).for_each(|i| v[i] += w * mode[i]);
        }
        v
    }

    fn rotates(&self, k: usize) -> bool {
        self.data.coordinates[k].direction.is_none()
    }

    /// b(s_a)
    pub(super) fn outer_force(&self, a: usize) -> Vec3 {
        let t = self.slab.start + self.time().nodes()[a] * self.slab.dt;
        self.data.force.as_ref().map_or([0.0; 3], |force| force(t))
    }

    /// sum_b T_ab v_b - phi_a(0) v_n of vectors of any length.
    fn rate(&self, a: usize, v: &[f64], bottom: &[f64]) -> Vec<f64> {
        let (row, at_bottom) = (self.time().slab_matrix().row(a), self.time().values(0.0)[a]);
        let sum = |i: usize| (0..row.len()).map(|b| row[b] * v[b * bottom.len() + i]).sum::<f64>();
        (0..bottom.len()).map(|i| sum(i) - at_bottom * bottom[i]).collect()
    }

    fn motion(&self, w: &[f64]) -> Motion {
        let (count, n) = (self.count(), self.time().order());
        let q = self.positions(w);
        let velocity = |a: usize| self.velocity_of_mass(&q[a * count..][..count], &w[a * count..][..count]);
        let v: Vec<f64> = (0..n).flat_map(velocity).collect();
        let bottom = self.velocity_of_mass(&self.slab.position, &self.slab.rate);
        let momentum = |a: usize| {
            let rate = self.rate(a, &v, &bottom);
            std::array::from_fn(|i| self.data.mass * rate[i])
        };
        Motion { momentum: (0..n).map(momentum).collect(), q }
    }

    /// r := (rigid body) without Q; at driven coordinates the difference to the prescribed rate, in units of momentum.
    pub(super) fn dynamics(&self, w: &[f64], r: &mut [f64]) {
        self.free_dynamics(w, r);
        let mut prescribed = w.to_vec();
        self.prescribe_rates(&mut prescribed);
        let (count, mass) = (self.count(), self.inertia_with_fluid(self.step));
        for k in self.driven() {
            for a in 0..self.time().order() {
                let i = a * count + k;
                r[i] = mass[(k, k)] * (w[i] - prescribed[i]);
            }
        }
    }

    /// r := (rigid body) without Q at all coordinates, driven or not: there it is the impulse of the drive.
    pub(super) fn free_dynamics(&self, w: &[f64], r: &mut [f64]) {
        let (count, Motion { q, momentum }) = (self.count(), self.motion(w));
        for (a, r) in r.chunks_exact_mut(count).enumerate() {
            let (q, force) = (&q[a * count..][..count], self.outer_force(a));
            let (weight, spin) = (self.slab.dt * self.time().weights()[a], self.rate(a, w, &self.slab.rate));
            for (k, r) in r.iter_mut().enumerate() {
                let (mode, coordinate) = (self.data.mode(k, q), &self.data.coordinates[k]);
                let springs = coordinate.damping * w[a * count + k] + coordinate.spring_force(q[k]);
                *r = dot(&mode, &momentum[a]) + weight * (springs - dot(&mode, &force));
                if self.rotates(k) {
                    *r += self.data.moment_of_inertia * spin[k];
                }
            }
        }
    }

    /// out := the derivative of (rigid body) without Q along the rates `x`.
    pub(super) fn dynamics_product(&self, x: &[f64], out: &mut [f64]) {
        let (count, n) = (self.count(), self.time().order());
        let (Motion { q, momentum }, still) = (self.motion(&self.w), vec![0.0; count]);
        let dq = self.at_nodes(&still, x);
        let at = |v: &'_ [f64], a: usize| -> Vec<f64> { v[a * count..][..count].to_vec() };
        let dv: Vec<f64> = (0..n)
            .flat_map(|a| {
                let moved = self.velocity_of_mass(&at(&q, a), &at(x, a));
                let turned = self.mode_derivative_sum(&at(&q, a), &at(&self.w, a), &at(&dq, a));
                (0..3).map(|i| moved[i] + turned[i]).collect::<Vec<_>>()
            })
            .collect();
        for (a, out) in out.chunks_exact_mut(count).enumerate() {
            let (rate, spin) = (self.rate(a, &dv, &[0.0; 3]), self.rate(a, x, &still));
            let (q, dq, force) = (at(&q, a), at(&dq, a), self.outer_force(a));
            let weight = self.slab.dt * self.time().weights()[a];
            let dmomentum = std::array::from_fn(|i| self.data.mass * rate[i]);
            for (k, out) in out.iter_mut().enumerate() {
                let (mode, coordinate) = (self.data.mode(k, &q), &self.data.coordinates[k]);
                let dmode = self.mode_derivative(k, &q, &dq);
                let springs = coordinate.damping * x[a * count + k] + coordinate.spring_stiffness(q[k]) * dq[k];
                *out = dot(&mode, &dmomentum) + dot(&dmode, &momentum[a]) + weight * (springs - dot(&dmode, &force));
                if self.rotates(k) {
                    *out += self.data.moment_of_inertia * spin[k];
                }
            }
        }
        let mass = self.inertia_with_fluid(self.step);
        for k in self.driven() {
            (0..n).for_each(|a| out[a * count + k] = mass[(k, k)] * x[a * count + k]);
        }
    }

    /// dg_k along `dq`: n x g_k for the rotation.
    fn mode_derivative(&self, k: usize, q: &[f64], dq: &[f64]) -> Vec3 {
        if !self.rotates(k) {
            return [0.0; 3];
        }
        let (_, dtheta) = self.data.motion(dq);
        cross(&self.data.axis, &self.data.mode(k, q)).map(|g| dtheta * g)
    }

    fn mode_derivative_sum(&self, q: &[f64], w: &[f64], dq: &[f64]) -> Vec3 {
        let mut sum = [0.0; 3];
        for (k, w) in w.iter().enumerate() {
            let dmode = self.mode_derivative(k, q, dq);
            (0..3).for_each(|i| sum[i] += w * dmode[i]);
        }
        sum
    }

    /// The coordinates that are driven in this slab.
    pub(super) fn driven(&self) -> impl Iterator<Item = usize> {
        let start = self.slab.start;
        (0..self.count()).filter(move |k| self.data.coordinates[*k].is_driven(start))
    }

    /// Sets the rates of driven coordinates to those whose positions at the time nodes are the prescribed ones.
    pub(super) fn prescribe_rates(&self, w: &mut [f64]) {
        let count = self.count();
        for k in self.driven() {
            let Some(drive) = &self.data.coordinates[k].drive else { continue };
            let time = |s: &f64| self.slab.start + s * self.slab.dt;
            let mut rates: Vec<f64> = self.time().nodes().iter().map(|s| (drive.position)(time(s))).collect();
            self.motion.velocities(self.slab.dt, &self.slab.position[k..=k], &mut rates);
            rates.iter().enumerate().for_each(|(a, rate)| w[a * count + k] = *rate);
        }
    }

    /// The matrix of inertia at the bottom with (added mass) in a slab of length `dt`.
    pub(super) fn inertia_with_fluid(&self, dt: f64) -> Matrix {
        let position = if self.slab.position.is_empty() { vec![0.0; self.count()] } else { self.slab.position.clone() };
        let (data, fluid) = (&self.data, self.added_mass(dt));
        Matrix::from_fn(self.count(), self.count(), |k, l| {
            let own = data.mass * dot(&data.mode(k, &position), &data.mode(l, &position));
            let spin = if k == l && self.rotates(k) { data.moment_of_inertia } else { 0.0 };
            own + spin + fluid[(k, l)]
        })
    }

    /// (added mass) in a slab of length `dt`.
    fn added_mass(&self, dt: f64) -> Matrix {
        let AddedMass { density, speed_of_sound, depth, area } = &self.data.added_mass;
        let ratio = self.mean_eigenvalue * depth / (dt * speed_of_sound);
        let layer = density * depth / (1.0 + ratio * ratio).sqrt();
        Matrix::from_fn(self.count(), self.count(), |k, l| layer * area[(k, l)])
    }

    /// The inverse of the derivative of (rigid body) with (added mass) in place of the load.
    pub(super) fn preconditioner(&self) -> Option<Matrix> {
        let (count, n) = (self.count(), self.time().order());
        let len = n * count;
        let columns: Vec<Vec<f64>> = (0..len)
            .map(|i| {
                let (mut unit, mut column) = (vec![0.0; len], vec![0.0; len]);
                unit[i] = 1.0;
                self.dynamics_product(&unit, &mut column);
                column
            })
            .collect();
        let (with_fluid, added) = (self.inertia_with_fluid(self.slab.dt), self.added_mass(self.slab.dt));
        let driven: Vec<usize> = self.driven().collect();
        let matrix = Matrix::from_fn(len, len, |i, j| {
            let (a, k, b, l) = (i / count, i % count, j / count, j % count);
            let fluid = if driven.contains(&k) { 0.0 } else { added[(k, l)] };
            let damped = if a == b { self.inverse_pseudo_time * self.time().weights()[a] * self.slab.dt } else { 0.0 };
            columns[j][i] + self.time().slab_matrix()[(a, b)] * fluid + damped * with_fluid[(k, l)]
        });
        matrix.inverse()
    }
}
