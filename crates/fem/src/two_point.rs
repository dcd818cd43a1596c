//! Derivatives of the two-point fluxes of (low order), for many faces at a time.

use crate::conservation_law::{BoundaryPoint, ConservationLaw, Imposed};
use crate::facet::times_normal;
use tensor::pulp::{Simd, WithSimd};
use tensor::{Dual, Lanes, Over, Pack, Real, WIDTH, norm};

/// Faces between two states each, one per lane; lanes without a face repeat the last one.
pub struct FacePairs {
    count: usize,
    components: usize,
    /// States of the minus and the plus side, `[pack][side][component]`; on a boundary plus holds the data of its condition.
    states: Vec<Pack>,
    /// Area vector from minus to plus, mesh velocity, 1/h of (two-point), `[pack][2 D + 1]`.
    geometry: Vec<Pack>,
    /// Derivatives of F^ |S| by the states of each side, `[pack][side][column][row]`.
    derivatives: Vec<Pack>,
}

impl FacePairs {
    /// No faces yet.
    pub(crate) fn new<const M: usize>() -> Self {
        FacePairs { count: 0, components: M, states: Vec::new(), geometry: Vec::new(), derivatives: Vec::new() }
    }

    pub(crate) fn clear(&mut self) {
        self.count = 0;
        self.states.clear();
        self.geometry.clear();
    }

    /// Adds a face between `minus` and `plus` with its area vector, the velocity of the mesh and 1/h.
    pub(crate) fn push<const D: usize, const M: usize>(
        &mut self,
        [minus, plus]: [[f64; M]; 2],
        area: [f64; D],
        velocity: [f64; D],
        near: f64,
    ) {
        if self.count.is_multiple_of(WIDTH) {
            self.states.resize(self.states.len() + 2 * M, Pack::ZERO);
            self.geometry.resize(self.geometry.len() + 2 * D + 1, Pack::ZERO);
        }
        let (lane, first) = (self.count % WIDTH, self.count / WIDTH);
        let fill = |packs: &mut [Pack], number: usize, value: f64| packs[number].0[lane..].fill(value);
        let states = &mut self.states[first * 2 * M..];
        for (number, value) in minus.into_iter().chain(plus).enumerate() {
            fill(states, number, value);
        }
        let geometry = &mut self.geometry[first * (2 * D + 1)..];
        for (number, value) in area.into_iter().chain(velocity).chain([near]).enumerate() {
            fill(geometry, number, value);
        }
        self.count += 1;
    }

    /// Adds `factor` times the derivative by the state of `side` at face `number` to a block.
    pub(crate) fn add(&self, number: usize, side: usize, factor: f64, block: &mut [f64]) {
        let len = self.components * self.components;
        let packs = &self.derivatives[(number / WIDTH * 2 + side) * len..][..len];
        block.iter_mut().zip(packs).for_each(|(entry, pack)| *entry += factor * pack.0[number % WIDTH]);
    }
}

/// Fills the derivatives of `pairs`: between cells, or on a boundary with `condition`.
pub(crate) struct TwoPointFluxes<'a, const D: usize, const M: usize, L: ConservationLaw<D, M>> {
    pub(crate) law: &'a L,
    pub(crate) condition: Option<L::Boundary>,
    /// theta of (two-point).
    pub(crate) dissipation: f64,
    pub(crate) pairs: &'a mut FacePairs,
}

impl<const D: usize, const M: usize, L: ConservationLaw<D, M>> WithSimd for TwoPointFluxes<'_, D, M, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let TwoPointFluxes { law, condition, dissipation, pairs } = self;
        let FacePairs { count, states, geometry, derivatives, .. } = pairs;
        derivatives.resize(count.div_ceil(WIDTH) * 2 * M * M, Pack::ZERO);
        let packs = states.chunks_exact(2 * M).zip(geometry.chunks_exact(2 * D + 1));
        for ((states, geometry), derivatives) in packs.zip(derivatives.chunks_exact_mut(2 * M * M)) {
            for part in 0..Lanes::<S>::PARTS {
                let face = Face::read(simd, geometry, part);
                let pair = [read(simd, states, part), read(simd, &states[M..], part)];
                for number in 0..2 * M {
                    let seeds = seeds(simd, &pair, number);
                    let flux = match condition {
                        None => between(law, &seeds, &face, dissipation),
                        Some(condition) => on_boundary(law, condition, &seeds[0], &pair[1], &face),
                    };
                    for m in 0..M {
                        (flux[m].derivative * face.area).write(&mut derivatives[number * M + m], part);
                    }
                }
            }
        }
    }
}

