//! The volume terms of a batch of cells.
//!
//! ```text
//! R_a += - int_I int_K ( phi_a' w u + phi_a grad_x w . (F_c - u v - F_v) + phi_a w s ) J  +  [ phi_a int_K w u J ]_top      (volume)
//! ```
//!
//! The integral over the slab is a sum over its Gauss points; at each of them the terms are those of a problem in space.

use crate::conservation_law::ConservationLaw;
use crate::mode::Mode;
use crate::point::{Place, along_reference, flag, load, metric, physical_gradient};
use crate::scratch::CellScratch;
use crate::tables::{Instant, Planes, Tables};
use crate::tensor_product::{Lattice, Parts, evaluate, integrate};
use basis::Matrix;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// Fills the source at a number of points from positions: `(time, points, x [b][d][p], source [b][m][p])`.
pub type SourceAt<'a> = &'a (dyn Fn(f64, usize, &[Pack], &mut [Pack]) + Sync);

/// What the kernels of a slab share.
pub struct CellContext<'a, const D: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// Length of the slab.
    pub dt: f64,
    /// Time at the bottom of the slab.
    pub start: f64,
    /// Rows that give positions at the Gauss points in time, and at the top.
    pub position_rows: &'a [Matrix],
    /// The source s, if there is one.
    pub source: Option<SourceAt<'a>>,
}

/// What a batch of cells is given: a block of packs for the values, and a second one for the derivatives where there are any.
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
        for (q, instant) in tables.instants.iter().enumerate() {
            at_instant::<D, M, S>(simd, tables, instant, &context.position_rows[q], coefficients, scratch);
            space_terms::<D, M, L, K, S>(
                simd,
                law,
                context,
                instant,
                context.dt * instant.weight,
                instant.weight,
                scratch,
            );
            let CellScratch { flux_now, moments_now, residual, scratch: room, .. } = &mut *scratch;
            room.contract(simd, &instant.test, 1, M * nodes, flux_now, residual, q > 0);
            room.contract(simd, &instant.test_rate, 1, M * nodes, moments_now, residual, true);
        }
        let top_row = &context.position_rows[tables.instants.len()];
        at_instant::<D, M, S>(simd, tables, &tables.top, top_row, coefficients, scratch);
        moments::<D, M, K, S>(simd, tables, scratch);
        let CellScratch { moments_now, residual, scratch: room, .. } = scratch;
        room.contract(simd, &tables.top.test, 1, M * nodes, moments_now, residual, true);
    }
}

/// The terms of space alone at one time: reads `state_now`, `position_now`, `velocity_now`, overwrites `flux_now` (scaled
/// by `flux_weight`) and `moments_now` (scaled by `moment_weight`).
pub struct SpaceCells<'a, 'c, const D: usize, const M: usize, L, K> {
    /// The conservation law.
    pub law: &'c L,
    /// Shared data.
    pub context: &'c CellContext<'a, D>,
    /// The time.
    pub instant: &'c Instant,
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
        space_terms::<D, M, L, K, S>(simd, self.law, self.context, self.instant, 1.0, 1.0, self.scratch);
    }
}

/// Moments int w u J of a state at one time: reads `state_now` and `position_now`, overwrites `moments_now`.
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
        moments::<D, M, crate::mode::Values, S>(simd, self.tables, self.scratch);
    }
}

/// State, position and velocity at one time of the slab.
#[inline(always)]
fn at_instant<const D: usize, const M: usize, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    instant: &Instant,
    position_row: &Matrix,
    coefficients: Coefficients,
    scratch: &mut CellScratch,
) {
    let (len, mesh_len) = (M * tables.orders.flow.pow(D as u32), D * tables.orders.mesh.pow(D as u32));
    let CellScratch { state_now, position_now, velocity_now, scratch: room, .. } = scratch;
    for (b, state) in coefficients.state.iter().enumerate() {
        room.contract(simd, &instant.values, 1, len, state, &mut state_now[b * len..], false);
    }
    for (b, mesh) in coefficients.mesh.iter().enumerate() {
        room.contract(simd, position_row, 1, mesh_len, mesh, &mut position_now[b * mesh_len..], false);
        room.contract(simd, &instant.velocities, 1, mesh_len, mesh, &mut velocity_now[b * mesh_len..], false);
    }
}

