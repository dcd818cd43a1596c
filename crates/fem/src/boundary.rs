//! Boundary terms of the residual, and the flux through boundaries.

use crate::conservation_law::{BoundaryPoint, ConservationLaw, Imposed};
use crate::facet::{DataAt, FacetContext, Put, times_normal};
use crate::facet_evaluation::FacetPoint;
use crate::mode::Values;
use crate::point::{Condition, Kernel, KernelTypes, PointIndex, Types, load};
use crate::scratch::{FacetScratch, through_len};
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use crate::time_points::{InTime, TimePoint, TimePointIndex};
use basis::Matrix;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// The numerical flux out of the domain at a point, in its two parts, per area.
pub struct PointFlux<T, const D: usize, const M: usize> {
    /// Fhat_c
    pub inviscid: [T; M],
    /// - Fhat_v
    pub viscous: [T; M],
    /// sigma F_v(u_b, (u- - u_b) n) . n, the part of `viscous` that is the penalty
    pub penalty: [T; M],
    /// F_v(u_b, (u- - u_b) n), for the symmetric term
    pub jump_flux: [[T; M]; D],
}

/// The state inside of a boundary, for viscous fluxes.
pub struct Inside<T, G, const D: usize, const M: usize> {
    /// grad u-, `[direction][component]`.
    pub gradient: [[T; M]; D],
    /// The penalty of (sip).
    pub sigma: G,
    /// See [`ConservationLaw::artificial_viscosity`].
    pub grid: [[G; D]; D],
}

impl<T: Real, const D: usize, const M: usize> PointFlux<T, D, M> {
    /// The numerical flux of `condition` where the state inside is `minus`: (facet) and the second line of (sip), with (artificial). `inside`
    /// is given for viscous laws only.
    #[inline(always)]
    pub fn new<G: Real, L: ConservationLaw<D, M>>(
        law: &L,
        condition: L::Boundary,
        minus: &[T; M],
        at: BoundaryPoint<'_, G, D, M>,
        inside: Option<&Inside<T, G, D, M>>,
    ) -> Self
    where
        T: Over<G>,
    {
        let Imposed { flux: inviscid, state } = law.impose(condition, minus, at);
        let mut viscous = [minus[0].zero(); M];
        let (mut penalty, mut jump_flux) = (viscous, [viscous; D]);
        if let Some(Inside { gradient, sigma, grid }) = inside {
            let jump = times_normal(minus, &state, at.normal);
            let through = law.boundary_viscous_flux(condition, &state, gradient, at);
            let penalised = law.boundary_viscous_flux(condition, &state, &jump, at);
            let mut add = |through: [T; M], penalised: [T; M]| {
                for m in 0..M {
                    let penalised = penalised[m].scale(*sigma);
                    penalty[m] += penalised;
                    viscous[m] += penalised - through[m];
                }
            };
            add(through, penalised);
            jump_flux = law.viscous_flux(&state, &jump);
            if law.captures_shocks() {
                let beta = law.artificial_viscosity(minus, gradient, grid);
                let through = law.boundary_artificial_flux(condition, &state, gradient, beta, at);
                let penalised = law.boundary_artificial_flux(condition, &state, &jump, beta, at);
                add(through, penalised);
                let artificial = law.artificial_flux(&state, &jump, beta);
                for k in 0..D {
                    for m in 0..M {
                        jump_flux[k][m] += artificial[k][m];
                    }
                }
            }
        }
        PointFlux { inviscid, viscous, penalty, jump_flux }
    }
}

