//! Boundary terms of the residual, and the flux through boundaries.

use crate::conservation_law::ConservationLaw;
use crate::facet::{DataAt, FacetContext, penalty, symmetric_term, times_normal};
use crate::facet_evaluation::{FacetPoint, facet_point, geometry_to_points, state_to_points, to_instants};
use crate::instants::{InTime, TimePoint, TimePointIndex};
use crate::mode::{Mode, Values};
use crate::point::{PointIndex, flag, load, physical_gradient};
use crate::scratch::{FacetScratch, through_len};
use crate::tables::Tables;
use crate::tensor_product::{EvaluationFlags, Lattice, evaluate};
use basis::Matrix;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// Positions at the points, relative to the origin of the cell, and the prescribed states there.
#[inline(always)]
pub(crate) fn boundary_data<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    context: &FacetContext<D>,
    instant: &TimePoint,
    of: TimePointIndex,
    data: Option<DataAt>,
    scratch: &mut FacetScratch,
) {
    let Some(data) = data else { return };
    positions::<D, K, S>(simd, context.tables, of, scratch);
    data(context.clock.time(instant.s), &scratch.x, &mut scratch.data);
}

#[inline(always)]
fn positions<const D: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    of: TimePointIndex,
    scratch: &mut FacetScratch,
) {
    let FacetScratch { sides, x, scratch: room, .. } = scratch;
    let (lattice, points) = (Lattice::whole(&tables.mesh, D - 1), tables.facet_points());
    for b in 0..K::GEOMETRY_BLOCKS {
        let position = of.block(&sides[0].position_at, b, D * lattice.nodes());
        evaluate(simd, lattice, D, EvaluationFlags::Values, position, &mut x[b * D * points..], &mut [], room);
    }
}

/// The numerical flux out of the domain at a point, in its two parts, per area.
struct PointFlux<T, const D: usize, const M: usize> {
    /// Fhat_c
    inviscid: [T; M],
    /// - Fhat_v
    viscous: [T; M],
    /// F_v(u_b, (u- - u_b) n), for the symmetric term
    jump_flux: [[T; M]; D],
}

/// The numerical flux of `condition` at a point: (facet) and the second line of (sip).
#[inline(always)]
fn point_flux<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    condition: L::Boundary,
    tables: &Tables<D>,
    here: &FacetPoint<K::Geometry<S>, D>,
    minus: &[K::State<S>; M],
    scratch: &FacetScratch,
    at: PointIndex,
) -> PointFlux<K::State<S>, D, M> {
    let FacetPoint { n, v, .. } = here;
    let data = load::<M, K::Geometry<S>, S>(simd, &scratch.data, at);
    let inviscid = law.boundary_flux::<K::State<S>, K::Geometry<S>>(condition, minus, n, v, &data);
    let mut viscous = [minus[0].zero(); M];
    let mut jump_flux = [viscous; D];
    if law.is_viscous() {
        let state = law.boundary_state::<K::State<S>, K::Geometry<S>>(condition, minus, n, v, &data);
        let gradients = &scratch.sides[0].gradient;
        let gradient = physical_gradient::<D, M, K, S>(simd, gradients, at, &here.cof, here.det);
        let jump = times_normal::<D, M, K::State<S>, K::Geometry<S>>(minus, &state, n);
        let through = law.boundary_viscous_flux::<K::State<S>, K::Geometry<S>>(condition, &state, &gradient, n, v);
        let penalised = law.boundary_viscous_flux::<K::State<S>, K::Geometry<S>>(condition, &state, &jump, n, v);
        let sigma = here.area * here.det.recip().abs() * penalty(tables);
        for m in 0..M {
            viscous[m] = penalised[m].scale(sigma) - through[m];
        }
        jump_flux = law.viscous_flux(&state, &jump);
    }
    PointFlux { inviscid, viscous, jump_flux }
}

/// Step 3 of the facet terms on a boundary.
#[inline(always)]
pub(crate) fn boundary_points<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    condition: L::Boundary,
    tables: &Tables<D>,
    weight: f64,
    scratch: &mut FacetScratch,
) {
    let points = tables.facet_points();
    let one = Lanes::<S>::splat(simd, 1.0);
    for p in 0..points {
        for part in 0..Lanes::<S>::PARTS {
            let (at, weight) = (PointIndex { points, p, part }, weight * tables.facet_weights[p]);
            let here = facet_point::<D, K, S>(simd, scratch, at);
            let minus = load::<M, K::State<S>, S>(simd, &scratch.sides[0].u, at);
            let PointFlux { inviscid, viscous, jump_flux } =
                point_flux::<D, M, L, K, S>(simd, law, condition, tables, &here, &minus, scratch, at);
            if law.is_viscous() {
                // Minus: uhat - u- = -(u- - u_b).
                let scale = here.area * -weight * here.det.recip();
                symmetric_term::<D, M, K, S>(&jump_flux, &here.cof, scale, at, &mut scratch.sides[0].tested_gradient);
            }
            for m in 0..M {
                let term = ((inviscid[m] + viscous[m]).scale(here.area) * weight).result();
                term.write(&mut scratch.sides[0].tested[at.index(m)], part);
            }
            flag::<K::State<S>, S>(simd, law.admissibility(&minus), one, &mut scratch.violated, part);
        }
    }
}

