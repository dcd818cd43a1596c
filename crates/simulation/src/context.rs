//! Data of a run besides its march: sums, clock, progress; and its end.

use super::controls::Columns;
use super::failure::Finding;
use super::statistics::RunStatistics;
use crate::clock::{self, CostClock};
use crate::observer::{NextStep, Observer};
use crate::session::Session;
use case::rounded_time;
use case::{Case, memory};
use output::{Cost, Machine};
use std::collections::BTreeSet;
use std::time::Instant;

/// Data of a run besides its march.
pub struct RunContext<'a> {
    /// Sums over the run.
    pub statistics: RunStatistics,
    /// Who called the run.
    pub observer: &'a dyn Observer,
    /// Slabs done since the call.
    pub slabs: usize,
    /// The columns of history.csv that controls need.
    pub control_columns: Columns,
    begun: Instant,
    setup_seconds: f64,
    clock: CostClock,
    has_warned_of_linear_law: bool,
    /// The points of which a warning has said that they are outside of the mesh.
    points_outside: BTreeSet<String>,
}

/// Why a run stopped before its end.
pub enum Stop {
    /// The observer has asked for it: after a signal, for instance.
    Asked,
    /// A slab could not be solved. The findings about it, if they are known already.
    Failed(anyhow::Error, Option<Box<Finding>>),
}

impl Stop {
    /// For summary.json.
    pub fn reason(&self) -> String {
        match self {
            Stop::Asked => "stopped on request or by a signal; the run can be resumed".into(),
            Stop::Failed(error, _) => coupled::chain(error.as_ref()),
        }
    }
}

impl<'a> RunContext<'a> {
    /// The context of a run of `case` that began at `begun` and has reached the time `reached`.
    pub fn new<const D: usize>(
        case: &Case<D>,
        reached: f64,
        session: &Session<'a>,
        begun: Instant,
        statistics: RunStatistics,
    ) -> Self {
        session.observer.begin(reached, case.time.end);
        RunContext {
            statistics,
            observer: session.observer,
            slabs: 0,
            control_columns: Columns::new(case),
            begun,
            setup_seconds: begun.elapsed().as_secs_f64(),
            clock: session.clock.clone(),
            has_warned_of_linear_law: false,
            points_outside: BTreeSet::new(),
        }
    }

    /// Says the `warning` about the law of a structure, if there is one and it was not said yet.
    pub fn warn_once_of_linear_law(&mut self, warning: impl FnOnce() -> Option<String>) {
        if self.has_warned_of_linear_law {
            return;
        }
        if let Some(text) = warning() {
            tracing::warn!("{text}");
            self.has_warned_of_linear_law = true;
        }
    }

    /// Says that the point `name` is outside of the mesh at this time, if that was not said yet.
    pub fn warn_once_of_point(&mut self, name: &str, time: f64) {
        if self.points_outside.insert(name.to_owned()) {
            let time = rounded_time(time);
            tracing::warn!(
                "the point `{name}` is outside of the mesh at t = {time}: its columns of history.csv are NaN as long as it is; with `carried = true` a \
                 point moves with the mesh"
            );
        }
    }

    /// Seconds since the run began.
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// The cost of the run so far.
    pub fn cost(&self) -> Cost {
        let parts = self.clock.parts();
        Cost {
            wall_seconds: parts.values().map(|part| part.seconds).sum(),
            setup_seconds: self.setup_seconds,
            peak_memory_bytes: memory::peak(),
            peak_memory_of_processes: Vec::new(),
            threads: rayon::current_num_threads(),
            residual_evaluations: self.statistics.residuals,
            jacobian_products: self.statistics.products,
            parts,
        }
    }

    /// Prints the wall time of the parts of the run.
    pub fn say_cost(&self) {
        self.observer.say(&clock::table(&self.clock.parts()));
    }

    /// Reports that the run has reached its end at `time`.
    pub fn say_done(&self, time: f64, session: &Session<'_>) {
        let (time, seconds, directory) = (rounded_time(time), self.seconds(), session.directory.path());
        let next = self.observer.advice(NextStep::Report, directory);
        self.observer.say(&format!("done: t = {time} in {seconds:.1} s; results in {}; {next}", directory.display()));
    }

    /// Reports that the run was stopped at `time`; `again` is the command that continues it.
    pub fn say_stopped(&self, time: f64, again: &str) {
        self.observer.say(&format!("stopped at t = {}; continue with: {again}", rounded_time(time)));
    }
}

/// The machine, as far as the system reports it.
pub fn machine() -> Machine {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    Machine {
        processor: model.map(|(_, name)| name.trim().to_owned()),
        processors: std::thread::available_parallelism().map_or(1, usize::from),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
    }
}
