//! An elastic body in one slab: supports, loads of the flow, walls, energy.

use super::ElasticBody;
use crate::block::Ledger;
use crate::blocks::slab_times::at_each_point;
use crate::state::extend;
use elasticity::{SlabBottom, StructureSlab};
use fem::Clock;
use newton_krylov::inner_product::{Euclidean, InnerProduct};

/// The slab that is being solved. Fields have the layout `[C0 node][component]`, behind a time node where there is one.
#[derive(Clone, Debug, Default)]
pub(super) struct Slab {
    /// The times of supports and loads.
    pub(super) clock: Clock,
    pub(super) dt: f64,
    /// d_n
    pub(super) displacement: Vec<f64>,
    /// w_n
    pub(super) velocity: Vec<f64>,
    /// f(s_a)
    pub(super) forces: Vec<f64>,
    /// V_a of (support) at fixed entries, zero elsewhere.
    pub(super) supports: Vec<f64>,
    /// The mean force of the supports, once the slab has ended.
    pub(super) reaction: Vec<f64>,
}

impl<const D: usize> ElasticBody<D> {
    /// The equations of the structure in the slab.
    pub(super) fn in_slab(&self) -> StructureSlab<'_, D> {
        let Slab { clock, dt, displacement, velocity, .. } = &self.slab;
        let bottom = SlabBottom { time: clock.time(0.0), displacement, velocity };
        let (structure, loads, motion) = (&self.data.structure, &self.data.loads, &self.motion);
        StructureSlab { structure, loads, motion, bottom, dt: *dt, clock: *clock }
    }

    /// The velocities of the supports at the time nodes.
    pub(super) fn prescribed(&self) -> Vec<f64> {
        let (data, Slab { clock, dt, displacement, .. }) = (&self.data, &self.slab);
        let mut v = vec![0.0; self.w.len()];
        if clock.runs() {
            data.supports.set_velocities(&data.structure, &self.motion, (*clock, *dt), displacement, &mut v);
        }
        v
    }

    /// z := the unknowns of the slab before, extrapolated; without them the velocity at the bottom. `past` holds them and its length.
    pub(super) fn extrapolate(&self, past: Option<(&[f64], f64)>, z: &mut [f64]) {
        match past {
            Some((past, dt)) => extend(self.motion.time(), self.slab.dt / dt, past, z),
            None => z.chunks_exact_mut(self.slab.velocity.len()).for_each(|z| z.copy_from_slice(&self.slab.velocity)),
        }
    }

    /// Writes the displacement of the walls at the time nodes, from the displacement at the `bottom` and the velocities `w`.
    pub(super) fn write_walls(&self, bottom: &[f64], w: &[f64], displacement: &mut [f64]) {
        let field = displacement.len() / self.motion.time().order();
        let mut d = vec![0.0; bottom.len()];
        for (a, out) in displacement.chunks_exact_mut(field).enumerate() {
            self.motion.displacement_at_node(self.slab.dt, bottom, w, a, &mut d);
            self.interface.add_displacement(D, &d, out);
        }
    }

    /// L_a of the loads `l` of the flow, `[time point][loaded node][component]`.
    pub(super) fn nodal_loads(&self, l: &[f64]) -> Vec<f64> {
        let length = self.data.structure.length();
        let mut loads = vec![0.0; self.w.len()];
        for (point, l) in at_each_point(l, self.at_points.rows()).enumerate() {
            for (a, loads) in loads.chunks_exact_mut(length).enumerate() {
                let phi = self.at_points[(point, a)];
                for (solid, loaded) in self.interface.wall() {
                    (0..D).for_each(|i| loads[solid * D + i] += phi * l[loaded * D + i]);
                }
            }
        }
        loads
    }

    /// The ledger after the slab with the velocities `w`; keeps the reaction of the supports.
    pub(super) fn closed(&mut self, w: &[f64], before: Ledger) -> Ledger {
        let (slab, fixed) = (self.in_slab(), self.data.structure.fixed());
        let mut r = vec![0.0; w.len()];
        // The slab is solved, so the residual is defined.
        let _ = slab.residual(&self.slab.forces, w, &mut r);
        r.iter_mut().zip(&self.flow_loads).for_each(|(r, load)| *r -= load);
        let work = slab.work(&self.slab.forces, w, &r);
        let reaction = slab.reaction(&r);
        let open: Vec<f64> = r.iter().enumerate().map(|(i, r)| if fixed[i % fixed.len()] { 0.0 } else { *r }).collect();
        self.slab.reaction = reaction;
        Ledger {
            flow: before.flow + Euclidean.dot(&self.flow_loads, w),
            drive: before.drive + work.support,
            force: before.force + work.load,
            damped: before.damped + work.damped,
            numerical: before.numerical + work.dissipation,
            defect: before.defect + Euclidean.dot(&open, w),
        }
    }
}
