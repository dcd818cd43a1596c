//! One slab as one nonlinear problem.
//!
//! ```text
//! z = (W, V, U),   R(z) = ( R_s(W; U, V), R_e(V; W), R_f(U; V) )                                                  (coupled)
//! ```
//!
//! W are the unknowns of bodies, V the velocities of the mesh, U the flow. Motions that are prescribed everywhere leave V out of z. Without
//! bodies dR/dz is block lower triangular: the mesh does not depend on the flow.

mod effect_of_bodies;
mod residual_breakdown;
mod rounding;

pub use effect_of_bodies::krylov_precision;
pub use residual_breakdown::ResidualBreakdown;

use crate::block::{Block, Body, Exchange, Quantity};
use crate::blocks::{Counts, FlowBlock, MeshBlock};
use crate::lagged_preconditioner::Linearisation;
use crate::mesh_mover::MeshMover;
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use fem::{Clock, Share, SlabOperator};
use newton_krylov::fgmres::Precision;
use newton_krylov::inner_product::{InnerProduct, Parts, Weighted};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use std::ops::Range;

/// The coupled problem of the current slab.
pub struct System<const D: usize, const M: usize> {
    /// Bodies: they move walls, and the flow loads them.
    pub bodies: Vec<Box<dyn Body>>,
    /// The mesh.
    pub mesh: MeshBlock<D>,
    /// The flow.
    pub flow: FlowBlock<D, M>,
    /// rho U^2 of the reference state, the unit of the kinetic energy of jumps of bodies.
    pub kinetic_scale: f64,
    /// The unit of the volume over which jumps are summed, L^D.
    pub volume_scale: f64,
    /// At the point z last evaluated.
    pub(crate) exchange: Exchange,
    /// Along the direction last taken.
    tangent: Exchange,
    /// For each unknown of the bodies, the travel of its body in a slab per unit of that unknown.
    travel_per_unit: Vec<f64>,
    fields: Vec<Field>,
    /// The entries of z of every block: bodies, mesh, flow. The range of the mesh may be empty.
    ranges: Vec<Range<usize>>,
    weights: Weighted,
    inverse_pseudo_time: Vec<f64>,
}

impl<const D: usize, const M: usize> System<D, M> {
    /// The problem of `flow` on the mesh that `mover` moves, without bodies.
    pub fn new(flow: SlabOperator<D, M>, mover: MeshMover<D>) -> Self {
        Self::with_bodies(flow, mover, Vec::new())
    }

    /// The problem of `flow` on the mesh that `mover` and `bodies` move.
    pub fn with_bodies(flow: SlabOperator<D, M>, mover: MeshMover<D>, bodies: Vec<Box<dyn Body>>) -> Self {
        let mut mesh = MeshBlock::new(mover, flow.tables.orders.time);
        let moves_walls = |body: &dyn Body| body.couplings().writes.contains(&Quantity::WallDisplacement);
        mesh.follows_bodies = bodies.iter().any(|body| moves_walls(&**body));
        let flow = FlowBlock::new(flow);
        let mut system = System {
            bodies,
            mesh,
            flow,
            kinetic_scale: 1.0,
            volume_scale: 1.0,
            exchange: Exchange::default(),
            tangent: Exchange::default(),
            travel_per_unit: Vec::new(),
            fields: Vec::new(),
            ranges: Vec::new(),
            weights: Weighted::new(Vec::new()),
            inverse_pseudo_time: Vec::new(),
        };
        system.lay_out();
        system
    }

    /// Fields, ranges and weights of z.
    fn lay_out(&mut self) {
        let blocks = self.bodies.iter().map(|body| &**body as &dyn Block);
        let blocks = blocks.chain([&self.mesh as &dyn Block, &self.flow]);
        for (name, weights) in blocks.map(|block| (block.field(), block.weights())) {
            let start = self.weights.weights.len();
            self.weights.weights.extend(&weights);
            let range = start..self.weights.weights.len();
            if !range.is_empty() {
                self.fields.push(Field { name, range: range.clone() });
            }
            self.ranges.push(range);
        }
        let (flow, layout) = (self.flow_range(), self.flow.operator.layout);
        self.tangent.effect_is_kept = self.keeps_effect();
        self.travel_per_unit = self.travels_of_bodies();
        self.weights.parts = parts(&self.flow.operator.share, flow.start, layout.cell_len());
        self.inverse_pseudo_time = vec![0.0; self.fields.len()];
        let len = self.flow.operator.mesh.field_len() * self.flow.operator.tables.orders.time;
        self.tangent.wall_displacement = vec![0.0; len];
        self.tangent.mesh_velocity = vec![0.0; len];
    }

    /// Number of mesh unknowns in z.
    pub fn mesh_len(&self) -> usize {
        self.mesh_range().len()
    }

    /// How Krylov vectors are stored, see [`krylov_precision`].
    pub fn krylov_precision(&self) -> Precision {
        krylov_precision(self.mesh.follows_everywhere(), self.mesh_range().start)
    }

