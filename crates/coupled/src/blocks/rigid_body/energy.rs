//! The energy of a rigid body and its balance.
//!
//! ```text
//! dE = sum_a,k W_a,k (terms of inertia of R_a,k) - D,    E = v_c . m v_c / 2 + Omega . H / 2                       (numerical)
//! ```
//!
//! D is the energy that the time integration takes. With translations and one rotation about a fixed axis, on linear springs, it is the energy of
//! the jumps of v_c and Omega at the bottom of the slab, and never negative. Stops are no such springs: the quadrature of their force misses their
//! energy. In a slab that is longer than the contact D may then be negative and as large as E.

use super::RigidBody;
use crate::block::Ledger;
use tensor::dot;

impl<const D: usize> RigidBody<D> {
    /// E at the coordinates `q` and their rates `w`.
    pub fn kinetic_energy(&self, q: &[f64], w: &[f64]) -> f64 {
        0.5 * dot(&self.data.velocity(q, w), &self.momentum(q, w))
    }

    /// The energy in springs.
    pub fn spring_energy(&self, q: &[f64]) -> f64 {
        self.data.coordinates.iter().zip(q).map(|(coordinate, q)| coordinate.spring_energy(*q)).sum()
    }

    /// -D / E, the part of its energy that the time integration gives to a free body that meets a stop in the slab with the rates `z`; 0 for
    /// others. E is the larger energy of bottom and top.
    pub(super) fn energy_gain(&self, z: &[f64]) -> f64 {
        let (count, [q, rates]) = (self.count(), self.at_top(z));
        let driven: Vec<usize> = self.driven().collect();
        let coordinate = |i: usize| &self.data.coordinates[i % count];
        let met = |(i, q): (usize, &f64)| !driven.contains(&(i % count)) && coordinate(i).meets_stop(*q);
        if !self.slab.position.iter().chain(&self.positions(z)).enumerate().any(met) {
            return 0.0;
        }
        let energy = |q: &[f64], w: &[f64]| self.kinetic_energy(q, w) + self.spring_energy(q);
        let largest = energy(&self.slab.position, &self.slab.rate).max(energy(&q, &rates));
        let mut ledger = Ledger::default();
        self.add_forces(z, &mut ledger);
        -ledger.numerical / largest.max(f64::MIN_POSITIVE)
    }

    /// The ledger after a slab with the rates `z`.
    pub(super) fn closed(&self, z: &[f64], before: Ledger) -> Ledger {
        let (q, r) = (self.total(&self.loads, z), self.free_dynamics(z));
        let driven: Vec<usize> = self.driven().collect();
        let mut ledger = Ledger { flow: before.flow + work(&q, z), ..before };
        for (i, (r, q)) in r.iter().zip(&q).enumerate() {
            let open = if driven.contains(&(i % self.count())) { &mut ledger.drive } else { &mut ledger.defect };
            *open += (r - q) * z[i];
        }
        self.add_forces(z, &mut ledger);
        let [q, rates] = self.at_top(z);
        ledger.drive += self.kinetic_energy(&q, &self.released(&q, rates.clone())) - self.kinetic_energy(&q, &rates);
        ledger
    }

    /// Adds the work of outer forces, dampers and the time integration in a slab with the rates `z`.
    fn add_forces(&self, z: &[f64], ledger: &mut Ledger) {
        let (count, positions) = (self.count(), self.positions(z));
        let mut springs = 0.0;
        for (a, (q, w)) in positions.chunks_exact(count).zip(z.chunks_exact(count)).enumerate() {
            let weight = self.slab.dt * self.time().weights()[a];
            let [x, y, z, ..] = self.data.velocity(q, w);
            ledger.force += weight * dot(&self.outer_force(a), &[x, y, z]);
            for ((coordinate, q), w) in self.data.coordinates.iter().zip(q).zip(w) {
                ledger.damped += weight * coordinate.damping * w * w;
                springs += weight * coordinate.spring_force(*q) * w;
            }
        }
        let (top, rates) = (&positions[positions.len() - count..], &z[z.len() - count..]);
        let (bottom, bottom_rates) = (&self.slab.position, &self.slab.rate);
        let kinetic = self.kinetic_energy(top, rates) - self.kinetic_energy(bottom, bottom_rates);
        let stored = self.spring_energy(top) - self.spring_energy(bottom);
        ledger.numerical += work(&self.inertia(z), z) - kinetic + springs - stored;
    }
}

/// sum_a,k Q_a,k W_a,k
fn work(q: &[f64], w: &[f64]) -> f64 {
    q.iter().zip(w).map(|(q, w)| q * w).sum()
}
