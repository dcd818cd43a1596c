//! (rigid body) without the loads of the flow, its derivative, and the preconditioner.

use super::{RigidBody, Six, Vec3, along, derivatives};
use basis::Matrix;
use tensor::{Transcendental, dot};

impl<const D: usize> RigidBody<D> {
    /// b(s_a)
    pub(super) fn outer_force(&self, a: usize) -> Vec3 {
        let t = self.slab.clock.time(self.time().nodes()[a]);
        self.data.force.as_ref().map_or([0.0; 3], |force| force(t))
    }

    /// (m v_c, H) at the coordinates `q` and their rates `w`.
    pub(super) fn momentum<T: Transcendental>(&self, q: &[T], w: &[T]) -> Six<T> {
        self.data.momentum(q, &self.data.velocity(q, w))
    }

    /// The terms of inertia of (rigid body), `[a][k]`.
    pub(super) fn inertia<T: Transcendental>(&self, w: &[T]) -> Vec<T> {
        let (count, q) = (self.count(), self.positions(w));
        let nodes = q.chunks_exact(count).zip(w.chunks_exact(count));
        let momentum: Vec<Six<T>> = nodes.map(|(q, w)| self.momentum(q, w)).collect();
        let bottom = self.momentum(&self.slab.position, &self.slab.rate);
        let (matrix, at_bottom) = (self.time().slab_matrix(), self.time().values(0.0));
        let rate = |a: usize| -> Six<T> {
            let sum = |i: usize| momentum.iter().zip(matrix.row(a)).fold(w[0].zero(), |sum, (p, t)| sum + p[i] * *t);
            std::array::from_fn(|i| sum(i) - at_bottom[a] * bottom[i])
        };
        let at_node = |(a, q)| {
            let rate = rate(a);
            self.data.modes(q).into_iter().map(move |mode| dot(&mode, &rate))
        };
        q.chunks_exact(count).enumerate().flat_map(at_node).collect()
    }

    /// (rigid body) without Q at all coordinates. At driven ones it is the impulse of the drive.
    pub(super) fn free_dynamics<T: Transcendental>(&self, w: &[T]) -> Vec<T> {
        let (count, q, mut r) = (self.count(), self.positions(w), self.inertia(w));
        for (a, r) in r.chunks_exact_mut(count).enumerate() {
            let (q, w, weight) = (&q[a * count..][..count], &w[a * count..], self.slab.dt * self.time().weights()[a]);
            let (modes, force) = (self.data.modes(q), self.outer_force(a));
            for (k, coordinate) in self.data.coordinates.iter().enumerate() {
                let springs = w[k] * coordinate.damping + coordinate.spring_force(q[k]);
                let outer = modes[k][0] * force[0] + modes[k][1] * force[1] + modes[k][2] * force[2];
                r[k] += (springs - outer) * weight;
            }
        }
        r
    }

    /// (rigid body) without Q; at driven coordinates the difference to the prescribed rate, in units of momentum.
    pub(super) fn dynamics<T: Transcendental>(&self, w: &[T]) -> Vec<T> {
        let (count, mass) = (self.count(), self.inertia_with_fluid(self.step));
        let (mut r, mut prescribed) = (self.free_dynamics(w), vec![0.0; w.len()]);
        self.prescribe_rates(&mut prescribed);
        for k in self.driven() {
            (k..w.len()).step_by(count).for_each(|i| r[i] = (w[i] - prescribed[i]) * mass[(k, k)]);
        }
        r
    }

    /// The derivative of (rigid body) without Q along the rates `x`.
    pub(super) fn dynamics_product(&self, x: &[f64]) -> Vec<f64> {
        derivatives(&self.dynamics(&along(&self.w, x)))
    }

    /// The coordinates that are driven in this slab.
    pub(super) fn driven(&self) -> impl Iterator<Item = usize> {
        let start = self.slab.clock.time(0.0);
        (0..self.count()).filter(move |k| self.data.coordinates[*k].is_driven(start, self.step))
    }

    /// Sets the rates of driven coordinates by (prescribed) of `elasticity::slab`.
    pub(super) fn prescribe_rates(&self, w: &mut [f64]) {
        let count = self.count();
        for k in self.driven() {
            let Some(drive) = &self.data.coordinates[k].drive else { continue };
            let position = |s: &f64| (drive.position)(self.slab.clock.time(*s));
            let positions = self.motion.times_of_prescribed().iter().map(position).collect();
            let rates = self.motion.prescribed(self.slab.dt, &self.slab.position[k..=k], positions);
            rates.iter().enumerate().for_each(|(a, rate)| w[a * count + k] = *rate);
        }
    }

