//! The impulses of follower pressures in a slab.
//!
//! ```text
//! I_a = dt sum_q omega_q phi_a(s_q) f(d(s_q), t(s_q)),    f by (follower pressure)                              (pressure impulse)
//! ```
//!
//! with n = floor(D N_t / 2) + 1 Gauss points s_q. The area vector of a wall has the degree (D - 1) N_t in time, and phi_a has N_t - 1.
//! The rule is exact for a constant pressure, as is that of the flow. A gas at rest and a follower pressure that balances it therefore
//! cancel for any motion. At the time nodes alone they would differ by a term of the order 2 N_t - 1 times a pressure which grows as
//! 1 / M^2 at low Mach numbers M.

use super::StructureSlab;
use crate::slab::accumulate;
use basis::gauss;

/// A point of the rule, in a slab of a given length and motion.
struct ImpulsePoint {
    time: f64,
    /// dt omega_q phi_a(s_q) for every a.
    tested: Vec<f64>,
    /// Phi_b(s_q) for every b.
    integrals: Vec<f64>,
    /// d(s_q)
    displacement: Vec<f64>,
}

impl<const D: usize> StructureSlab<'_, D> {
    /// The points of (pressure impulse) for the velocities `v`; none where no pressure acts.
    fn impulse_points<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = ImpulsePoint> + 'a {
        let time = self.motion.time();
        let count = if self.loads.pressures.is_empty() { 0 } else { D * time.order() / 2 + 1 };
        let rule = gauss(count.max(1)).on(0.0, 1.0);
        rule.points.into_iter().zip(rule.weights).take(count).map(move |(s, weight)| {
            let integrals = time.integrals(s);
            let mut displacement = self.bottom.displacement.to_vec();
            accumulate(self.dt, v, &integrals, &mut displacement);
            let tested = time.values(s).iter().map(|phi| self.dt * weight * phi).collect();
            ImpulsePoint { time: self.clock.time(s), tested, integrals, displacement }
        })
    }

    /// loads += I for the velocities `v`, `[time node][C0 node][component]`.
    pub(super) fn add_pressure_impulses(&self, v: &[f64], loads: &mut [f64]) {
        for point in self.impulse_points(v) {
            let mut force = vec![0.0; self.structure.length()];
            self.structure.add_pressures(self.loads, point.time, &point.displacement, &mut force);
            add_tested(&point.tested, &force, loads);
        }
    }

    /// out -= (dI/dV)(V) w
    pub(super) fn subtract_impulse_product(&self, v: &[f64], w: &[f64], out: &mut [f64]) {
        for point in self.impulse_points(v) {
            let mut along = vec![0.0; self.structure.length()];
            accumulate(self.dt, w, &point.integrals, &mut along);
            let (at, mut change) = ((&point.displacement[..], &along[..]), vec![0.0; along.len()]);
            self.structure.add_pressure_stiffness(self.loads, point.time, at, -1.0, &mut change);
            add_tested(&point.tested, &change, out);
        }
    }
}

/// out_a += tested_a force
fn add_tested(tested: &[f64], force: &[f64], out: &mut [f64]) {
    for (factor, out) in tested.iter().zip(out.chunks_exact_mut(force.len())) {
        out.iter_mut().zip(force).for_each(|(out, force)| *out += factor * force);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::SlabBottom;
    use super::*;
    use crate::testing::{distance, largest, material, noise, unit_box};
    use crate::{Loads, SlabMotion, Structure};
    use basis::RadauTime;
    use mesh::NodeNumbering;

    /// A free box under the pressure `p` on all its sides, in a slab with some motion.
    fn in_slab<const D: usize, R>(order: usize, act: impl Fn(&StructureSlab<'_, D>, &[f64]) -> R) -> R {
        let mesh = unit_box([1; D], 3, 0.02);
        let numbering = NodeNumbering::new(&mesh, 3);
        let free = vec![[false; D]; numbering.count];
        let structure = Structure::new(mesh, numbering, material(), 1.0, free).unwrap();
        let pressure = |_: &[f64; D], _| 3.0;
        let pressures: Vec<(usize, crate::loads::Pressure<D>)> =
            (0..2 * D).map(|boundary| (boundary, Box::new(pressure) as crate::loads::Pressure<D>)).collect();
        let (loads, motion) = (Loads { pressures, ..Loads::default() }, SlabMotion::new(RadauTime::new(order)));
        let displacement: Vec<f64> = noise(structure.length()).iter().map(|d| 0.02 * d).collect();
        let velocity = vec![0.0; structure.length()];
        let bottom = SlabBottom { time: 0.0, displacement: &displacement, velocity: &velocity };
        let v: Vec<f64> = noise(order * structure.length()).iter().map(|v| 0.1 * v).collect();
        act(
            &StructureSlab {
                structure: &structure,
                loads: &loads,
                motion: &motion,
                bottom,
                dt: 0.4,
                clock: fem::Clock::running(0.0, 0.4),
            },
            &v,
        )
    }

    /// The volume of the body, by the divergence theorem with its pressure load.
    fn volume<const D: usize>(slab: &StructureSlab<'_, D>, d: &[f64]) -> f64 {
        let mut force = vec![0.0; d.len()];
        slab.structure.add_pressures(slab.loads, 0.0, d, &mut force);
        let position = slab.structure.coordinates().as_flattened().iter().zip(d).map(|(x, d)| x + d);
        -position.zip(&force).map(|(x, f)| x * f).sum::<f64>() / (3.0 * D as f64)
    }

    /// W = -p (V_{n+1} - V_n) for a constant pressure, whatever the motion.
    fn work_is_that_of_the_volume<const D: usize>() {
        for order in 1..=3 {
            in_slab::<D, _>(order, |slab, v| {
                let mut impulses = vec![0.0; v.len()];
                slab.add_pressure_impulses(v, &mut impulses);
                let work: f64 = impulses.iter().zip(v).map(|(i, v)| i * v).sum();
                let mut top = vec![0.0; slab.structure.length()];
                slab.motion.displacement(slab.dt, slab.bottom.displacement, v, 1.0, &mut top);
                let change = volume(slab, &top) - volume(slab, slab.bottom.displacement);
                assert!((work + 3.0 * change).abs() < 1e-13, "{D}-D, N_t = {order}: {work} for {}", -3.0 * change);
                assert!(change.abs() > 1e-6);
            });
        }
    }

    #[test]
    fn a_constant_pressure_works_as_the_volume_changes() {
        work_is_that_of_the_volume::<2>();
        work_is_that_of_the_volume::<3>();
    }

    #[test]
    fn the_product_is_the_derivative_of_the_impulses() {
        in_slab::<2, _>(2, |slab, v| {
            let (w, step) = (noise(v.len() + 1)[1..].to_vec(), 1e-3);
            let at = |a: f64| {
                let moved: Vec<f64> = v.iter().zip(&w).map(|(v, w)| v + a * w).collect();
                let mut impulses = vec![0.0; v.len()];
                slab.add_pressure_impulses(&moved, &mut impulses);
                impulses
            };
            let difference: Vec<f64> =
                at(step).iter().zip(at(-step)).map(|(plus, minus)| (minus - plus) / (2.0 * step)).collect();
            let mut product = vec![0.0; v.len()];
            slab.subtract_impulse_product(v, &w, &mut product);
            assert!(distance(&product, &difference) < 1e-9 * largest(&product));
        });
    }
}
