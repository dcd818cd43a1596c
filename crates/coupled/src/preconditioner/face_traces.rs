//! Traces on the faces of a cell in single precision.

use fem::TraceSpace;
use tensor::Arch;

/// The traces T on a face in single precision: number k is the sum of `weight * x[coefficient]` over `entries[..ends[k]]` from
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

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// For every trace its entries.
    #[inline(always)]
    fn functionals(&self) -> impl Iterator<Item = &[(u32, f32)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.entries[start..end])
    }

    /// T x.
    pub fn take(&self, x: &[f32], traces: &mut [f32]) {
        for (trace, functional) in traces.iter_mut().zip(self.functionals()) {
            *trace = functional.iter().map(|&(i, weight)| weight * x[i as usize]).sum();
        }
    }

    /// x -= factor T^T `traces`.
    #[inline(always)]
    pub fn subtract(&self, factor: f32, traces: &[f32], x: &mut [f32]) {
        for (trace, functional) in traces.iter().zip(self.functionals()) {
            let sent = factor * trace;
            functional.iter().for_each(|&(i, weight)| x[i as usize] -= weight * sent);
        }
    }

    /// T X T^T for a matrix X whose columns, one every `stride` numbers, are of length `n`. The result is row-major.
    pub fn of_matrix(&self, x: &[f32], n: usize, stride: usize) -> Vec<f32> {
        Arch::new().dispatch(|| {
            let right = transposed(&self.combined(x, n, stride), n);
            self.combined(&right, self.len(), self.len())
        })
    }

    /// X T^T: sums of columns of X.
    #[inline(always)]
    fn combined(&self, x: &[f32], n: usize, stride: usize) -> Vec<f32> {
        let mut sums = vec![0.0; n * self.len()];
        for (sum, functional) in sums.chunks_exact_mut(n).zip(self.functionals()) {
            functional.iter().for_each(|&(j, weight)| add(weight, &x[j as usize * stride..][..n], sum));
        }
        sums
    }

    /// X -= T^T B T for such a matrix X, and B column-major.
    pub fn subtract_lifted(&self, b: &[f32], n: usize, stride: usize, x: &mut [f32]) {
        let mut lifted = vec![0.0; n];
        Arch::new().dispatch(|| {
            for (b, functional) in b.chunks_exact(self.len()).zip(self.functionals()) {
                lifted.fill(0.0);
                self.subtract(1.0, b, &mut lifted);
                functional.iter().for_each(|&(j, weight)| add(weight, &lifted, &mut x[j as usize * stride..][..n]));
            }
        });
    }
}

/// y += factor x.
#[inline(always)]
fn add(factor: f32, x: &[f32], y: &mut [f32]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
}

/// The transpose of a matrix of columns of length `n`.
#[inline(always)]
fn transposed(x: &[f32], n: usize) -> Vec<f32> {
    let columns = x.len() / n;
    let mut rows = vec![0.0; x.len()];
    for (j, column) in x.chunks_exact(n).enumerate() {
        column.iter().enumerate().for_each(|(i, x)| rows[i * columns + j] = *x);
    }
    rows
}
