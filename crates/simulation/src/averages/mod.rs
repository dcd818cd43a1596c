//! Averages over time of the flow, at its nodes in every cell.
//!
//! ```text
//! <q> = 1/T int q dt,   <q' r'> = <q r> - <q> <r>,   T the length of the averaged time                              (average)
//! ```
//!
//! The nodes follow the mesh: an average belongs to a point of the mesh at rest. In a slab the solution is a polynomial in time. A
//! slab is cut at the start and the end of the averages and at the limits of phases, and each part is integrated by N_t + 1 Gauss points. The
//! first state is subtracted before products are summed, because a small fluctuation of a large
//! mean would lose digits.
//!
//! | module | holds |
//! |---|---|
//! | `moments` | the summed quantities, and the averages that follow |
//! | `intervals` | the parts of a slab that count |
//! | `sums` | the sums over the run, for checkpoints |
//! | `fields` | averages over the whole mesh, as coefficients and for a viewer |
//! | `phase_file` | the averages over phases, for a viewer |
//! | `along` | the averages along axes of space, as a table and for a viewer |

mod along;
pub mod fields;
mod intervals;
mod moments;
mod phase_file;
mod sums;

pub use along::AlongFiles;
pub use moments::{Averaged, Moments};
pub use phase_file::PhaseFile;
pub use sums::{AverageSums, MOMENTS, OFFSETS, is_of_averages};

use basis::{RadauTime, gauss, gauss_lobatto};
use case::{Averages, Case, Flow};
use coupled::blocks::FlowBlock;
use coupled::{FlowMarch, MeshMover, Past};
use fem::{Layout, Sampler};
use intervals::{Part, parts};
use moments::AveragedQuantity;
use navier_stokes::{Gas, Primitive};
use output::Arrays;
use rayon::prelude::*;
use std::array::from_fn;

/// Names of the files of averages.
pub const FILES: [&str; 3] = [phase_file::PHASE_FILE, along::TABLE, along::VIEWER_FILE];

/// A warning if averages should have begun before the `state`, and nothing was averaged so far: the `sums` of the run have none.
pub fn are_late<const D: usize>(case: &Case<D>, sums: &Arrays, state: &coupled::State) -> Option<String> {
    let is_late = |averages: &&Averages| {
        averages.from < state.time - case.time.round_off() && averages.to.is_none_or(|to| to > state.time)
    };
    let averages = case.averages.as_ref().filter(is_late)?;
    let is_missing = state.slab > 0 && !sums.keys().any(|name| is_of_averages(name));
    is_missing.then(|| {
        let (from, time) = (averages.from, coupled::rounded_time(state.time));
        format!(
            "the averages begin at t = {time}, and not at {from} (`output.averages.from`): the earlier run has none that this one could continue"
        )
    })
}

/// Adds the last slab of `march` to the `sums` over the cells of this rank, if `case` asks for averages.
pub fn add_slab<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    march: &FlowMarch<D, M>,
    sums: &mut AverageSums,
) {
    let (Some(wanted), Some(past)) = (&case.averages, &march.state.past) else { return };
    let FlowBlock { operator, .. } = &march.solver.system.flow;
    let (mover, gas) = (&march.solver.system.mesh.mover, &flow.law.gas);
    let (cells, layout) = (&operator.share.own[..], operator.layout);
    FlowAverages { wanted, mover, cells, layout, order: flow.order, gas }.add::<M>(past, sums);
}

/// The averages of a case, and the slabs that it averages.
struct FlowAverages<'a, const D: usize> {
    /// What the case asks for.
    wanted: &'a Averages,
    /// The mesh.
    mover: &'a MeshMover<D>,
    /// The cells of this rank by their numbers in the mesh.
    cells: &'a [usize],
    /// The layout of their flow in a slab.
    layout: Layout,
    /// Nodes per direction of the flow.
    order: usize,
    /// The gas.
    gas: &'a Gas,
}

/// A time at which a slab is evaluated.
struct TimeSample {
    phase: usize,
    /// The displacement of the mesh, if gradients are needed.
    displacement: Vec<f64>,
    /// Its weight in the integral over time.
    weight: f64,
    /// phi_a there.
    values: Vec<f64>,
    /// int phi_a dt up to there.
    integrals: Vec<f64>,
}

