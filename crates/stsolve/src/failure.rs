//! Failures of a command: message and exit code.

use simulation::Failure;
use std::error::Error;
use std::io::Write;

/// Prints the chain of errors, once. Returns the exit code: 2 for bad input, 1 for a failed solve, 3 after a signal.
pub fn report(failure: &Failure) -> u8 {
    let (error, code) = match failure {
        Failure::BadInput(error) => (error, 2),
        Failure::Solve(error) => (error, 1),
        Failure::Stopped => return 3,
    };
    // If stderr is closed, the message cannot be shown.
    let _ = writeln!(std::io::stderr(), "error: {}", chain(error.as_ref()));
    code
}

/// The message of `error` and of its causes, without those that the message above them already contains.
pub fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let message = cause.to_string();
        if !text.contains(&message) {
            text += &format!("\n  caused by: {message}");
        }
        next = cause.source();
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_chain_says_everything_once() {
        let cause = std::io::Error::other("no space left");
        let repeated = anyhow::Error::new(cause).context("cannot write: no space left").context("the slab is lost");
        assert_eq!(chain(repeated.as_ref()), "the slab is lost\n  caused by: cannot write: no space left");
    }
}
