//! The facet terms of a batch of facets.
//!
//! ```text
//! R_a += int_I int_f phi_a w ( Fhat_c - Fhat_v ) ds - int_I int_f phi_a grad_x w : F_v(u, (uhat - u) n)             (facet)
//!
//! interior   Fhat_v = { F_v(u, grad u) } . n - sigma { F_v(u, [u] n) } . n,   uhat = {u},   [u] = u- - u+           (sip)
//! boundary   Fhat_v = F_v(u_b, grad u-) . n - sigma F_v(u_b, (u- - u_b) n) . n,             uhat = u_b
//! ```
//!
//! This is the symmetric interior penalty method with sigma = N_s^2 |S| / J. The penalty follows from the inverse trace
//! inequality on the cell's height over the facet, 2 J / |S|. The larger penalty of both sides is taken. n points from
//! minus to plus; plus takes the flux with opposite sign.

use crate::boundary::{boundary_data, boundary_points};
use crate::conservation_law::ConservationLaw;
use crate::facet_evaluation::{FacetPoint, facet_point, geometry_to_points, state_to_points, to_instants};
use crate::instants::{Clock, TimePointIndex};
use crate::kernels::Times;
use crate::mode::Mode;
use crate::point::{PointIndex, along_reference, flag, load, metric, physical_gradient};
use crate::scratch::{FacetScratch, SideScratch};
use crate::slope;
use crate::tables::Tables;
use crate::tensor_product::{EvaluationFlags, Lattice, Scratch, integrate};
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
pub struct FacetContext<'a, const D: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// Length of the slab.
    pub dt: f64,
    /// The times at which data are evaluated.
    pub clock: Clock,
}

/// The facet terms at a list of times: reads traces, overwrites `terms`.
///
/// In a slab the times are its Gauss points, with weights; for the operator of space alone there is one time, weight one.
pub struct Facets<'a, 'c, const D: usize, const M: usize, L: ConservationLaw<D, M>, K> {
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

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode> WithSimd for Facets<'_, '_, D, M, L, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Facets { law, conditions, context, times, across, scratch, .. } = self;
        let tables = context.tables;
        let viscous = law.is_viscous();
        let used = if matches!(across, Across::Cells) { 2 } else { 1 };
        scratch.violated = Pack::ZERO;
        to_instants::<D, M, K, S>(simd, tables, times.in_time, viscous, used, scratch); // 1.
        for (number, instant) in times.instants.iter().enumerate() {
            let weight = times.weight * instant.weight;
            let of = TimePointIndex { number, count: times.instants.len() };
            for side in &mut scratch.sides[..used] {
                state_to_points::<D, M, K, S>(simd, tables, of, viscous, side, &mut scratch.scratch); // 2.
            }
            geometry_to_points::<D, M, K, S>(simd, tables, of, viscous, used, scratch);
            match across {
                Across::Cells => interior_points::<D, M, L, K, S>(simd, law, tables, weight, scratch), // 3.
                Across::Boundary(number, data) => {
                    boundary_data::<D, M, K, S>(simd, context, instant, of, *data, scratch);
                    boundary_points::<D, M, L, K, S>(simd, law, conditions[*number], tables, weight, scratch);
                    if scratch.with_loads {
                        test_loads::<D, S>(simd, tables, of, scratch); // 4.
                    }
                }
            }
            for side in &mut scratch.sides[..used] {
                test::<D, M, S>(simd, tables, of, viscous, side, &mut scratch.scratch); // 4.
            }
        }
        let kinds = if viscous { 2 } else { 1 };
        let len = M * tables.orders.flow.pow(D as u32 - 1);
        for SideScratch { terms, terms_at, .. } in &mut scratch.sides[..used] {
            scratch.scratch.contract(simd, times.test, kinds, len, terms_at, terms, false); // 5.
        }
    }
}

/// Step 3 between two cells.
#[inline(always)]
fn interior_points<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
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
            let plus = load::<M, K::State<S>, S>(simd, &scratch.sides[1].u, at);
            let normal_speed = tensor::dot(&here.n, &here.v);
            let mut f = law.numerical_flux::<K::State<S>, K::Geometry<S>>(&minus, &plus, &here.n, normal_speed);
            if law.is_viscous() {
                let sides = &mut scratch.sides;
                interior_viscous::<D, M, L, K, S>(simd, law, tables, [&minus, &plus], &here, weight, at, sides, &mut f);
            }
            for m in 0..M {
                let term = (f[m].scale(here.area) * weight).result();
                term.write(&mut scratch.sides[0].tested[at.index(m)], part);
                // The flux that leaves minus enters plus.
                (-term).write(&mut scratch.sides[1].tested[at.index(m)], part);
            }
            flag::<K::State<S>, S>(
                simd,
                law.admissibility(&minus).min(law.admissibility(&plus)),
                one,
                &mut scratch.violated,
                part,
            );
        }
    }
}

