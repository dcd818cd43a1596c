//! A viscosity in cells in which the volume terms would destroy entropy.
//!
//! Quadrature with errors may reduce the entropy of a flow that the mesh does not resolve. Where it does, the cell has a viscosity, just
//! large enough that no entropy is lost.
//!
//! ```text
//! R_i += eps sum_j int_K Delta_j psi . H Delta_j v_h J,   eps = m / D,   m = q^2 / (q + x_0),   q = max(x_0 - x_r - delta, 0)  (entropy viscosity)
//! D = sum_j int_K Delta_j v_h . H Delta_j v_h J,   H = du / dv,   Delta_j = 2 / (N_s - 1) d / dxi_j             (dissipation)
//! delta = int_dK Psi . n + sum_i sum_nodes omega ( g_i (u . d_i v_h - d_i phi_h) - d_i v_h . F_c . A_i )       (production)
//! ```
//!
//! S(u) is a convex entropy of the law, for a gas minus the physical one, and v = S'(u) are its entropy variables. v_h interpolates them at
//! the nodes. H is positive, Psi = v . F_c - F_S with the flux F_S of S, and phi = v . u - S. A_i and g_i are the area vectors and the grid
//! flux of [`crate::collocation`]. A test of the equations with v_h shows: Up to a flux through the facets the volume terms change the integral of
//! S at the rate -delta, and the viscosity at the rate -eps D.
//!
//! The points are the nodes, where sums along lines can be integrated by parts. In the exact form of delta, int_K phi d_t J takes the place
//! of the terms with g_i, since d_t J is the divergence of g.
//!
//! Delta_j is the change from node to node along axis j, so that the viscosity acts at the rate eps along all axes. In a thin cell one
//! viscosity for all directions, large enough for the long side, would act across the cell at a rate larger by the square of the ratio of sides.
//!
//! m is a smooth maximum of -delta - x_r and 0, never below it. With a speed of signals c and the distance of nodes h,
//!
//! * x_0 is the dissipation at a rate eps of c / h / 10^6;
//! * x_r, 1e-12 times the integral of phi c / h, is above the round-off of delta. Round-off must not become a viscosity where the flow is nearly
//!   uniform.
//!
//! D has an additional term of the size of round-off, for uniform flow.
//!
//! eps belongs to the cell, and there is no term on facets. A constant psi has no gradient, so conservation is not affected.
//!
//! After J. Chan, arXiv:2501.16529 (2025); here with H in place of viscous matrices, for moving meshes, and with a smooth maximum.

use crate::conservation_law::ConservationLaw;
use crate::point::{Kernel, KernelTypes, Metric, PointIndex, along_reference};
use crate::scratch::CellScratch;
use crate::tables::Planes;
use crate::tensor_product::{AtPoints, Lattice, evaluate};
use tensor::{LaneNumber, Lanes, Over, Pack, Real, smooth_ramp};

/// x_0 over the dissipation at a rate of one signal speed over the distance of nodes.
const SMOOTHING: f64 = 1e-6;

/// x_r over the integral of phi times the signal speed over the distance of nodes.
const PRODUCTION_ROUND_OFF: f64 = 1e-12;

/// The square of a difference of the entropy variables between nodes that is round-off.
const ROUND_OFF: f64 = 1e-14;

/// Packs of (entropy viscosity) in one batch of cells; `b` counts blocks, `i` nodes, which are the points.
#[derive(Default)]
pub(crate) struct EntropyScratch {
    /// v_h, `[b][m][i]`.
    variables: Vec<Pack>,
    /// Its derivatives along reference directions, and later H Delta_j v_h, `[b][j][m][i]`.
    gradient: Vec<Pack>,
    /// phi, `[b][i]`.
    phi: Vec<Pack>,
    /// Its derivatives, `[b][j][i]`.
    phi_gradient: Vec<Pack>,
}

