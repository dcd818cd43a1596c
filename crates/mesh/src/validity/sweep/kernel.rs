//! The kernel of [`Sweep`].

use super::{Part, Scratch, Sweep, TermBounds};
use basis::{AllAxes, AlongAxis, apply_all_axes, contract};
use tensor::pulp::{Simd, WithSimd};
use tensor::{Lanes, Pack, Real, WIDTH, det};

/// Bounds of det J / det J_0 in eight cells.
#[derive(Clone, Copy, Debug)]
pub(in crate::validity) struct Swept {
    /// Proved.
    pub(in crate::validity) lower: Pack,
    /// The smallest and the largest value on the grid.
    pub(in crate::validity) sampled_min: Pack,
    pub(in crate::validity) sampled_max: Pack,
    /// The number of the grid point with the smallest value.
    pub(in crate::validity) place: Pack,
    /// max |det J|, and a bound of its error.
    largest: Pack,
    error: Pack,
}

impl Swept {
    const NOTHING: Swept = Swept {
        lower: Pack([f64::INFINITY; WIDTH]),
        sampled_min: Pack::ZERO,
        sampled_max: Pack::ZERO,
        place: Pack::ZERO,
        largest: Pack::ZERO,
        error: Pack::ZERO,
    };
}

impl<const D: usize> Sweep<D> {
    /// Columns of J: interpolation in time, then along the axes of space, differentiated along one.
    #[inline(always)]
    fn jacobians<S: Simd>(&self, simd: S, work: &mut Scratch) {
        let matrix = &self.time_values;
        let in_time = AlongAxis { matrix, outer: 1, inner: work.nodes.len() / matrix.cols() };
        contract(simd, in_time, &work.nodes, &mut work.in_time, false);
        let length = work.columns.len() / D;
        for (j, column) in work.columns.chunks_exact_mut(length).enumerate() {
            let mut matrices = [&self.values; D];
            matrices[j] = &self.derivatives;
            let axes = AllAxes { matrices: &matrices, components: matrix.rows() * D };
            apply_all_axes(simd, axes, &work.in_time, column, &mut work.between, false);
        }
    }

    /// det J, the sampled values of det J / det J_0, and an error bound of det J.
    #[inline(always)]
    fn determinants<S: Simd>(&self, simd: S, work: &mut Scratch, out: &mut Swept, part: usize) {
        let (points, zero) = (work.reference.len(), Lanes::splat(simd, 0.0));
        let (mut lowest, mut highest) = (Lanes::splat(simd, f64::INFINITY), Lanes::splat(simd, f64::NEG_INFINITY));
        let (mut place, mut largest, mut squares) = (zero, zero, [zero; D]);
        // It becomes NaN as soon as one of the values is NaN, which the minima ignore.
        let mut defect = zero;
        let column_length = work.columns.len() / D;
        for q in 0..work.values.len() {
            let (time, point) = (q / points, q % points);
            let mut m = [[zero; D]; D];
            for j in 0..D {
                let mut square = zero;
                for i in 0..D {
                    m[i][j] =
                        Lanes::read(simd, &work.columns[j * column_length + (time * D + i) * points + point], part);
                    square = m[i][j].mul_add(m[i][j], square);
                }
                squares[j] = square.max(squares[j]);
            }
            let det = det(&m);
            det.write(&mut work.values[q], part);
            largest = det.abs().max(largest);
            defect += det * 0.0;
            let ratio = det / Lanes::read(simd, &work.reference[point], part);
            place = lowest.select_ge(ratio, Lanes::splat(simd, q as f64), place);
            lowest = ratio.min(lowest);
            highest = ratio.max(highest);
        }
        lowest.write(&mut out.sampled_min, part);
        highest.write(&mut out.sampled_max, part);
        place.write(&mut out.place, part);
        largest.write(&mut out.largest, part);
        (self.error(simd, &work.nodes, squares, part) + defect).write(&mut out.error, part);
    }

    /// A bound of the error of det J, see `determinant_error`, with the longest columns |m_a|^2 = `squares[a]`.
    #[inline(always)]
    fn error<S: Simd>(&self, simd: S, nodes: &[Pack], squares: [Lanes<S>; D], part: usize) -> Lanes<S> {
        let size = largest_of(simd, nodes, part);
        let mut sum = Lanes::splat(simd, 0.0);
        for a in 0..D {
            let mut product = size * (2.0 * self.entry_error) + squares[a].sqrt() * (8.0 * f64::EPSILON);
            for b in 0..D {
                if b != a {
                    product = product * squares[b].sqrt();
                }
            }
            sum += product;
        }
        sum
    }

