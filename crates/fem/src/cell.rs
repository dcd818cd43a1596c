//! The volume terms of a batch of cells.
//!
//! ```text
//! R_a += - int_I int_K ( phi_a' w u + phi_a grad_x w . (F_c - u v - F_v) + phi_a w s ) J  +  [ phi_a int_K w u J ]_top      (volume)
//! ```
//!
//! The integral over the slab is a sum over its Gauss points. At each of them the terms form a problem in space.

use crate::conservation_law::ConservationLaw;
use crate::instants::{Clock, TimePoint, TimePointIndex};
use crate::mode::Mode;
use crate::point::{PointIndex, along_reference, flag, load, metric, physical_gradient};
use crate::scratch::CellScratch;
use crate::tables::{Planes, Tables};
use crate::tensor_product::{EvaluationFlags, Lattice, evaluate, integrate};
use basis::Matrix;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

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
    /// Positions at the Gauss points in time and last at the top, `[instant][slot]`.
    pub positions: &'a Matrix,
    /// The source s, if there is one.
    pub source: Option<SourceAt<'a>>,
}

/// The input of a batch of cells: a block of packs for the values, and a second block for the derivatives, if there are any.
#[derive(Clone, Copy)]
pub struct Coefficients<'a> {
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
    pub coefficients: Coefficients<'c>,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
    /// Values or derivatives.
    pub mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for SlabCells<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let SlabCells { law, context, coefficients, scratch, .. } = self;
        let tables = context.tables;
        let nodes = tables.orders.flow.pow(D as u32);
        scratch.violated = Pack::ZERO;
        to_instants::<D, M, S>(simd, context, coefficients, scratch);
        let count = tables.instants.len() + 1;
        for (number, instant) in tables.instants.iter().enumerate() {
            let weights = [context.dt * instant.weight, instant.weight];
            space_terms::<D, M, L, K, S>(
                simd,
                law,
                context,
                instant,
                TimePointIndex { number, count },
                weights,
                scratch,
            );
        }
        mass_product::<D, M, K, S>(simd, tables, TimePointIndex { number: count - 1, count }, scratch);
        let CellScratch { flux_at, mass_product_at, residual, scratch: room, .. } = scratch;
        room.contract(simd, &tables.test, 1, M * nodes, flux_at, residual, false);
        room.contract(simd, &tables.test_rate, 1, M * nodes, mass_product_at, residual, true);
    }
}

/// The terms of space alone at one time. Reads `state_at`, `position_at` and `velocity_at` of one time, overwrites `flux_at` and
/// `mass_product_at` of time 0.
pub struct SpaceCells<'a, 'c, const D: usize, const M: usize, L, K> {
    /// The conservation law.
    pub law: &'c L,
    /// Shared data.
    pub context: &'c CellContext<'a, D>,
    /// The time.
    pub instant: &'c TimePoint,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
    /// Values or derivatives.
    pub mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for SpaceCells<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.scratch.violated = Pack::ZERO;
        space_terms::<D, M, L, K, S>(
            simd,
            self.law,
            self.context,
            self.instant,
            TimePointIndex::ALONE,
            [1.0; 2],
            self.scratch,
        );
    }
}

/// Moments int w u J of a state at one time. Reads `state_at` and `position_at` of one time, overwrites `mass_product_at` of time 0.
pub struct CellMoments<'a, 'c, const D: usize, const M: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// This thread's packs.
    pub scratch: &'c mut CellScratch,
}

impl<const D: usize, const M: usize> WithSimd for CellMoments<'_, '_, D, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        mass_product::<D, M, crate::mode::Values, S>(simd, self.tables, TimePointIndex::ALONE, self.scratch);
    }
}

/// State and position at all instants and at the top, velocity at all instants.
#[inline(always)]
fn to_instants<const D: usize, const M: usize, S: Simd>(
    simd: S,
    context: &CellContext<D>,
    coefficients: Coefficients,
    scratch: &mut CellScratch,
) {
    let tables = context.tables;
    let (len, mesh_len) = (M * tables.orders.flow.pow(D as u32), D * tables.orders.mesh.pow(D as u32));
    let count = tables.instants.len() + 1;
    let CellScratch { state_at, position_at, velocity_at, scratch: room, .. } = scratch;
    for (b, state) in coefficients.state.iter().enumerate() {
        room.contract(simd, &tables.values_and_top, 1, len, state, &mut state_at[b * count * len..], false);
    }
    for (b, mesh) in coefficients.mesh.iter().enumerate() {
        let start = b * count * mesh_len;
        room.contract(simd, context.positions, 1, mesh_len, mesh, &mut position_at[start..], false);
        room.contract(simd, &tables.velocities, 1, mesh_len, mesh, &mut velocity_at[start..], false);
    }
}

