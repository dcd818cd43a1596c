//! The flux through the boundaries of the domain, by the numerical fluxes and the quadrature of the scheme.

use crate::batches::FacetBatch;
use crate::boundary::FluxTime;
use crate::kernels::Differentiate;
use crate::operator::SlabOperator;
use crate::scratch::{FacetScratch, through_len};
use std::ops::AddAssign;
use tensor::{Pack, cross};

/// The flux through a boundary at one time, or its integral over some time: inviscid and viscous flux relative to the
/// moving boundary, (through).
///
/// Moments are taken about a point near the boundary, because far from the origin of coordinates they would lose digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryFlux<const M: usize> {
    /// The point that moments are taken about; in 2-D its last component is zero.
    pub centre: [f64; 3],
    /// The inviscid flux.
    pub inviscid: FluxPart<M>,
    /// The viscous flux.
    pub viscous: FluxPart<M>,
    /// For a wall, the power of both momentum fluxes on it, (power).
    pub work: f64,
    /// For a wall, the heat that it takes up, (power).
    pub heat: f64,
}

/// One part of the flux through a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxPart<const M: usize> {
    /// Of every component.
    pub components: [f64; M],
    /// Of momentum: a force. In 2-D the last component is zero.
    pub force: [f64; 3],
    /// Of angular momentum about the centre. In 2-D only the last component is not zero.
    pub moment: [f64; 3],
}

/// The fluxes through every boundary at one time of a slab.
#[derive(Clone, Debug, PartialEq)]
pub struct FluxesAt<const M: usize> {
    /// The time.
    pub time: f64,
    /// Its weight in an integral over the slab; zero at the top, which is no quadrature point.
    pub weight: f64,
    /// In the order of the boundaries.
    pub boundaries: Vec<BoundaryFlux<M>>,
}

impl<const M: usize> Default for BoundaryFlux<M> {
    fn default() -> Self {
        let (inviscid, viscous) = (FluxPart::default(), FluxPart::default());
        BoundaryFlux { centre: [0.0; 3], inviscid, viscous, work: 0.0, heat: 0.0 }
    }
}

impl<const M: usize> Default for FluxPart<M> {
    fn default() -> Self {
        FluxPart { components: [0.0; M], force: [0.0; 3], moment: [0.0; 3] }
    }
}

impl<const M: usize> FluxPart<M> {
    /// One lane of the result of the kernel.
    fn of_lane(through: &[Pack], lane: usize) -> Self {
        let at = |i: usize| through[i].0[lane];
        FluxPart {
            components: std::array::from_fn(at),
            force: std::array::from_fn(|i| at(M + i)),
            moment: std::array::from_fn(|i| at(M + 3 + i)),
        }
    }

    /// The moment about the point from which the centre is `arm` away: (x - p) x f = (x - c) x f + (c - p) x f.
    fn moment_at(&self, arm: &[f64; 3]) -> [f64; 3] {
        let of_arm = cross(arm, &self.force);
        std::array::from_fn(|i| self.moment[i] + of_arm[i])
    }

    fn scaled(&self, factor: f64) -> Self {
        FluxPart {
            components: self.components.map(|f| factor * f),
            force: self.force.map(|f| factor * f),
            moment: self.moment.map(|f| factor * f),
        }
    }

    /// Adds `other`, whose centre is `arm` away from this one.
    fn add(&mut self, other: &Self, arm: &[f64; 3]) {
        let add = |sums: &mut [f64], terms: &[f64]| sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        add(&mut self.components, &other.components);
        add(&mut self.force, &other.force);
        add(&mut self.moment, &other.moment_at(arm));
    }
}

impl<const M: usize> BoundaryFlux<M> {
    /// Every component, of both fluxes.
    pub fn total(&self) -> [f64; M] {
        std::array::from_fn(|m| self.inviscid.components[m] + self.viscous.components[m])
    }

    /// The moments of both fluxes about `point`.
    pub fn moment_about(&self, point: &[f64; 3]) -> [f64; 3] {
        let arm = self.arm_from(point);
        let [inviscid, viscous] = [&self.inviscid, &self.viscous].map(|flux| flux.moment_at(&arm));
        std::array::from_fn(|i| inviscid[i] + viscous[i])
    }