/// The condition of boundary facets, and their geometry at the points.
struct BoundaryFacets<'a, B> {
    condition: B,
    geometry: &'a [Pack],
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// Positions at the points, relative to the origin of the cell, and the data of the condition there.
    #[inline(always)]
    pub(crate) fn boundary_data(self, time: f64, of: TimePointIndex, data: Option<DataAt>, scratch: &mut FacetScratch) {
        let Some(data) = data else { return };
        self.positions(of, scratch);
        data(time, &scratch.x, &mut scratch.data);
    }

    #[inline(always)]
    fn positions(self, of: TimePointIndex, scratch: &mut FacetScratch) {
        let FacetScratch { sides, x, scratch: room, .. } = scratch;
        let (lattice, points) = (Lattice::whole(&self.tables.mesh, D - 1, D), self.tables.facet_points());
        for b in 0..T::GEOMETRY_BLOCKS {
            let position = of.block(&sides[0].position_at, b, lattice.len());
            evaluate(self.simd, lattice, position, AtPoints::Values(&mut x[b * D * points..]), room);
        }
    }

    /// The numerical flux at a point.
    #[inline(always)]
    fn point_flux(
        self,
        BoundaryFacets { condition, geometry }: BoundaryFacets<'_, Condition<D, M, T>>,
        here: &FacetPoint<T::Geometry, D>,
        minus: &[T::State; M],
        scratch: &FacetScratch,
        at: PointIndex,
    ) -> PointFlux<T::State, D, M> {
        let FacetPoint { n, v, .. } = here;
        let data = self.geometry(&scratch.data, at);
        let point = BoundaryPoint { normal: n, velocity: v, data: &data };
        if !self.law.is_viscous() {
            return PointFlux::new(self.law, condition, minus, point, None);
        }
        let metric = self.map_of_side(geometry, 0, at);
        let gradient = self.physical_gradient(&scratch.sides[0].gradient, at, &metric);
        let sigma = self.penalty(here.area, metric.det.recip().abs());
        let inside = Inside { gradient, sigma, grid: self.grid(&metric) };
        PointFlux::new(self.law, condition, minus, point, Some(&inside))
    }

    /// Step 3 of the facet terms on a boundary.
    #[inline(always)]
    pub(crate) fn boundary_points(
        self,
        condition: Condition<D, M, T>,
        known: Option<&[Pack]>,
        weight: f64,
        scratch: &mut FacetScratch,
    ) {
        let (points, law) = (self.tables.facet_points(), self.law);
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let geometry = known.unwrap_or(&scratch.geometry);
                let here = self.facet_point(geometry, at, weight);
                let minus = self.state(&scratch.sides[0].u, at);
                let flux = self.point_flux(BoundaryFacets { condition, geometry }, &here, &minus, scratch, at);
                let PointFlux { inviscid, viscous, jump_flux, .. } = flux;
                if law.is_viscous() {
                    let metric = self.map_of_side(geometry, 0, at);
                    // Minus: uhat - u- = -(u- - u_b).
                    let (scale, tested) = (here.area * -here.weight, &mut scratch.sides[0].tested_gradient);
                    self.symmetric_term(&jump_flux, &metric, scale, at, Put::Set(tested));
                }
                for m in 0..M {
                    let term = ((inviscid[m] + viscous[m]).scale(here.area) * here.weight).result();
                    term.write(&mut scratch.sides[0].tested[at.index(m)], part);
                }
                if scratch.with_loads {
                    self.keep_momentum(scratch, at);
                }
                self.flag(law.admissibility(&minus), &mut scratch.violated, part);
            }
        }
    }

    /// The momentum of the flux that is tested at a point, for the loads.
    #[inline(always)]
    fn keep_momentum(self, scratch: &mut FacetScratch, at: PointIndex) {
        let flux: [Lanes<T::Simd>; M] = load(self.simd, &scratch.sides[0].tested, at);
        let momentum = self.law.momentum(&flux);
        for d in 0..D {
            momentum[d].write(&mut scratch.momentum[at.index(d)], at.part);
        }
    }
}

