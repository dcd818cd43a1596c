//! The volume terms of a batch of cells at one time: what the kernels of [`crate::cell`] do with planes of points.

use crate::cell::{CellCoefficients, CellContext};
use crate::collocation::geometry_len;
use crate::conservation_law::ConservationLaw;
use crate::instants::{TimePoint, TimePointIndex};
use crate::mode::Mode;
use crate::point::{Kernel, PointIndex, along_reference};
use crate::scratch::CellScratch;
use crate::tables::Planes;
use crate::tensor_product::{AlongAxis, AtPoints, Lattice, evaluate, integrate};
use tensor::pulp::Simd;
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// A time at which the terms of space are evaluated.
#[derive(Clone, Copy)]
pub(crate) struct CellTime<'a> {
    /// The time.
    pub(crate) instant: &'a TimePoint,
    /// Its place in the arrays of the scratch.
    pub(crate) of: TimePointIndex,
    /// Weights of fluxes and sources, and of moments.
    pub(crate) weights: [f64; 2],
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd> Kernel<'_, D, M, L, K, S> {
    /// State and position at all instants and at the top, velocity at all instants.
    #[inline(always)]
    pub(crate) fn to_instants(
        self,
        context: &CellContext<D>,
        coefficients: CellCoefficients,
        scratch: &mut CellScratch,
    ) {
        let (simd, tables) = (self.simd, self.tables);
        let (len, mesh_len) = (M * tables.orders.flow.pow(D as u32), D * tables.orders.mesh.pow(D as u32));
        let count = tables.times();
        let CellScratch { state_at, position_at, velocity_at, scratch: room, .. } = scratch;
        for (b, state) in coefficients.state.iter().enumerate() {
            let values = AlongAxis { matrix: &tables.values_and_top, outer: 1, inner: len };
            room.contract(simd, values, state, &mut state_at[b * count * len..], false);
        }
        if tables.collocation.is_some() && context.source.is_none() {
            return; // The geometry is known.
        }
        for (b, mesh) in coefficients.mesh.iter().enumerate() {
            let (start, outer, inner) = (b * count * mesh_len, 1, mesh_len);
            let positions = AlongAxis { matrix: context.positions, outer, inner };
            room.contract(simd, positions, mesh, &mut position_at[start..], false);
            let velocities = AlongAxis { matrix: &tables.velocities, outer, inner };
            room.contract(simd, velocities, mesh, &mut velocity_at[start..], false);
        }
    }

    /// Steps 1 to 4 of the volume terms at one instant, planes by planes: fluxes and moments with their weights.
    #[inline(always)]
    pub(crate) fn space_terms(self, context: &CellContext<D>, time: CellTime, scratch: &mut CellScratch) {
        let len = M * self.tables.orders.flow.pow(D as u32);
        for (block, planes) in self.tables.planes.iter().enumerate() {
            self.to_points(planes, time.of, scratch); // 1. geometry and state at the points
            let with_source = self.source_at_points(context, planes, time, scratch); // 2. the source
            self.fluxes(context, planes, time, with_source, scratch); // 3.
            let CellScratch { flux, source, mass_product, flux_at, mass_product_at, scratch: room, .. } = &mut *scratch;
            let tested =
                if with_source { AtPoints::Both(&source[..], &flux[..]) } else { AtPoints::Gradients(&flux[..]) };
            let (flow, start) = (self.flow_lattice(planes), time.of.number * len);
            integrate(self.simd, flow, tested, &mut flux_at[start..], room, block > 0); // 4. test
            let moments = AtPoints::Values(&mass_product[..]);
            integrate(self.simd, flow, moments, &mut mass_product_at[start..], room, block > 0);
        }
    }

    /// The flow polynomials at some planes of points.
    #[inline(always)]
    fn flow_lattice<'p>(self, planes: &'p Planes) -> Lattice<'p>
    where
        Self: 'p,
    {
        Lattice { line: &self.tables.flow, last: &planes.flow, dimension: D, components: M }
    }

    /// The mesh polynomials there.
    #[inline(always)]
    fn mesh_lattice<'p>(self, planes: &'p Planes) -> Lattice<'p>
    where
        Self: 'p,
    {
        Lattice { line: &self.tables.mesh, last: &planes.mesh, dimension: D, components: D }
    }

    /// Jacobian matrix, mesh velocity, state and its reference gradient at the points.
    #[inline(always)]
    fn to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut CellScratch) {
        if self.tables.collocation.is_none() {
            self.jacobian_to_points(planes, of, scratch);
            self.velocity_to_points(planes, of, scratch);
        }
        let (flow, points, viscous) = (self.flow_lattice(planes), planes.weights.len(), self.law.is_viscous());
        let CellScratch { u, gradient, state_at, scratch: room, .. } = scratch;
        for b in 0..K::STATE_BLOCKS {
            let (u, gradient) = (&mut u[b * M * points..], &mut gradient[b * D * M * points..]);
            let state = of.block(state_at, b, flow.len());
            evaluate(self.simd, flow, state, AtPoints::new(u, gradient, viscous), room);
        }
    }

    /// Mesh velocities at the points.
    #[inline(always)]
    fn velocity_to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut CellScratch) {
        let mesh = self.mesh_lattice(planes);
        let CellScratch { v, velocity_at, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let v = AtPoints::Values(&mut v[b * D * planes.weights.len()..]);
            evaluate(self.simd, mesh, of.block(velocity_at, b, mesh.len()), v, room);
        }
    }

    /// Jacobian matrices at the points.
    #[inline(always)]
    fn jacobian_to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut CellScratch) {
        let mesh = self.mesh_lattice(planes);
        let CellScratch { jacobian, position_at, scratch: room, .. } = scratch;
        for b in 0..K::GEOMETRY_BLOCKS {
            let jacobian = AtPoints::Gradients(&mut jacobian[b * D * D * planes.weights.len()..]);
            evaluate(self.simd, mesh, of.block(position_at, b, mesh.len()), jacobian, room);
        }
    }

    /// Evaluates the source at the points, if there is one.
    #[inline(always)]
    fn source_at_points(
        self,
        context: &CellContext<D>,
        planes: &Planes,
        time: CellTime,
        scratch: &mut CellScratch,
    ) -> bool {
        let Some(source) = context.source else { return false };
        let CellScratch { x, position_at, scratch: room, .. } = &mut *scratch;
        let (mesh, points) = (self.mesh_lattice(planes), planes.weights.len());
        for b in 0..K::GEOMETRY_BLOCKS {
            let position = time.of.block(position_at, b, mesh.len());
            evaluate(self.simd, mesh, position, AtPoints::Values(&mut x[b * D * points..]), room);
        }
        source(context.clock.time(time.instant.s), points, &scratch.x, &mut scratch.source);
        true
    }

    /// The point functions: fluxes in reference directions, moments, source, admissibility.
    #[inline(always)]
    fn fluxes(
        self,
        context: &CellContext<D>,
        planes: &Planes,
        CellTime { of, weights: [flux_weight, moment_weight], .. }: CellTime,
        with_source: bool,
        scratch: &mut CellScratch,
    ) {
        let (points, law, viscous) = (planes.weights.len(), self.law, self.law.is_viscous());
        let collocated = self.tables.collocation.is_some();
        let len = K::GEOMETRY_BLOCKS * geometry_len(D) * points;
        for p in 0..points {
            for part in 0..Lanes::<S>::PARTS {
                let at = PointIndex { points, p, part };
                let u = self.state(&scratch.u, at);
                let (metric, v) = if collocated {
                    let geometry = context.geometry.unwrap_or(&scratch.geometry.at_points);
                    self.known_geometry(&geometry[of.number * len..], at)
                } else {
                    (self.metric(&scratch.jacobian, at), self.geometry(&scratch.v, at))
                };
                let mut gradient = [u; D];
                if viscous {
                    gradient = self.physical_gradient(&scratch.gradient, at, &metric);
                }
                let f = law.flux(&u, &gradient, &v);
                // Minus from integration by parts.
                let weight = -planes.weights[p] * flux_weight;
                self.test_gradients(&f, &metric.cof, weight, at, &mut scratch.flux);
                self.moments(&u, metric.det, planes.weights[p] * moment_weight, at, &mut scratch.mass_product);
                if with_source {
                    let s = law.source(&u, &self.geometry::<M>(&scratch.source, at));
                    for m in 0..M {
                        // Minus: the source stands on the right of the law. Result overwrites the value block in place.
                        let tested = s[m].scale(metric.det) * weight;
                        tested.result().write(&mut scratch.source[at.index(m)], part);
                    }
                }
                let admissibility = law.admissibility(&u).min(K::State::<S>::lift(metric.det));
                self.flag(admissibility, &mut scratch.violated, part);
            }
        }
    }

    /// weight grad_x w . f J as tests against reference derivatives: weight sum_k cof_kj f_k for direction j; `tested[j][m][p]`.
    #[inline(always)]
    fn test_gradients(
        self,
        f: &[[K::State<S>; M]; D],
        cof: &[[K::Geometry<S>; D]; D],
        weight: f64,
        at: PointIndex,
        tested: &mut [Pack],
    ) {
        for j in 0..D {
            for m in 0..M {
                let sum = along_reference(f, cof, j, m);
                (sum * weight).result().write(&mut tested[at.index(j * M + m)], at.part);
            }
        }
    }

    /// weight u J at a point.
    #[inline(always)]
    fn moments(self, u: &[K::State<S>; M], det: K::Geometry<S>, weight: f64, at: PointIndex, moments: &mut [Pack]) {
        for m in 0..M {
            let moment = u[m].scale(det) * weight;
            moment.result().write(&mut moments[at.index(m)], at.part);
        }
    }

    /// Moments of the state at one instant, int w u J.
    #[inline(always)]
    pub(crate) fn mass_product(self, of: TimePointIndex, scratch: &mut CellScratch) {
        let collocated = self.tables.collocation.is_some();
        for (block, planes) in self.tables.planes.iter().enumerate() {
            if collocated {
                self.determinants_to_points(scratch);
            } else {
                self.jacobian_to_points(planes, of, scratch);
            }
            let (flow, points) = (self.flow_lattice(planes), planes.weights.len());
            let CellScratch { state_at, jacobian, u, mass_product, mass_product_at, scratch: room, .. } = &mut *scratch;
            for b in 0..K::STATE_BLOCKS {
                let u = AtPoints::Values(&mut u[b * M * points..]);
                evaluate(self.simd, flow, of.block(state_at, b, flow.len()), u, room);
            }
            for p in 0..points {
                for part in 0..Lanes::<S>::PARTS {
                    let at = PointIndex { points, p, part };
                    let det = if collocated {
                        K::Geometry::<S>::load(self.simd, jacobian, points, p, part)
                    } else {
                        self.metric(jacobian, at).det
                    };
                    self.moments(&self.state(u, at), det, planes.weights[p], at, mass_product);
                }
            }
            let (moments, start) = (AtPoints::Values(&mass_product[..]), of.number * flow.len());
            integrate(self.simd, flow, moments, &mut mass_product_at[start..], room, block > 0);
        }
    }

    /// J of (carried) at the points, in place of Jacobian matrices.
    #[inline(always)]
    fn determinants_to_points(self, scratch: &mut CellScratch) {
        let CellScratch { jacobian, determinant_at, scratch: room, .. } = scratch;
        let nodal = Lattice::whole(&self.tables.flow, D, 1);
        evaluate(self.simd, nodal, determinant_at, AtPoints::Values(&mut jacobian[..]), room);
    }
}
