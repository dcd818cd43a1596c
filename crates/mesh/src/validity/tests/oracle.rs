//! Dense sampling of eight cells, independent of the proof.

use basis::{AllAxes, AlongAxis, Lagrange, Matrix, apply_all_axes, contract, gauss_lobatto, scratch_length};
use tensor::Arch;
use tensor::pulp::{Scalar, Simd, WithSimd};
use tensor::{Lanes, Pack, WIDTH, det, zeroed};

/// The smallest det J / det J_0 on a dense grid with its ends.
pub(super) struct Oracle<const D: usize> {
    times: Matrix,
    /// Nodes to points of one axis, and one row for each of the last axis.
    along: [Matrix; 2],
    rows: Vec<[Matrix; 2]>,
    /// det J_0
    reference: Vec<Pack>,
}

impl<const D: usize> Oracle<D> {
    /// On the Gauss-Lobatto points of order `n`, relative to the cells with positions `at_rest`, or else to 1.
    pub(super) fn new(order: usize, times: &[f64], n: usize, at_rest: Option<&[Pack]>) -> Self {
        let (lagrange, points) = (Lagrange::gauss_lobatto(order), gauss_lobatto(n).points);
        let at = if times.len() == 1 { vec![0.0] } else { vec![0.0, 0.25, 0.5, 0.75, 1.0] };
        let matrices = |points: &[f64]| [lagrange.value_matrix(points), lagrange.derivative_matrix(points)];
        let mut oracle = Oracle {
            times: Matrix::identity(1),
            along: matrices(&points),
            rows: points.iter().map(|x| matrices(&[*x])).collect(),
            reference: vec![Pack([1.0; WIDTH]); n.pow(D as u32)],
        };
        if let Some(at_rest) = at_rest {
            let mut reference = zeroed(oracle.reference.len());
            oracle.visit(at_rest, |slice, ratios| {
                reference[slice * ratios.len()..][..ratios.len()].copy_from_slice(ratios)
            });
            oracle.reference = reference;
        }
        oracle.times = Lagrange::new(times.to_vec()).value_matrix(&at);
        oracle
    }

    pub(super) fn smallest(&self, positions: &[Pack]) -> [f64; WIDTH] {
        let mut smallest = [f64::INFINITY; WIDTH];
        self.visit(positions, |_, ratios| {
            for ratio in ratios {
                (0..WIDTH).for_each(|lane| smallest[lane] = smallest[lane].min(ratio.0[lane]));
            }
        });
        smallest
    }

    /// Visits det J / det J_0 slice by slice across the last axis, at all times, because a whole grid would not fit into
    /// the cache.
    fn visit(&self, positions: &[Pack], mut visit: impl FnMut(usize, &[Pack])) {
        let (n, length) = (self.rows.len(), positions.len() / self.times.cols());
        let mut nodes = zeroed(length * self.times.rows());
        let along = AlongAxis { matrix: &self.times, outer: 1, inner: length };
        contract(Scalar, along, positions, &mut nodes, false);
        let points = n.pow(D as u32 - 1);
        let mut work = SliceWork::new::<D>(&self.along[0], length, points);
        for nodes in nodes.chunks_exact(length) {
            for slice in 0..n {
                Arch::new().dispatch(Slice { oracle: self, nodes, slice, work: &mut work });
                visit(slice, &work.ratios);
            }
        }
    }
}

/// Work space of a slice.
struct SliceWork {
    /// Positions and their derivatives along the last axis, `[component][node of the slice]`.
    across: [Vec<Pack>; 2],
    /// `[column][component][point]`
    columns: Vec<Pack>,
    ratios: Vec<Pack>,
    scratch: Vec<Pack>,
}

impl SliceWork {
    fn new<const D: usize>(along: &Matrix, length: usize, points: usize) -> Self {
        SliceWork {
            across: [zeroed(length / along.cols()), zeroed(length / along.cols())],
            columns: zeroed(D * D * points),
            ratios: zeroed(points),
            scratch: zeroed(scratch_length(&vec![along; D - 1], D)),
        }
    }
}

/// det J / det J_0 in one slice at one time.
struct Slice<'a, const D: usize> {
    oracle: &'a Oracle<D>,
    nodes: &'a [Pack],
    slice: usize,
    work: &'a mut SliceWork,
}

impl<const D: usize> WithSimd for Slice<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (Slice { oracle, nodes, slice, work }, last) = (self, D - 1);
        let SliceWork { across, columns, ratios, scratch } = work;
        let points = ratios.len();
        for k in 0..2 {
            let along = AlongAxis { matrix: &oracle.rows[slice][k], outer: D, inner: across[k].len() / D };
            contract(simd, along, nodes, &mut across[k], false);
        }
        for (j, column) in columns.chunks_exact_mut(D * points).enumerate() {
            let mut matrices = [&oracle.along[0]; D];
            matrices[j] = &oracle.along[usize::from(j < last)];
            let axes = AllAxes { matrices: &matrices[..last], components: D };
            apply_all_axes(simd, axes, &across[usize::from(j == last)], column, scratch, false);
        }
        for q in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let mut m = [[Lanes::splat(simd, 0.0); D]; D];
                for i in 0..D {
                    for j in 0..D {
                        m[i][j] = Lanes::read(simd, &columns[(j * D + i) * points + q], part);
                    }
                }
                let reference = Lanes::read(simd, &oracle.reference[slice * points + q], part);
                (det(&m) / reference).write(&mut ratios[q], part);
            }
        }
    }
}