/// The flux through each facet of a batch on a boundary at one time, of the inviscid and then of the viscous flux,
///
/// ```text
/// int_f Fhat ds  and  int_f x x Fhat_m ds,   Fhat_m the flux of momentum                                     (through)
/// ```
///
/// where the second is about the origin of the cell. In 2-D only its last component, about the axis normal to the plane, is not zero. Then
/// follow the power of the momentum flux and the conducted heat,
///
/// ```text
/// int_f Fhat_m . w ds  and  int_f (Fhat_v,E - Fhat_v,m . w_b) ds                                                (power)
/// ```
///
/// with w_b the velocity of the boundary as the mesh moves. w is the same, or the prescribed velocity of the boundary at that
/// time.
pub struct FacetFlux<'a, 'c, const D: usize, const M: usize, L: ConservationLaw<D, M>> {
    /// The conservation law.
    pub law: &'c L,
    /// The condition on the boundary.
    pub condition: L::Boundary,
    /// Shared data.
    pub context: &'c FacetContext<'a, D>,
    /// The time.
    pub instant: &'c TimePoint,
    /// The row of positions at that time.
    pub position_row: &'c Matrix,
    /// Prescribed states, if the condition takes any.
    pub data: Option<DataAt<'a>>,
    /// Whether w is `boundary_velocity` of the scratch instead of the velocity of the mesh.
    pub velocity_is_given: bool,
    /// This thread's packs: reads the traces of the minus side, overwrites `through`.
    pub scratch: &'c mut FacetScratch,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> WithSimd for FacetFlux<'_, '_, D, M, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let FacetFlux { law, condition, context, instant, position_row, data, velocity_is_given, scratch } = self;
        let tables = context.tables;
        let points = tables.facet_points();
        let (viscous, of) = (law.is_viscous(), TimePointIndex::ALONE);
        let in_time = InTime { values: &instant.values, velocities: &instant.velocities, positions: position_row };
        to_instants::<D, M, Values, S>(simd, tables, in_time, viscous, 1, scratch);
        let FacetScratch { sides, scratch: room, .. } = &mut *scratch;
        state_to_points::<D, M, Values, S>(simd, tables, of, viscous, &mut sides[0], room);
        geometry_to_points::<D, M, Values, S>(simd, tables, of, viscous, 1, scratch);
        velocity_of_work::<D, S>(simd, tables, velocity_is_given, scratch);
        positions::<D, Values, S>(simd, tables, of, scratch);
        boundary_data::<D, M, Values, S>(simd, context, instant, of, data, scratch);
        scratch.through.fill(Pack::ZERO);
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let at = PointIndex { points, p, part };
                let here = facet_point::<D, Values, S>(simd, scratch, at);
                let minus = load::<M, Lanes<S>, S>(simd, &scratch.sides[0].u, at);
                let flux = point_flux::<D, M, L, Values, S>(simd, law, condition, tables, &here, &minus, scratch, at);
                let area = here.area * tables.facet_weights[p];
                let x = load::<D, Lanes<S>, S>(simd, &scratch.x, at);
                let v = load::<D, Lanes<S>, S>(simd, &scratch.v[D * points..], at);
                let at_work = law.boundary_velocity(condition, &here.n, &v);
                let moving = law.boundary_velocity(condition, &here.n, &here.v);
                let work = power::<D, M, S>(&flux.inviscid, &at_work) + power::<D, M, S>(&flux.viscous, &at_work);
                let heat = flux.viscous[M - 1] - power::<D, M, S>(&flux.viscous, &moving);
                let (fluxes, powers) = scratch.through.split_at_mut(2 * through_len(M));
                let (inviscid, viscous) = fluxes.split_at_mut(through_len(M));
                add_through::<D, M, S>(simd, &flux.inviscid, area, &x, inviscid, part);
                add_through::<D, M, S>(simd, &flux.viscous, area, &x, viscous, part);
                (Lanes::read(simd, &powers[0], part) + work * area).write(&mut powers[0], part);
                (Lanes::read(simd, &powers[1], part) + heat * area).write(&mut powers[1], part);
            }
        }
    }
}

/// The velocity at which forces do work, at the points: the second block of `v`, whose derivatives are not needed here.
#[inline(always)]
fn velocity_of_work<const D: usize, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    velocity_is_given: bool,
    scratch: &mut FacetScratch,
) {
    let (lattice, len) = (Lattice::whole(&tables.mesh, D - 1), D * tables.facet_points());
    let FacetScratch { v, boundary_velocity, scratch: room, .. } = scratch;
    let (of_mesh, of_work) = v.split_at_mut(len);
    if velocity_is_given {
        evaluate(simd, lattice, D, EvaluationFlags::Values, boundary_velocity, of_work, &mut [], room);
    } else {
        of_work[..len].copy_from_slice(&of_mesh[..len]);
    }
}

/// f_m . w, the momentum f_m being components 1 to D of f.
#[inline(always)]
fn power<const D: usize, const M: usize, S: Simd>(f: &[Lanes<S>; M], w: &[Lanes<S>; D]) -> Lanes<S> {
    let mut sum = f[1] * w[0];
    for i in 1..D {
        sum += f[1 + i] * w[i];
    }
    sum
}

/// sums += area (f, x x f_m), the momentum f_m being components 1 to D of f.
#[inline(always)]
fn add_through<const D: usize, const M: usize, S: Simd>(
    simd: S,
    f: &[Lanes<S>; M],
    area: Lanes<S>,
    x: &[Lanes<S>; D],
    sums: &mut [Pack],
    part: usize,
) {
    for m in 0..M {
        (Lanes::read(simd, &sums[m], part) + f[m] * area).write(&mut sums[m], part);
    }
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        if j < D && k < D {
            let turning = x[j] * f[1 + k] - x[k] * f[1 + j];
            (Lanes::read(simd, &sums[M + i], part) + turning * area).write(&mut sums[M + i], part);
        }
    }
}