    /// The rates at the top, at the coordinates `q`, with which the next slab begins: `rates`, unless a drive ends there. The coordinate then has
    /// the rate of its drive. An impulse of the drive changes it, so that the momenta of free coordinates stay:
    ///
    /// ```text
    /// sum_l M_kl dw_l = 0 for free k,   dw_l = drive - w_l for released l                                        (release)
    /// ```
    pub(super) fn released(&self, q: &[f64], rates: Vec<f64>) -> Vec<f64> {
        let (count, top) = (self.count(), self.slab.clock.time(1.0));
        let driven: Vec<usize> = self.driven().collect();
        let mut change = vec![0.0; count];
        for &k in driven.iter().filter(|k| !self.data.coordinates[**k].is_driven(top, self.step)) {
            change[k] = self.exact_rate(k).map_or(0.0, |rate| rate - rates[k]);
        }
        if change.iter().all(|change| *change == 0.0) {
            return rates;
        }
        let mass = self.inertia_at(q);
        let is_free = |k: usize| !driven.contains(&k);
        let matrix = |k: usize, l: usize| if is_free(k) { mass[(k, l)] } else { f64::from(u8::from(k == l)) };
        let right = |k: usize| if is_free(k) { 0.0 } else { change[k] };
        let Some(inverse) = Matrix::from_fn(count, count, matrix).inverse() else { return rates };
        let mut changes = vec![0.0; count];
        inverse.apply(&(0..count).map(right).collect::<Vec<_>>(), &mut changes);
        rates.iter().zip(changes).map(|(rate, change)| rate + change).collect()
    }

    /// M_kl = g_k . m g_l + G_k . R J R^T G_l at the coordinates `q`.
    fn inertia_at(&self, q: &[f64]) -> Matrix {
        let modes = self.data.modes(q);
        let momenta: Vec<Six<f64>> = modes.iter().map(|mode| self.data.momentum(q, mode)).collect();
        Matrix::from_fn(self.count(), self.count(), |k, l| dot(&modes[k], &momenta[l]))
    }

    /// The matrix of inertia at the bottom with (added mass) in a slab of length `dt`.
    pub(super) fn inertia_with_fluid(&self, dt: f64) -> Matrix {
        let position = if self.slab.position.is_empty() { vec![0.0; self.count()] } else { self.slab.position.clone() };
        let (inertia, fluid) = (self.inertia_at(&position), &self.data.added_mass);
        let layer = fluid.surface_density(self.mean_eigenvalue / dt);
        Matrix::from_fn(self.count(), self.count(), |k, l| inertia[(k, l)] + layer * fluid.area[(k, l)])
    }

    /// T m_L of (added mass), with the derivative (dt W)^-1 T in time: the load of the layer per area and rate, `[a][b]`.
    fn layer_load(&self) -> Option<Matrix> {
        let (time, fluid) = (self.time(), &self.data.added_mass);
        let (t, n, mass) = (time.slab_matrix(), time.order(), fluid.density * fluid.depth);
        let derivative = |a: usize, b: usize| t[(a, b)] / (self.slab.dt * time.weights()[a]);
        let delayed = |a: usize, b: usize| f64::from(u8::from(a == b)) + fluid.delay() * derivative(a, b);
        let load = t.product(&Matrix::from_fn(n, n, delayed).inverse()?);
        Some(Matrix::from_fn(n, n, |a, b| mass * load[(a, b)]))
    }

    /// The inverse of the derivative of (rigid body), with (added mass) as the estimate of the load.
    pub(super) fn preconditioner(&self) -> Option<Matrix> {
        let (count, n) = (self.count(), self.time().order());
        let len = n * count;
        let units = Matrix::identity(len);
        let columns: Vec<Vec<f64>> = (0..len).map(|i| self.dynamics_product(units.row(i))).collect();
        let (with_fluid, layer, area) =
            (self.inertia_with_fluid(self.slab.dt), self.layer_load()?, &self.data.added_mass.area);
        let driven: Vec<usize> = self.driven().collect();
        let matrix = Matrix::from_fn(len, len, |i, j| {
            let (a, k, b, l) = (i / count, i % count, j / count, j % count);
            let fluid = if driven.contains(&k) { 0.0 } else { layer[(a, b)] * area[(k, l)] };
            let damped = if a == b { self.inverse_pseudo_time * self.time().weights()[a] * self.slab.dt } else { 0.0 };
            columns[j][i] + fluid + damped * with_fluid[(k, l)]
        });
        matrix.inverse()
    }
}