    /// From `point` to the centre.
    fn arm_from(&self, point: &[f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| self.centre[i] - point[i])
    }

    /// The fluxes of a facet, from one lane of the result of the kernel. Moments are about the origin of its cell.
    fn of_lane(scratch: &FacetScratch, lane: usize, centre: [f64; 3]) -> Self {
        let [inviscid, viscous] = [0, 1].map(|part| FluxPart::of_lane(&scratch.through[part * through_len(M)..], lane));
        let [work, heat] = [0, 1].map(|i| scratch.through[2 * through_len(M) + i].0[lane]);
        BoundaryFlux { centre, inviscid, viscous, work, heat }
    }

    /// Length of [`Self::numbers`].
    const LEN: usize = 3 + 2 * (M + 6) + 2;

    /// All numbers in a row.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let parts = [self.inviscid, self.viscous];
        let parts = parts.into_iter().flat_map(|part| part.components.into_iter().chain(part.force).chain(part.moment));
        self.centre.into_iter().chain(parts).chain([self.work, self.heat])
    }

    /// From [`Self::numbers`].
    fn from_numbers(numbers: &[f64]) -> Self {
        let part = |start: usize| FluxPart {
            components: std::array::from_fn(|i| numbers[start + i]),
            force: std::array::from_fn(|i| numbers[start + M + i]),
            moment: std::array::from_fn(|i| numbers[start + M + 3 + i]),
        };
        let centre = std::array::from_fn(|i| numbers[i]);
        let [work, heat] = [numbers[Self::LEN - 2], numbers[Self::LEN - 1]];
        BoundaryFlux { centre, inviscid: part(3), viscous: part(9 + M), work, heat }
    }

    /// Adds the flux of a facet. Moments are about the centre of the first one.
    fn add_facet(&mut self, facet: Self) {
        if *self == Self::default() {
            self.centre = facet.centre;
        }
        *self += facet;
    }

    /// The fluxes times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let (inviscid, viscous) = (self.inviscid.scaled(factor), self.viscous.scaled(factor));
        BoundaryFlux { centre: self.centre, inviscid, viscous, work: factor * self.work, heat: factor * self.heat }
    }
}

/// The centre does not change.
impl<const M: usize> AddAssign for BoundaryFlux<M> {
    fn add_assign(&mut self, other: Self) {
        let arm = other.arm_from(&self.centre);
        self.inviscid.add(&other.inviscid, &arm);
        self.viscous.add(&other.viscous, &arm);
        self.work += other.work;
        self.heat += other.heat;
    }
}

