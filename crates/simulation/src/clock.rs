//! The wall time of the parts of a run.
//!
//! The numerics open a span of `tracing` with the target "cost" around each part of their work. The time between entering and leaving a
//! span is added up by the name of the span, without the time of the spans within it. Time outside of all spans is the rest, so the
//! parts add up to the wall time of the run. Only spans of the thread that drives the run count. No measured time enters a result.

use output::Part;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tracing::span::Id;
use tracing::{Metadata, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;

/// The parts of a run in the order of the table: the name of the span, and its description.
const PARTS: [(&str, &str); 10] = [
    ("setup", "set-up"),
    ("residual", "residual"),
    ("product", "Jacobian products"),
    ("preconditioner_setup", "preconditioner, made"),
    ("preconditioner", "preconditioner, applied"),
    ("orthogonalisation", "orthogonalisation"),
    ("elasticity", "elasticity"),
    ("mesh_proof", "proof of the mesh"),
    ("output", "output"),
    ("rest", "rest"),
];

// The parts outside all spans: before the clock starts, and afterwards.
const SETUP: &str = PARTS[0].0;
const REST: &str = PARTS[9].0;

/// A clock that spans start and stop, shared by all its clones.
#[derive(Clone, Debug)]
pub struct CostClock(Arc<Mutex<Times>>);

#[derive(Debug)]
struct Times {
    /// The spans that are open, the innermost last.
    open: Vec<&'static str>,
    /// All time up to this moment is assigned.
    last: Instant,
    spent: BTreeMap<&'static str, (Duration, u64)>,
}

impl Times {
    /// Assigns the time until now to the innermost span.
    fn assign(&mut self) {
        let now = Instant::now();
        let part = self.open.last().copied().unwrap_or(REST);
        self.spent.entry(part).or_default().0 += now - self.last;
        self.last = now;
    }
}

impl CostClock {
    /// A clock of a run that has `begun` and is now set up.
    pub fn new(begun: Instant) -> Self {
        let now = Instant::now();
        let spent = BTreeMap::from([(SETUP, (now - begun, 1))]);
        CostClock(Arc::new(Mutex::new(Times { open: Vec::new(), last: now, spent })))
    }

    /// Whether a span is one of the parts of a run.
    pub fn counts(metadata: &Metadata<'_>) -> bool {
        metadata.is_span() && metadata.target() == "cost"
    }

    /// The parts of the run so far, by name.
    pub fn parts(&self) -> BTreeMap<String, Part> {
        self.with(|times| {
            times.assign();
            let part = |(name, (time, calls)): (&&str, &(Duration, u64))| {
                (name.to_string(), Part { seconds: time.as_secs_f64(), calls: *calls })
            };
            times.spent.iter().map(part).collect()
        })
    }

    /// The sums remain valid after a panic.
    fn with<R>(&self, work: impl FnOnce(&mut Times) -> R) -> R {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for CostClock {
    fn on_enter(&self, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        self.with(|times| {
            times.assign();
            times.open.push(span.name());
            times.spent.entry(span.name()).or_default().1 += 1;
        });
    }

    fn on_exit(&self, _: &Id, _: Context<'_, S>) {
        self.with(|times| {
            times.assign();
            times.open.pop();
        });
    }
}

/// The parts of a run as lines of a table.
pub fn table(parts: &BTreeMap<String, Part>) -> String {
    let whole: f64 = parts.values().map(|part| part.seconds).sum();
    let mut lines = vec![format!("{:<25}{:>10}{:>8}{:>10}", "where the time went", "s", "%", "calls")];
    for (name, text) in PARTS {
        let Some(Part { seconds, calls }) = parts.get(name) else { continue };
        let calls = if *calls > 0 { calls.to_string() } else { String::new() };
        lines.push(format!("{text:<25}{seconds:>10.2}{:>8.1}{calls:>10}", 100.0 * seconds / whole));
    }
    lines.join("\n")
}
