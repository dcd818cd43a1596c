//! The motion of the surface of a rigid body in a slab, and its derivatives.
//!
//! At the time nodes the surface has the velocity of the body. A constant leads it to the position of the body at the top:
//!
//! ```text
//! V_b = ( x(q_b) )' + c,    dV_b = sum_k ( dx/dq_k dW_b,k + d(x')/dq_k dq_b,k ) + dc                        (surface)
//! ```
//!
//! A polynomial through the positions x(q_b) would leave the pressure on a body that turns one order in time less.

use super::{RigidBody, SurfaceNode, along, derivatives, lifted};
use crate::block::Exchange;
use basis::Matrix;
use tensor::Transcendental;

/// The derivatives of the surface along a coordinate at a time node, `[node][component]`.
pub(super) struct SurfaceDerivatives {
    /// dx/dq_k, which is dx'/dW_k.
    of_position: Vec<f64>,
    /// dx'/dq_k
    of_velocity: Vec<f64>,
}

impl<const D: usize> RigidBody<D> {
    /// Sets the rates to `w`, and writes the displacement of the nodes that the body moves.
    pub(super) fn set_rates(&mut self, w: &[f64], exchange: &mut Exchange) {
        if self.w != w || self.surface_displacement.is_empty() {
            self.w.copy_from_slice(w);
            self.surface_derivatives = None;
            let rates = self.surface_rates(&self.surface.nodes, w);
            self.surface_displacement = self.displacement_at_nodes(&self.slab.surface, &rates);
        }
        self.add_to_fields(&self.surface_displacement, &mut exchange.wall_displacement);
    }

    /// V of (surface) for the first nodes of the surface, `[b][node][component]`, and the rates `w` of the coordinates.
    pub(super) fn surface_rates<T: Transcendental>(&self, nodes: &[SurfaceNode<D>], w: &[T]) -> Vec<T> {
        let (q, count) = (self.positions(w), self.count());
        let velocity = |(q, w): (&[T], &[T])| derivatives(&self.data.displacement(nodes, &along(q, w)));
        let mut rates: Vec<T> = q.chunks_exact(count).zip(w.chunks_exact(count)).flat_map(velocity).collect();
        let top = self.data.displacement(nodes, &q[q.len() - count..]);
        self.motion.lead_to(self.slab.dt, &lifted(&self.slab.surface[..top.len()]), &top, &mut rates);
        rates
    }

    /// The displacement at the time nodes of points with the `rates` `[b][..]` that start from `bottom`.
    fn displacement_at_nodes(&self, bottom: &[f64], rates: &[f64]) -> Vec<f64> {
        let mut displacement = vec![0.0; rates.len()];
        for (a, d) in displacement.chunks_exact_mut(bottom.len()).enumerate() {
            self.motion.displacement_at_node(self.slab.dt, bottom, rates, a, d);
        }
        displacement
    }

    /// Adds values of the surface at the time nodes, `[time node][node][component]`, to `fields`, `[time node][C0 node][component]`.
    pub(super) fn add_to_fields(&self, values: &[f64], fields: &mut [f64]) {
        let nodes = self.time().order();
        let (of_surface, of_field) = (values.len() / nodes, fields.len() / nodes);
        for (values, field) in values.chunks_exact(of_surface).zip(fields.chunks_exact_mut(of_field)) {
            self.surface.add_to_field(values, field);
        }
    }

    /// The derivatives of the surface at the time nodes, `[b][k]`.
    pub(super) fn derivatives_of_surface(&self) -> Vec<SurfaceDerivatives> {
        let (q, count) = (self.positions(&self.w), self.count());
        let (units, zero) = (Matrix::identity(count), vec![0.0; count]);
        let along_coordinate = |q: &[f64], w: &[f64], k: usize| {
            let moving = self.data.displacement(&self.surface.nodes, &along(&along(q, units.row(k)), &along(w, &zero)));
            SurfaceDerivatives {
                of_position: moving.iter().map(|x| x.value.derivative).collect(),
                of_velocity: moving.iter().map(|x| x.derivative.derivative).collect(),
            }
        };
        let nodes = q.chunks_exact(count).zip(self.w.chunks_exact(count));
        nodes.flat_map(|(q, w)| (0..count).map(move |k| along_coordinate(q, w, k))).collect()
    }

    /// The derivative of the displacement of the surface at the time nodes along the rates `x`, by (surface).
    pub(super) fn displacement_along(&self, derivatives: &[SurfaceDerivatives], x: &[f64]) -> Vec<f64> {
        let (count, still) = (self.count(), vec![0.0; self.slab.surface.len()]);
        let dq = self.displacement_at_nodes(&vec![0.0; count], x);
        let mut rates = vec![0.0; still.len() * self.time().order()];
        for (i, derivative) in derivatives.iter().enumerate() {
            let of_node = &mut rates[i / count * still.len()..][..still.len()];
            for ((rate, of_position), of_velocity) in
                of_node.iter_mut().zip(&derivative.of_position).zip(&derivative.of_velocity)
            {
                *rate += of_position * x[i] + of_velocity * dq[i];
            }
        }
        let (mut top, last) = (still.clone(), x.len() - count);
        for (derivative, dq) in derivatives[last..].iter().zip(&dq[last..]) {
            top.iter_mut().zip(&derivative.of_position).for_each(|(top, of_position)| *top += of_position * dq);
        }
        self.motion.lead_to(self.slab.dt, &still, &top, &mut rates);
        self.displacement_at_nodes(&still, &rates)
    }
}