    /// The part of z of body number `body`.
    pub fn body_range(&self, body: usize) -> Range<usize> {
        self.ranges[body].clone()
    }
    /// The mesh's part of z.
    pub fn mesh_range(&self) -> Range<usize> {
        self.ranges[self.bodies.len()].clone()
    }
    /// The flow's part of z.
    pub fn flow_range(&self) -> Range<usize> {
        self.ranges[self.bodies.len() + 1].clone()
    }
    /// The motion of the mesh.
    pub fn mover(&self) -> &MeshMover<D> {
        &self.mesh.mover
    }

    /// Calls `act` with every block, its part of z, and its 1/dtau.
    fn each(&mut self, mut act: impl FnMut(&mut dyn Block, Range<usize>, f64, &mut Exchange, &mut Exchange)) {
        self.each_body(&mut act);
        self.mesh_and_flow(act);
    }

    /// [`Self::each`] for the blocks of bodies.
    fn each_body(&mut self, mut act: impl FnMut(&mut dyn Block, Range<usize>, f64, &mut Exchange, &mut Exchange)) {
        for number in 0..self.bodies.len() {
            let (range, rate) = (self.ranges[number].clone(), self.inverse_pseudo_time_of(number));
            act(&mut *self.bodies[number], range, rate, &mut self.exchange, &mut self.tangent);
        }
    }

    /// [`Self::each`] for the other blocks.
    fn mesh_and_flow(&mut self, mut act: impl FnMut(&mut dyn Block, Range<usize>, f64, &mut Exchange, &mut Exchange)) {
        let bodies = self.bodies.len();
        let [of_mesh, of_flow] = [bodies, bodies + 1].map(|number| self.inverse_pseudo_time_of(number));
        act(&mut self.mesh, self.ranges[bodies].clone(), of_mesh, &mut self.exchange, &mut self.tangent);
        act(&mut self.flow, self.ranges[bodies + 1].clone(), of_flow, &mut self.exchange, &mut self.tangent);
    }

    /// 1/dtau of block number `block`; zero where it has no unknowns.
    fn inverse_pseudo_time_of(&self, block: usize) -> f64 {
        let field = self.fields.iter().position(|field| field.range == self.ranges[block]);
        field.map_or(0.0, |field| self.inverse_pseudo_time[field])
    }

    /// Evaluates all data of this and of later slabs at `time`: a steady state depends on one time, although its slabs are long.
    pub fn hold_time(&mut self, time: f64) {
        self.flow.operator.hold_time(time);
    }

    /// Whether data follow the time of slabs.
    pub(crate) fn follows_time(&self) -> bool {
        self.flow.operator.held_time().is_none()
    }

    /// Moves to the slab `interval` on top of `state`.
    ///
    /// # Errors
    /// The error of a block that cannot begin there.
    pub fn begin(&mut self, interval: Interval, state: &State) -> Result<(), SlabError> {
        self.inverse_pseudo_time.fill(0.0);
        let clock = Clock::of_slab(interval.start, interval.length(), self.flow.operator.held_time());
        let mut begun = Ok(());
        self.each(|block, _, _, _, _| {
            if begun.is_ok() {
                begun = block.begin_slab(interval, clock, state);
            }
        });
        self.mesh.prescribe(&mut self.exchange);
        begun
    }

    /// Sets the displacement of walls to the prescribed one. Bodies then add to it.
    fn reset_walls(&mut self) {
        if !self.bodies.is_empty() {
            self.mesh.prescribe(&mut self.exchange);
        }
    }

    /// Replaces the guess `v` by the mesh in equilibrium with its boundary at every time node, and sets the mesh of the flow. Bodies must
    /// have written the displacement of their walls.
    ///
    /// # Errors
    /// As [`MeshMover::velocities`].
    pub fn move_mesh(&mut self, v: &mut [f64]) -> Result<(), elasticity::ElasticityError> {
        self.mesh.solve(&mut self.exchange, v)?;
        self.flow.set_mesh(&self.exchange);
        Ok(())
    }

    /// The guesses of the bodies, which also write the displacement of their walls.
    pub(crate) fn guess_bodies(&mut self, state: &State, z: &mut [f64]) {
        self.reset_walls();
        for (number, body) in self.bodies.iter_mut().enumerate() {
            let past = state.past.as_ref().map(|past| (&past.bodies[number][..], past.dt));
            body.guess(past, &mut self.exchange, &mut z[self.ranges[number].clone()]);
        }
    }

    /// Sets all blocks to `z`, the point of products and boundary fluxes.
    pub fn set_point(&mut self, z: &[f64]) {
        self.reset_walls();
        self.each(|block, range, rate, exchange, _| block.linearise(&z[range], exchange, rate));
    }

    /// Makes the preconditioner again from the linearisation that it was made of.
    pub fn rebuild(&mut self, linearisation: Linearisation) {
        self.flow.rebuild(linearisation);
        self.mesh.forget();
    }

