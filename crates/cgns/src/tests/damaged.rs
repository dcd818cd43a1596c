//! Damaged files give an error, or a mesh, and never a panic.
