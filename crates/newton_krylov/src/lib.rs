//! Newton-Krylov on vectors: FGMRES, CG, inexact Newton, pseudo-transient continuation
