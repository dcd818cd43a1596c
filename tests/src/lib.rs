//! Verification, regression, command-line and restart tests of stsolve.