impl<const D: usize> FlowAverages<'_, D> {
    /// Adds the slab `past` to the `sums`.
    fn add<const M: usize>(&self, past: &Past, sums: &mut AverageSums) {
        let moments = Moments::new::<D>(&self.wanted.fields);
        let parts = parts(self.wanted, past.interval.start, past.interval.end);
        if parts.is_empty() {
            return;
        }
        let mut samples: Vec<TimeSample> = parts.iter().flat_map(|part| self.samples(part, past)).collect();
        if moments.need_gradient() {
            samples.iter_mut().for_each(|sample| sample.displacement = sample.displaced(past));
        }
        if sums.is_empty() {
            let displacement = if self.wanted.phases.is_some() { past.bottom.len() } else { 0 };
            *sums = AverageSums::new(self.wanted, [self.layout.cells, moments.len(), self.layout.nodes], displacement);
            sums.offsets = self.at::<M>(&moments, past, &samples[0]);
        }
        parts.iter().for_each(|part| sums.durations[part.phase] += part.end - part.start);
        self.add_flow::<M>(&moments, past, &samples, sums);
        if !sums.displacements.is_empty() {
            samples.iter().for_each(|sample| add_mesh(past, sample, sums));
        }
    }

    /// The Gauss points of a part of the slab.
    fn samples(&self, part: &Part, past: &Past) -> Vec<TimeSample> {
        let time = RadauTime::new(self.layout.time_order);
        let rule = gauss(self.layout.time_order + 1).on(part.start, part.end);
        let sample = |(t, weight): (&f64, &f64)| {
            let s = ((t - past.interval.start) / past.dt).clamp(0.0, 1.0);
            let integrals = time.integrals(s).iter().map(|integral| past.dt * integral).collect();
            TimeSample {
                phase: part.phase,
                displacement: Vec::new(),
                weight: *weight,
                values: time.values(s),
                integrals,
            }
        };
        rule.points.iter().zip(&rule.weights).map(sample).collect()
    }

    /// The quantities of all cells at a time, `[cell][quantity][node]`.
    fn at<const M: usize>(&self, moments: &Moments, past: &Past, sample: &TimeSample) -> Vec<f64> {
        (0..self.layout.cells).flat_map(|cell| self.of_cell::<M>(moments, past, cell, sample)).collect()
    }

    /// The quantities of a cell at a time, `[quantity][node]`.
    fn of_cell<const M: usize>(&self, moments: &Moments, past: &Past, cell: usize, sample: &TimeSample) -> Vec<f64> {
        let states = self.states::<M>(&past.u[self.layout.cell(cell)], sample);
        let gradients = match moments.need_gradient() {
            true => self.gradients(&states, &self.mover.cell_positions(self.cells[cell], &sample.displacement)),
            false => vec![[[0.0; D]; D]; states.len()],
        };
        let at_nodes = || states.iter().zip(&gradients);
        let of = |quantity: &AveragedQuantity| {
            at_nodes().map(|(state, gradient)| quantity.of(self.gas, state, gradient)).collect::<Vec<_>>()
        };
        moments.quantities.iter().flat_map(of).collect()
    }

    /// The states at the nodes of a cell with the coefficients `u`, `[time node][component][node]`, at a time.
    fn states<const M: usize>(&self, u: &[f64], sample: &TimeSample) -> Vec<Primitive<f64, D>> {
        let (nodes, length) = (self.layout.nodes, self.layout.time_len());
        let state = |node: usize| {
            let coefficients = |m: usize| u.iter().skip(m * nodes + node).step_by(length);
            let state: [f64; M] = from_fn(|m| coefficients(m).zip(&sample.values).map(|(u, phi)| u * phi).sum());
            Primitive::unpack(self.gas, &state)
        };
        (0..nodes).map(state).collect()
    }

    /// d_j w_i at the nodes of a cell at `positions`, `[node][j][i]`, of the polynomial through the velocities at the nodes.
    fn gradients(&self, states: &[Primitive<f64, D>], positions: &[f64]) -> Vec<[[f64; D]; D]> {
        let order = self.order;
        let sampler = Sampler::<D>::new(order, self.mover.reference.order(), &gauss_lobatto(order).points);
        let velocities: Vec<f64> = (0..D).flat_map(|i| states.iter().map(move |state| state.velocity[i])).collect();
        let by_direction = sampler.gradients(&velocities, positions);
        let n = states.len();
        (0..n).map(|node| from_fn(|j| from_fn(|i| by_direction[j][i * n + node]))).collect()
    }

    /// Adds the moments. Every cell has its own sums, so they have the same bits for any number of threads.
    fn add_flow<const M: usize>(&self, moments: &Moments, past: &Past, samples: &[TimeSample], sums: &mut AverageSums) {
        let (nodes, AverageSums { moments: of_run, offsets, durations, .. }) = (self.layout.nodes, sums);
        let (each, first) = (durations.len() * moments.len() * nodes, moments.quantities.len() * nodes);
        of_run.par_chunks_exact_mut(each).zip(offsets.par_chunks_exact(first)).enumerate().for_each(
            |(cell, (sums, offsets))| {
                for sample in samples {
                    let mut values = self.of_cell::<M>(moments, past, cell, sample);
                    values.iter_mut().zip(offsets).for_each(|(value, offset)| *value -= offset);
                    let length = moments.len() * nodes;
                    moments.add(&values, sample.weight, &mut sums[sample.phase * length..][..length]);
                }
            },
        );
    }
}

impl TimeSample {
    /// The displacement of the mesh: that at the bottom and the integral of its velocity.
    fn displaced(&self, past: &Past) -> Vec<f64> {
        let moved = |i: usize| -> f64 {
            let velocities = past.v.iter().skip(i).step_by(past.bottom.len());
            velocities.zip(&self.integrals).map(|(v, integral)| v * integral).sum()
        };
        past.bottom.iter().enumerate().map(|(i, bottom)| bottom + moved(i)).collect()
    }
}

/// Adds the displacement of the mesh.
fn add_mesh(past: &Past, sample: &TimeSample, sums: &mut AverageSums) {
    let sums = &mut sums.displacements[sample.phase * past.bottom.len()..][..past.bottom.len()];
    sums.iter_mut().zip(sample.displaced(past)).for_each(|(sum, displacement)| *sum += sample.weight * displacement);
}
