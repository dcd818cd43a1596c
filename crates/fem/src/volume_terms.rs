//! The volume terms of a batch of cells at one time: what the kernels of [`crate::cell`] do with planes of points.

use crate::cell::{CellCoefficients, CellContext};
use crate::cell_geometry::{CellGeometry, GeometryScratch, geometry_len};
use crate::conservation_law::ConservationLaw;
use crate::fields::Fields;
use crate::point::{Kernel, KernelTypes, Metric, PointIndex, along_reference};
use crate::scratch::CellScratch;
use crate::tables::Planes;
use crate::tensor_product::{AtPoints, Lattice, evaluate, integrate};
use crate::time_points::{TimePoint, TimePointIndex};
use basis::AlongAxis;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// A time at which the terms of space are evaluated.
#[derive(Clone, Copy)]
pub(crate) struct CellTime<'a> {
    /// The time.
    pub(crate) time_point: &'a TimePoint,
    /// Its place in the arrays of the scratch.
    pub(crate) of: TimePointIndex,
    /// Weights of fluxes and sources, and of the mass product.
    pub(crate) weights: [f64; 2],
}

/// The arguments of [`Kernel::space_terms`].
struct SpaceTerms<'c, 'a, const D: usize, const M: usize, T: KernelTypes<D, M>> {
    kernel: Kernel<'c, D, M, T>,
    context: &'c CellContext<'a, D>,
    geometry: Option<&'c [Pack]>,
    time: CellTime<'c>,
    scratch: &'c mut CellScratch,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> WithSimd for SpaceTerms<'_, '_, D, M, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let SpaceTerms { kernel, context, geometry, time, scratch } = self;
        kernel.planes(context, geometry, time, scratch);
    }
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// The state at all times; position and velocity too, where the geometry is not known or the source needs the position.
    #[inline(always)]
    pub(crate) fn to_time_points(
        self,
        context: &CellContext<D>,
        coefficients: CellCoefficients,
        scratch: &mut CellScratch,
    ) {
        let (tables, len) = (self.tables, M * self.tables.orders.flow.pow(D as u32));
        let CellScratch { state_at, geometry, scratch: room, .. } = scratch;
        for (b, state) in coefficients.state.iter().enumerate() {
            let values = AlongAxis { matrix: &tables.values_and_top, outer: 1, inner: len };
            room.contract(self.simd, values, state, &mut state_at[b * tables.times() * len..], false);
        }
        if context.geometry.is_none() || context.source.is_some() {
            self.cell_geometry().mesh_at_times(context.positions, coefficients.mesh, geometry);
        }
    }

    /// The steps of the geometry, for the same numbers.
    #[inline(always)]
    fn cell_geometry(&self) -> CellGeometry<'_, D, T::Mode, T::Simd> {
        CellGeometry { simd: self.simd, tables: self.tables, mode: PhantomData }
    }

    /// Steps 1 to 4 of the volume terms at one time point. Slabs and the operator of space share one compiled function.
    #[inline(always)]
    pub(crate) fn space_terms(
        self,
        context: &CellContext<D>,
        geometry: Option<&[Pack]>,
        time: CellTime,
        scratch: &mut CellScratch,
    ) {
        self.simd.vectorize(SpaceTerms { kernel: self, context, geometry, time, scratch });
    }

    /// Steps 1 to 4, planes by planes: fluxes and mass products with their weights. If `geometry` is not known, it is computed in the scratch.
    #[inline(always)]
    fn planes(self, context: &CellContext<D>, geometry: Option<&[Pack]>, time: CellTime, scratch: &mut CellScratch) {
        let len = M * self.tables.orders.flow.pow(D as u32);
        let mut first = time.of.number * self.tables.volume_points();
        for (block, planes) in self.tables.planes.iter().enumerate() {
            self.state_to_points(planes, time.of, scratch); // 1. state, then geometry at the points
            let known = geometry.map(|known| &known[T::GEOMETRY_BLOCKS * geometry_len(D) * first..]);
            if known.is_none() {
                self.geometry_to_points(planes, time.of, &mut scratch.geometry);
            }
            first += planes.weights.len();
            let with_source = self.source_at_points(context, planes, time, scratch); // 2. the source
            if self.law.is_split() {
                self.fluxes::<true>(known, planes, time.weights, with_source, scratch); // 3.
            } else {
                self.fluxes::<false>(known, planes, time.weights, with_source, scratch);
            }
            if self.law.captures_shocks() {
                self.add_artificial_fluxes(known, planes, time.weights[0], scratch);
            }
            if self.law.corrects_entropy() {
                self.add_entropy_viscosity(known, planes, time.weights[0], scratch);
            }
            let CellScratch { flux, source, mass_product, flux_at, mass_product_at, scratch: room, .. } = &mut *scratch;
            let tested = match (with_source || self.law.is_split(), self.has_gradients()) {
                (false, _) => AtPoints::Gradients(&flux[..]),
                (true, false) => AtPoints::Values(&source[..]),
                (true, true) => AtPoints::Both(&source[..], &flux[..]),
            };
            let (flow, start) = (self.flow_lattice(planes), time.of.number * len);
            integrate(self.simd, flow, tested, &mut flux_at[start..], room, block > 0); // 4. test
            let products = AtPoints::Values(&mass_product[..]);
            integrate(self.simd, flow, products, &mut mass_product_at[start..], room, block > 0);
        }
    }

    /// Whether fluxes are tested with gradients: all, or where the inviscid ones are split the viscous ones.
    #[inline(always)]
    fn has_gradients(self) -> bool {
        !self.law.is_split() || self.law.is_viscous()
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

    /// State and its reference gradient at the points.
    #[inline(always)]
    fn state_to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut CellScratch) {
        let (flow, points, viscous) = (self.flow_lattice(planes), planes.weights.len(), self.law.is_viscous());
        let CellScratch { u, gradient, state_at, scratch: room, .. } = scratch;
        for b in 0..T::STATE_BLOCKS {
            let (u, gradient) = (&mut u[b * M * points..], &mut gradient[b * D * M * points..]);
            let state = of.block(state_at, b, flow.len());
            evaluate(self.simd, flow, state, AtPoints::new(u, gradient, viscous), room);
        }
    }

    /// The geometry that is not known, `at_points[b][number][p]`.
    #[inline(always)]
    fn geometry_to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let mut at_points = std::mem::take(&mut scratch.at_points);
        self.cell_geometry().of_map(planes, of, scratch, &mut at_points);
        scratch.at_points = at_points;
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
        let CellScratch { x, geometry, scratch: room, .. } = &mut *scratch;
        let (mesh, points) = (self.mesh_lattice(planes), planes.weights.len());
        for b in 0..T::GEOMETRY_BLOCKS {
            let position = time.of.block(&geometry.position_at, b, mesh.len());
            evaluate(self.simd, mesh, position, AtPoints::Values(&mut x[b * D * points..]), room);
        }
        source(context.clock.time(time.time_point.s), points, &scratch.x, &mut scratch.source);
        true
    }

    /// The point functions: fluxes in reference directions, mass product, source, admissibility. `SPLIT` as [`ConservationLaw::is_split`]:
    /// two loops, each with its own registers.
    #[inline(always)]
    fn fluxes<const SPLIT: bool>(
        self,
        known: Option<&[Pack]>,
        planes: &Planes,
        [flux_weight, mass_weight]: [f64; 2],
        with_source: bool,
        scratch: &mut CellScratch,
    ) {
        let (points, law, viscous) = (planes.weights.len(), self.law, self.law.is_viscous());
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let geometry = known.unwrap_or(&scratch.geometry.at_points);
                let (metric, v) = (self.cell_metric(geometry, at), self.cell_velocity(geometry, at));
                let u = self.state(&scratch.u, at);
                let mut gradient = [u; D];
                if viscous {
                    gradient = self.physical_gradient(&scratch.gradient, at, &metric);
                }
                let f = if SPLIT { self.viscous_part(&u, &gradient) } else { law.flux(&u, &gradient, &v) };
                // Minus from integration by parts.
                let weight = -planes.weights[p] * flux_weight;
                if !SPLIT || viscous {
                    self.test_gradients(&f, &metric.cof, weight, at, &mut scratch.flux);
                }
                self.point_mass_product(&u, metric.det, planes.weights[p] * mass_weight, at, &mut scratch.mass_product);
                if with_source {
                    let s = law.source(&u, &self.geometry::<M>(&scratch.source, at));
                    for m in 0..M {
                        // Minus: the source stands on the right of the law. Result overwrites the value block in place.
                        let tested = s[m].scale(metric.det) * weight;
                        tested.result().write(&mut scratch.source[at.index(m)], part);
                    }
                } else if law.is_split() {
                    (0..M).for_each(|m| {
                        Lanes::<T::Simd>::splat(self.simd, 0.0).write(&mut scratch.source[at.index(m)], part)
                    });
                }
                let admissibility = law.admissibility(&u).min(T::State::lift(metric.det));
                self.flag(admissibility, &mut scratch.violated, part);
            }
        }
        if SPLIT {
            let CellScratch { u, geometry, source, .. } = scratch;
            self.split_terms([u, known.unwrap_or(&geometry.at_points)], planes, flux_weight, source);
        }
    }

    /// -F_v, where the inviscid flux is tested in (split).
    #[inline(always)]
    fn viscous_part(self, u: &[T::State; M], gradient: &[[T::State; M]; D]) -> [[T::State; M]; D] {
        let mut flux = [[u[0].zero(); M]; D];
        if self.law.is_viscous() {
            let viscous = self.law.viscous_flux(u, gradient);
            for k in 0..D {
                for m in 0..M {
                    flux[k][m] = -viscous[k][m];
                }
            }
        }
        flux
    }

    /// The metric at a point, of `geometry[b][number][p]`.
    #[inline(always)]
    pub(crate) fn cell_metric(self, geometry: &[Pack], at: PointIndex) -> Metric<T::Geometry, D> {
        self.metric(geometry, Fields::new(geometry_len(D), at.points), [0, D * D + D], at)
    }

    /// The velocity of the mesh at a point, of `geometry[b][number][p]`.
    #[inline(always)]
    pub(crate) fn cell_velocity(self, geometry: &[Pack], at: PointIndex) -> [T::Geometry; D] {
        Fields::new(geometry_len(D), at.points).from(D * D).vector(self.simd, geometry, at.p, at.part)
    }

    /// weight grad_x psi . f J as tests against reference derivatives: weight sum_k cof_kj f_k for direction j; `tested[j][m][p]`.
    #[inline(always)]
    fn test_gradients(
        self,
        f: &[[T::State; M]; D],
        cof: &[[T::Geometry; D]; D],
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
    fn point_mass_product(self, u: &[T::State; M], det: T::Geometry, weight: f64, at: PointIndex, out: &mut [Pack]) {
        for m in 0..M {
            let product = u[m].scale(det) * weight;
            product.result().write(&mut out[at.index(m)], at.part);
        }
    }

    /// Mass product of the state at one time, int psi u J. J is `known` at the points, `[p]`, or computed.
    #[inline(always)]
    pub(crate) fn mass_product(self, known: Option<&[Pack]>, of: TimePointIndex, scratch: &mut CellScratch) {
        let mut first = 0;
        for (block, planes) in self.tables.planes.iter().enumerate() {
            let known = known.map(|known| &known[first..]);
            if known.is_none() {
                self.determinants_to_points(planes, of, &mut scratch.geometry);
            }
            first += planes.weights.len();
            let (flow, points) = (self.flow_lattice(planes), planes.weights.len());
            let CellScratch { state_at, geometry, u, mass_product, mass_product_at, scratch: room, .. } = &mut *scratch;
            for b in 0..T::STATE_BLOCKS {
                let u = AtPoints::Values(&mut u[b * M * points..]);
                evaluate(self.simd, flow, of.block(state_at, b, flow.len()), u, room);
            }
            let determinants = known.unwrap_or(&geometry.at_points);
            for p in 0..points {
                for part in 0..Lanes::<T::Simd>::PARTS {
                    let at = PointIndex { points, p, part };
                    let det = T::Geometry::load(self.simd, determinants, points, p, part);
                    self.point_mass_product(&self.state(u, at), det, planes.weights[p], at, mass_product);
                }
            }
            let (products, start) = (AtPoints::Values(&mass_product[..]), of.number * flow.len());
            integrate(self.simd, flow, products, &mut mass_product_at[start..], room, block > 0);
        }
    }

    /// J at the points, `at_points[b][p]`.
    #[inline(always)]
    fn determinants_to_points(self, planes: &Planes, of: TimePointIndex, scratch: &mut GeometryScratch) {
        let mut at_points = std::mem::take(&mut scratch.at_points);
        self.cell_geometry().determinants(planes, of, scratch, &mut at_points);
        scratch.at_points = at_points;
    }
}
