//! stderr, shared by messages, log lines and the progress bar, so that they do not overwrite each other.

use indicatif::MultiProgress;
use std::io::{self, IsTerminal, Write};

/// stderr.
#[derive(Clone, Debug, Default)]
pub struct Terminal {
    bars: MultiProgress,
}

impl Terminal {
    /// Whether stderr is a terminal.
    pub fn is_interactive(&self) -> bool {
        io::stderr().is_terminal()
    }

    /// The bars below the text.
    pub(crate) fn bars(&self) -> &MultiProgress {
        &self.bars
    }

    /// Prints a line above the bars.
    pub fn print(&self, line: &str) {
        self.write(format!("{line}\n").as_bytes());
    }

    /// If stderr is closed, the output is dropped and the run continues.
    fn write(&self, bytes: &[u8]) {
        let _ = self.bars.suspend(|| io::stderr().write_all(bytes));
    }
}

/// For the lines of the log.
impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Terminal::write(self, bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
