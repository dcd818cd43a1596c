//! The stsolve command: case files, progress, reports