/// The inviscid and then the viscous flux through each facet of a batch on a boundary at one time,
///
/// ```text
/// int_F Fhat dS,   int_F Fhat_m dS   and   int_F x x Fhat_m dS,   Fhat_m the flux of momentum                   (through)
/// ```
///
/// the last about the origin of the cell; in 2-D only its last component, about the axis normal to the plane, is not zero. Then the work of
/// the momentum that leaves and the heat that is conducted, per time,
///
/// ```text
/// int_F Fhat_m . w dS  and  int_F (Fhat_v,E - Fhat_v,m . w_b) dS                                                (power)
/// ```
///
/// with w_b the velocity of the boundary as the mesh moves. w is the same, or the prescribed velocity of the boundary at that
/// time. At the top of a slab the penalty is that of (penalty at top), from the times before.
pub struct FacetFlux<'a, 'c, const D: usize, const M: usize, L: ConservationLaw<D, M>> {
    /// The conservation law.
    pub law: &'c L,
    /// The condition on the boundary.
    pub condition: L::Boundary,
    /// Shared data.
    pub context: &'c FacetContext<'a, D>,
    /// The time.
    pub time: FluxTime<'c>,
    /// The data of the condition, if it takes any.
    pub data: Option<DataAt<'a>>,
    /// This thread's packs: reads the traces of the minus side, overwrites `through`. Adds the penalty to `penalty`, or reads it at the top.
    pub scratch: &'c mut FacetScratch,
}