/// The amount that leaves the domain during a slab through all boundaries: the integral of `fluxes`.
pub fn left_during_slab<const M: usize>(fluxes: &[FluxesAt<M>]) -> [f64; M] {
    let mut sum = BoundaryFlux::default();
    for at in fluxes {
        at.boundaries.iter().for_each(|flux| sum += flux.scaled(at.weight));
    }
    sum.total()
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// The fluxes through the boundaries at the Gauss points of the slab in time, and last at its top, in the state and on the
    /// mesh last set.
    ///
    /// Test functions sum to one in space and in time. So the integral over the slab equals the amount that the residual
    /// takes from the cells.
    ///
    /// Work is done at the velocity of the mesh, so that at the Gauss points work and heat are the energy that leaves through a wall. That velocity is a
    /// polynomial in time, and at a given time less accurate than the positions. The volume of a body that turns seems to oscillate,
    /// and pressure does work on this. Therefore the power at the top uses `velocity_at_top`, `[C0 node][component]`, if given.
    ///
    /// At the top the penalty is that of (penalty at top): the mean that the equations of the top node see, since phi_N is their test function. At
    /// the top itself u- differs from the data by the error in time, which the penalty multiplies by 1 / h.
    pub fn boundary_fluxes(&self, velocity_at_top: Option<&[f64]>) -> Vec<FluxesAt<M>> {
        let (clock, (_, dt)) = (self.clock(), self.interval());
        let time_points = self.tables.time_points.iter().chain([&self.tables.top]);
        let mut fluxes: Vec<FluxesAt<M>> = time_points
            .map(|time_point| FluxesAt {
                time: clock.time(time_point.s),
                weight: dt * time_point.weight,
                boundaries: vec![BoundaryFlux::default(); self.problem.kernels.boundaries()],
            })
            .collect();
        let top = fluxes.len() - 1;
        fluxes[top].weight = 0.0;
        let (facets, numbers) = self.fluxes_of_facets(&self.tables.shares_at_top(), velocity_at_top);
        let len = 1 + fluxes.len() * BoundaryFlux::<M>::LEN;
        for facet in self.share.all_in_order(&facets, numbers, len).chunks_exact(len) {
            let boundary = facet[0] as usize;
            for (at, numbers) in fluxes.iter_mut().zip(facet[1..].chunks_exact(BoundaryFlux::<M>::LEN)) {
                at.boundaries[boundary].add_facet(BoundaryFlux::from_numbers(numbers));
            }
        }
        fluxes
    }

    /// For every boundary facet its number in the whole mesh; and its boundary with the fluxes at the time points, which have these `shares` in
    /// (penalty at top), and at the top.
    fn fluxes_of_facets(&self, shares: &[f64], velocity_at_top: Option<&[f64]>) -> (Vec<usize>, Vec<f64>) {
        let (mut facets, mut numbers) = (self.boundary_facets.iter(), Vec::new());
        let mut keys = Vec::with_capacity(facets.len());
        let all = self.facets.batches.iter().filter_map(|batch| batch.boundary.map(|boundary| (boundary, batch)));
        for (boundary, batch) in all {
            let of_batch = self.fluxes_of_batch(batch, shares, velocity_at_top);
            for lane in 0..batch.count {
                keys.extend(facets.next());
                numbers.push(boundary as f64);
                of_batch.iter().for_each(|at| numbers.extend(at[lane].numbers()));
            }
        }
        (keys, numbers)
    }

    /// The fluxes of a batch on a boundary at the time points, and last at the top, `[time][lane]`.
    fn fluxes_of_batch(
        &self,
        batch: &FacetBatch,
        shares: &[f64],
        velocity_at_top: Option<&[f64]>,
    ) -> Vec<Vec<BoundaryFlux<M>>> {
        let time_points = self.tables.time_points.iter().chain([&self.tables.top]).zip(&self.position_rows);
        let origins = self.facet_origins(batch).map(in_space);
        self.facet_scratch.with(|scratch| {
            self.gather_states(Differentiate::Nothing, &[self.traced_state()], batch, scratch);
            self.gather_mesh(Differentiate::Nothing, batch, scratch);
            if let Some(velocity) = velocity_at_top {
                self.gather_boundary_velocity(velocity, batch, &mut scratch.boundary_velocity);
            }
            scratch.penalty.fill(Pack::ZERO);
            let at = |(number, (time_point, row))| {
                let share = shares.get(number).copied();
                let velocity_is_given = share.is_none() && velocity_at_top.is_some();
                let time = FluxTime { time_point, position_row: row, velocity_is_given, share };
                self.across(Differentiate::Nothing, batch, |context, across| {
                    self.problem.kernels.boundary_flux(context, time, across, scratch);
                });
                (0..batch.count).map(|lane| BoundaryFlux::of_lane(scratch, lane, origins[lane])).collect()
            };
            time_points.enumerate().map(at).collect()
        })
    }

    /// Reads the `velocity` of the nodes of a batch on a boundary, `[C0 node][component]`, into `packs`, `[d][face node]`.
    fn gather_boundary_velocity(&self, velocity: &[f64], batch: &FacetBatch, packs: &mut [Pack]) {
        for (lane, end) in batch.ends(0).into_iter().enumerate() {
            let face = self.mesh.numbering().face::<D>(end);
            for (d, packs) in packs.chunks_exact_mut(face.len()).enumerate() {
                packs.iter_mut().zip(&face).for_each(|(pack, node)| pack.0[lane] = velocity[node * D + d]);
            }
        }
    }
}

/// A point in two or three dimensions as three coordinates.
fn in_space(x: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0))
}