/// The geometry of a face.
struct Face<G, const D: usize> {
    area: G,
    n: [G; D],
    v: [G; D],
    /// 1/h
    near: G,
}

impl<S: Simd, const D: usize> Face<Lanes<S>, D> {
    #[inline(always)]
    fn read(simd: S, geometry: &[Pack], part: usize) -> Self {
        let mut n: [Lanes<S>; D] = read(simd, geometry, part);
        let area = norm(&n);
        let inverse = area.recip();
        for d in 0..D {
            n[d] = n[d] * inverse;
        }
        Face { area, n, v: read(simd, &geometry[D..], part), near: Lanes::read(simd, &geometry[2 * D], part) }
    }
}

#[inline(always)]
fn read<const C: usize, S: Simd>(simd: S, packs: &[Pack], part: usize) -> [Lanes<S>; C] {
    let mut values = [Lanes::read(simd, &packs[0], part); C];
    for c in 1..C {
        values[c] = Lanes::read(simd, &packs[c], part);
    }
    values
}

/// The states with derivative 1 in component `number` of both.
#[inline(always)]
fn seeds<const M: usize, S: Simd>(simd: S, pair: &[[Lanes<S>; M]; 2], number: usize) -> [[Dual<Lanes<S>>; M]; 2] {
    let zero = Lanes::splat(simd, 0.0);
    let mut seeds = [[Dual::new(zero, zero); M]; 2];
    for side in 0..2 {
        for m in 0..M {
            let derivative = if side * M + m == number { 1.0 } else { 0.0 };
            seeds[side][m] = Dual::new(pair[side][m], Lanes::splat(simd, derivative));
        }
    }
    seeds
}

/// F^ of (two-point).
#[inline(always)]
fn between<const D: usize, const M: usize, L: ConservationLaw<D, M>, T: Over<G>, G: Real>(
    law: &L,
    [minus, plus]: &[[T; M]; 2],
    face: &Face<G, D>,
    theta: f64,
) -> [T; M] {
    let (mut mean, still) = (*minus, [[minus[0].zero(); M]; D]);
    for m in 0..M {
        mean[m] = (minus[m] + plus[m]) * 0.5;
    }
    let mut flux = law.numerical_flux(minus, plus, &face.n, tensor::dot(&face.n, &face.v));
    let (flux_minus, flux_plus) = (law.flux(minus, &still, &face.v), law.flux(plus, &still, &face.v));
    let slope = times_normal(plus, minus, &face.n);
    let mut viscous = law.viscous_flux(&mean, &slope);
    if law.captures_shocks() {
        let artificial = law.artificial_flux(&mean, &slope, artificial_viscosity(law, &mean, &slope, face.near));
        for d in 0..D {
            for m in 0..M {
                viscous[d][m] += artificial[d][m];
            }
        }
    }
    for m in 0..M {
        flux[m] = flux[m] * theta;
        for d in 0..D {
            let central = (flux_minus[d][m] + flux_plus[d][m]) * (0.5 * (1.0 - theta));
            flux[m] += (central - viscous[d][m].scale(face.near)).scale(face.n[d]);
        }
    }
    flux
}

/// beta of (artificial) with the slope between two states at a distance of 1 / `near`.
#[inline(always)]
fn artificial_viscosity<const D: usize, const M: usize, L: ConservationLaw<D, M>, T: Over<G>, G: Real>(
    law: &L,
    mean: &[T; M],
    difference: &[[T; M]; D],
    near: G,
) -> T {
    let (mut gradient, mut grid) = (*difference, [[near.zero(); D]; D]);
    for d in 0..D {
        grid[d][d] = near;
        for m in 0..M {
            gradient[d][m] = difference[d][m].scale(near);
        }
    }
    law.artificial_viscosity(mean, &gradient, &grid)
}

/// The flux through a boundary. The penalty is its only viscous term.
#[inline(always)]
fn on_boundary<const D: usize, const M: usize, L: ConservationLaw<D, M>, T: Over<G>, G: Real>(
    law: &L,
    condition: L::Boundary,
    minus: &[T; M],
    data: &[G; M],
    face: &Face<G, D>,
) -> [T; M] {
    let point = BoundaryPoint { normal: &face.n, velocity: &face.v, data };
    let Imposed { mut flux, state } = law.impose(condition, minus, point);
    if law.is_viscous() {
        let jump = times_normal(minus, &state, &face.n);
        let penalised = law.boundary_viscous_flux(condition, &state, &jump, point);
        for m in 0..M {
            flux[m] += penalised[m].scale(face.near);
        }
    }
    flux
}
