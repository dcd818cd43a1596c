//! The interruption of a run by signals.

use crate::terminal::Terminal;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the run has been asked to stop.
#[derive(Clone, Debug, Default)]
pub struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    /// Whether to stop after the current slab, or the current step of a search.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Installs handlers: the first Ctrl-C, SIGTERM or SIGUSR1 sets the flag and is answered on `terminal`. The second one ends the process at
    /// once. Launchers of MPI pass SIGUSR1 on; of the others they end all processes. A terminal that closes sets the flag, too, and may say so
    /// several times.
    ///
    /// # Errors
    /// If the system refuses to install the handlers.
    pub fn install(&self, terminal: &Terminal) -> io::Result<()> {
        let mut signals = Signals::new([SIGINT, SIGTERM, SIGUSR1])?;
        if !outlives_terminal() {
            signals.add_signal(SIGHUP)?;
        }
        let (flag, terminal) = (self.clone(), terminal.clone());
        std::thread::spawn(move || {
            for signal in signals.forever() {
                if flag.0.swap(true, Ordering::Relaxed) && signal != SIGHUP {
                    // Does not return: the process ends as if the signal had not been caught.
                    let _ = emulate_default_handler(signal);
                }
                let answer = "finishing this slab, or this step or slab of a search, then writing a checkpoint; press again to stop at once";
                terminal.print(answer);
            }
        });
        Ok(())
    }
}

/// Whether SIGHUP is ignored, as `nohup` asks for; `true` where the system does not tell.
fn outlives_terminal() -> bool {
    let ignored = |status: String| {
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
        Some(u64::from_str_radix(mask.trim(), 16).ok()? >> (SIGHUP - 1) & 1 == 1)
    };
    std::fs::read_to_string("/proc/self/status").ok().and_then(ignored).unwrap_or(true)
}

/// Leaves signals to the first of several processes: this one does nothing, however many come. One that ended at its second signal would end
/// all, before the first process has written a checkpoint.
///
/// # Errors
/// If the system refuses to install the handlers.
pub fn leave_to_first_process() -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGUSR1, SIGHUP])?;
    std::thread::spawn(move || signals.forever().for_each(drop));
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn the_first_signal_sets_the_flag_and_the_process_lives() {
        // The handler of a flag ends the process at a second signal, so that one kind of signal has to do.
        let flag = StopFlag::default();
        flag.install(&Terminal::default()).unwrap();
        assert!(!flag.is_set());
        signal_hook::low_level::raise(SIGUSR1).unwrap();
        let begun = Instant::now();
        while !flag.is_set() && begun.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(flag.is_set());
    }
}
