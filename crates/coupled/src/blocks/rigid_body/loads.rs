//! The load of the flow on a rigid body.
//!
//! ```text
//! Q_a,k = sum_q phi_a(s_q) e_k . sum_i L_q,i                                    translations
//!       = sum_q phi_a(s_q) G_k(s_q) . sum_i (x_i - p - h) x L_q,i               rotations
//!         + e W_a,k / (sum_b,l W_b,l^2 + slow^2),    e = work of the wall - work of these forces and moments                  (rigid load)
//! ```
//!
//! The last sum is over all rotations l. Between the time nodes the wall is a polynomial in time, not a rigid body. The last term, of the
//! order of the error in time, gives the body exactly the energy that the flow loses.

use super::geometry::six;
use super::{RigidBody, Six, SurfaceNode, along, derivatives, lifted};
use crate::blocks::slab_times::at_each_point;
use basis::Matrix;
use tensor::{Transcendental, cross, dot};

/// The load without the correction, and the work of the wall.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads<T> {
    /// `[a][k]`
    moments: Vec<T>,
    /// sum_q,i L_q,i . v_i(s_q)
    wall_work: T,
}

/// The wall at a time point: arms and velocities of its nodes.
struct Wall<T> {
    arms: Vec<[T; 3]>,
    velocities: Vec<[T; 3]>,
    /// Velocity of the pivot and angular velocity per rate of every coordinate.
    modes: Vec<Six<T>>,
}

/// The rate of a body that turns by this angle in a slab counts as zero.
const HARDLY: f64 = 1e-5;

impl<const D: usize> RigidBody<D> {
    /// Computes the load at the point of linearisation and evaluation.
    pub(super) fn set_loads(&mut self) {
        self.loads = self.load(&self.w, &self.flow_loads);
        self.load_columns = None;
    }

    /// Q with the correction, at the rates `w`.
    pub(super) fn total<T: Transcendental>(&self, loads: &Loads<T>, w: &[T]) -> Vec<T> {
        let (count, slow) = (self.count(), HARDLY / self.slab.dt);
        let turns = |i: &usize| self.data.coordinates[i % count].freedom.rotates();
        let squares = (0..w.len()).filter(turns).fold(T::from(slow * slow), |sum, i| sum + w[i] * w[i]);
        let error = loads.moments.iter().zip(w).fold(loads.wall_work, |sum, (q, w)| sum - *q * *w);
        let (mut total, factor) = (loads.moments.clone(), error / squares);
        (0..w.len()).filter(turns).for_each(|i| total[i] += factor * w[i]);
        total
    }

    /// Q of the nodal loads `l`, `[time point][loaded node][component]`, on the wall that moves with the rates `w`.
    fn load<T: Transcendental>(&self, w: &[T], l: &[T]) -> Loads<T> {
        let (count, rates) = (self.count(), self.surface_rates(self.surface.wall(), w));
        let mut loads = Loads { moments: vec![T::from(0.0); w.len()], wall_work: T::from(0.0) };
        for (point, l) in at_each_point(l, self.points.len()).enumerate() {
            let wall = self.wall_at(point, w, &rates);
            let (resultant, power) = self.resultant(&wall, l);
            loads.wall_work += power;
            for (i, q) in loads.moments.iter_mut().enumerate() {
                *q += dot(&wall.modes[i % count], &resultant) * self.at_points[(point, i / count)];
            }
        }
        loads
    }

    /// Force and moment about the pivot, and the power, of the nodal loads `l` at a time point.
    fn resultant<T: Transcendental>(&self, wall: &Wall<T>, l: &[T]) -> (Six<T>, T) {
        let (mut force, mut moment, mut power) = ([T::from(0.0); 3], [T::from(0.0); 3], T::from(0.0));
        for ((loaded, arm), velocity) in self.surface.loaded.iter().zip(&wall.arms).zip(&wall.velocities) {
            let load = in_space(&l[loaded * D..(loaded + 1) * D]);
            let turning = cross(arm, &load);
            (0..3).for_each(|d| (force[d], moment[d]) = (force[d] + load[d], moment[d] + turning[d]));
            power += dot(&load, velocity);
        }
        (six(&force, &moment), power)
    }

    /// The wall at a time point. The coordinates have the rates `w`, and the wall nodes the velocities `rates`, at the time nodes.
    fn wall_at<T: Transcendental>(&self, point: usize, w: &[T], rates: &[T]) -> Wall<T> {
        let (dt, s) = (self.slab.dt, self.points[point]);
        let wall = self.surface.wall().len() * D;
        let (mut d, mut q) = (lifted(&self.slab.surface[..wall]), lifted(&self.slab.position));
        self.motion.displacement(dt, &d.clone(), rates, s, &mut d);
        self.motion.displacement(dt, &q.clone(), w, s, &mut q);
        let h = self.data.place(&q).h;
        let arm = |(node, d): (&SurfaceNode<D>, &[T])| {
            let (rest, d) = (self.data.arm(&node.position), in_space(d));
            std::array::from_fn(|i| d[i] - h[i] + rest[i])
        };
        Wall {
            arms: self.surface.wall().iter().zip(d.chunks_exact(D)).map(arm).collect(),
            velocities: self.interpolated(point, rates).chunks_exact(D).map(in_space).collect(),
            modes: self.data.pivot_modes(&q),
        }
    }

    /// sum_b phi_b V_b at a time point, of vectors V of any length.
    fn interpolated<T: Transcendental>(&self, point: usize, v: &[T]) -> Vec<T> {
        let (phi, length) = (self.at_points.row(point), v.len() / self.time().order());
        let mut sum = vec![T::from(0.0); length];
        for (phi, v) in phi.iter().zip(v.chunks_exact(length)) {
            sum.iter_mut().zip(v).for_each(|(sum, v)| *sum += *v * *phi);
        }
        sum
    }

    /// The derivative of Q along the rates `x`, at fixed nodal loads: the arms and the velocity of the wall change.
    pub(super) fn load_derivative_of_motion(&mut self, x: &[f64]) -> Vec<f64> {
        let columns = self.load_columns.take().unwrap_or_else(|| self.columns_of_load());
        let of_row = |i: usize| columns.iter().zip(x).map(|(column, x)| column[i] * x).sum();
        let derivative = (0..x.len()).map(of_row).collect();
        self.load_columns = Some(columns);
        derivative
    }

    /// The derivatives of Q along every rate, at fixed nodal loads.
    fn columns_of_load(&self) -> Vec<Vec<f64>> {
        let units = Matrix::identity(self.w.len());
        let column = |i: usize| {
            let w = along(&self.w, units.row(i));
            derivatives(&self.total(&self.load(&w, &lifted(&self.flow_loads)), &w))
        };
        (0..self.w.len()).map(column).collect()
    }

    /// The derivative of Q along the nodal loads `l`, at fixed rates: Q is linear in them.
    pub(super) fn load_derivative(&self, l: &[f64]) -> Vec<f64> {
        self.total(&self.load(&self.w, l), &self.w)
    }

    /// r -= Q where the coordinate is not driven.
    pub(super) fn subtract_loads(&self, q: &[f64], r: &mut [f64]) {
        let count = self.count();
        let driven: Vec<usize> = self.driven().collect();
        let free = |i: &usize| !driven.contains(&(i % count));
        (0..r.len()).filter(free).for_each(|i| r[i] -= q[i]);
    }
}

/// A vector with D components as a vector of space.
fn in_space<T: Transcendental>(components: &[T]) -> [T; 3] {
    std::array::from_fn(|k| components.get(k).copied().unwrap_or(T::from(0.0)))
}
