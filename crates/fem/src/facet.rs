//! The facet terms of a batch of facets.
//!
//! ```text
//! R_a += int_I int_F phi_a psi ( Fhat_c - Fhat_v ) dS + int_I int_F phi_a grad_x psi : F_v(u, (uhat - u) n) dS      (facet)
//!
//! interior   Fhat_v = { F_v(u, grad u) } . n - sigma { F_v(u, [u] n) } . n,   uhat = {u},   [u] = u- - u+           (sip)
//! boundary   Fhat_v = F_v(u_b, grad u-) . n - sigma F_v(u_b, (u- - u_b) n) . n,             uhat = u_b
//! ```
//!
//! This is the symmetric interior penalty method. Its penalty follows from the inverse trace inequality on the cell's height h over
//! the facet,
//!
//! ```text
//! sigma = N_s^2 |S| / J = 2 N_s^2 / h,   h = 2 J / |S|                                                            (penalty)
//! ```
//!
//! The larger penalty of both sides is taken. In (facet) n points out of the cell of psi, in (sip) from minus to plus.

use crate::conservation_law::ConservationLaw;
use crate::facet_evaluation::FacetPoint;
use crate::facet_geometry::facet_geometry_len;
use crate::kernels::Times;
use crate::mode::Mode;
use crate::point::{Condition, Kernel, KernelTypes, Metric, PointIndex, along_reference};
use crate::scratch::{FacetScratch, SideScratch};
use crate::slope;
use crate::tables::Tables;
use crate::tensor_product::{AtPoints, Lattice, Scratch, integrate};
use crate::time_points::{Clock, TimePointIndex};
use basis::AlongAxis;
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// Fills the prescribed state at points from positions relative to the origins of the minus cells:
/// `(time, x [b][d][p], data [b][m][p])`.
pub type DataAt<'a> = &'a (dyn Fn(f64, &[Pack], &mut [Pack]) + Sync);

/// The two sides of a batch of facets.
pub enum Across<'a> {
    /// Two cells.
    Cells,
    /// A cell and the outside: the number of the boundary, and its prescribed states, if its condition takes any.
    Boundary(usize, Option<DataAt<'a>>),
}

/// Data shared by the facet kernels of a slab.
#[derive(Clone, Copy)]
pub struct FacetContext<'a, const D: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// Length of the slab.
    pub dt: f64,
    /// The times at which data are evaluated.
    pub clock: Clock,
    /// The geometry of the batch at its times, `[time][number][p]`, where it is kept and not differentiated.
    pub geometry: Option<&'a [Pack]>,
}

