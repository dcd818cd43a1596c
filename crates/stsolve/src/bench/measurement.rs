//! The results: rows of text, JSON for programs.

use super::roofs::Machine;
use serde::Serialize;
use simulation::bench::{MessageCount, Size, Work};
use std::collections::BTreeMap;
use std::fmt;

/// One kernel at one order.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Measurement {
    dimension: usize,
    order: usize,
    kernel: &'static str,
    unknowns: f64,
    /// Seconds of one call, on one core and on all.
    seconds_one: f64,
    seconds_all: f64,
    /// Million unknowns per second, one core.
    million_per_second: f64,
    /// Billion operations per second, one core; absent if they are not counted.
    gflops: Option<f64>,
    /// Billion bytes per second that must move, one core.
    gbytes: f64,
    /// The fraction of the lower roof that is reached, one core.
    share_of_limit: f64,
    /// The growth of the cost per unknown since the lowest order, relative to the growth of N: at most 1 if the cost grows no
    /// faster than N.
    growth: f64,
    /// Time on one core over time on all.
    speedup: f64,
}

impl Measurement {
    pub(super) fn new(size: Size, work: Work, one: f64, all: f64) -> Self {
        Measurement {
            dimension: size.dimension,
            order: size.order,
            kernel: work.kernel,
            unknowns: work.unknowns,
            seconds_one: one,
            seconds_all: all,
            million_per_second: work.unknowns / one * 1e-6,
            gflops: work.flops.map(|flops| flops / one * 1e-9),
            gbytes: work.bytes / one * 1e-9,
            share_of_limit: f64::NAN,
            growth: 1.0,
            speedup: one / all,
        }
    }

    /// Compares with the roofs of the roofline model. The kernel reaches a larger fraction of the lower roof, which limits it.
    pub(super) fn against(self, machine: &Machine) -> Self {
        let arithmetic = self.gflops.unwrap_or(0.0) / machine.gflops_one;
        Measurement { share_of_limit: arithmetic.max(self.gbytes / machine.gbytes_one), ..self }
    }
}

/// The cost per unknown of every kernel at the lowest order.
#[derive(Default)]
pub(super) struct Growth(BTreeMap<&'static str, (f64, f64)>);

impl Growth {
    /// Compares with the lowest order: (cost / cost_0) / (N / N_0).
    pub(super) fn of(&mut self, m: Measurement) -> Measurement {
        let (cost, order) = (1.0 / m.million_per_second, m.order as f64);
        let (first_cost, first_order) = *self.0.entry(m.kernel).or_insert((cost, order));
        Measurement { growth: cost / first_cost / (order / first_order), ..m }
    }
}

impl fmt::Display for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gflops = self.gflops.map_or_else(|| "-".into(), |gflops| format!("{gflops:.1}"));
        write!(
            f,
            "{}  {:2}  {:26} {:9.0} {:10.3} {:10.2} {:>8} {:8.1} {:7.0} % {:8.2} {:8.2}",
            self.dimension,
            self.order,
            self.kernel,
            self.unknowns,
            self.seconds_one * 1e3,
            self.million_per_second,
            gflops,
            self.gbytes,
            100.0 * self.share_of_limit,
            self.growth,
            self.speedup,
        )
    }
}

/// All measurements.
#[derive(Default, Serialize)]
pub(super) struct Report {
    /// None if nothing is timed.
    pub(super) machine: Option<Machine>,
    pub(super) rows: Vec<Measurement>,
    pub(super) messages: Vec<MessageCount>,
}

/// The machine, and the names of the columns. All columns except the last are for one core.
pub(super) fn heading(machine: &Machine) -> String {
    let Machine { threads, lanes, gflops_one, gflops_all, gbytes_one, gbytes_all } = machine;
    format!(
        "peak       {gflops_one:6.1} GFLOP/s on one core, {gflops_all:6.1} on {threads} (fused multiply-adds, {lanes} lanes)\n\
         bandwidth  {gbytes_one:6.1} GB/s on one core,    {gbytes_all:6.1} on {threads} (y := x + a y)\n\
         D   N  kernel                      unknowns         ms  million/s  GFLOP/s     GB/s    limit   growth  all/one"
    )
}

impl Report {
    pub(super) fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}
