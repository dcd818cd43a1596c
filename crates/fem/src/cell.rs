//! The volume terms of a batch of cells.
//!
//! ```text
//! R_a += - int_I int_K ( phi_a' psi u + phi_a grad_x psi . (F_c - u v - F_v) + phi_a psi b ) J + [ phi_a int_K psi u J ]_top  (volume)
//! ```
//!
//! The integral over the slab is a sum over its Gauss points. At each of them the terms form a problem in space.

use crate::cell_geometry::geometry_len;
use crate::conservation_law::ConservationLaw;
use crate::mode::{Mode, Values};
use crate::point::Kernel;
use crate::scratch::CellScratch;
use crate::tables::Tables;
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use crate::time_points::{Clock, TimePoint, TimePointIndex};
use crate::volume_terms::CellTime;
use basis::{AlongAxis, Matrix};
use std::marker::PhantomData;
use tensor::Pack;
use tensor::pulp::{Simd, WithSimd};

/// Fills the source at a number of points from positions relative to the origins of their cells:
/// `(time, points, x [b][d][p], source [b][m][p])`.
pub type SourceAt<'a> = &'a (dyn Fn(f64, usize, &[Pack], &mut [Pack]) + Sync);

/// Data shared by the cell kernels of a slab.
pub struct CellContext<'a, const D: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// Length of the slab.
    pub dt: f64,
    /// The times at which data are evaluated.
    pub clock: Clock,
    /// Positions at the Gauss points in time and last at the top, `[time point][slot]`.
    pub positions: &'a Matrix,
    /// The source b, if there is one.
    pub source: Option<SourceAt<'a>>,
    /// The geometry at the points, where it is kept and not differentiated, see [`crate::slab_geometry`].
    pub geometry: Option<&'a [Pack]>,
}

/// The input of a batch of cells: a block of packs for the values, and a second block for the derivatives, if there are any.
#[derive(Clone, Copy)]
pub struct CellCoefficients<'a> {
    /// State in the slab, `[a][m][i]`.
    pub state: &'a [&'a [Pack]],
    /// Bottom position and velocities of the mesh, `[slot][d][i]`.
    pub mesh: &'a [&'a [Pack]],
}

/// The volume terms of a slab: overwrites `residual` of the scratch.
pub struct SlabCells<'a, 'c, const D: usize, const M: usize, L, K> {
    /// The conservation law.
    pub law: &'c L,
    /// Shared data.
    pub context: &'c CellContext<'a, D>,
    /// State and motion of these cells.
    pub coefficients: CellCoefficients<'c>,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
    /// Values or derivatives.
    pub mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for SlabCells<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let SlabCells { law, context, coefficients, scratch, mode } = self;
        let tables = context.tables;
        let kernel = Kernel::new(simd, law, tables, mode);
        let inner = M * tables.orders.flow.pow(D as u32);
        scratch.violated = Pack::ZERO;
        kernel.to_time_points(context, coefficients, scratch);
        // The geometry of collocated rules with its derivatives is in the scratch.
        let of_scratch = std::mem::take(&mut scratch.geometry.known);
        let geometry = context.geometry.or(tables.collocation.is_some().then_some(&of_scratch[..]));
        let count = tables.times();
        for (number, time_point) in tables.time_points.iter().enumerate() {
            let weights = [context.dt * time_point.weight, time_point.weight];
            let time = CellTime { time_point, of: TimePointIndex { number, count }, weights };
            kernel.space_terms(context, geometry, time, scratch);
        }
        if count > tables.time_points.len() {
            let top =
                geometry.map(|known| &known[tables.time_points.len() * geometry_len(D) * tables.volume_points()..]);
            kernel.mass_product(top, TimePointIndex { number: count - 1, count }, scratch);
        }
        scratch.geometry.known = of_scratch;
        let CellScratch { flux_at, mass_product_at, residual, scratch: room, .. } = scratch;
        room.contract(simd, AlongAxis { matrix: &tables.test, outer: 1, inner }, flux_at, residual, false);
        room.contract(simd, AlongAxis { matrix: &tables.test_rate, outer: 1, inner }, mass_product_at, residual, true);
    }
}

/// The terms of the operator of space at one time. Reads `state_at` of one time and the `known` geometry of the scratch, overwrites
/// `flux_at` and `mass_product_at` of time 0.
pub struct SpaceCells<'a, 'c, const D: usize, const M: usize, L, K> {
    /// The conservation law.
    pub law: &'c L,
    /// Shared data.
    pub context: &'c CellContext<'a, D>,
    /// The time.
    pub time_point: &'c TimePoint,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
    /// Values or derivatives.
    pub mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for SpaceCells<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let SpaceCells { law, context, time_point, scratch, mode } = self;
        scratch.violated = Pack::ZERO;
        let time = CellTime { time_point, of: TimePointIndex::ALONE, weights: [1.0; 2] };
        let geometry = std::mem::take(&mut scratch.geometry.known);
        Kernel::new(simd, law, context.tables, mode).space_terms(context, Some(&geometry), time, scratch);
        scratch.geometry.known = geometry;
    }
}

/// Mass product int psi u J of a state at one time. Reads `state_at` of one time and `position_at`, or where J is carried `determinant_at`;
/// overwrites `mass_product_at` of time 0.
pub struct CellMassProduct<'a, 'c, const D: usize, const M: usize, L> {
    /// The conservation law.
    pub law: &'c L,
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> WithSimd for CellMassProduct<'_, '_, D, M, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let CellMassProduct { law, tables, scratch } = self;
        let kernel = Kernel::new(simd, law, tables, PhantomData::<Values>);
        if tables.collocation.is_none() {
            return kernel.mass_product(None, TimePointIndex::ALONE, scratch);
        }
        let mut carried = std::mem::take(&mut scratch.geometry.at_points);
        let (nodal, CellScratch { determinant_at, scratch: room, .. }) =
            (Lattice::whole(&tables.flow, D, 1), &mut *scratch);
        evaluate(simd, nodal, determinant_at, AtPoints::Values(&mut carried[..]), room);
        kernel.mass_product(Some(&carried), TimePointIndex::ALONE, scratch);
        scratch.geometry.at_points = carried;
    }
}