/// Steps 1 to 4 of the volume terms at one instant, planes by planes: fluxes and moments with their weights.
#[inline(always)]
fn space_terms<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    context: &CellContext<D>,
    instant: &TimePoint,
    of: TimePointIndex,
    weights: [f64; 2],
    scratch: &mut CellScratch,
) {
    let (tables, viscous) = (context.tables, law.is_viscous());
    let len = M * tables.orders.flow.pow(D as u32);
    for (block, planes) in tables.planes.iter().enumerate() {
        to_points::<D, M, K, S>(simd, tables, planes, of, viscous, scratch); // 1. geometry and state at the points
        let with_source = source_at_points::<D, K, S>(simd, context, instant, planes, of, scratch); // 2. the source
        fluxes::<D, M, L, K, S>(simd, law, planes, weights, scratch, viscous, with_source); // 3.
        let parts = if with_source { EvaluationFlags::Both } else { EvaluationFlags::Gradients }; // 4. test
        let (lattice, room) = (flow_lattice::<D>(tables, planes), &mut scratch.scratch);
        let (flux_at, mass_product_at) =
            (&mut scratch.flux_at[of.number * len..], &mut scratch.mass_product_at[of.number * len..]);
        integrate(simd, lattice, M, parts, &scratch.source, &scratch.flux, flux_at, room, block > 0);
        integrate(
            simd,
            lattice,
            M,
            EvaluationFlags::Values,
            &scratch.mass_product,
            &[],
            mass_product_at,
            room,
            block > 0,
        );
    }
}

/// The flow polynomials at some planes of points.
#[inline(always)]
fn flow_lattice<'a, const D: usize>(tables: &'a Tables<D>, planes: &'a Planes) -> Lattice<'a> {
    Lattice { line: &tables.flow, last: &planes.flow, dimension: D }
}

/// The mesh polynomials there.
#[inline(always)]
fn mesh_lattice<'a, const D: usize>(tables: &'a Tables<D>, planes: &'a Planes) -> Lattice<'a> {
    Lattice { line: &tables.mesh, last: &planes.mesh, dimension: D }
}

/// Jacobian matrix, mesh velocity, state and its reference gradient at the points.
#[inline(always)]
fn to_points<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    planes: &Planes,
    of: TimePointIndex,
    viscous: bool,
    scratch: &mut CellScratch,
) {
    let (flow, mesh) = (flow_lattice::<D>(tables, planes), mesh_lattice::<D>(tables, planes));
    jacobian_to_points::<D, K, S>(simd, mesh, of, planes, scratch);
    let CellScratch { v, u, gradient, scratch: room, .. } = scratch;
    let (points, mesh_len) = (planes.weights.len(), D * mesh.nodes());
    for b in 0..K::GEOMETRY_BLOCKS {
        let velocity = of.block(&scratch.velocity_at, b, mesh_len);
        evaluate(simd, mesh, D, EvaluationFlags::Values, velocity, &mut v[b * D * points..], &mut [], room);
    }
    let parts = if viscous { EvaluationFlags::Both } else { EvaluationFlags::Values };
    for b in 0..K::STATE_BLOCKS {
        let state = of.block(&scratch.state_at, b, M * flow.nodes());
        let gradient = &mut gradient[b * D * M * points..];
        evaluate(simd, flow, M, parts, state, &mut u[b * M * points..], gradient, room);
    }
}

/// Jacobian matrices at the points.
#[inline(always)]
fn jacobian_to_points<const D: usize, K: Mode, S: Simd>(
    simd: S,
    mesh: Lattice,
    of: TimePointIndex,
    planes: &Planes,
    scratch: &mut CellScratch,
) {
    let CellScratch { jacobian, position_at, scratch: room, .. } = scratch;
    for b in 0..K::GEOMETRY_BLOCKS {
        let position = of.block(position_at, b, D * mesh.nodes());
        let jacobian = &mut jacobian[b * D * D * planes.weights.len()..];
        evaluate(simd, mesh, D, EvaluationFlags::Gradients, position, &mut [], jacobian, room);
    }
}

/// Evaluates the source at the points, if there is one.
#[inline(always)]
fn source_at_points<const D: usize, K: Mode, S: Simd>(
    simd: S,
    context: &CellContext<D>,
    instant: &TimePoint,
    planes: &Planes,
    of: TimePointIndex,
    scratch: &mut CellScratch,
) -> bool {
    let Some(source) = context.source else { return false };
    let CellScratch { x, scratch: room, .. } = scratch;
    let (mesh, points) = (mesh_lattice::<D>(context.tables, planes), planes.weights.len());
    for b in 0..K::GEOMETRY_BLOCKS {
        let position = of.block(&scratch.position_at, b, D * mesh.nodes());
        evaluate(simd, mesh, D, EvaluationFlags::Values, position, &mut x[b * D * points..], &mut [], room);
    }
    source(context.clock.time(instant.s), points, x, &mut scratch.source);
    true
}