/// The facet terms at a list of times: reads traces, overwrites `terms`.
///
/// In a slab the times are its Gauss points, with weights. The operator of space has one time, with weight one.
pub struct FacetTerms<'a, 'c, const D: usize, const M: usize, L: ConservationLaw<D, M>, K> {
    /// The conservation law.
    pub law: &'c L,
    /// Its conditions on the boundaries.
    pub conditions: &'c [L::Boundary],
    /// Shared data.
    pub context: &'c FacetContext<'a, D>,
    /// The times.
    pub times: &'c Times<'c>,
    /// The other side of the facets.
    pub across: &'c Across<'a>,
    /// This thread's packs.
    pub scratch: &'c mut FacetScratch,
    /// Values or derivatives.
    pub mode: PhantomData<K>,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for FacetTerms<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let FacetTerms { law, conditions, context, times, across, scratch, mode } = self;
        let tables = context.tables;
        let kernel = Kernel::new(simd, law, tables, mode);
        let used = if matches!(across, Across::Cells) { 2 } else { 1 };
        scratch.violated = Pack::ZERO;
        kernel.states_to_time_points(times.in_time.values, used, scratch); // 1.
        if context.geometry.is_none() || matches!(across, Across::Boundary(_, Some(_))) {
            kernel.facet_geometry().mesh_at_times(times.in_time, used, scratch);
        }
        let len = facet_geometry_len(D, law.is_viscous()) * tables.facet_points();
        for (number, time_point) in times.time_points.iter().enumerate() {
            let weight = times.weight * time_point.weight;
            let of = TimePointIndex { number, count: times.time_points.len() };
            for side in &mut scratch.sides[..used] {
                kernel.trace_to_points(of, side, &mut scratch.scratch); // 2.
            }
            let known = context.geometry.map(|geometry| &geometry[number * len..]);
            if known.is_none() {
                kernel.facet_geometry_to_points(of, used, scratch);
            }
            match across {
                Across::Cells => {
                    simd.vectorize(PointsBetweenCells { kernel, known, weight, scratch }); // 3.
                }
                Across::Boundary(number, data) => {
                    kernel.boundary_data(context.clock.time(time_point.s), of, *data, scratch);
                    let condition = conditions[*number];
                    simd.vectorize(PointsOnBoundary { kernel, condition, known, weight, scratch }); // 3.
                    if scratch.with_loads {
                        kernel.test_loads(of, scratch); // 4.
                    }
                }
            }
            for side in &mut scratch.sides[..used] {
                kernel.test(of, side, &mut scratch.scratch); // 4.
            }
        }
        let outer = if law.is_viscous() { 2 } else { 1 };
        let back = AlongAxis { matrix: times.test, outer, inner: M * tables.orders.flow.pow(D as u32 - 1) };
        for SideScratch { terms, terms_at, .. } in &mut scratch.sides[..used] {
            scratch.scratch.contract(simd, back, terms_at, terms, false); // 5.
        }
    }
}

/// Step 3 between two cells. It is compiled as a function of its own, which takes less time than a part of a larger one.
struct PointsBetweenCells<'c, const D: usize, const M: usize, T: KernelTypes<D, M>> {
    kernel: Kernel<'c, D, M, T>,
    known: Option<&'c [Pack]>,
    weight: f64,
    scratch: &'c mut FacetScratch,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> WithSimd for PointsBetweenCells<'_, D, M, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let PointsBetweenCells { kernel, known, weight, scratch } = self;
        kernel.interior_points(known, weight, scratch);
        if kernel.law.captures_shocks() {
            kernel.add_artificial_between(known, weight, scratch);
        }
    }
}

/// The same on a boundary.
struct PointsOnBoundary<'c, const D: usize, const M: usize, T: KernelTypes<D, M>> {
    kernel: Kernel<'c, D, M, T>,
    condition: Condition<D, M, T>,
    known: Option<&'c [Pack]>,
    weight: f64,
    scratch: &'c mut FacetScratch,
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> WithSimd for PointsOnBoundary<'_, D, M, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let PointsOnBoundary { kernel, condition, known, weight, scratch } = self;
        kernel.boundary_points(condition, known, weight, scratch);
    }
}

/// State and map of a cell at a point of one of its faces.
#[derive(Clone, Copy)]
struct SidePoint<'a, T, G, const D: usize, const M: usize> {
    u: &'a [T; M],
    map: &'a Metric<G, D>,
}

