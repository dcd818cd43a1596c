//! The flow as a block: the conservative state in every cell, on the mesh that moves.

mod effect_of_mesh;

use effect_of_mesh::{Effect, EffectOfMesh};

use crate::block::{Block, Couplings, Exchange, Quantity};
use crate::lagged_preconditioner::{LaggedPreconditioner, Linearisation, Update};
use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use fem::{Bottom, Clock, SlabEnd, SlabOperator, Violation};
use newton_krylov::inner_product::{self, axpy};
use newton_krylov::problem::Inadmissible;

/// What a solve has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Evaluations of the flow's residual.
    pub residuals: usize,
    /// Jacobian products along the state alone.
    pub products: usize,
    /// Jacobian products along state and mesh.
    pub mesh_products: usize,
    /// CG iterations with K.
    pub elasticity_iterations: usize,
    /// Times the flow's Jacobian was computed anew.
    pub rebuilds: usize,
    /// Times its modes were factored anew without that.
    pub refactors: usize,
}

impl Counts {
    /// All numbers.
    pub fn numbers(&self) -> [usize; 6] {
        let Counts { residuals, products, mesh_products, elasticity_iterations, rebuilds, refactors } = *self;
        [residuals, products, mesh_products, elasticity_iterations, rebuilds, refactors]
    }

    /// Back from [`Counts::numbers`].
    pub fn from_numbers(numbers: [usize; 6]) -> Self {
        let [residuals, products, mesh_products, elasticity_iterations, rebuilds, refactors] = numbers;
        Counts { residuals, products, mesh_products, elasticity_iterations, rebuilds, refactors }
    }
}

/// The flow of a slab.
pub struct FlowBlock<const D: usize, const M: usize> {
    /// Residual and derivatives.
    pub operator: SlabOperator<D, M>,
    /// The preconditioner.
    pub preconditioner: LaggedPreconditioner<D, M>,
    /// What has been done since the counts were last taken.
    pub counts: Counts,
    bottom: Vec<f64>,
    /// The velocities of the mesh that are set.
    velocities: Vec<f64>,
    inverse_pseudo_time: f64,
    /// Zero: the direction of a state that does not change.
    still: Vec<f64>,
    /// What is left of a residual after the mesh, where that moves.
    rest: Vec<f64>,
    effect_of_mesh: EffectOfMesh,
}

impl<const D: usize, const M: usize> FlowBlock<D, M> {
    /// The flow of `operator`.
    pub fn new(operator: SlabOperator<D, M>) -> Self {
        let field_len = operator.mesh.field_len();
        FlowBlock {
            preconditioner: LaggedPreconditioner::default(),
            counts: Counts::default(),
            bottom: vec![0.0; field_len],
            velocities: vec![f64::NAN; field_len * operator.tables.orders.time],
            inverse_pseudo_time: 0.0,
            still: Vec::new(),
            rest: Vec::new(),
            effect_of_mesh: EffectOfMesh::default(),
            operator,
        }
    }

    /// Moves to the slab `interval` on top of `bottom`.
    pub(crate) fn begin(&mut self, interval: Interval, bottom: Bottom) {
        self.operator.begin_slab(interval.start, interval.length(), bottom);
        self.bottom.copy_from_slice(bottom.displacement);
        self.forget();
        self.inverse_pseudo_time = 0.0;
        self.preconditioner.begin_slab();
    }

    /// Sets the mesh.
    pub(crate) fn set_mesh(&mut self, exchange: &Exchange) {
        if self.velocities != exchange.mesh_velocity {
            self.velocities.clone_from(&exchange.mesh_velocity);
            self.operator.set_mesh(&self.velocities);
        }
    }

    /// Forgets the mesh: it must be set again.
    fn forget(&mut self) {
        self.velocities.fill(f64::NAN);
        self.effect_of_mesh.forget();
    }

    /// The integrals of the components of `u`, see [`totals`].
    pub fn totals(&self, u: &[f64]) -> Vec<f64> {
        totals(&self.operator, u)
    }

