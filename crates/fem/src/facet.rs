//! The facet terms of a batch of facets.
//!
//! ```text
//! R_a += int_I int_f phi_a w ( Fhat_c - Fhat_v ) ds - int_I int_f phi_a grad_x w : F_v(u, (uhat - u) n)             (facet)
//!
//! interior   Fhat_v = { F_v(u, grad u) } . n - sigma { F_v(u, [u] n) } . n,   uhat = {u},   [u] = u- - u+           (sip)
//! boundary   Fhat_v = F_v(u_b, grad u-) . n - sigma F_v(u_b, (u- - u_b) n) . n,             uhat = u_b
//! ```
//!
//! the symmetric interior penalty method with sigma = N_s^2 |S| / J: the inverse trace inequality on the cell's height
//! 2 J / |S| over the facet, the larger of both sides. n points from minus to plus; plus takes the flux with opposite sign.

use crate::boundary::{boundary_data, boundary_points, through_len};
use crate::cell::{flag, load_state, metric, physical_gradient};
use crate::conservation_law::ConservationLaw;
use crate::kernels::Times;
use crate::mode::Mode;
use crate::tables::{Instant, Tables};
use crate::tensor_product::{Parts, Scratch, evaluate, integrate};
use basis::{Matrix, contract, contract_add};
use std::marker::PhantomData;
use tensor::pulp::{Simd, WithSimd};
use tensor::{LaneNumber, Lanes, Over, Pack, Real, norm, zeroed};

/// Packs of one side of a batch of facets, in the lattice of the minus face.
///
/// Traces have two kinds: 0 the values, 1 the derivative along the reference axis that leaves the facet. Gradients are
/// ordered tangential directions first, the leaving axis last.
pub struct SideScratch {
    /// State traces, `[kind][b][a][m][i]`.
    pub state: [Vec<Pack>; 2],
    /// Mesh traces, `[kind][b][slot][d][i]`.
    pub mesh: [Vec<Pack>; 2],
    /// Terms to test with, `[kind][a][m][i]`.
    pub terms: [Vec<Pack>; 2],
    state_now: [Vec<Pack>; 2],
    pub(crate) position_now: [Vec<Pack>; 2],
    terms_now: [Vec<Pack>; 2],
    pub(crate) u: Vec<Pack>,
    pub(crate) gradient: Vec<Pack>,
    jacobian: Vec<Pack>,
    pub(crate) tested: Vec<Pack>,
    pub(crate) tested_gradient: Vec<Pack>,
}

/// Packs of a batch of facets, kept by a thread from one batch to the next.
pub struct FacetScratch {
    /// Minus and plus side; the plus side is unused on boundaries.
    pub sides: [SideScratch; 2],
    /// +1 or -1 per lane: the sign that turns the minus face's tangential cross product into the outward normal.
    pub normal_sign: Pack,
    /// Positions at points, `[b][d][p]`.
    pub x: Vec<Pack>,
    /// Prescribed states at points, `[b][m][p]`.
    pub data: Vec<Pack>,
    /// What leaves through a boundary facet at one time, see [`crate::boundary::FacetFlux`].
    pub through: Vec<Pack>,
    /// One where a trace of the lane was inadmissible.
    pub violated: Pack,
    velocity_now: Vec<Pack>,
    v: Vec<Pack>,
    pub(crate) scratch: Scratch,
}

impl SideScratch {
    fn new<const D: usize, const M: usize>(tables: &Tables<D>) -> Self {
        let (n_t, points) = (tables.orders.time, tables.facet_points());
        let nodes = tables.orders.flow.pow(D as u32 - 1);
        let mesh_nodes = tables.orders.mesh.pow(D as u32 - 1);
        let pair = |len: usize| [zeroed(len), zeroed(len)];
        SideScratch {
            state: pair(2 * n_t * M * nodes),
            mesh: pair(2 * (n_t + 1) * D * mesh_nodes),
            terms: pair(n_t * M * nodes),
            state_now: pair(2 * M * nodes),
            position_now: pair(2 * D * mesh_nodes),
            terms_now: pair(M * nodes),
            u: zeroed(2 * M * points),
            gradient: zeroed(D * 2 * M * points),
            jacobian: zeroed(D * 2 * D * points),
            tested: zeroed(M * points),
            tested_gradient: zeroed(D * M * points),
        }
    }
}

