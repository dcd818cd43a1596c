//! Results on disk: VTKHDF, exact coefficients, checkpoint, history, summary
