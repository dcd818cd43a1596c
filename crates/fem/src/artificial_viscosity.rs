//! The terms of an artificial viscosity, which joins the viscous flux.
//!
//! ```text
//! F_v(u, grad u) + F_a(u, grad u; beta),   beta = beta(u, grad u, dxi/dx) at the same point                        (artificial)
//! ```
//!
//! in (volume) and (sip). On facets either side has its own beta, with which F_a of the gradient and of the jump are taken. It depends on
//! the values at the point only, so derivatives by dual numbers are exact. The terms have their own loops: laws without artificial
//! viscosity run the loops of the other terms only.

use crate::conservation_law::ConservationLaw;
use crate::facet::{Put, subtract_penalised, times_normal};
use crate::point::{Kernel, KernelTypes, Metric, PointIndex, along_reference};
use crate::scratch::{CellScratch, FacetScratch, SideScratch};
use crate::tables::Planes;
use tensor::{LaneNumber, Lanes, Over, Pack, Real};

/// One side of a facet at a point, for (artificial).
struct Side<T, G, const D: usize, const M: usize> {
    metric: Metric<G, D>,
    /// F_a of the gradient and of the jump.
    flux: [[T; M]; D],
    jump_flux: [[T; M]; D],
}

/// Distances between nodes along the axes of a cell, per length: (N_s - 1) / 2 dxi/dx, `[axis][direction]`, with the cofactors `cof` and
/// the determinant `det` of dx/dxi, and N_s = `order`.
#[inline(always)]
pub fn node_grid<G: Real, const D: usize>(cof: &[[G; D]; D], det: G, order: usize) -> [[G; D]; D] {
    let factor = det.recip() * (0.5 * (order - 1) as f64);
    let mut grid = *cof;
    for j in 0..D {
        for k in 0..D {
            grid[j][k] = cof[k][j] * factor;
        }
    }
    grid
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// [`node_grid`] of a cell.
    #[inline(always)]
    pub(crate) fn grid(self, metric: &Metric<T::Geometry, D>) -> [[T::Geometry; D]; D] {
        node_grid(&metric.cof, metric.det, self.tables.orders.flow)
    }

    /// Adds -F_a to the fluxes that are tested at the points of some planes.
    #[inline(always)]
    pub(crate) fn add_artificial_fluxes(
        self,
        known: Option<&[Pack]>,
        planes: &Planes,
        flux_weight: f64,
        scratch: &mut CellScratch,
    ) {
        let (points, law) = (planes.weights.len(), self.law);
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let metric = self.cell_metric(known.unwrap_or(&scratch.geometry.at_points), at);
                let u = self.state(&scratch.u, at);
                let gradient = self.physical_gradient(&scratch.gradient, at, &metric);
                let viscosity = law.artificial_viscosity(&u, &gradient, &self.grid(&metric));
                let f = law.artificial_flux(&u, &gradient, viscosity);
                // Plus: minus from integration by parts, minus of F_a.
                let weight = planes.weights[p] * flux_weight;
                for j in 0..D {
                    for m in 0..M {
                        let term = (along_reference(&f, &metric.cof, j, m) * weight).result();
                        self.add_to(term, &mut scratch.flux[at.index(j * M + m)], part);
                    }
                }
            }
        }
    }

    /// Adds (sip) of F_a between two cells.
    #[inline(always)]
    pub(crate) fn add_artificial_between(self, known: Option<&[Pack]>, weight: f64, scratch: &mut FacetScratch) {
        let points = self.tables.facet_points();
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let geometry = known.unwrap_or(&scratch.geometry);
                let here = self.facet_point(geometry, at, weight);
                let [side_minus, side_plus] = &scratch.sides;
                let (u_minus, u_plus) = (self.state(&side_minus.u, at), self.state(&side_plus.u, at));
                let jump = times_normal(&u_minus, &u_plus, &here.n);
                let minus = self.artificial_side(self.map_of_side(geometry, 0, at), side_minus, &u_minus, &jump, at);
                let plus = self.artificial_side(self.map_of_side(geometry, 1, at), side_plus, &u_plus, &jump, at);
                let sigma = self.interior_penalty(here.area, [&minus.metric, &plus.metric]);
                let mut f = [u_minus[0].zero(); M];
                let (flux, jump_flux) = ([&minus.flux, &plus.flux], [&minus.jump_flux, &plus.jump_flux]);
                subtract_penalised(&mut f, flux, jump_flux, &here.n, sigma);
                let [side_minus, side_plus] = &mut scratch.sides;
                for m in 0..M {
                    let term = (f[m].scale(here.area) * here.weight).result();
                    self.add_to(term, &mut side_minus.tested[at.index(m)], part);
                    self.add_to(-term, &mut side_plus.tested[at.index(m)], part);
                }
                let scale = here.area * (-0.5 * here.weight);
                for (side, scratch) in [(&minus, side_minus), (&plus, side_plus)] {
                    let tested = Put::Add(&mut scratch.tested_gradient);
                    self.symmetric_term(&side.jump_flux, &side.metric, scale, at, tested);
                }
            }
        }
    }

    /// F_a on one side of a facet.
    #[inline(always)]
    fn artificial_side(
        self,
        metric: Metric<T::Geometry, D>,
        side: &SideScratch,
        u: &[T::State; M],
        jump: &[[T::State; M]; D],
        at: PointIndex,
    ) -> Side<T::State, T::Geometry, D, M> {
        let gradient = self.physical_gradient(&side.gradient, at, &metric);
        let viscosity = self.law.artificial_viscosity(u, &gradient, &self.grid(&metric));
        let flux = self.law.artificial_flux(u, &gradient, viscosity);
        Side { flux, jump_flux: self.law.artificial_flux(u, jump, viscosity), metric }
    }
}
