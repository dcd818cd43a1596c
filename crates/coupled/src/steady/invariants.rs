//! The totals of a steady flow that (steady) leaves open.
//!
//! ```text
//! (rho, m, E) := f (rho, m, E),      f = mass_0 / mass                                                          (mass)
//! m := m + rho v,   E := E + m . v + rho v . v / 2,      v = (momentum_0 - momentum) / mass                     (momentum)
//! E := E + (energy_0 - energy) / volume                                                                         (energy)
//! ```
//!
//! Where nothing can change a total of the gas, every value of it has a steady flow. The one with the value of the initial state is found by
//! these changes and a solve after them, until both agree. The first keeps velocities and temperatures, the second temperatures and relative
//! velocities, so few steps follow.

use super::search::{PATIENT, Search, Stage};
use crate::coupled_slab::SlabReport;
use crate::slab_error::SlabError;
use fem::Layout;
use navier_stokes::Conserved;
use newton_krylov::inner_product::largest;
use std::array::from_fn;

/// How often totals are corrected, and their relative error that ends this.
const CORRECTIONS: usize = 8;
const SAME: f64 = 1e-13;

/// The totals of the initial state that no boundary and no source can change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Invariants<const D: usize> {
    /// No gas can enter or leave.
    pub mass: bool,
    /// Nothing exerts a force along these axes: there is no boundary, or frictionless ones along them.
    pub momentum: [bool; D],
    /// Walls are adiabatic and do no work.
    pub energy: bool,
}

/// Totals by their names.
type Totals<const D: usize> = Conserved<f64, D>;

impl<const D: usize, const M: usize> Search<'_, D, M> {
    /// Replaces the steady flow `u` by that with the invariants of the initial state.
    pub(super) fn with_initial_totals(
        &self,
        mut report: SlabReport<M>,
        u: &mut [f64],
        stages: &mut Vec<Stage>,
    ) -> Result<SlabReport<M>, SlabError> {
        if !self.invariants.mass {
            return Ok(report);
        }
        let (mut problem, initial) = (self.discretise)(self.own());
        problem.at_rest(self.times(), &initial, self.displacement)?;
        let named = |totals: &[f64]| Totals::unpack(&from_fn::<f64, M, _>(|m| totals[m]));
        let wanted = named(&problem.flow.totals(&initial));
        let volume = named(&problem.flow.totals(&vec![1.0; initial.len()])).density;
        let layout = problem.flow.operator.layout.at_one_time();
        for _ in 0..CORRECTIONS {
            let found = named(&report.totals);
            if self.invariants.error(&wanted, &found) <= SAME {
                break;
            }
            self.correct(layout, [&wanted, &found], volume, u);
            report = self.solve(self.own(), u, self.with(PATIENT), stages)?;
        }
        Ok(report)
    }

    /// (mass), (momentum) and (energy).
    fn correct(&self, layout: Layout, [wanted, found]: [&Totals<D>; 2], volume: f64, u: &mut [f64]) {
        let factor = wanted.density / found.density;
        let missing = |i: usize| (wanted.momentum[i] - factor * found.momentum[i]) / wanted.density;
        let velocity = from_fn(|i| if self.invariants.momentum[i] { missing(i) } else { 0.0 });
        let missing = wanted.energy - changed(found, factor, &velocity).energy;
        let added = if self.invariants.energy { missing / volume } else { 0.0 };
        for (cell, i) in (0..layout.cells).flat_map(|cell| (0..layout.nodes).map(move |i| (cell, i))) {
            let at = |m: usize| layout.index(cell, 0, m, i);
            let here = changed(&Conserved::unpack(&from_fn::<f64, M, _>(|m| u[at(m)])), factor, &velocity);
            let new: [f64; M] = Conserved { energy: here.energy + added, ..here }.pack();
            (0..M).for_each(|m| u[at(m)] = new[m]);
        }
    }
}

impl<const D: usize> Invariants<D> {
    /// The largest error of a total that is kept. Momentum counts relative to that of all gas at the speed of its thermal energy.
    fn error(self, wanted: &Totals<D>, found: &Totals<D>) -> f64 {
        let thermal = (wanted.density * wanted.energy).sqrt();
        let momenta = (0..D).map(|i| (self.momentum[i], (found.momentum[i] - wanted.momentum[i]).abs() / thermal));
        let errors = [
            (self.mass, (found.density / wanted.density - 1.0).abs()),
            (self.energy, (found.energy / wanted.energy - 1.0).abs()),
        ];
        largest(errors.into_iter().chain(momenta).filter_map(|(is_kept, error)| is_kept.then_some(error)))
    }
}

/// f u with the velocity v in addition.
fn changed<const D: usize>(u: &Conserved<f64, D>, f: f64, v: &[f64; D]) -> Conserved<f64, D> {
    let (density, mut momentum, mut energy) = (f * u.density, u.momentum.map(|m| f * m), f * u.energy);
    for (m, v) in momentum.iter_mut().zip(v) {
        energy += *m * v + 0.5 * density * v * v;
        *m += density * v;
    }
    Conserved { density, momentum, energy }
}
