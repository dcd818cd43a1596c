//! Shows a run to the user of a terminal, who can stop it.

use crate::cli::RunArguments;
use crate::logging;
use crate::progress::Progress;
use crate::signals::StopFlag;
use crate::terminal::Terminal;
use coupled::{MeshQuality, StructureReport};
use simulation::clock::CostClock;
use simulation::{NextStep, Observer, SlabDone};
use std::path::Path;
use std::sync::OnceLock;

/// Shows a run on stderr, logs it, and stops it after a signal.
pub struct TerminalObserver<'a> {
    arguments: &'a RunArguments,
    command: &'static str,
    terminal: Terminal,
    stop: StopFlag,
    /// Known when the run begins.
    progress: OnceLock<Progress>,
}

impl<'a> TerminalObserver<'a> {
    /// Of the run that `command` makes with `arguments`.
    pub fn new(arguments: &'a RunArguments, command: &'static str) -> Self {
        let (terminal, stop) = (Terminal::default(), StopFlag::default());
        TerminalObserver { arguments, command, terminal, stop, progress: OnceLock::new() }
    }

    fn show(&self, show: impl FnMut(&Progress)) {
        self.progress.get().into_iter().for_each(show);
    }
}

impl Observer for TerminalObserver<'_> {
    fn open(&self, directory: &Path, clock: &CostClock) -> anyhow::Result<()> {
        let RunArguments { force, verbosity, .. } = self.arguments;
        logging::start(directory, !force, *verbosity, &self.terminal, clock)?;
        Ok(self.stop.install(&self.terminal)?)
    }
    fn begin(&self, start: f64, end: f64) {
        self.progress.get_or_init(|| Progress::new(start, end, self.arguments.verbosity, &self.terminal));
    }
    fn begin_slabs(&self) {
        self.show(Progress::begin_slabs);
    }
    fn slab(&self, slab: &SlabDone) {
        self.show(|progress| progress.slab(slab));
    }
    fn mesh_slab(&self, number: usize, time: f64, quality: &MeshQuality) {
        self.show(|progress| progress.mesh(number, time, quality));
    }
    fn structure_slab(&self, report: &StructureReport) {
        self.show(|progress| progress.structure(report));
    }
    fn say(&self, message: &str) {
        self.show(|progress| progress.say(message));
    }
    fn finish(&self) {
        self.show(Progress::finish);
    }
    fn is_stop_requested(&self) -> bool {
        self.stop.is_set()
    }
    fn advice(&self, step: NextStep, directory: &Path) -> String {
        match step {
            NextStep::Resume => self.arguments.again(self.command, directory, "--resume"),
            NextStep::Replace => self.arguments.again(self.command, directory, "--force"),
            NextStep::WriteElsewhere => "add `--output` and another directory".to_owned(),
            NextStep::Report => RunArguments::to_report(directory),
        }
    }
}