impl EntropyScratch {
    /// Packs for `components` in `dimension` directions and `nodes` per cell.
    pub(crate) fn new(dimension: usize, components: usize, nodes: usize) -> Self {
        let room = |count: usize| tensor::zeroed(2 * count * nodes);
        EntropyScratch {
            variables: room(components),
            gradient: room(dimension * components),
            phi: room(1),
            phi_gradient: room(dimension),
        }
    }
}

/// Sums over the points of a cell.
struct Sums<T> {
    /// delta of (production).
    delta: T,
    /// D of (dissipation), with its term of round-off.
    dissipation: T,
    /// x_0
    smoothing: T,
    /// x_r
    round_off: T,
}

impl<T: Real> Sums<T> {
    /// eps of (entropy viscosity)
    #[inline(always)]
    fn viscosity(self) -> T {
        smooth_ramp(self.smoothing - self.round_off - self.delta, self.smoothing) / self.dissipation
    }
}

impl<const D: usize, const M: usize, T: KernelTypes<D, M>> Kernel<'_, D, M, T> {
    /// Adds (entropy viscosity) to the fluxes that are tested at the points of all planes.
    #[inline(always)]
    pub(crate) fn add_entropy_viscosity(
        self,
        known: Option<&[Pack]>,
        planes: &Planes,
        flux_weight: f64,
        scratch: &mut CellScratch,
    ) {
        self.entropy_variables(planes, scratch); // 1. v_h, phi_h and their derivatives
        let (points, CellScratch { u, flux, entropy, geometry, .. }) = (planes.weights.len(), scratch);
        let geometry = known.unwrap_or(&geometry.at_points);
        for part in 0..Lanes::<T::Simd>::PARTS {
            let viscosity = self.entropy_sums([u, geometry], planes, part, entropy).viscosity(); // 2. eps, H Delta_j v_h
            for p in 0..points {
                let at = PointIndex { points, p, part };
                let (metric, f) = (self.cell_metric(geometry, at), self.reference_gradient(&entropy.gradient, at));
                let scale = metric.det * (self.node_distance() * planes.weights[p] * flux_weight);
                for j in 0..D {
                    for m in 0..M {
                        let term = (f[j][m] * viscosity).scale(scale);
                        self.add_to(term.result(), &mut flux[at.index(j * M + m)], part); // 3. the fluxes
                    }
                }
            }
        }
    }

    /// The distance of nodes in reference coordinates, 2 / (N_s - 1).
    #[inline(always)]
    fn node_distance(self) -> f64 {
        2.0 / (self.tables.orders.flow - 1) as f64
    }

    /// v_h, phi_h and their derivatives along reference directions.
    #[inline(always)]
    fn entropy_variables(self, planes: &Planes, scratch: &mut CellScratch) {
        let points = planes.weights.len();
        let CellScratch { u, entropy, scratch: room, .. } = scratch;
        for p in 0..points {
            for part in 0..Lanes::<T::Simd>::PARTS {
                let at = PointIndex { points, p, part };
                let u = self.state(u, at);
                let variables = self.law.entropy_variables(&u);
                for m in 0..M {
                    variables[m].store(&mut entropy.variables, M * points, at.index(m), part);
                }
                self.law.entropy_potential(&u).1.store(&mut entropy.phi, points, p, part);
            }
        }
        let lattice = |components| Lattice { line: &self.tables.flow, last: &planes.flow, dimension: D, components };
        for b in 0..T::STATE_BLOCKS {
            let gradient = AtPoints::Gradients(&mut entropy.gradient[b * D * M * points..]);
            evaluate(self.simd, lattice(M), &entropy.variables[b * M * points..][..M * points], gradient, room);
            let gradient = AtPoints::Gradients(&mut entropy.phi_gradient[b * D * points..]);
            evaluate(self.simd, lattice(1), &entropy.phi[b * points..][..points], gradient, room);
        }
    }

    /// The sums over the cells in a part of the lanes. H Delta_j v_h takes the place of the derivatives of v_h.
    #[inline(always)]
    fn entropy_sums(
        self,
        [u, geometry]: [&[Pack]; 2],
        planes: &Planes,
        part: usize,
        entropy: &mut EntropyScratch,
    ) -> Sums<T::State> {
        let points = planes.weights.len();
        let zero = self.state(u, PointIndex { points, p: 0, part })[0].zero();
        let mut sums = Sums { delta: zero, dissipation: zero, smoothing: zero, round_off: zero };
        for p in 0..points {
            let (at, weight) = (PointIndex { points, p, part }, planes.weights[p]);
            let (metric, v) = (self.cell_metric(geometry, at), self.cell_velocity(geometry, at));
            let u = self.state(u, at);
            let (psi, phi) = self.law.entropy_potential(&u);
            sums.delta += self.through_ends(&psi, &metric, planes, p);
            sums.delta -= self.entropy_flux(&u, &metric, &v, at, entropy) * weight;
            let changes = self.reference_gradient(&entropy.gradient, at).map(|v| v.map(|v| v * self.node_distance()));
            let f = self.law.gradient_by_entropy(&u, &changes);
            let mut dissipation = phi * ROUND_OFF;
            for j in 0..D {
                for m in 0..M {
                    dissipation += changes[j][m] * f[j][m];
                    f[j][m].store(&mut entropy.gradient, D * M * points, at.index(j * M + m), part);
                }
            }
            let dissipation = dissipation.scale(metric.det) * weight;
            sums.dissipation += dissipation;
            let rate = self.law.signal_speed(&u).scale(self.inverse_square(&metric).sqrt());
            sums.smoothing += dissipation * rate * SMOOTHING;
            sums.round_off += phi * rate.scale(metric.det) * (weight * PRODUCTION_ROUND_OFF);
        }
        sums
    }

    /// d_i v_h . (F_c . A_i - u g_i) + g_i d_i phi_h at a node, summed over i: the terms of (production) inside of the cell.
    #[inline(always)]
    fn entropy_flux(
        self,
        u: &[T::State; M],
        metric: &Metric<T::Geometry, D>,
        v: &[T::Geometry; D],
        at: PointIndex,
        entropy: &EntropyScratch,
    ) -> T::State {
        let f = self.law.flux(u, &[[u[0].zero(); M]; D], v);
        let (simd, points, part) = (self.simd, at.points, at.part);
        let mut sum = u[0].zero();
        for j in 0..D {
            let phi_slope = T::State::load(simd, &entropy.phi_gradient, D * points, at.index(j), part);
            let mut grid_flux = metric.cof[0][j] * v[0];
            for k in 1..D {
                grid_flux += metric.cof[k][j] * v[k];
            }
            sum = phi_slope.scale_add(grid_flux, sum);
            for m in 0..M {
                let slope = T::State::load(simd, &entropy.gradient, D * M * points, at.index(j * M + m), part);
                sum += along_reference(&f, &metric.cof, j, m) * slope;
            }
        }
        sum
    }

    /// Psi . n with the weights of the faces on which node `p` lies.
    #[inline(always)]
    fn through_ends(self, psi: &[T::State; D], metric: &Metric<T::Geometry, D>, planes: &Planes, p: usize) -> T::State {
        let (n, weights) = (self.tables.orders.flow, &self.tables.rule.weights);
        let mut sum = psi[0].zero();
        for axis in 0..D {
            let on_line = p / n.pow(axis as u32) % n;
            if on_line != 0 && on_line != n - 1 {
                continue;
            }
            let sign = if on_line == 0 { -1.0 } else { 1.0 };
            let weight = sign * planes.weights[p] / weights[on_line];
            for k in 0..D {
                sum += psi[k].scale(metric.cof[k][axis]) * weight;
            }
        }
        sum
    }

    /// One over the square of the distance of nodes, the sum over all axes.
    #[inline(always)]
    fn inverse_square(self, metric: &Metric<T::Geometry, D>) -> T::Geometry {
        let grid = self.grid(metric);
        let mut sum = grid[0][0].zero();
        for row in &grid {
            for entry in row {
                sum += *entry * *entry;
            }
        }
        sum
    }
}
