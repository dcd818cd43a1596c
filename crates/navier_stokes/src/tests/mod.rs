//! Properties of every flux and every boundary condition, in two and three dimensions.
#![allow(clippy::unwrap_used)]

mod consistency;
mod derivatives;
mod exact;
mod gas;
mod given_inflows;
mod invariance;
mod lanes;
mod openings;
mod shocks;
mod sources;
mod values_at_points;
mod walls;

use crate::*;
use fem::{BoundaryPoint, ConservationLaw, Imposed};
use tensor::{Over, Real, dot, norm};

/// Runs each generic test in two and in three dimensions.
macro_rules! in_both_dimensions {
    ($($name:ident),* $(,)?) => {
        mod plane { $(#[test] fn $name() { super::$name::<2, 4>() })* }
        mod space { $(#[test] fn $name() { super::$name::<3, 5>() })* }
    };
}
pub(super) use in_both_dimensions;

/// Repeatable random numbers: SplitMix64 (Steele, Lea & Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
    pub(super) fn vector<const D: usize>(&mut self, size: f64) -> [f64; D] {
        std::array::from_fn(|_| self.between(-size, size))
    }
    pub(super) fn unit<const D: usize>(&mut self) -> [f64; D] {
        let a: [f64; D] = self.vector(1.0);
        let length = norm(&a);
        a.map(|a| a / length)
    }
    pub(super) fn primitive<const D: usize>(&mut self) -> Primitive<f64, D> {
        Primitive { density: self.between(0.5, 2.0), velocity: self.vector(1.5), pressure: self.between(0.5, 2.0) }
    }
}

/// A point of a boundary.
pub(super) fn at<'a, G, const D: usize, const M: usize>(
    normal: &'a [G; D],
    velocity: &'a [G; D],
    data: &'a [G; M],
) -> BoundaryPoint<'a, G, D, M> {
    BoundaryPoint { normal, velocity, data }
}

/// The data [pressure, vector, temperature] of conditions whose values are given at points.
pub(super) fn values<const D: usize, const M: usize>(pressure: f64, vector: [f64; D], temperature: f64) -> [f64; M] {
    Conserved { density: pressure, momentum: vector, energy: temperature }.pack()
}

/// The arguments of the point functions, with numbers `T` of the state and `G` of the geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<T, G, const D: usize, const M: usize> {
    pub(super) minus: [T; M],
    pub(super) plus: [T; M],
    pub(super) gradient: [[T; M]; D],
    pub(super) n: [G; D],
    pub(super) v: [G; D],
    /// A state.
    pub(super) data: [G; M],
    /// A pressure, a vector and a temperature.
    pub(super) values: [G; M],
}

impl<const D: usize, const M: usize> Point<f64, f64, D, M> {
    pub(super) fn random(random: &mut Random) -> Self {
        let gas = gas();
        Point {
            minus: random.primitive::<D>().pack(&gas),
            plus: random.primitive::<D>().pack(&gas),
            gradient: std::array::from_fn(|_| random.vector(1.0)),
            n: random.unit(),
            v: random.vector(1.0),
            data: random.primitive::<D>().pack(&gas),
            values: values(random.between(0.5, 2.0), random.vector::<D>(1.5), random.between(0.5, 2.0)),
        }
    }
    /// A change of everything.
    pub(super) fn direction(random: &mut Random) -> Self {
        Point {
            minus: random.vector(1.0),
            plus: random.vector(1.0),
            gradient: std::array::from_fn(|_| random.vector(1.0)),
            n: random.vector(1.0),
            v: random.vector(1.0),
            data: random.vector(1.0),
            values: random.vector(1.0),
        }
    }
    /// Combines two points, number by number: those of the state by `state`, those of the geometry by `geometry`.
    pub(super) fn zip<T, G>(
        &self,
        o: &Self,
        state: impl Fn(f64, f64) -> T,
        geometry: impl Fn(f64, f64) -> G,
    ) -> Point<T, G, D, M> {
        Point {
            minus: std::array::from_fn(|c| state(self.minus[c], o.minus[c])),
            plus: std::array::from_fn(|c| state(self.plus[c], o.plus[c])),
            gradient: std::array::from_fn(|i| std::array::from_fn(|c| state(self.gradient[i][c], o.gradient[i][c]))),
            n: std::array::from_fn(|i| geometry(self.n[i], o.n[i])),
            v: std::array::from_fn(|i| geometry(self.v[i], o.v[i])),
            data: std::array::from_fn(|c| geometry(self.data[c], o.data[c])),
            values: std::array::from_fn(|c| geometry(self.values[c], o.values[c])),
        }
    }
}

/// A gas with variable viscosity.
pub(super) fn gas() -> Gas {
    let viscosity = Viscosity::Sutherland { viscosity: 0.1, temperature: 1.2, constant: 0.4 };
    Gas::new(1.4, 0.7, 0.72, viscosity).unwrap()
}

pub(super) const SOLVERS: [Riemann; 4] =
    [Riemann::LaxFriedrichs, Riemann::Hllc, Riemann::Roe, Riemann::LowMachRoe { speed: 0.7 }];

