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

pub mod fields;
mod intervals;
mod moments;
mod phase_file;
mod sums;

pub use moments::{Averaged, Moments};
pub use phase_file::PhaseFile;
pub use sums::AverageSums;

use basis::{RadauTime, gauss};
use case::Averages;
use coupled::Past;
use fem::Layout;
use intervals::{Part, parts};
use navier_stokes::{Gas, Primitive};
use rayon::prelude::*;

/// The averages of a case, and the slabs that it averages.
pub struct FlowAverages<'a> {
    /// What the case asks for.
    pub wanted: &'a Averages,
    /// The layout of the flow in a slab.
    pub layout: Layout,
    /// The gas.
    pub gas: &'a Gas,
}

/// A time at which a slab is evaluated.
struct TimeSample {
    phase: usize,
    /// Its weight in the integral over time.
    weight: f64,
    /// phi_a there.
    values: Vec<f64>,
    /// int phi_a dt up to there.
    integrals: Vec<f64>,
}

impl FlowAverages<'_> {
    /// Adds the slab `past` to the `sums`.
    pub fn add<const D: usize, const M: usize>(&self, past: &Past, sums: &mut AverageSums) {
        let moments = Moments::new::<D>(&self.wanted.fields);
        let parts = parts(self.wanted, past.interval.start, past.interval.end);
        if parts.is_empty() {
            return;
        }
        let samples: Vec<TimeSample> = parts.iter().flat_map(|part| self.samples(part, past)).collect();
        if sums.is_empty() {
            let displacement = if self.wanted.phases.is_some() { past.bottom.len() } else { 0 };
            *sums = AverageSums::new(self.wanted, [self.layout.cells, moments.len(), self.layout.nodes], displacement);
            sums.offsets = self.at::<D, M>(&moments, past, &samples[0]);
        }
        parts.iter().for_each(|part| sums.durations[part.phase] += part.end - part.start);
        self.add_flow::<D, M>(&moments, past, &samples, sums);
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
            TimeSample { phase: part.phase, weight: *weight, values: time.values(s), integrals }
        };
        rule.points.iter().zip(&rule.weights).map(sample).collect()
    }

    /// The quantities of all cells at a time, `[cell][quantity][node]`.
    fn at<const D: usize, const M: usize>(&self, moments: &Moments, past: &Past, sample: &TimeSample) -> Vec<f64> {
        let cell = |cell: usize| self.of_cell::<D, M>(moments, &past.u[self.layout.cell(cell)], sample);
        (0..self.layout.cells).flat_map(cell).collect()
    }

    /// The quantities of a cell with the coefficients `u`, `[time node][component][node]`, at a time: `[quantity][node]`.
    fn of_cell<const D: usize, const M: usize>(&self, moments: &Moments, u: &[f64], sample: &TimeSample) -> Vec<f64> {
        let (nodes, length) = (self.layout.nodes, self.layout.time_len());
        let mut out = vec![0.0; moments.quantities.len() * nodes];
        for node in 0..nodes {
            let coefficients = |m: usize| u.iter().skip(m * nodes + node).step_by(length);
            let state: [f64; M] =
                std::array::from_fn(|m| coefficients(m).zip(&sample.values).map(|(u, phi)| u * phi).sum());
            let state = Primitive::<f64, D>::unpack(self.gas, &state);
            for (k, quantity) in moments.quantities.iter().enumerate() {
                out[k * nodes + node] = quantity.of(self.gas, &state);
            }
        }
        out
    }

    /// Adds the moments. Every cell has its own sums, so they have the same bits for any number of threads.
    fn add_flow<const D: usize, const M: usize>(
        &self,
        moments: &Moments,
        past: &Past,
        samples: &[TimeSample],
        sums: &mut AverageSums,
    ) {
        let (nodes, AverageSums { moments: of_run, offsets, durations, .. }) = (self.layout.nodes, sums);
        let (each, first) = (durations.len() * moments.len() * nodes, moments.quantities.len() * nodes);
        of_run.par_chunks_exact_mut(each).zip(offsets.par_chunks_exact(first)).enumerate().for_each(
            |(cell, (sums, offsets))| {
                for sample in samples {
                    let mut values = self.of_cell::<D, M>(moments, &past.u[self.layout.cell(cell)], sample);
                    values.iter_mut().zip(offsets).for_each(|(value, offset)| *value -= offset);
                    let length = moments.len() * nodes;
                    moments.add(&values, sample.weight, &mut sums[sample.phase * length..][..length]);
                }
            },
        );
    }
}

/// Adds the displacement of the mesh: that at the bottom and the integral of its velocity.
fn add_mesh(past: &Past, sample: &TimeSample, sums: &mut AverageSums) {
    let length = past.bottom.len();
    let sums = &mut sums.displacements[sample.phase * length..][..length];
    for (i, (sum, bottom)) in sums.iter_mut().zip(&past.bottom).enumerate() {
        let velocities = past.v.iter().skip(i).step_by(length);
        let moved: f64 = velocities.zip(&sample.integrals).map(|(v, integral)| v * integral).sum();
        *sum += sample.weight * (bottom + moved);
    }
}