/// Minus and plus.
type SidePoints<'a, const D: usize, const M: usize, T> =
    [SidePoint<'a, <T as KernelTypes<D, M>>::State, <T as KernelTypes<D, M>>::Geometry, D, M>; 2];

/// sigma of (penalty), with |S| = `area`, 1 / |J| = `per_volume` and N_s = `order`.
#[inline(always)]
pub fn penalty<G: Real>(area: G, per_volume: G, order: usize) -> G {
    area * per_volume * (order * order) as f64
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// Step 3 between two cells.
    #[inline(always)]
    fn interior_points(self, known: Option<&[Pack]>, weight: f64, scratch: &mut FacetScratch) {
        let (points, law) = (self.tables.facet_points(), self.law);
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let geometry = known.unwrap_or(&scratch.geometry);
                let here = self.facet_point(geometry, at, weight);
                let minus = self.state(&scratch.sides[0].u, at);
                let plus = self.state(&scratch.sides[1].u, at);
                let normal_speed = tensor::dot(&here.n, &here.v);
                let mut f = law.numerical_flux(&minus, &plus, &here.n, normal_speed);
                if law.is_viscous() {
                    let (map_minus, map_plus) = (self.map_of_side(geometry, 0, at), self.map_of_side(geometry, 1, at));
                    let minus = SidePoint { u: &minus, map: &map_minus };
                    let plus = SidePoint { u: &plus, map: &map_plus };
                    self.interior_viscous([minus, plus], &here, at, &mut scratch.sides, &mut f);
                }
                for m in 0..M {
                    let term = (f[m].scale(here.area) * here.weight).result();
                    term.write(&mut scratch.sides[0].tested[at.index(m)], part);
                    // The flux that leaves minus enters plus.
                    (-term).write(&mut scratch.sides[1].tested[at.index(m)], part);
                }
                let admissibility = law.admissibility(&minus).min(law.admissibility(&plus));
                self.flag(admissibility, &mut scratch.violated, part);
            }
        }
    }

    /// The viscous part of step 3 between two cells, (sip): subtracts Fhat_v from `f`, and sets the terms that are tested with
    /// gradients.
    #[inline(always)]
    fn interior_viscous(
        self,
        [SidePoint { u: minus, map: metric_minus }, SidePoint { u: plus, map: metric_plus }]: SidePoints<'_, D, M, T>,
        here: &FacetPoint<T::Geometry, D>,
        at: PointIndex,
        [side_minus, side_plus]: &mut [SideScratch; 2],
        f: &mut [T::State; M],
    ) {
        let law = self.law;
        let gradient_minus = self.physical_gradient(&side_minus.gradient, at, metric_minus);
        let gradient_plus = self.physical_gradient(&side_plus.gradient, at, metric_plus);
        let (flux_minus, flux_plus) =
            (law.viscous_flux(minus, &gradient_minus), law.viscous_flux(plus, &gradient_plus));
        let jump = times_normal(minus, plus, &here.n);
        let (mut jump_flux_minus, mut jump_flux_plus) = (law.viscous_flux(minus, &jump), law.viscous_flux(plus, &jump));
        let sigma = self.interior_penalty(here.area, [metric_minus, metric_plus]);
        subtract_penalised(f, [&flux_minus, &flux_plus], [&jump_flux_minus, &jump_flux_plus], &here.n, sigma);
        if self.penalises_slopes() {
            let flux = self.slope_penalty([minus, plus], [&gradient_minus, &gradient_plus], &here.n, sigma);
            slope::join(&flux, &here.n, &mut jump_flux_minus, &mut jump_flux_plus);
        }
        // uhat - u- = -[u]/2 along n, and uhat - u+ = +[u]/2 along -n: the same on both sides.
        let scale = here.area * (-0.5 * here.weight);
        self.symmetric_term(&jump_flux_minus, metric_minus, scale, at, Put::Set(&mut side_minus.tested_gradient));
        self.symmetric_term(&jump_flux_plus, metric_plus, scale, at, Put::Set(&mut side_plus.tested_gradient));
    }

    /// sigma of (penalty) between two cells, with the smaller of their volumes.
    #[inline(always)]
    pub(crate) fn interior_penalty(
        self,
        area: T::Geometry,
        [minus, plus]: [&Metric<T::Geometry, D>; 2],
    ) -> T::Geometry {
        self.penalty(area, minus.det.recip().abs().max(plus.det.recip().abs()))
    }

    /// sigma of (penalty), with |S| = `area` and 1 / |J| = `per_volume`.
    #[inline(always)]
    pub(crate) fn penalty(self, area: T::Geometry, per_volume: T::Geometry) -> T::Geometry {
        penalty(area, per_volume, self.tables.orders.flow)
    }

    /// scale grad_x psi : f as tests against reference derivatives: scale / det sum_k cof_kj f_k for direction j. They are `put` among the others.
    #[inline(always)]
    pub(crate) fn symmetric_term(
        self,
        f: &[[T::State; M]; D],
        metric: &Metric<T::Geometry, D>,
        scale: T::Geometry,
        at: PointIndex,
        put: Put<'_>,
    ) {
        let (tested_gradient, adds) = match put {
            Put::Set(terms) => (terms, false),
            Put::Add(terms) => (terms, true),
        };
        let scale = scale * metric.det.recip();
        for j in 0..D {
            for m in 0..M {
                let term = along_reference(f, &metric.cof, j, m).scale(scale).result();
                let place = &mut tested_gradient[at.index(j * M + m)];
                if adds {
                    self.add_to(term, place, at.part);
                } else {
                    term.write(place, at.part);
                }
            }
        }
    }

    /// Step 4 for (load): tests the flux of momentum through a boundary with the shape functions of the mesh, at one time point.
    #[inline(always)]
    fn test_loads(self, TimePointIndex { number, .. }: TimePointIndex, scratch: &mut FacetScratch) {
        let lattice = Lattice::whole(&self.tables.mesh, D - 1, D);
        let FacetScratch { momentum, loads, scratch: room, .. } = scratch;
        let out = &mut loads[number * lattice.len()..];
        integrate(self.simd, lattice, AtPoints::Values(&momentum[..]), out, room, false);
    }

    /// Step 4: tests one side's terms in space, at one time point.
    #[inline(always)]
    fn test(self, TimePointIndex { number, count }: TimePointIndex, side: &mut SideScratch, room: &mut Scratch) {
        let (points, lattice) = (self.tables.facet_points(), Lattice::whole(&self.tables.flow, D - 1, M));
        let SideScratch { terms_at, tested, tested_gradient, .. } = side;
        let (len, viscous) = (lattice.len(), self.law.is_viscous());
        let (values, derivatives) = terms_at[number * len..].split_at_mut(count * len);
        let along = AtPoints::new(&tested[..], &tested_gradient[..], viscous);
        integrate(self.simd, lattice, along, values, room, false);
        if viscous {
            let leaving = AtPoints::Values(&tested_gradient[(D - 1) * M * points..]);
            integrate(self.simd, lattice, leaving, derivatives, room, false);
        }
    }
}