    /// Makes the preconditioner again from what it was made of.
    pub fn rebuild(&mut self, linearisation: Linearisation) {
        self.preconditioner.rebuild(&mut self.operator, linearisation);
        self.forget();
    }

    /// Rebuilds, refactors or keeps the preconditioner.
    pub(crate) fn update_preconditioner(&mut self) {
        let _timed = tracing::trace_span!(target: "cost", "preconditioner_setup").entered();
        let FlowBlock { operator, preconditioner, bottom, velocities, inverse_pseudo_time, .. } = self;
        match preconditioner.update(operator, bottom, velocities, *inverse_pseudo_time) {
            Update::Kept => {}
            Update::Refactored => self.counts.refactors += 1,
            Update::Rebuilt => self.counts.rebuilds += 1,
        }
    }

    /// Takes the effect of the unknowns `x` of bodies that the whole mesh follows. Returns unknowns whose effect is lacking for that, see
    /// [`Self::learn_effect`].
    pub(crate) fn take_effect(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        self.effect_of_mesh.take(x)
    }

    /// Keeps the effect of the unknowns `q` of bodies, along which the mesh moves as in `tangent`.
    pub(crate) fn learn_effect(&mut self, q: Vec<f64>, tangent: &Exchange) {
        let (mut of_mesh, v) = (std::mem::take(&mut self.effect_of_mesh), &tangent.mesh_velocity);
        of_mesh.learn(q, |effect| self.product_along_mesh(v, effect));
        self.effect_of_mesh = of_mesh;
    }

    /// Takes the effect of the velocities of the mesh.
    fn take_effect_of_velocities(&mut self, v: &[f64]) {
        let mut of_mesh = std::mem::take(&mut self.effect_of_mesh);
        of_mesh.take_alone(v, |effect| self.product_along_mesh(v, effect));
        self.effect_of_mesh = of_mesh;
    }

    /// The effect B v of the velocities v of the mesh, and of nothing else.
    fn product_along_mesh(&mut self, v: &[f64], effect: &mut Effect) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        let FlowBlock { operator, counts, still, .. } = self;
        counts.mesh_products += 1;
        still.resize(operator.layout.len(), 0.0);
        effect.residual.resize(still.len(), 0.0);
        operator.product_with_mesh(still, v, &mut effect.residual);
        effect.loads.clear();
        effect.loads.extend_from_slice(operator.loads());
    }

    /// The rows of the effect of the mesh last taken, if it serves several products and nobody has judged it yet.
    pub(crate) fn unjudged_effect(&self) -> Option<&[f64]> {
        self.effect_of_mesh.unjudged().map(|effect| &effect.residual[..])
    }

    /// Notes whether the effect of the mesh is small: then later Newton steps use it too. Returns true if it must be taken anew.
    pub(crate) fn judge_effect(&mut self, is_small: bool) -> bool {
        self.effect_of_mesh.judge(is_small)
    }

    /// The derivative along the state alone; that along the mesh, known already, is added.
    fn product_beside_mesh(&mut self, x: &[f64], tangent: &mut Exchange, out: &mut [f64]) {
        self.counts.products += 1;
        self.operator.product(x, out);
        tangent.wall_loads.clear();
        tangent.wall_loads.extend_from_slice(self.operator.loads());
        if tangent.mesh_moves {
            let effect = self.effect_of_mesh.of_last();
            axpy(1.0, &effect.residual, out);
            axpy(1.0, &effect.loads, &mut tangent.wall_loads);
        }
    }

    fn product_with_mesh(&mut self, x: &[f64], tangent: &mut Exchange, out: &mut [f64]) {
        self.counts.mesh_products += 1;
        self.operator.product_with_mesh(x, &tangent.mesh_velocity, out);
        tangent.wall_loads.clear();
        tangent.wall_loads.extend_from_slice(self.operator.loads());
    }
}