/// A time at which fluxes through boundaries are integrated.
#[derive(Clone, Copy)]
pub struct FluxTime<'a> {
    /// The time.
    pub time_point: &'a TimePoint,
    /// The row of positions at that time.
    pub position_row: &'a Matrix,
    /// Whether w of (power) comes from `boundary_velocity` of the scratch instead of from the mesh.
    pub velocity_is_given: bool,
    /// The share of this time in (penalty at top); `None` at the top itself.
    pub share: Option<f64>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> WithSimd for FacetFlux<'_, '_, D, M, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let FacetFlux { law, condition, context, time, data, scratch } = self;
        let FluxTime { time_point, position_row, velocity_is_given, share } = time;
        let kernel = Kernel::new(simd, law, context.tables, PhantomData::<Values>);
        let of = TimePointIndex::ALONE;
        let in_time =
            InTime { values: &time_point.values, velocities: &time_point.velocities, positions: position_row };
        kernel.states_to_time_points(in_time.values, 1, scratch);
        kernel.facet_geometry().mesh_at_times(in_time, 1, scratch);
        kernel.trace_to_points(of, &mut scratch.sides[0], &mut scratch.scratch);
        kernel.facet_geometry_to_points(of, 1, scratch);
        kernel.velocity_of_work(velocity_is_given, scratch);
        kernel.positions(of, scratch);
        kernel.boundary_data(context.clock.time(time_point.s), of, data, scratch);
        kernel.flux_through(condition, share, scratch);
    }
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, S: Simd> Kernel<'_, D, M, Types<L, Values, S>> {
    /// (through) and (power) from states, positions and velocities at the points.
    #[inline(always)]
    fn flux_through(self, condition: L::Boundary, share: Option<f64>, scratch: &mut FacetScratch) {
        let (points, law) = (self.tables.facet_points(), self.law);
        scratch.through.fill(Pack::ZERO);
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let at = PointIndex { points, p, part };
                let here = self.facet_point(&scratch.geometry, at, 1.0);
                let minus = self.state(&scratch.sides[0].u, at);
                let facets = BoundaryFacets { condition, geometry: &scratch.geometry };
                let PointFlux { inviscid, viscous, penalty, .. } = self.point_flux(facets, &here, &minus, scratch, at);
                let (x, area) = (self.geometry(&scratch.x, at), here.area * here.weight);
                let (data, at_work) = (self.geometry(&scratch.data, at), self.geometry(&scratch.work_velocity, at));
                let moving = BoundaryPoint { normal: &here.n, velocity: &here.v, data: &data };
                let at_work = BoundaryPoint { velocity: &at_work, ..moving };
                let [moving, at_work] = [moving, at_work].map(|at| law.boundary_velocity(condition, at));
                let heat_of = |f: &[Lanes<S>; M]| law.energy(f) - power(&law.momentum(f), &moving);
                let parts = [&viscous, &penalty].map(|flux| (*flux, heat_of(flux)));
                let (viscous, heat) = self.with_penalty_at_top(share, parts, &mut scratch.penalty, at);
                let [pushing, rubbing] = [law.momentum(&inviscid), law.momentum(&viscous)];
                let work = power(&pushing, &at_work) + power(&rubbing, &at_work);
                let (fluxes, powers) = scratch.through.split_at_mut(2 * through_len(M));
                let (inviscid_sums, viscous_sums) = fluxes.split_at_mut(through_len(M));
                self.add_part(&inviscid, &pushing, &Arm { x, area, part }, inviscid_sums);
                self.add_part(&viscous, &rubbing, &Arm { x, area, part }, viscous_sums);
                self.add_to(work * area, &mut powers[0], part);
                self.add_to(heat * area, &mut powers[1], part);
            }
        }
    }

    /// The viscous flux and its heat at a point: those with (penalty at top) at the top, the given ones at the times before, which leave their
    /// `share` of the penalty in `seen`.
    #[inline(always)]
    fn with_penalty_at_top(
        self,
        share: Option<f64>,
        [viscous, penalty]: [([Lanes<S>; M], Lanes<S>); 2],
        seen: &mut [Pack],
        at: PointIndex,
    ) -> ([Lanes<S>; M], Lanes<S>) {
        let Some(share) = share else {
            let read = |i: usize| Lanes::read(self.simd, &seen[at.index(i)], at.part);
            let flux = std::array::from_fn(|m| viscous.0[m] - penalty.0[m] + read(m));
            return (flux, viscous.1 - penalty.1 + read(M));
        };
        for m in 0..M {
            self.add_to(penalty.0[m] * share, &mut seen[at.index(m)], at.part);
        }
        self.add_to(penalty.1 * share, &mut seen[at.index(M)], at.part);
        viscous
    }

    /// The velocity at which forces do work, at the points.
    #[inline(always)]
    fn velocity_of_work(self, velocity_is_given: bool, scratch: &mut FacetScratch) {
        let lattice = Lattice::whole(&self.tables.mesh, D - 1, D);
        let len = D * self.tables.facet_points();
        let FacetScratch { work_velocity, geometry, boundary_velocity, scratch: room, .. } = scratch;
        if velocity_is_given {
            evaluate(self.simd, lattice, boundary_velocity, AtPoints::Values(work_velocity), room);
        } else {
            work_velocity[..len].copy_from_slice(&geometry[len..2 * len]);
        }
    }

    /// sums += area (f, f_m, x x f_m) with the momentum f_m of the flux f.
    #[inline(always)]
    fn add_part(self, f: &[Lanes<S>; M], force: &[Lanes<S>; D], here: &Arm<S, D>, sums: &mut [Pack]) {
        let Arm { x, area, part } = *here;
        for m in 0..M {
            self.add_to(f[m] * area, &mut sums[m], part);
        }
        for i in 0..D {
            self.add_to(force[i] * area, &mut sums[M + i], part);
        }
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            if j < D && k < D {
                let moment = x[j] * force[k] - x[k] * force[j];
                self.add_to(moment * area, &mut sums[M + 3 + i], part);
            }
        }
    }
}

/// Where a force acts: the position relative to the origin of the cell, the area, and the part of the packs.
struct Arm<S: Simd, const D: usize> {
    x: [Lanes<S>; D],
    area: Lanes<S>,
    part: usize,
}

/// The power f_m . w of a force at a velocity.
#[inline(always)]
fn power<const D: usize, S: Simd>(force: &[Lanes<S>; D], w: &[Lanes<S>; D]) -> Lanes<S> {
    let mut sum = force[0] * w[0];
    for i in 1..D {
        sum += force[i] * w[i];
    }
    sum
}