/// The terms that are tested with gradients, `[j * M + m][point]`, and what happens to them.
pub(crate) enum Put<'a> {
    /// They are replaced.
    Set(&'a mut [Pack]),
    /// They are added to.
    Add(&'a mut [Pack]),
}

/// f -= ( {F_v} - sigma {F_v([u] n)} ) . n: the terms of (sip) that are tested with values. The pairs hold both sides.
#[inline(always)]
pub(crate) fn subtract_penalised<const D: usize, const M: usize, T: Over<G>, G: Real>(
    f: &mut [T; M],
    flux: [&[[T; M]; D]; 2],
    jump_flux: [&[[T; M]; D]; 2],
    n: &[G; D],
    sigma: G,
) {
    for m in 0..M {
        for k in 0..D {
            let mean = (flux[0][k][m] + flux[1][k][m]) * 0.5;
            let mean_jump = (jump_flux[0][k][m] + jump_flux[1][k][m]) * 0.5;
            f[m] -= (mean - mean_jump.scale(sigma)).scale(n[k]);
        }
    }
}

/// (a - b) n, indexed `[direction][component]`.
#[inline(always)]
pub(crate) fn times_normal<const D: usize, const M: usize, T: Over<G>, G: Real>(
    a: &[T; M],
    b: &[T; M],
    n: &[G; D],
) -> [[T; M]; D] {
    let mut product = [*a; D];
    for k in 0..D {
        for m in 0..M {
            product[k][m] = (a[m] - b[m]).scale(n[k]);
        }
    }
    product
}
