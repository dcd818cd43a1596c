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
    times: Times,
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

/// Smaller times are written with an exponent.
const SMALL_TIME: f64 = 1e-3;

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
            times: Times::new(start, end),
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
        self.show(slab.time, describe(slab, &self.times.of(slab.time)));
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
        let text = format!("slab {number}  t = {}  det J / det J_0 >= {:.4}", self.times.of(time), quality.lower_bound);
        self.show(time, text);
    }

    /// Reports a slab of a structure.
    pub fn structure(&self, report: &coupled::StructureReport) {
        let coupled::StructureReport { slab, interval, dynamics, kinetic_energy, strain_energy, .. } = report;
        let (times, energy) = (self.times.of(interval.end), kinetic_energy + strain_energy);
        let text = format!("slab {slab}  t = {times}  energy {energy:.6e}  iterations {}", dynamics.iterations);
        self.show(interval.end, text);
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
fn describe(slab: &SlabDone, times: &str) -> String {
    let SlabDone { number, newton, krylov, residual, .. } = slab;
    format!("slab {number}  t = {times}  newton {newton}  krylov {krylov}  residual {residual:.1e}")
}

/// How times of a run are written, such that those of its slabs differ.
#[derive(Clone, Copy, Debug)]
struct Times {
    end: f64,
    /// Digits after the point.
    digits: usize,
    /// Whether all times are so small that they are written with an exponent.
    are_small: bool,
}

impl Times {
    /// Those of a run from `start` to `end`: to about a millionth of its length, with at least six digits.
    fn new(start: f64, end: f64) -> Self {
        let (largest, length) = (start.abs().max(end.abs()), end - start);
        let digits = if length > 0.0 { (6.0 - length.log10()).floor().clamp(6.0, 15.0) as usize } else { 6 };
        Times { end: rounded_time(end), digits, are_small: largest > 0.0 && largest < SMALL_TIME }
    }

    /// "0.24 of 8", for the time 0.24.
    fn of(self, time: f64) -> String {
        let Times { end, digits, are_small } = self;
        if are_small { format!("{time:.6e} of {end:e}") } else { format!("{time:.digits$} of {end}") }
    }
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
        let line = describe(&slab, &Times::new(0.0, 8.0).of(slab.time));
        assert_eq!(line, "slab 12  t = 0.240000 of 8  newton 3  krylov 27  residual 1.2e-9");
    }

    /// All slabs of a run to t = 1e-8 were at t = 0.000000.
    #[test]
    fn times_of_slabs_differ_in_any_unit() {
        let told = |start: f64, end: f64, time: f64| Times::new(start, end).of(time);
        assert_eq!(told(0.0, 1e-8, 5e-10), "5.000000e-10 of 1e-8");
        assert_eq!(told(0.0, 6.815388118e-6, 3.4e-7), "3.400000e-7 of 6.815388118e-6");
        assert_eq!(told(0.0, 0.5, 0.025), "0.025000 of 0.5");
        assert_eq!(told(0.0, 0.05, 0.025), "0.0250000 of 0.05");
        assert_eq!(told(1.0, 1.00001, 1.000005), "1.0000050000 of 1.00001");
        assert_eq!(told(0.0, 0.0, 0.0), "0.000000 of 0");
    }
}
