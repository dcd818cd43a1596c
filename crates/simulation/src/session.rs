//! What a run sets up before its first slab.

use crate::clock::CostClock;
use crate::destination::Destination;
use crate::error::Failure;
use crate::observer::{Observer, WarningSink};
use output::RunDirectory;
use std::time::Instant;
use tracing::subscriber::NoSubscriber;
use tracing_subscriber::filter::filter_fn;
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::{Layer, Registry};

/// The output directory, locked, and the caller of the run.
pub(crate) struct Session<'a> {
    /// The output directory.
    pub(crate) directory: RunDirectory,
    /// Who called.
    pub(crate) observer: &'a dyn Observer,
    /// Where the time of the run goes.
    pub(crate) clock: CostClock,
}

impl<'a> Session<'a> {
    /// Sets up a run that has `begun`.
    ///
    /// # Errors
    /// An output directory that cannot be written or is in use, and errors of the observer.
    pub(crate) fn start(
        destination: &Destination,
        observer: &'a dyn Observer,
        begun: Instant,
    ) -> Result<Self, Failure> {
        let clock = CostClock::new(begun);
        let directory = RunDirectory::open(&destination.directory)?;
        observer.open(directory.path(), &clock).map_err(Failure::BadInput)?;
        Ok(Session { directory, observer, clock })
    }

    /// Does `work` while the spans of the numerics drive the clock, and warnings reach the observer. The program has a subscriber that passes
    /// them on; a library may have none.
    pub(crate) fn timed<R>(&self, work: impl FnOnce() -> R) -> R {
        if tracing::dispatcher::get_default(|present| !present.is::<NoSubscriber>()) {
            return work();
        }
        let clock = self.clock.clone().with_filter(filter_fn(CostClock::counts));
        let warnings = self.observer.warnings().map(Warnings);
        tracing::subscriber::with_default(Registry::default().with(clock).with(warnings), work)
    }
}

/// Hands warnings to an observer.
struct Warnings(WarningSink);

impl<S: tracing::Subscriber> Layer<S> for Warnings {
    fn on_event(&self, event: &tracing::Event<'_>, _context: Context<'_, S>) {
        if *event.metadata().level() == tracing::Level::WARN {
            let mut text = String::new();
            event.record(&mut |field: &tracing::field::Field, value: &dyn std::fmt::Debug| {
                let name = if field.name() == "message" { String::new() } else { format!("{} = ", field.name()) };
                let separator = if text.is_empty() { "" } else { ", " };
                text += &format!("{separator}{name}{value:?}");
            });
            (self.0)(&text);
        }
    }
}
