//! (rigid motion) of the nodes of the mesh that a body moves.

use super::{Coordinate, Freedom, RigidBodyData, Six, Vec3};
use tensor::{Transcendental, angular_velocity, cross, moved_by_rotation, rotated};

/// A node of the mesh that a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceNode<const D: usize> {
    /// The C0 node.
    pub node: usize,
    /// X, its position at rest.
    pub position: [f64; D],
    /// w
    pub weight: f64,
}

/// The nodes that a body moves; the flow loads some of them.
#[derive(Clone, Debug, Default)]
pub struct Surface<const D: usize> {
    /// All nodes; those of the wall come first.
    pub nodes: Vec<SurfaceNode<D>>,
    /// For every node of the wall, in the order of `nodes`, its position in the list of loaded nodes of the flow.
    pub loaded: Vec<usize>,
    /// The size of the body.
    pub size: f64,
}

impl<const D: usize> Surface<D> {
    /// The unit of a coordinate: the size of the body, or one radian.
    pub(super) fn length(&self, coordinate: &Coordinate) -> f64 {
        if coordinate.freedom.rotates() { 1.0 } else { self.size }
    }

    /// Adds `values`, `[node][component]`, to the field `out`, `[C0 node][component]`.
    pub(super) fn add_to_field(&self, values: &[f64], out: &mut [f64]) {
        for (node, values) in self.nodes.iter().zip(values.chunks_exact(D)) {
            out[node.node * D..(node.node + 1) * D].iter_mut().zip(values).for_each(|(out, value)| *out += value);
        }
    }

    /// The nodes of the wall.
    pub(super) fn wall(&self) -> &[SurfaceNode<D>] {
        &self.nodes[..self.loaded.len()]
    }
}

/// The position of a body.
pub struct BodyPosition<T> {
    /// h
    pub(super) h: [T; 3],
    /// Theta
    pub(super) theta: [T; 3],
    /// Whether a coordinate is a rotation.
    rotates: bool,
}

impl<T: Transcendental> BodyPosition<T> {
    /// h and Theta of coordinates with these values.
    pub fn new(coordinates: impl Iterator<Item = (Freedom, T)>) -> Self {
        let zero = [T::from(0.0); 3];
        let mut position = BodyPosition { h: zero, theta: zero, rotates: false };
        for (freedom, q) in coordinates {
            position.rotates |= freedom.rotates();
            let (sum, direction) = match freedom {
                Freedom::Translation(direction) => (&mut position.h, direction),
                Freedom::Rotation(axis) => (&mut position.theta, axis),
            };
            (0..3).for_each(|i| sum[i] += q * direction[i]);
        }
        position
    }

    /// The displacement of a point at `arm` from the pivot at rest, with the weight w, (rigid motion).
    pub fn displacement<const D: usize>(&self, arm: &Vec3, weight: f64) -> [T; D] {
        let translated = std::array::from_fn(|d| self.h[d] * weight);
        if !self.rotates {
            return translated;
        }
        let turned = moved_by_rotation(&self.theta.map(|theta| theta * weight), &arm.map(T::from));
        std::array::from_fn(|d| translated[d] + turned[d])
    }
}

impl RigidBodyData {
    /// Theta
    pub(super) fn rotation_vector(&self, q: &[f64]) -> Vec3 {
        self.place(q).theta
    }

    /// h and Theta at the coordinates `q`.
    pub(super) fn place<T: Transcendental>(&self, q: &[T]) -> BodyPosition<T> {
        BodyPosition::new(self.coordinates.iter().map(|coordinate| coordinate.freedom).zip(q.iter().copied()))
    }

    /// X - p
    pub(super) fn arm<const D: usize>(&self, x: &[f64; D]) -> Vec3 {
        std::array::from_fn(|i| if i < D { x[i] - self.pivot[i] } else { 0.0 })
    }

    /// The displacement of `nodes` at the coordinates `q`, (rigid motion), `[node][component]`.
    pub(super) fn displacement<T: Transcendental, const D: usize>(&self, nodes: &[SurfaceNode<D>], q: &[T]) -> Vec<T> {
        let place = self.place(q);
        let of_node = |node: &SurfaceNode<D>| place.displacement::<D>(&self.arm(&node.position), node.weight);
        nodes.iter().flat_map(of_node).collect()
    }

    /// Velocity of the pivot and angular velocity per rate of every coordinate: (e_k, 0) or (0, G_k).
    pub(super) fn pivot_modes<T: Transcendental>(&self, q: &[T]) -> Vec<Six<T>> {
        let (theta, zero) = (self.place(q).theta, [T::from(0.0); 3]);
        let mode = |coordinate: &Coordinate| match coordinate.freedom {
            Freedom::Translation(direction) => six(&direction.map(T::from), &zero),
            Freedom::Rotation(axis) => six(&zero, &angular_velocity(&theta, &axis.map(T::from))),
        };
        self.coordinates.iter().map(mode).collect()
    }

    /// (g_k, G_k) of every coordinate at the coordinates `q`.
    pub(super) fn modes<T: Transcendental>(&self, q: &[T]) -> Vec<Six<T>> {
        let arm = rotated(&self.place(q).theta, &self.centre_of_mass.map(T::from));
        let mut modes = self.pivot_modes(q);
        for mode in &mut modes {
            let turning = cross(&[mode[3], mode[4], mode[5]], &arm);
            (0..3).for_each(|i| mode[i] += turning[i]);
        }
        modes
    }

    /// (v_c, Omega) at the coordinates `q` and their rates `w`.
    pub(super) fn velocity<T: Transcendental>(&self, q: &[T], w: &[T]) -> Six<T> {
        let mut sum = [T::from(0.0); 6];
        for (mode, w) in self.modes(q).iter().zip(w) {
            (0..6).for_each(|i| sum[i] += *w * mode[i]);
        }
        sum
    }

    /// (m v_c, H) at the coordinates `q`, where the velocity is (v_c, Omega).
    pub(super) fn momentum<T: Transcendental>(&self, q: &[T], velocity: &Six<T>) -> Six<T> {
        let theta = self.place(q).theta;
        let spin = rotated(&theta.map(|theta| -theta), &[velocity[3], velocity[4], velocity[5]]);
        let at_rest = std::array::from_fn(|i| (0..3).fold(spin[0].zero(), |sum, j| sum + spin[j] * self.inertia[i][j]));
        six(&[velocity[0], velocity[1], velocity[2]].map(|v| v * self.mass), &rotated(&theta, &at_rest))
    }
}

/// Joins two vectors of space.
pub(super) fn six<T: Copy>(first: &[T; 3], second: &[T; 3]) -> Six<T> {
    std::array::from_fn(|i| if i < 3 { first[i] } else { second[i - 3] })
}