/// The viscous part of step 3 between two cells, (sip): subtracts Fhat_v from `f`, and sets the terms that are tested with
/// gradients.
#[inline(always)]
fn interior_viscous<const D: usize, const M: usize, L: ConservationLaw<D, M>, K: Mode, S: Simd>(
    simd: S,
    law: &L,
    tables: &Tables<D>,
    [minus, plus]: [&[K::State<S>; M]; 2],
    here: &FacetPoint<K::Geometry<S>, D>,
    weight: f64,
    at: PointIndex,
    [side_minus, side_plus]: &mut [SideScratch; 2],
    f: &mut [K::State<S>; M],
) {
    let (cof_plus, det_plus) = metric::<D, K::Geometry<S>, S>(simd, &side_plus.jacobian, at);
    let gradient_minus = physical_gradient::<D, M, K, S>(simd, &side_minus.gradient, at, &here.cof, here.det);
    let gradient_plus = physical_gradient::<D, M, K, S>(simd, &side_plus.gradient, at, &cof_plus, det_plus);
    let (flux_minus, flux_plus) = (law.viscous_flux(minus, &gradient_minus), law.viscous_flux(plus, &gradient_plus));
    let jump = times_normal::<D, M, K::State<S>, K::Geometry<S>>(minus, plus, &here.n);
    let (mut jump_flux_minus, mut jump_flux_plus) = (law.viscous_flux(minus, &jump), law.viscous_flux(plus, &jump));
    let sigma = here.area * here.det.recip().abs().max(det_plus.recip().abs()) * penalty(tables);
    for m in 0..M {
        for k in 0..D {
            let mean = (flux_minus[k][m] + flux_plus[k][m]) * 0.5;
            let mean_jump = (jump_flux_minus[k][m] + jump_flux_plus[k][m]) * 0.5;
            f[m] -= (mean - mean_jump.scale(sigma)).scale(here.n[k]);
        }
    }
    if slope::is_penalised(tables) {
        let gradients = [&gradient_minus, &gradient_plus];
        let flux = slope::flux::<D, M, L, K, S>(law, tables, [minus, plus], gradients, &here.n, sigma);
        slope::join(&flux, &here.n, &mut jump_flux_minus, &mut jump_flux_plus);
    }
    // uhat - u- = -[u]/2 along n, and uhat - u+ = +[u]/2 along -n: the same on both sides.
    let scale = here.area * (-0.5 * weight);
    let (scale_minus, scale_plus) = (scale * here.det.recip(), scale * det_plus.recip());
    symmetric_term::<D, M, K, S>(&jump_flux_minus, &here.cof, scale_minus, at, &mut side_minus.tested_gradient);
    symmetric_term::<D, M, K, S>(&jump_flux_plus, &cof_plus, scale_plus, at, &mut side_plus.tested_gradient);
}

/// N_s^2 of sigma.
#[inline(always)]
pub(crate) fn penalty<const D: usize>(tables: &Tables<D>) -> f64 {
    (tables.orders.flow * tables.orders.flow) as f64
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

/// grad_x w : f as tests against reference derivatives, times det `scale`: sum_k cof_kj f_k for direction j.
#[inline(always)]
pub(crate) fn symmetric_term<const D: usize, const M: usize, K: Mode, S: Simd>(
    f: &[[K::State<S>; M]; D],
    cof: &[[K::Geometry<S>; D]; D],
    scale: K::Geometry<S>,
    at: PointIndex,
    tested_gradient: &mut [Pack],
) {
    for j in 0..D {
        for m in 0..M {
            let sum = along_reference::<D, M, K::State<S>, K::Geometry<S>>(f, cof, j, m);
            sum.scale(scale).result().write(&mut tested_gradient[at.index(j * M + m)], at.part);
        }
    }
}

/// Step 4 for (load): tests the flux of momentum through a boundary with the shape functions of the mesh, at one instant.
#[inline(always)]
fn test_loads<const D: usize, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    TimePointIndex { number, .. }: TimePointIndex,
    scratch: &mut FacetScratch,
) {
    let lattice = Lattice::whole(&tables.mesh, D - 1);
    let FacetScratch { sides, loads, scratch: room, .. } = scratch;
    // Components 1 to D are momentum.
    let momentum = &sides[0].tested[tables.facet_points()..];
    let out = &mut loads[number * D * lattice.nodes()..];
    integrate(simd, lattice, D, EvaluationFlags::Values, momentum, &[], out, room, false);
}

/// Step 4: tests one side's terms in space, at one instant.
#[inline(always)]
fn test<const D: usize, const M: usize, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    TimePointIndex { number, count }: TimePointIndex,
    viscous: bool,
    side: &mut SideScratch,
    room: &mut Scratch,
) {
    let (points, lattice) = (tables.facet_points(), Lattice::whole(&tables.flow, D - 1));
    let len = M * tables.orders.flow.pow(D as u32 - 1);
    let SideScratch { terms_at, tested, tested_gradient, .. } = side;
    let (values, derivatives) = terms_at[number * len..].split_at_mut(count * len);
    let parts = if viscous { EvaluationFlags::Both } else { EvaluationFlags::Values };
    integrate(simd, lattice, M, parts, tested, tested_gradient, values, room, false);
    if viscous {
        let leaving = &tested_gradient[(D - 1) * M * points..];
        integrate(simd, lattice, M, EvaluationFlags::Values, leaving, &[], derivatives, room, false);
    }
}
