//! The kernel of one batch: the forces of its cells, or their derivative along a direction, from the same source.

use super::{LineTables, Operator};
use crate::law::PointLaw;
use basis::{AllAxes, AlongAxis, apply_all_axes, contract, scratch_length};
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Dual, LaneNumber, Lanes, Over, Pack, Real, WIDTH, dot, zeroed};

/// The quantity that a run of the kernel computes: forces or their derivative.
pub(super) trait Mode: Send + Sync {
    /// Numbers of the displacement.
    type Number<S: Simd>: LaneNumber<S> + Over<Lanes<S>>;
    /// Blocks of its arrays: values, then derivatives.
    const BLOCKS: usize;
}

/// The forces themselves.
pub(super) struct Forces;

impl Mode for Forces {
    type Number<S: Simd> = Lanes<S>;
    const BLOCKS: usize = 1;
}

/// Their derivative along a direction.
pub(super) struct Tangent;

impl Mode for Tangent {
    type Number<S: Simd> = Dual<Lanes<S>>;
    const BLOCKS: usize = 2;
}

/// Work space of one batch; arrays hold as many fields as laws need, one or two per block.
pub(super) struct Scratch {
    /// `[block][field][component][node]`
    pub(super) nodal: Vec<Pack>,
    /// `[block][field][component][point]`
    values: Vec<Pack>,
    /// `[direction][block][field][component][point]`
    gradients: Vec<Pack>,
    /// Intermediate results between two axes.
    between: Vec<Pack>,
}

impl Scratch {
    pub(super) fn new<const D: usize>(lines: &LineTables, fields: usize) -> Self {
        let LineTables { interpolate, interpolate_transposed, .. } = lines;
        let (points, nodes) = (lines.points::<D>(), interpolate.cols().pow(D as u32));
        let between =
            scratch_length(&[interpolate; D], fields * D).max(scratch_length(&[interpolate_transposed; D], D));
        Scratch {
            nodal: zeroed(fields * D * nodes),
            values: zeroed(fields * D * points),
            gradients: zeroed(fields * D * D * points),
            between: zeroed(between),
        }
    }
}

/// The forces of consecutive batches from `first`, for a displacement and, if it is differentiated, a direction.
pub(super) struct Cells<'a, const D: usize, M, L> {
    pub(super) operator: &'a Operator<D>,
    pub(super) law: L,
    pub(super) mode: PhantomData<M>,
    pub(super) first: usize,
    /// One nodal vector per block and field.
    pub(super) fields: &'a [&'a [f64]],
    /// The cell field of results.
    pub(super) results: &'a mut [Pack],
    /// The smallest J of every cell.
    pub(super) smallest: &'a mut [Pack],
    pub(super) scratch: &'a mut Scratch,
}

impl<const D: usize, M: Mode, L: PointLaw> WithSimd for Cells<'_, D, M, L> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Cells { operator, law, first, fields, results, smallest, scratch, .. } = self;
        let length = operator.batches.cell_length();
        for (offset, result) in results.chunks_exact_mut(length).enumerate() {
            let batch = first + offset;
            for (number, field) in fields.iter().enumerate() {
                operator.batches.gather(batch, field, &mut scratch.nodal[number * length..][..length]);
            }
            smallest[offset] = operator.apply_to_batch::<S, M, L>(simd, law, batch, scratch, result);
        }
    }
}

/// The matrices of the cells of one batch, column by column.
pub(super) struct CellMatrices<'a, const D: usize, M, L> {
    pub(super) operator: &'a Operator<D>,
    pub(super) law: L,
    pub(super) mode: PhantomData<M>,
    pub(super) batch: usize,
    /// The displacement at which the forces are differentiated.
    pub(super) point: &'a [f64],
    /// `[column][row]`, both of them `[component][node]`.
    pub(super) columns: &'a mut [Pack],
}

impl<const D: usize, M: Mode, L: PointLaw> WithSimd for CellMatrices<'_, D, M, L> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let CellMatrices { operator, law, batch, point, columns, .. } = self;
        let length = operator.batches.cell_length();
        let mut scratch = Scratch::new::<D>(&operator.lines, M::BLOCKS);
        // The direction is the last block; if there are two, the displacement lies before it.
        let direction = (M::BLOCKS - 1) * length;
        for (number, column) in columns.chunks_exact_mut(length).enumerate() {
            operator.batches.gather(batch, point, &mut scratch.nodal[..length]);
            scratch.nodal[direction..].fill(Pack::ZERO);
            scratch.nodal[direction + number] = Pack([1.0; WIDTH]);
            operator.apply_to_batch::<S, M, L>(simd, law, batch, &mut scratch, column);
        }
    }
}

impl<const D: usize> Operator<D> {
    /// `result` = the forces of the cells of one batch for the displacement `scratch.nodal`. Returns the smallest J of every cell.
    fn apply_to_batch<S: Simd, M: Mode, L: PointLaw>(
        &self,
        simd: S,
        law: L,
        batch: usize,
        scratch: &mut Scratch,
        result: &mut [Pack],
    ) -> Pack {
        let LineTables { differentiate_transposed, interpolate, interpolate_transposed, .. } = &self.lines;
        let (extents, field) = ([interpolate.rows(); D], D * self.lines.points::<D>());
        // 1. values and reference gradients at the points
        reference_gradients::<S, D>(simd, &self.lines, M::BLOCKS * L::FIELDS, scratch);
        let Scratch { values, gradients, between, .. } = scratch;
        // 2. the law at every point
        let metric = self.batch_metric(batch);
        let smallest = simd.vectorize(LawAtPoints::<D, M, L> { law, metric, gradients, field, mode: PhantomData });
        // 3. against the reference gradients of the test functions
        let values = &mut values[..field];
        for a in 0..D {
            let gradients = &gradients[a * M::BLOCKS * L::FIELDS * field..][..field];
            let along = AlongAxis::new(differentiate_transposed, a, &extents, D);
            contract(simd, along, gradients, values, a > 0);
        }
        // 4. from points to nodes
        let axes = AllAxes { matrices: &[interpolate_transposed; D], components: D };
        apply_all_axes(simd, axes, values, result, between, false);
        smallest
    }