/// The integrals of the components of `u`, a state at one time, on the mesh at the top of the slab (at first: at rest). A collective call.
pub fn totals<const D: usize, const M: usize>(flow: &SlabOperator<D, M>, u: &[f64]) -> Vec<f64> {
    totals_at(flow, u, if flow.interval().1 > 0.0 { SlabEnd::Top } else { SlabEnd::Bottom })
}

/// The integrals of the components of `u` on the mesh at an end of the slab.
pub(crate) fn totals_at<const D: usize, const M: usize>(
    flow: &SlabOperator<D, M>,
    u: &[f64],
    end: SlabEnd,
) -> Vec<f64> {
    let integrals = flow.integrals(u, end);
    let of_cells = |m: usize| integrals.iter().skip(m).step_by(M).copied().collect::<Vec<f64>>();
    let component = |m: usize| inner_product::sum_over_blocks(&of_cells(m), &flow.share.ends, &flow.share.sums);
    (0..M).map(component).collect()
}

impl<const D: usize, const M: usize> Block for FlowBlock<D, M> {
    fn field(&self) -> &'static str {
        "flow"
    }

    fn couplings(&self) -> Couplings {
        Couplings { reads: &[Quantity::MeshVelocity], writes: &[Quantity::WallLoads] }
    }

    fn weights(&self) -> Vec<f64> {
        crate::weights::flow(&self.operator)
    }

    /// The operator has the clock itself: tests and measurements use it without a system.
    fn begin_slab(&mut self, interval: Interval, _clock: Clock, state: &State) -> Result<(), SlabError> {
        let State { u, d, determinants, .. } = state;
        self.begin(interval, Bottom { state: u, displacement: d, determinants });
        Ok(())
    }

    fn residual(&mut self, u: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible> {
        self.set_mesh(exchange);
        self.counts.residuals += 1;
        let _timed = tracing::trace_span!(target: "cost", "residual").entered();
        self.operator.residual(u, r).map_err(inadmissible)?;
        exchange.wall_loads.clear();
        exchange.wall_loads.extend_from_slice(self.operator.loads());
        Ok(())
    }

    fn linearise(&mut self, u: &[f64], exchange: &mut Exchange, inverse_pseudo_time: f64) {
        self.set_mesh(exchange);
        self.operator.linearise(u);
        self.inverse_pseudo_time = inverse_pseudo_time;
        self.effect_of_mesh.grow_old();
    }

    fn product(&mut self, x: &[f64], tangent: &mut Exchange, out: &mut [f64]) {
        let _timed = tracing::trace_span!(target: "cost", "product").entered();
        let is_known = tangent.effect_is_kept || self.effect_of_mesh.is_of(&tangent.mesh_velocity);
        if !tangent.mesh_moves || is_known {
            self.product_beside_mesh(x, tangent, out);
        } else {
            self.product_with_mesh(x, tangent, out);
        }
    }

    /// The flow by its factored modes, after the effect of the mesh, an exact product.
    fn precondition(&mut self, r: &[f64], tangent: &mut Exchange, x: &mut [f64]) {
        if tangent.mesh_moves {
            if !tangent.effect_is_kept {
                self.take_effect_of_velocities(&tangent.mesh_velocity);
            }
            self.rest.clear();
            self.rest.extend(r.iter().zip(&self.effect_of_mesh.of_last().residual).map(|(r, effect)| r - effect));
        }
        let _timed = tracing::trace_span!(target: "cost", "preconditioner").entered();
        self.preconditioner.apply(if tangent.mesh_moves { &self.rest } else { r }, x);
    }

    /// (1/dtau) dt W (x) M, with one lumped mass.
    fn add_pseudo_time(&mut self, x: &[f64], out: &mut [f64]) {
        let (_, dt) = self.operator.interval();
        self.operator.add_mass(self.inverse_pseudo_time * dt, x, out);
    }
}

pub(crate) fn inadmissible(violation: Violation) -> Inadmissible {
    let Violation { quantity, value, cell, time } = violation;
    Inadmissible { quantity, value, location: format!("in cell {cell} at t = {time}") }
}
