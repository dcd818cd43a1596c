//! Progress of a run: a bar on a terminal, otherwise lines, nothing with `--quiet`.

use crate::cli::Verbosity;
use crate::terminal::Terminal;
use case::rounded_time;
use indicatif::{ProgressBar, ProgressStyle};
use simulation::SlabDone;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Reports the progress of a run.
#[derive(Debug)]
pub struct Progress {
    display: Display,
    terminal: Terminal,
    /// The interval that this process covers.
    start: f64,
    end: f64,
    begun: Instant,
    /// The time that passed before the first slab.
    before_slabs: OnceLock<Duration>,
}

#[derive(Debug)]
enum Display {
    Bar(ProgressBar),
    Lines,
    Nothing,
}

/// The number of parts in which the bar counts time. Slabs may be halved, so their number is not known.
const PARTS: u64 = 10_000;

impl Progress {
    /// Of a run from time `start`, which is later than the case's own start if it is resumed, to `end`.
    pub fn new(start: f64, end: f64, verbosity: Verbosity, terminal: &Terminal) -> Self {
        let display = if verbosity.quiet {
            Display::Nothing
        } else if terminal.is_interactive() {
            Display::Bar(terminal.bars().add(bar()))
        } else {
            Display::Lines
        };
        Progress {
            display,
            terminal: terminal.clone(),
            start,
            end: rounded_time(end),
            begun: Instant::now(),
            before_slabs: OnceLock::new(),
        }
    }

    /// Marks the begin of the slabs: the time before them does not enter the estimate.
    pub fn begin_slabs(&self) {
        self.before_slabs.get_or_init(|| self.begun.elapsed());
        if let Display::Bar(bar) = &self.display {
            bar.reset_eta();
        }
    }

    /// Reports a slab.
    pub fn slab(&self, slab: &SlabDone) {
        self.show(slab.time, describe(slab, self.end));
    }

    fn show(&self, time: f64, text: String) {
        let fraction = ((time - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
        match &self.display {
            Display::Bar(bar) => {
                bar.set_position((fraction * PARTS as f64) as u64);
                bar.set_message(text);
            }
            Display::Lines => self
                .terminal
                .print(&format!("{text}  {}", remaining(self.begun.elapsed(), self.before_slabs(), fraction))),
            Display::Nothing => {}
        }
    }

    /// Reports a slab of the mesh alone.
    pub fn mesh(&self, number: usize, time: f64, quality: &coupled::MeshQuality) {
        let text =
            format!("slab {number}  t = {time:.6} of {}  det J / det J_0 >= {:.4}", self.end, quality.lower_bound);
        self.show(time, text);
    }

    /// Reports a slab of a structure.
    pub fn structure(&self, report: &coupled::StructureReport) {
        let coupled::StructureReport { slab, interval, dynamics, kinetic_energy, strain_energy, .. } = report;
        let (time, end, energy, iterations) =
            (interval.end, self.end, kinetic_energy + strain_energy, dynamics.iterations);
        let text = format!("slab {slab}  t = {time:.6} of {end}  energy {energy:.6e}  iterations {iterations}");
        self.show(time, text);
    }

    /// Prints a line above the bar, unless `--quiet` is set.
    pub fn say(&self, line: &str) {
        if !matches!(self.display, Display::Nothing) {
            self.terminal.print(line);
        }
    }

    fn before_slabs(&self) -> Duration {
        self.before_slabs.get().copied().unwrap_or_default()
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  {elapsed} elapsed, {eta} left")
        .expect("the template is fixed and has been tried");
    ProgressBar::new(PARTS).with_style(style)
}

/// slab 12  t = 0.24 of 8  newton 3  krylov 27  residual 1.2e-9
fn describe(slab: &SlabDone, end: f64) -> String {
    let SlabDone { number, time, newton, krylov, residual } = slab;
    format!("slab {number}  t = {time:.6} of {end}  newton {newton}  krylov {krylov}  residual {residual:.1e}")
}

/// 12 s elapsed, 48 s left
fn remaining(elapsed: Duration, before_slabs: Duration, fraction: f64) -> String {
    let seconds = elapsed.as_secs_f64();
    let in_slabs = seconds - before_slabs.as_secs_f64();
    if fraction <= 0.0 {
        return format!("{seconds:.0} s elapsed");
    }
    format!("{seconds:.0} s elapsed, {:.0} s left", in_slabs * (1.0 - fraction) / fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_in_proportion() {
        let left =
            |seconds, before, fraction| remaining(Duration::from_secs(seconds), Duration::from_secs(before), fraction);
        assert_eq!(left(12, 0, 0.2), "12 s elapsed, 48 s left");
        assert_eq!(left(12, 10, 0.2), "12 s elapsed, 8 s left");
        assert_eq!(left(3, 0, 0.0), "3 s elapsed");
        assert_eq!(left(5, 0, 1.0), "5 s elapsed, 0 s left");
    }

    #[test]
    fn a_slab_is_one_line() {
        let slab = SlabDone { number: 12, time: 0.24, newton: 3, krylov: 27, residual: 1.2e-9 };
        assert_eq!(describe(&slab, 8.0), "slab 12  t = 0.240000 of 8  newton 3  krylov 27  residual 1.2e-9");
    }
}