/// The point functions: fluxes in reference directions, moments, source, admissibility.
#[inline(always)]
fn fluxes<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    planes: &Planes,
    [flux_weight, moment_weight]: [f64; 2],
    scratch: &mut CellScratch,
    viscous: bool,
    with_source: bool,
) {
    let points = planes.weights.len();
    let one = Lanes::<S>::splat(simd, 1.0);
    for p in 0..points {
        for part in 0..Lanes::<S>::PARTS {
            let at = PointIndex { points, p, part };
            let (cof, det) = metric::<D, K::Geometry<S>, S>(simd, &scratch.jacobian, at);
            let u = load::<M, K::State<S>, S>(simd, &scratch.u, at);
            let v = load::<D, K::Geometry<S>, S>(simd, &scratch.v, at);
            let mut gradient = [u; D];
            if viscous {
                gradient = physical_gradient::<D, M, K, S>(simd, &scratch.gradient, at, &cof, det);
            }
            let f = law.flux::<K::State<S>, K::Geometry<S>>(&u, &gradient, &v);
            // Minus from integration by parts.
            let weight = -planes.weights[p] * flux_weight;
            test_gradients::<D, M, K, S>(&f, &cof, weight, at, &mut scratch.flux);
            for m in 0..M {
                let moment = u[m].scale(det) * (planes.weights[p] * moment_weight);
                moment.result().write(&mut scratch.mass_product[at.index(m)], part);
            }
            if with_source {
                let s = load::<M, K::Geometry<S>, S>(simd, &scratch.source, at);
                for m in 0..M {
                    // Minus: the source is on the right-hand side of the law. The result overwrites the value block in
                    // place.
                    let tested = K::State::<S>::lift(s[m] * det) * weight;
                    tested.result().write(&mut scratch.source[at.index(m)], part);
                }
            }
            let admissibility = law.admissibility(&u).min(K::State::<S>::lift(det));
            flag::<K::State<S>, S>(simd, admissibility, one, &mut scratch.violated, part);
        }
    }
}

/// weight grad_x w . f J as tests against reference derivatives: weight sum_k cof_kj f_k for direction j; `tested[j][m][p]`.
#[inline(always)]
fn test_gradients<const D: usize, const M: usize, K: Mode, S: Simd>(
    f: &[[K::State<S>; M]; D],
    cof: &[[K::Geometry<S>; D]; D],
    weight: f64,
    at: PointIndex,
    tested: &mut [Pack],
) {
    for j in 0..D {
        for m in 0..M {
            let sum = along_reference::<D, M, K::State<S>, K::Geometry<S>>(f, cof, j, m);
            (sum * weight).result().write(&mut tested[at.index(j * M + m)], at.part);
        }
    }
}

/// Moments of the state at one instant, int w u J.
#[inline(always)]
fn mass_product<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    of: TimePointIndex,
    scratch: &mut CellScratch,
) {
    let len = M * tables.orders.flow.pow(D as u32);
    for (block, planes) in tables.planes.iter().enumerate() {
        let (flow, mesh) = (flow_lattice::<D>(tables, planes), mesh_lattice::<D>(tables, planes));
        jacobian_to_points::<D, K, S>(simd, mesh, of, planes, scratch);
        let CellScratch { state_at, jacobian, u, mass_product, mass_product_at, scratch: room, .. } = &mut *scratch;
        for b in 0..K::STATE_BLOCKS {
            let u = &mut u[b * M * planes.weights.len()..];
            evaluate(simd, flow, M, EvaluationFlags::Values, of.block(state_at, b, len), u, &mut [], room);
        }
        let points = planes.weights.len();
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let at = PointIndex { points, p, part };
                let (_, det) = metric::<D, K::Geometry<S>, S>(simd, jacobian, at);
                let u = load::<M, K::State<S>, S>(simd, u, at);
                for m in 0..M {
                    let moment = u[m].scale(det) * planes.weights[p];
                    moment.result().write(&mut mass_product[at.index(m)], part);
                }
            }
        }
        let mass_product_at = &mut mass_product_at[of.number * len..];
        integrate(simd, flow, M, EvaluationFlags::Values, mass_product, &[], mass_product_at, room, block > 0);
    }
}