    /// What attempts have cost since a slab was last accepted.
    pub fn counts(&self) -> Counts {
        Counts { elasticity_iterations: self.mesh.iterations, ..self.flow.counts }
    }

    /// Sets them, after a resume.
    pub fn set_counts(&mut self, counts: Counts) {
        (self.mesh.iterations, self.flow.counts) = (counts.elasticity_iterations, counts);
    }

    /// The counts since this was last called.
    pub(crate) fn take_counts(&mut self) -> Counts {
        let counts = self.counts();
        self.set_counts(Counts::default());
        counts
    }

    /// Block lower triangular: each block after the effect of the blocks before it.
    fn apply_inverses(&mut self, r: &[f64], out: &mut [f64]) {
        let bodies = self.mesh_range().start;
        self.each_body(|block, range, _, _, tangent| block.precondition(&r[range.clone()], tangent, &mut out[range]));
        self.move_along(&out[..bodies]);
        self.mesh_and_flow(|block, range, _, _, tangent| {
            block.precondition(&r[range.clone()], tangent, &mut out[range]);
        });
    }

    /// The norm of each field of a residual.
    pub fn field_norms(&self, r: &[f64]) -> Vec<f64> {
        self.fields.iter().map(|field| self.weights.norm_on(field.range.clone(), r)).collect()
    }

    /// The norms that relative tolerances refer to, and |R| at the guess z. For the flow it is its residual at z. The residuals of bodies and
    /// mesh are errors of position relative to the spacing of nodes. For the mesh the reference is one. For a body it is its way in the slab, at
    /// most one: a body that begins to move goes less than the spacing of nodes for many slabs.
    pub(crate) fn references(&mut self, z: &[f64]) -> Result<(Vec<f64>, f64), Inadmissible> {
        let mut r = vec![0.0; z.len()];
        self.residual(z, &mut r)?;
        let mut norms = self.field_norms(&r);
        let (bodies, flow) = (self.bodies.len(), norms.len() - 1);
        for (number, body) in self.bodies.iter().enumerate() {
            norms[number] = body.travel(&z[self.body_range(number)]).max(norms[number]).min(1.0);
        }
        norms[bodies..flow].fill(1.0);
        Ok((norms, self.weights.norm(&r)))
    }
}

/// The parts of z: all ranks have the unknowns of bodies and mesh, which are `common` entries, and the flow of their own cells.
fn parts(share: &Share, common: usize, cell_len: usize) -> Option<Parts> {
    let ends: Vec<usize> = share.ends.iter().map(|cells| cells * cell_len).collect();
    (!share.is_whole()).then(|| Parts::new(common, &ends, share.sums.clone()))
}

impl<const D: usize, const M: usize> NonlinearProblem for System<D, M> {
    fn len(&self) -> usize {
        self.weights.weights.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &self.weights
    }

    fn residual(&mut self, z: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.reset_walls();
        let mut result = Ok(());
        self.each(|block, range, _, exchange, _| {
            if result.is_ok() {
                result = block.residual(&z[range.clone()], exchange, &mut r[range]);
            }
        });
        self.each(|block, range, _, exchange, _| block.receive(exchange, &mut r[range]));
        result
    }

    fn linearise(&mut self, z: &[f64], inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.inverse_pseudo_time.copy_from_slice(inverse_pseudo_time);
        self.set_point(z);
        self.flow.update_preconditioner();
        Ok(())
    }

    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        let bodies = self.mesh_range().start;
        self.move_along(&direction[..bodies]);
        self.each(|block, range, _, _, tangent| block.product(&direction[range.clone()], tangent, &mut out[range]));
        self.each(|block, range, _, _, tangent| block.receive_product(tangent, &mut out[range]));
    }

    fn add_pseudo_time(&mut self, direction: &[f64], out: &mut [f64]) {
        self.each(|block, range, _, _, _| block.add_pseudo_time(&direction[range.clone()], &mut out[range]));
    }

    /// Solves for the mesh alone if that is exact. Then all Krylov directions leave the mesh alone.
    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        increment.fill(0.0);
        let range = self.mesh_range();
        let norm = self.weights.norm_on(range.clone(), right_side);
        self.mesh.solve_ahead(norm, &right_side[range.clone()], &mut increment[range]);
    }

    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        self.apply_inverses(r, out);
        if self.must_take_effect_anew(r) {
            self.apply_inverses(r, out);
        }
    }

    fn round_off(&mut self, z: &[f64]) -> Option<Vec<f64>> {
        Some(self.rounding(z))
    }

    fn largest_step(&mut self, z: &[f64], increment: &[f64]) -> f64 {
        let mut largest: f64 = 1.0;
        self.each(|block, range, _, _, _| {
            largest = largest.min(block.largest_step(&z[range.clone()], &increment[range]));
        });
        largest
    }
}
