//! The `stsolve` command.
fn main() {}