impl FacetScratch {
    /// Room for any mode.
    pub fn new<const D: usize, const M: usize>(tables: &Tables<D>) -> Self {
        let points = tables.facet_points();
        let widest = tables.rule.points.len().max(tables.orders.flow).max(tables.orders.mesh);
        FacetScratch {
            sides: [SideScratch::new::<D, M>(tables), SideScratch::new::<D, M>(tables)],
            normal_sign: Pack::ZERO,
            x: zeroed(2 * D * points),
            data: zeroed(2 * M * points),
            through: zeroed(2 * through_len(M)),
            violated: Pack::ZERO,
            velocity_now: zeroed(2 * D * tables.orders.mesh.pow(D as u32 - 1)),
            v: zeroed(2 * D * points),
            scratch: Scratch::new(D - 1, 2 * M.max(D), widest),
        }
    }
}

/// Fills the prescribed state at points from positions at points: `(time, x [b][d][p], data [b][m][p])`.
pub type DataAt<'a> = &'a (dyn Fn(f64, &[Pack], &mut [Pack]) + Sync);

/// What a batch of facets separates.
pub enum Across<'a> {
    /// Two cells.
    Cells,
    /// A cell from the outside: the number of the boundary, and its prescribed states where its condition takes any.
    Boundary(usize, Option<DataAt<'a>>),
}

/// What the facet kernels of a slab share.
pub struct FacetContext<'a, const D: usize> {
    /// One-dimensional tables.
    pub tables: &'a Tables<D>,
    /// Length of the slab.
    pub dt: f64,
    /// Time at the bottom of the slab.
    pub start: f64,
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
    /// What lies on the plus side.
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
        for side in &mut scratch.sides[..used] {
            side.terms[0].fill(Pack::ZERO);
            side.terms[1].fill(Pack::ZERO);
        }
        scratch.violated = Pack::ZERO;
        for (instant, row) in times.instants.iter().zip(times.position_rows) {
            let weight = times.weight * instant.weight;
            for side in &mut scratch.sides[..used] {
                to_points::<D, M, K, S>(simd, tables, instant, row, viscous, side, &mut scratch.scratch); // 1.
            }
            mesh_velocity::<D, M, K, S>(simd, tables, instant, scratch); // 2.
            match across {
                Across::Cells => interior_points::<D, M, L, K, S>(simd, law, tables, weight, scratch), // 3.
                Across::Boundary(number, data) => {
                    boundary_data::<D, M, K, S>(simd, context, instant, *data, scratch);
                    boundary_points::<D, M, L, K, S>(simd, law, conditions[*number], tables, weight, scratch);
                }
            }
            for side in &mut scratch.sides[..used] {
                test::<D, M, S>(simd, tables, instant, viscous, side, &mut scratch.scratch); // 4.
            }
        }
    }
}

/// Step 1: state, gradients and Jacobian matrix of one side at the points.
#[inline(always)]
pub(crate) fn to_points<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    instant: &Instant,
    position_row: &Matrix,
    viscous: bool,
    side: &mut SideScratch,
    room: &mut Scratch,
) {
    let (b, g, points) = (K::STATE_BLOCKS, K::GEOMETRY_BLOCKS, tables.facet_points());
    let nodes = tables.orders.flow.pow(D as u32 - 1);
    let mesh_nodes = tables.orders.mesh.pow(D as u32 - 1);
    for kind in 0..(if viscous { 2 } else { 1 }) {
        contract(simd, &instant.values, b, M * nodes, &side.state[kind], &mut side.state_now[kind]);
        contract(simd, position_row, g, D * mesh_nodes, &side.mesh[kind], &mut side.position_now[kind]);
    }
    let SideScratch { state_now, position_now, u, gradient, jacobian, .. } = side;
    evaluate(simd, &tables.mesh, D - 1, g * D, Parts::Gradients, &position_now[0], &mut [], jacobian, room);
    if viscous {
        evaluate(simd, &tables.flow, D - 1, b * M, Parts::Both, &state_now[0], u, gradient, room);
        let leaving = &mut gradient[(D - 1) * b * M * points..];
        evaluate(simd, &tables.flow, D - 1, b * M, Parts::Values, &state_now[1], leaving, &mut [], room);
        let leaving = &mut jacobian[(D - 1) * g * D * points..];
        evaluate(simd, &tables.mesh, D - 1, g * D, Parts::Values, &position_now[1], leaving, &mut [], room);
    } else {
        evaluate(simd, &tables.flow, D - 1, b * M, Parts::Values, &state_now[0], u, &mut [], room);
    }
}