    /// (lower) of one part of the box, if it is lower than the bound of the others.
    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, part: &Part, work: &mut Scratch, out: &mut Swept) {
        let mut matrices = [&part.matrices[0]; 4];
        part.matrices.iter().enumerate().for_each(|(axis, matrix)| matrices[axis] = matrix);
        let Scratch { values, coefficients, reference, reference_coefficients, between, .. } = work;
        let (whole, in_space) = (&matrices[..=D], &matrices[..D]);
        apply_all_axes(simd, AllAxes { matrices: whole, components: 1 }, values, coefficients, between, false);
        let axes = AllAxes { matrices: in_space, components: 1 };
        apply_all_axes(simd, axes, reference, reference_coefficients, between, false);
        let in_space = &self.kept[..D];
        for register in 0..Lanes::<S>::PARTS {
            let read = |pack: &Pack| Lanes::read(simd, pack, register);
            let tail = self.tail(simd, &self.kept, &work.coefficients, &mut work.term_bounds, register);
            let largest = read(&out.largest) * part.sum_error;
            let margin = read(&out.error) * self.lebesgue + largest + tail;
            let tail = self.tail(simd, in_space, &work.reference_coefficients, &mut work.term_bounds, register);
            let reference_margin =
                read(&work.reference_error) + largest_of(simd, &work.reference, register) * part.sum_error + tail;
            let lower = self.lower(simd, work, [margin, reference_margin], register);
            read(&out.lower).min(lower).write(&mut out.lower, register);
        }
    }

    /// (tail): the bound of all terms with a T_i.
    #[inline(always)]
    fn tail<S: Simd>(
        &self,
        simd: S,
        kept: &[usize],
        coefficients: &[Pack],
        TermBounds { all, tail }: &mut TermBounds,
        part: usize,
    ) -> Lanes<S> {
        let (zero, n) = (Lanes::splat(simd, 0.0), [self.values.rows(), self.time_values.rows()]);
        if kept[0] == n[0] && kept[kept.len() - 1] == n[usize::from(kept.len() > D)] {
            return zero;
        }
        for k in 0..coefficients.len() {
            Lanes::read(simd, &coefficients[k], part).abs().write(&mut all[k], part);
            zero.write(&mut tail[k], part);
        }
        let mut length = coefficients.len();
        for axis in 0..kept.len() {
            let n = n[axis / D];
            length /= n;
            for line in 0..length {
                let (mut sum, mut tails) = (zero, zero);
                for i in line * n..line * n + kept[axis] {
                    sum = Lanes::read(simd, &all[i], part).max(sum);
                    tails = Lanes::read(simd, &tail[i], part).max(tails);
                }
                for i in line * n + kept[axis]..(line + 1) * n {
                    let high = Lanes::read(simd, &all[i], part);
                    (sum, tails) = (sum + high, tails + high);
                }
                sum.write(&mut all[line], part);
                tails.write(&mut tail[line], part);
            }
        }
        Lanes::read(simd, &tail[0], part)
    }

    /// (lower); there is no bound if det J_0 is not proved to be positive.
    #[inline(always)]
    fn lower<S: Simd>(
        &self,
        simd: S,
        work: &Scratch,
        [margin, reference_margin]: [Lanes<S>; 2],
        part: usize,
    ) -> Lanes<S> {
        let (points, zero) = (work.reference.len(), Lanes::splat(simd, 0.0));
        let nothing = Lanes::splat(simd, f64::NEG_INFINITY);
        let mut lowest = Lanes::splat(simd, f64::INFINITY);
        for place in &self.bernstein_places {
            let reference = Lanes::read(simd, &work.reference_coefficients[*place], part);
            let mut smallest = Lanes::splat(simd, f64::INFINITY);
            for time in 0..self.kept[D] {
                smallest = Lanes::read(simd, &work.coefficients[time * points + place], part).min(smallest);
            }
            let (least, low) = (smallest - margin, reference - reference_margin);
            let ratio = least / least.select_ge(zero, reference + reference_margin, low);
            // A NaN of a cell is in its margin, and so in all ratios: the last one keeps it.
            lowest = lowest.min(zero.select_ge(low, nothing, ratio));
        }
        lowest
    }
}

/// max |x|
#[inline(always)]
fn largest_of<S: Simd>(simd: S, packs: &[Pack], part: usize) -> Lanes<S> {
    let mut largest = Lanes::splat(simd, 0.0);
    for pack in packs {
        largest = Lanes::read(simd, pack, part).abs().max(largest);
    }
    largest
}

/// The bounds of eight cells whose positions and det J_0 lie in `work`.
pub(in crate::validity) struct BoundPack<'a, const D: usize> {
    pub(in crate::validity) sweep: &'a Sweep<D>,
    pub(in crate::validity) work: &'a mut Scratch,
    /// Whether to bound all halves instead of the whole.
    pub(in crate::validity) in_halves: bool,
}

impl<const D: usize> WithSimd for BoundPack<'_, D> {
    type Output = Swept;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Swept {
        let BoundPack { sweep, work, in_halves } = self;
        let mut out = Swept::NOTHING;
        sweep.jacobians(simd, work);
        for register in 0..Lanes::<S>::PARTS {
            sweep.determinants(simd, work, &mut out, register);
        }
        let parts = if in_halves { &sweep.halves[..] } else { std::slice::from_ref(&sweep.whole) };
        for part in parts {
            sweep.bound(simd, part, work, &mut out);
        }
        out
    }
}