/// Steps 1 to 4 of the volume terms at one time, planes by planes.
#[inline(always)]
fn space_terms<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    context: &CellContext<D>,
    instant: &Instant,
    flux_weight: f64,
    moment_weight: f64,
    scratch: &mut CellScratch,
) {
    let tables = context.tables;
    let viscous = law.is_viscous();
    for (block, planes) in tables.planes.iter().enumerate() {
        to_points::<D, M, K, S>(simd, tables, planes, viscous, scratch); // 1. geometry and state at the points
        let with_source = source_at_points::<D, K, S>(simd, context, instant, planes, scratch); // 2. the source
        fluxes::<D, M, L, K, S>(simd, law, planes, flux_weight, moment_weight, scratch, viscous, with_source); // 3.
        let parts = if with_source { Parts::Both } else { Parts::Gradients }; // 4. test
        let (lattice, room) = (flow_lattice::<D>(tables, planes), &mut scratch.scratch);
        integrate(simd, lattice, M, parts, &scratch.source, &scratch.flux, &mut scratch.flux_now, room, block > 0);
        integrate(simd, lattice, M, Parts::Values, &scratch.moments, &[], &mut scratch.moments_now, room, block > 0);
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
    viscous: bool,
    scratch: &mut CellScratch,
) {
    let (b, g) = (K::STATE_BLOCKS, K::GEOMETRY_BLOCKS);
    let (flow, mesh) = (flow_lattice::<D>(tables, planes), mesh_lattice::<D>(tables, planes));
    let CellScratch { jacobian, v, u, gradient, scratch: room, .. } = scratch;
    evaluate(simd, mesh, g * D, Parts::Gradients, &scratch.position_now, &mut [], jacobian, room);
    evaluate(simd, mesh, g * D, Parts::Values, &scratch.velocity_now, v, &mut [], room);
    let parts = if viscous { Parts::Both } else { Parts::Values };
    evaluate(simd, flow, b * M, parts, &scratch.state_now, u, gradient, room);
}

/// Evaluates the source at the points, if there is one.
#[inline(always)]
fn source_at_points<const D: usize, K: Mode, S: Simd>(
    simd: S,
    context: &CellContext<D>,
    instant: &Instant,
    planes: &Planes,
    scratch: &mut CellScratch,
) -> bool {
    let Some(source) = context.source else { return false };
    let CellScratch { x, scratch: room, .. } = scratch;
    let (mesh, components) = (mesh_lattice::<D>(context.tables, planes), K::GEOMETRY_BLOCKS * D);
    evaluate(simd, mesh, components, Parts::Values, &scratch.position_now, x, &mut [], room);
    source(context.start + context.dt * instant.s, planes.weights.len(), x, &mut scratch.source);
    true
}

/// The point functions: fluxes in reference directions, moments, source, admissibility.
#[inline(always)]
fn fluxes<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    planes: &Planes,
    flux_weight: f64,
    moment_weight: f64,
    scratch: &mut CellScratch,
    viscous: bool,
    with_source: bool,
) {
    let points = planes.weights.len();
    let one = Lanes::<S>::splat(simd, 1.0);
    for p in 0..points {
        for part in 0..Lanes::<S>::PARTS {
            let at = Place { points, p, part };
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
                moment.result().write(&mut scratch.moments[at.index(m)], part);
            }
            if with_source {
                let s = load::<M, K::Geometry<S>, S>(simd, &scratch.source, at);
                for m in 0..M {
                    // Minus: the source stands on the right of the law. Result overwrites the value block in place.
                    let tested = K::State::<S>::lift(s[m] * det) * weight;
                    tested.result().write(&mut scratch.source[at.index(m)], part);
                }
            }
            let margin = law.margin(&u).min(K::State::<S>::lift(det));
            flag::<K::State<S>, S>(simd, margin, one, &mut scratch.violated, part);
        }
    }
}

/// weight grad_x w . f J as tests against reference derivatives: weight sum_k cof_kj f_k for direction j; `tested[j][m][p]`.
#[inline(always)]
fn test_gradients<const D: usize, const M: usize, K: Mode, S: Simd>(
    f: &[[K::State<S>; M]; D],
    cof: &[[K::Geometry<S>; D]; D],
    weight: f64,
    at: Place,
    tested: &mut [Pack],
) {
    for j in 0..D {
        for m in 0..M {
            let sum = along_reference::<D, M, K::State<S>, K::Geometry<S>>(f, cof, j, m);
            (sum * weight).result().write(&mut tested[at.index(j * M + m)], at.part);
        }
    }
}

/// Moments of the state at one time, int w u J.
#[inline(always)]
fn moments<const D: usize, const M: usize, K: Mode, S: Simd>(simd: S, tables: &Tables<D>, scratch: &mut CellScratch) {
    let (b, g) = (K::STATE_BLOCKS, K::GEOMETRY_BLOCKS);
    let CellScratch { jacobian, u, moments, moments_now, scratch: room, .. } = scratch;
    for (block, planes) in tables.planes.iter().enumerate() {
        let (flow, mesh) = (flow_lattice::<D>(tables, planes), mesh_lattice::<D>(tables, planes));
        evaluate(simd, mesh, g * D, Parts::Gradients, &scratch.position_now, &mut [], jacobian, room);
        evaluate(simd, flow, b * M, Parts::Values, &scratch.state_now, u, &mut [], room);
        let points = planes.weights.len();
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let at = Place { points, p, part };
                let (_, det) = metric::<D, K::Geometry<S>, S>(simd, jacobian, at);
                let u = load::<M, K::State<S>, S>(simd, u, at);
                for m in 0..M {
                    let moment = u[m].scale(det) * planes.weights[p];
                    moment.result().write(&mut moments[at.index(m)], part);
                }
            }
        }
        integrate(simd, flow, M, Parts::Values, moments, &[], moments_now, room, block > 0);
    }
}
