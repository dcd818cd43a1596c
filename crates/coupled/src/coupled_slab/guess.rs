//! The first guess of a slab.

use super::{CoupledSlab, Predictor};
use crate::blocks::FlowBlock;
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use newton_krylov::problem::NonlinearProblem;

impl<const D: usize, const M: usize> CoupledSlab<D, M> {
    /// Begins the slab `interval` on top of `state`. Returns the guess of z and the norms that relative tolerances refer to.
    ///
    /// # Errors
    /// A mesh that cannot be moved or is not valid, or a flow that is not admissible.
    pub fn guess(&mut self, state: &State, interval: Interval) -> Result<(Vec<f64>, Vec<f64>), SlabError> {
        let system = &mut self.system;
        system.begin(interval, state)?;
        let FlowBlock { preconditioner, operator, .. } = &mut system.flow;
        preconditioner.patience = state.reuse_policy.patience();
        preconditioner.reconsider_coarse_level(operator, state.reuse_policy.base);
        let mut z = vec![0.0; system.len()];
        system.guess_bodies(state, &mut z);
        let mut v = self.guess_velocities(state, interval);
        let range = self.system.mesh_range();
        if self.predictor == Predictor::Elastic || range.is_empty() {
            self.system.move_mesh(&mut v)?;
            // No flow is solved on an invalid mesh.
            self.check_mesh()?;
        }
        let (mesh, flow) = (range.len(), self.system.flow_range());
        z[range].copy_from_slice(&v[..mesh]);
        z[flow].copy_from_slice(&self.constant_guess(state));
        let (references, norm) = self.system.references(&z)?;
        if self.predictor != Predictor::Constant {
            self.improve_guess(state, interval, &mut z, norm);
        }
        Ok((z, references))
    }

    /// The state at the bottom, at every time node.
    pub fn constant_guess(&self, state: &State) -> Vec<f64> {
        let layout = self.system.flow.operator.layout;
        let one = layout.at_one_time();
        let mut guess = vec![0.0; layout.len()];
        for cell in 0..layout.cells {
            for a in 0..layout.time_order {
                guess[layout.cell_at(cell, a)].copy_from_slice(&state.u[one.cell(cell)]);
            }
        }
        guess
    }

    /// Replaces the flow's guess by the polynomial of the slab before, if its residual is smaller than `norm`, that of the guess.
    fn improve_guess(&mut self, state: &State, interval: Interval, z: &mut [f64], norm: f64) {
        let Some(past) = &state.past else { return };
        let (layout, range) = (self.system.flow.operator.layout, self.system.flow_range());
        let mut candidate = z.to_vec();
        let time = self.system.mover().slab_motion.time();
        for (a, s) in time.nodes().iter().enumerate() {
            let phi = time.extrapolation((interval.length()) / past.dt, *s);
            for cell in 0..layout.cells {
                let out = &mut candidate[range.clone()][layout.cell_at(cell, a)];
                out.fill(0.0);
                for (b, phi) in phi.iter().enumerate() {
                    out.iter_mut().zip(&past.u[layout.cell_at(cell, b)]).for_each(|(u, old)| *u += phi * old);
                }
            }
        }
        let mut r = vec![0.0; z.len()];
        let admissible = self.system.residual(&candidate, &mut r).is_ok();
        if admissible && self.system.inner_product().norm(&r) < norm {
            z.copy_from_slice(&candidate);
        }
    }

    /// The first guess of the mesh velocities: rest, unless the motion of the slab before may be continued.
    fn guess_velocities(&self, state: &State, interval: Interval) -> Vec<f64> {
        let mover = self.system.mover();
        let (time, len) = (mover.slab_motion.time(), mover.field_len());
        let extrapolated = state.extrapolated_velocities(time, len, interval.length());
        let is_good = match self.predictor {
            Predictor::Constant => false,
            Predictor::Elastic => true,
            Predictor::Extrapolated => mover.quality(&state.d, &extrapolated, interval).is_valid(),
        };
        if is_good { extrapolated } else { vec![0.0; len * time.order()] }
    }
}