pub(super) fn law<const D: usize>(riemann: Riemann) -> NavierStokes<D> {
    let gas = gas();
    NavierStokes {
        gas,
        riemann,
        reference: Reference::new(&gas, 1.0, 1.0, 1.0).unwrap(),
        source: Source::Given,
        volume_flux: VolumeFlux::Central,
        shock_capturing: Some(ShockCapturing::new(2.0, 0.02).unwrap()),
        wall_flux: WallFlux::Inside,
    }
}

/// The boundary conditions with their vectors: free stream, sliding velocity, inflow direction.
pub(super) struct Conditions<const D: usize> {
    pub(super) free_stream: [f64; D],
    pub(super) slide: [f64; D],
    pub(super) direction: [f64; D],
}

impl<const D: usize> Conditions<D> {
    pub(super) fn sample() -> Self {
        let mut random = Random(9);
        Conditions { free_stream: random.vector(1.0), slide: random.vector(1.0), direction: random.unit() }
    }
    /// The number of conditions at the end of the list that depend on the observer. A reservoir is at rest, a mass flux refers to a plane at
    /// rest, and a sliding velocity at a point is relative to the mesh.
    pub(super) const OF_AN_OBSERVER: usize = 6;

    /// Each condition, named.
    pub(super) fn list(&self) -> Vec<Boundary<D>> {
        let free_stream = Primitive { density: 1.1, velocity: self.free_stream, pressure: 0.9 };
        vec![
            Boundary::FarField(FarField::new(free_stream).unwrap()),
            Boundary::PrescribedState(PrescribedState),
            Boundary::AdiabaticWall(AdiabaticWall::new(self.slide).unwrap()),
            Boundary::IsothermalWall(IsothermalWall::new(1.3, self.slide).unwrap()),
            Boundary::SlipWall(SlipWall),
            Boundary::Symmetry(SlipWall),
            Boundary::Outflow(Outflow::new(0.8, 1.9).unwrap()),
            Boundary::Outflow(Outflow::of_velocity()),
            Boundary::VelocityInflow(VelocityInflow::OfVelocity),
            Boundary::SupersonicInflow(SupersonicInflow),
            Boundary::Inflow(Inflow::new(2.0, 2.5, self.direction).unwrap()),
            Boundary::VelocityInflow(VelocityInflow::OfMassFlux),
            Boundary::Inflow(Inflow::at_points()),
            Boundary::Outflow(Outflow::at_points()),
            Boundary::IsothermalWall(IsothermalWall::at_points()),
            Boundary::AdiabaticWall(AdiabaticWall::at_points()),
        ]
    }
}

/// Some distances between nodes per length that turn with the geometry.
fn grid<G: Real, const D: usize>(n: &[G; D]) -> [[G; D]; D] {
    std::array::from_fn(|i| std::array::from_fn(|j| n[i] * n[j] + if i == j { 3.0 } else { 0.0 }))
}

/// The values of all point functions, the fluxes through a facet with normal n, by name.
pub(super) fn evaluate<T: Over<G>, G: Real, const D: usize, const M: usize>(
    conditions: &[Boundary<D>],
    p: &Point<T, G, D, M>,
) -> Vec<(String, [T; M])> {
    let through = |flux: [[T; M]; D]| -> [T; M] {
        std::array::from_fn(|c| {
            let mut sum = flux[0][c].scale(p.n[0]);
            for i in 1..D {
                sum += flux[i][c].scale(p.n[i]);
            }
            sum
        })
    };
    let base = law::<D>(Riemann::Roe);
    let mut values = vec![
        ("flux".to_string(), through(base.flux(&p.minus, &p.gradient, &p.v))),
        ("viscous flux".to_string(), through(base.viscous_flux(&p.minus, &p.gradient))),
    ];
    for riemann in SOLVERS {
        let law = law::<D>(riemann);
        values.push((format!("{riemann:?}"), law.numerical_flux(&p.minus, &p.plus, &p.n, dot(&p.v, &p.n))));
    }
    let beta = base.artificial_viscosity(&p.minus, &p.gradient, &grid(&p.n));
    values.push(("artificial flux".to_string(), through(base.artificial_flux(&p.minus, &p.gradient, beta))));
    let mirrored = NavierStokes { wall_flux: WallFlux::Mirrored, ..base };
    for &condition in conditions {
        let takes_state = matches!(condition, Boundary::PrescribedState(_) | Boundary::SupersonicInflow(_));
        let at = at(&p.n, &p.v, if takes_state { &p.data } else { &p.values });
        let Imposed { flux, state } = base.impose(condition, &p.minus, at);
        let viscous = base.boundary_viscous_flux(condition, &state, &p.gradient, at);
        values.push((format!("state of {condition:?}"), state));
        values.push((format!("flux of {condition:?}"), flux));
        values.push((format!("viscous flux of {condition:?}"), viscous));
        let artificial = base.boundary_artificial_flux(condition, &state, &p.gradient, beta, at);
        values.push((format!("artificial flux of {condition:?}"), artificial));
        values.push((format!("mirrored flux of {condition:?}"), mirrored.impose(condition, &p.minus, at).flux));
    }
    values
}

/// The largest difference of the components, relative to the largest component (at least 1).
pub(super) fn difference<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    let largest = |u: &[f64; M]| u.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let jump: [f64; M] = std::array::from_fn(|c| a[c] - b[c]);
    assert!(jump.iter().all(|c| c.is_finite()), "{a:?} against {b:?}");
    largest(&jump) / largest(b).max(1.0)
}
