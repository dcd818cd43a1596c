//! (rigid motion) of the nodes of the mesh that a body moves.

use super::{Coordinate, RigidBodyData, Vec3};
use tensor::{cross, rotated};

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

/// The nodes that a body moves, and those of them that are loaded.
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
        if coordinate.direction.is_some() { self.size } else { 1.0 }
    }

    /// The displacement of the wall nodes in the field `d`, `[C0 node][component]`.
    pub(super) fn gather(&self, d: &[f64]) -> Vec<f64> {
        self.nodes[..self.loaded.len()]
            .iter()
            .flat_map(|node| &d[node.node * D..(node.node + 1) * D])
            .copied()
            .collect()
    }

    /// The displacement of the wall nodes at the coordinates `q`, `[node][component]`.
    pub(super) fn wall_displacement(&self, data: &RigidBodyData, q: &[f64]) -> Vec<f64> {
        let motion = data.motion(q);
        self.wall().iter().flat_map(|node| data.displacement(node, motion)).collect()
    }

    /// Its derivative along `dq`.
    pub(super) fn wall_derivative(&self, data: &RigidBodyData, q: &[f64], dq: &[f64]) -> Vec<f64> {
        let (motion, along) = (data.motion(q), data.motion(dq));
        self.wall().iter().flat_map(|node| data.displacement_derivative(node, motion, along)).collect()
    }

    /// Adds the displacement at the coordinates `q` to the field `out`, `[C0 node][component]`.
    pub(super) fn add_displacement(&self, data: &RigidBodyData, q: &[f64], out: &mut [f64]) {
        let motion = data.motion(q);
        self.add(out, |node| data.displacement(node, motion));
    }

    /// Adds its derivative along `dq`.
    pub(super) fn add_derivative(&self, data: &RigidBodyData, q: &[f64], dq: &[f64], out: &mut [f64]) {
        let (motion, along) = (data.motion(q), data.motion(dq));
        self.add(out, |node| data.displacement_derivative(node, motion, along));
    }

    fn wall(&self) -> &[SurfaceNode<D>] {
        &self.nodes[..self.loaded.len()]
    }

    fn add(&self, out: &mut [f64], value: impl Fn(&SurfaceNode<D>) -> [f64; D]) {
        for node in &self.nodes {
            let value = value(node);
            out[node.node * D..(node.node + 1) * D].iter_mut().zip(value).for_each(|(out, value)| *out += value);
        }
    }
}

impl RigidBodyData {
    /// The translation and the rotation at the coordinates `q`, or their rates.
    pub(super) fn motion(&self, q: &[f64]) -> (Vec3, f64) {
        let (mut h, mut theta) = ([0.0; 3], 0.0);
        for (coordinate, q) in self.coordinates.iter().zip(q) {
            match coordinate.direction {
                Some(direction) => (0..3).for_each(|i| h[i] += q * direction[i]),
                None => theta = *q,
            }
        }
        (h, theta)
    }

    /// X - p
    pub(super) fn arm<const D: usize>(&self, x: &[f64; D]) -> Vec3 {
        std::array::from_fn(|i| if i < D { x[i] - self.pivot[i] } else { 0.0 })
    }

    /// The displacement of `node` by a translation and a rotation, (rigid motion).
    fn displacement<const D: usize>(&self, node: &SurfaceNode<D>, (h, theta): (Vec3, f64)) -> [f64; D] {
        let arm = self.arm(&node.position);
        let turned = rotated(&self.axis, node.weight * theta, &arm);
        std::array::from_fn(|d| node.weight * h[d] + (turned[d] - arm[d]))
    }

    /// Its derivative along a translation and a rotation.
    fn displacement_derivative<const D: usize>(
        &self,
        node: &SurfaceNode<D>,
        (_, theta): (Vec3, f64),
        (dh, dtheta): (Vec3, f64),
    ) -> [f64; D] {
        let turned = rotated(&self.axis, node.weight * theta, &self.arm(&node.position));
        let along = cross(&self.axis, &turned);
        std::array::from_fn(|d| node.weight * (dh[d] + dtheta * along[d]))
    }

    /// g_k = dv_c / dq_k' at the coordinates `q`.
    pub(super) fn mode(&self, k: usize, q: &[f64]) -> Vec3 {
        let (_, theta) = self.motion(q);
        self.coordinates[k]
            .direction
            .unwrap_or_else(|| cross(&self.axis, &rotated(&self.axis, theta, &self.centre_of_mass)))
    }
}