/// Step 2: the mesh velocity at the points, the same from both sides.
#[inline(always)]
pub(crate) fn mesh_velocity<const D: usize, const M: usize, K: Mode, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    instant: &Instant,
    scratch: &mut FacetScratch,
) {
    let g = K::GEOMETRY_BLOCKS;
    let mesh_nodes = tables.orders.mesh.pow(D as u32 - 1);
    let FacetScratch { sides, velocity_now, v, scratch: room, .. } = scratch;
    contract(simd, &instant.velocities, g, D * mesh_nodes, &sides[0].mesh[0], velocity_now);
    evaluate(simd, &tables.mesh, D - 1, g * D, Parts::Values, velocity_now, v, &mut [], room);
}

/// The geometry of a facet point, seen from one side.
pub(crate) struct FacetPoint<G, const D: usize> {
    /// Cofactors of the side's Jacobian matrix, columns ordered tangential first.
    pub(crate) cof: [[G; D]; D],
    /// Its determinant, of either sign: the facet's frame need not be right-handed.
    pub(crate) det: G,
    /// Area per reference area, |S|.
    pub(crate) area: G,
    /// Unit normal, from minus to plus.
    pub(crate) n: [G; D],
    /// Mesh velocity.
    pub(crate) v: [G; D],
}

#[inline(always)]
pub(crate) fn facet_point<const D: usize, K: Mode, S: Simd>(
    simd: S,
    scratch: &FacetScratch,
    points: usize,
    p: usize,
    part: usize,
) -> FacetPoint<K::Geometry<S>, D> {
    let (cof, det) = metric::<D, K::Geometry<S>, S>(simd, &scratch.sides[0].jacobian, points, p, part);
    let sign = Lanes::read(simd, &scratch.normal_sign, part);
    let mut v = [det; D];
    let mut normal = [det; D];
    for d in 0..D {
        v[d] = K::Geometry::<S>::load(simd, &scratch.v, D * points, d * points + p, part);
        normal[d] = cof[d][D - 1].times(sign);
    }
    let area = norm(&normal);
    let inverse = area.recip();
    let mut n = normal;
    for d in 0..D {
        n[d] = normal[d] * inverse;
    }
    FacetPoint { cof, det, area, n, v }
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
    let viscous = law.is_viscous();
    let penalty = (tables.orders.flow * tables.orders.flow) as f64;
    for p in 0..points {
        for part in 0..Lanes::<S>::PARTS {
            let weight = weight * tables.facet_weights[p];
            let here = facet_point::<D, K, S>(simd, scratch, points, p, part);
            let minus = load_state::<M, K::State<S>, S>(simd, &scratch.sides[0].u, points, p, part);
            let plus = load_state::<M, K::State<S>, S>(simd, &scratch.sides[1].u, points, p, part);
            let mut f = law.numerical_flux::<K::State<S>, K::Geometry<S>>(
                &minus,
                &plus,
                &here.n,
                tensor::dot(&here.n, &here.v),
            );
            if viscous {
                let (cof_plus, det_plus) =
                    metric::<D, K::Geometry<S>, S>(simd, &scratch.sides[1].jacobian, points, p, part);
                let gradient_minus = physical_gradient::<D, M, K, S>(
                    simd,
                    &scratch.sides[0].gradient,
                    points,
                    p,
                    part,
                    &here.cof,
                    here.det,
                );
                let gradient_plus = physical_gradient::<D, M, K, S>(
                    simd,
                    &scratch.sides[1].gradient,
                    points,
                    p,
                    part,
                    &cof_plus,
                    det_plus,
                );
                let jump = times_normal::<D, M, K::State<S>, K::Geometry<S>>(&minus, &plus, &here.n);
                let jump_flux_minus = law.viscous_flux(&minus, &jump);
                let jump_flux_plus = law.viscous_flux(&plus, &jump);
                let flux_minus = law.viscous_flux(&minus, &gradient_minus);
                let flux_plus = law.viscous_flux(&plus, &gradient_plus);
                let sigma = here.area * here.det.abs().recip().max(det_plus.abs().recip()) * penalty;
                for m in 0..M {
                    for k in 0..D {
                        let mean = (flux_minus[k][m] + flux_plus[k][m]) * 0.5;
                        let mean_jump = (jump_flux_minus[k][m] + jump_flux_plus[k][m]) * 0.5;
                        f[m] -= (mean - mean_jump.scale(sigma)).scale(here.n[k]);
                    }
                }
                // uhat - u- = -[u]/2 along n, and uhat - u+ = +[u]/2 along -n: the same on both sides.
                let half = -0.5 * weight;
                let [side_minus, side_plus] = &mut scratch.sides;
                symmetric_term::<D, M, K, S>(
                    &jump_flux_minus,
                    &here.cof,
                    here.det,
                    here.area,
                    half,
                    points,
                    p,
                    part,
                    &mut side_minus.tested_gradient,
                );
                symmetric_term::<D, M, K, S>(
                    &jump_flux_plus,
                    &cof_plus,
                    det_plus,
                    here.area,
                    half,
                    points,
                    p,
                    part,
                    &mut side_plus.tested_gradient,
                );
            }
            for m in 0..M {
                let term = (f[m].scale(here.area) * weight).result();
                term.write(&mut scratch.sides[0].tested[m * points + p], part);
                // The flux that leaves minus enters plus.
                (-term).write(&mut scratch.sides[1].tested[m * points + p], part);
            }
            flag::<K::State<S>, S>(simd, law.margin(&minus).min(law.margin(&plus)), one, &mut scratch.violated, part);
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

/// factor grad_x w : f |S| as tests against reference derivatives: sum_k cof_kj / det f_k for direction j.
#[inline(always)]
pub(crate) fn symmetric_term<const D: usize, const M: usize, K: Mode, S: Simd>(
    f: &[[K::State<S>; M]; D],
    cof: &[[K::Geometry<S>; D]; D],
    det: K::Geometry<S>,
    area: K::Geometry<S>,
    factor: f64,
    points: usize,
    p: usize,
    part: usize,
    tested_gradient: &mut [Pack],
) {
    let scale = area * det.recip() * factor;
    for j in 0..D {
        for m in 0..M {
            let mut sum = f[0][m].scale(cof[0][j]);
            for k in 1..D {
                sum = f[k][m].scale_add(cof[k][j], sum);
            }
            sum.scale(scale).result().write(&mut tested_gradient[(j * M + m) * points + p], part);
        }
    }
}

/// Step 4: tests one side's terms in space and sends them to the time nodes.
#[inline(always)]
fn test<const D: usize, const M: usize, S: Simd>(
    simd: S,
    tables: &Tables<D>,
    instant: &Instant,
    viscous: bool,
    side: &mut SideScratch,
    room: &mut Scratch,
) {
    let points = tables.facet_points();
    let nodes = tables.orders.flow.pow(D as u32 - 1);
    let SideScratch { terms, terms_now, tested, tested_gradient, .. } = side;
    let parts = if viscous { Parts::Both } else { Parts::Values };
    terms_now[0].fill(Pack::ZERO);
    integrate(simd, &tables.flow, D - 1, M, parts, tested, tested_gradient, &mut terms_now[0], room);
    contract_add(simd, &instant.test, 1, M * nodes, &terms_now[0], &mut terms[0]);
    if viscous {
        let leaving = &tested_gradient[(D - 1) * M * points..];
        terms_now[1].fill(Pack::ZERO);
        integrate(simd, &tables.flow, D - 1, M, Parts::Values, leaving, &[], &mut terms_now[1], room);
        contract_add(simd, &instant.test, 1, M * nodes, &terms_now[1], &mut terms[1]);
    }
}
