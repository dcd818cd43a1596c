//! Traces on the faces of a cell in single precision, for the sweeps.

use fem::TraceSpace;

/// The traces on a face in single precision: number k is the sum of `weight * x[coefficient]` over `entries[..ends[k]]` from
/// where the one before ends.
pub struct FaceTraces {
    ends: Vec<usize>,
    entries: Vec<(u32, f32)>,
}

impl FaceTraces {
    /// The traces of `traces` on `face`.
    pub fn new(traces: &TraceSpace, face: usize) -> Self {
        let (mut ends, mut entries) = (Vec::new(), Vec::new());
        for trace in 0..traces.len() {
            let (offset, functional) = traces.functional(face, trace);
            entries.extend(functional.iter().map(|&(node, weight)| ((offset + node) as u32, weight as f32)));
            ends.push(entries.len());
        }
        FaceTraces { ends, entries }
    }

    /// For every trace its entries.
    fn functionals(&self) -> impl Iterator<Item = &[(u32, f32)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.entries[start..end])
    }

    /// The traces of `x`.
    pub fn take(&self, x: &[f32], traces: &mut [f32]) {
        for (trace, functional) in traces.iter_mut().zip(self.functionals()) {
            *trace = functional.iter().map(|&(i, weight)| weight * x[i as usize]).sum();
        }
    }

    /// x -= factor T^T `traces`.
    pub fn subtract(&self, factor: f32, traces: &[f32], x: &mut [f32]) {
        for (trace, functional) in traces.iter().zip(self.functionals()) {
            let sent = factor * trace;
            functional.iter().for_each(|&(i, weight)| x[i as usize] -= weight * sent);
        }
    }
}