    /// The reference gradients of the displacement `d` in one batch, `[direction][component][point]`.
    pub(super) fn gradients_of<'a, S: Simd>(
        &self,
        simd: S,
        batch: usize,
        d: &[f64],
        scratch: &'a mut Scratch,
    ) -> &'a [Pack] {
        self.batches.gather(batch, d, &mut scratch.nodal);
        reference_gradients::<S, D>(simd, &self.lines, 1, scratch);
        &scratch.gradients
    }
}

/// Interpolates to the points, and differentiates there.
fn reference_gradients<S: Simd, const D: usize>(simd: S, lines: &LineTables, fields: usize, scratch: &mut Scratch) {
    let Scratch { nodal, values, gradients, between } = scratch;
    let (components, extents) = (fields * D, [lines.interpolate.rows(); D]);
    let length = components * lines.points::<D>();
    let axes = AllAxes { matrices: &[&lines.interpolate; D], components };
    apply_all_axes(simd, axes, nodal, values, between, false);
    for a in 0..D {
        let gradient = &mut gradients[a * length..][..length];
        let along = AlongAxis::new(&lines.differentiate, a, &extents, components);
        contract(simd, along, values, gradient, false);
    }
}

/// Replaces H by W P(H G) G^T at every point, the factor of the reference gradients of the test functions. Returns the smallest
/// J.
struct LawAtPoints<'a, const D: usize, M, L> {
    law: L,
    metric: &'a [Pack],
    gradients: &'a mut [Pack],
    /// Numbers of a field at the points.
    field: usize,
    mode: PhantomData<M>,
}

impl<const D: usize, M: Mode, L: PointLaw> WithSimd for LawAtPoints<'_, D, M, L> {
    type Output = Pack;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Pack {
        let LawAtPoints { law, metric, gradients, field, .. } = self;
        let points = field / D;
        let layout = GradientLayout { points, block: L::FIELDS * field, direction: M::BLOCKS * L::FIELDS * field };
        let direction = layout.direction;
        let mut smallest = Pack([f64::MAX; WIDTH]);
        for point in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let (weight, g) = read_metric::<S, D>(simd, metric, point, part);
                let physical = layout.physical::<S, M::Number<S>, D>(simd, gradients, 0, (point, part), &g);
                let rate = if L::FIELDS > 1 {
                    layout.physical::<S, M::Number<S>, D>(simd, gradients, field, (point, part), &g)
                } else {
                    physical
                };
                let stress = law.stress(&physical, &rate);
                if L::HAS_BARRIER {
                    let least = Lanes::read(simd, &smallest, part);
                    let ratio = stress.volume_ratio.primal();
                    // A minimum forgets a NaN; the products keep it.
                    (least.min(ratio) + (least + ratio) * 0.0).write(&mut smallest, part);
                }
                for i in 0..D {
                    let mut weighted = g[0];
                    for j in 0..D {
                        weighted[j] = stress.piola[i][j].result() * weight;
                    }
                    for a in 0..D {
                        dot(&weighted, &g[a]).write(&mut gradients[a * direction + i * points + point], part);
                    }
                }
            }
        }
        smallest
    }
}

/// Where reference gradients lie: `[direction][block][field][component][point]`.
#[derive(Clone, Copy)]
pub(super) struct GradientLayout {
    /// Points of a cell.
    pub(super) points: usize,
    /// Numbers of a block.
    pub(super) block: usize,
    /// Numbers of a direction.
    pub(super) direction: usize,
}

impl GradientLayout {
    /// That of one field of values.
    pub(super) fn of_one(dimension: usize, points: usize) -> Self {
        GradientLayout { points, block: dimension * points, direction: dimension * points }
    }

    /// grad d = H G at the part `at.1` of the lanes of the point `at.0`, for the field that begins at `first` in a block.
    #[inline(always)]
    pub(super) fn physical<S: Simd, T: LaneNumber<S> + Over<Lanes<S>>, const D: usize>(
        self,
        simd: S,
        gradients: &[Pack],
        first: usize,
        at: (usize, usize),
        g: &[[Lanes<S>; D]; D],
    ) -> [[T; D]; D] {
        let (point, part) = at;
        let mut physical = [[T::lift(g[0][0].zero()); D]; D];
        for a in 0..D {
            for i in 0..D {
                let index = first + i * self.points + point;
                let h = T::load(simd, &gradients[a * self.direction..], self.block, index, part);
                for j in 0..D {
                    physical[i][j] = h.scale_add(g[a][j], physical[i][j]);
                }
            }
        }
        physical
    }
}

/// W and G at one point.
#[inline(always)]
pub(super) fn read_metric<S: Simd, const D: usize>(
    simd: S,
    metric: &[Pack],
    point: usize,
    part: usize,
) -> (Lanes<S>, [[Lanes<S>; D]; D]) {
    let entry = &metric[point * (1 + D * D)..][..1 + D * D];
    let mut g = [[Lanes::splat(simd, 0.0); D]; D];
    for a in 0..D {
        for j in 0..D {
            g[a][j] = Lanes::read(simd, &entry[1 + a * D + j], part);
        }
    }
    (Lanes::read(simd, &entry[0], part), g)
}
